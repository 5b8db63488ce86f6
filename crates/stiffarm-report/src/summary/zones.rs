//! What `zones` says: where dexterity is high and K_C matters little.

use super::map::RANGE;
use super::worth::length_in_words;
use crate::summary::{Block, Context, DataTable, Number, Quantity, Section, Summarise, Summary, Text, counted};
use crate::zones::zones_figure;
use stiffarm::Result;
use stiffarm::ask::zones::ZonesResultOptions;
use stiffarm::findings::{list, visible};
use stiffarm::model::posture::PostureGroup;
use stiffarm::plan::zones::Zones;
use stiffarm::units::{rad_to_shortest_deg, rounded, with_minus};

impl Summarise<ZonesResultOptions> for Zones {
    fn summary(&self, options: &ZonesResultOptions, context: &Context<'_>) -> Result<Summary> {
        let mut zones = self.clone();
        for joint in &mut zones.joints {
            *joint = visible(joint).into_owned();
        }
        let [horizontal, vertical] = &zones.joints;
        let held = zones.held.iter().enumerate();
        let held = held.filter_map(|(j, q)| Some(format!("q{} = {}", j + 1, degrees((*q)?))));
        let held: Vec<String> = held.collect();
        let what_was_done = Text::new(format!(
            "Dexterity and the influence of K_C, what the load adds to the stiffness, were mapped at {} postures: \
         {horizontal} {}, {vertical} {}, with {}; ",
            zones.postures,
            ends(&zones.q2),
            ends(&zones.q3),
            list(&held)
        ))
        .number(Number::count(zones.within_limits))
        .words(" of them meet the limits of the cell.");
        let angle = |angle: f64| Number::degrees(angle).decimals(0).unit("°");
        let conclusion = match &zones.best {
            Some(best) => Text::new(format!("The best zone is {horizontal} from "))
                .number(angle(best.q2[0]))
                .words(" to ")
                .number(angle(best.q2[1]))
                .words(format!(" and {vertical} from "))
                .number(angle(best.q3[0]))
                .words(" to ")
                .number(angle(best.q3[1]))
                .words(": dexterity 1/k(J_N) up to ")
                .number(Number::new(best.inverse_condition).significant(3))
                .words(", K_C changes the translation by ")
                .number(Number::new(best.translation_deviation).of(Quantity::PERCENT))
                .words(" there."),
            None => Text::new("No posture of the map is both dexterous and little affected by K_C."),
        };
        let next_step = match &zones.best {
            Some(_) => Text::new("Place measuring postures there, as Dumas et al. do, or let ")
                .code("stiffarm select")
                .words(" weigh what they tell of the stiffness itself."),
            None => Text::new("Hold the other joints elsewhere (")
                .code("--q-deg")
                .words("), widen the limits, or choose postures with ")
                .code("stiffarm select")
                .words("."),
        };
        let best = zones.best.as_ref();
        let mut key = if best.is_some() {
            DataTable::new(
                "Range over the map, and the most dexterous posture of the best zone",
                ["quantity", "smallest", "median", "largest", "best posture"],
            )
        } else {
            DataTable::new("Range over the map", ["quantity", "smallest", "median", "largest"])
        };
        let rows = [
            ("dexterity 1/k(J_N)", zones.inverse_condition_range, best.map(|best| best.inverse_condition), 1.0),
            (
                "change of translation by K_C [%]",
                zones.translation_range,
                best.map(|best| best.translation_deviation),
                100.0,
            ),
            ("change of rotation by K_C [%]", zones.rotation_range, best.map(|best| best.rotation_deviation), 100.0),
        ];
        for (name, range, best, factor) in rows {
            let of = |value: Option<f64>| {
                let number = Number::new(value).times(factor);
                Text::from(number.significant(3))
            };
            let ends = RANGE.map(|(_, end)| of(range.as_ref().map(end)));
            let best = best.map(|best| of(Some(best)));
            key.row(name, ends.into_iter().chain(best));
        }
        let mut sections = Vec::new();
        if let Some(best) = &zones.best {
            let group = PostureGroup::from_angles("best posture", [best.best_q.clone()]);
            sections.push(context.cell_section(&[group], "The cell at the most dexterous posture of the best zone.")?);
        }
        let map = Block::Figure(zones_figure(&zones));
        let mut blocks = vec![map];
        if let Some(best) = &zones.best {
            let angles: Vec<String> = best.best_q.iter().map(|q| degrees(*q)).collect();
            let count = counted(best.posture_count, "posture");
            blocks.push(Block::Text(Text::new(format!(
            "The best zone has {count} of the map, with 1/k(J_N) in its upper quarter and both deviations in its lower \
             half. Its most dexterous posture: {}.",
            angles.join(", ")
        ))));
        }
        blocks.extend(length_in_words(context, options.characteristic_length_m).map(Block::Text));
        sections.insert(0, Section::new("zones", "The maps", blocks).in_summary());
        let heading = "Zones for stiffness identification".to_string();
        let summary = context.summary(Vec::new(), heading, [what_was_done, conclusion, next_step], Some(key), sections);
        let none = "No posture of the map is in a good zone.";
        Ok(summary.caution("zones", zones.best.is_none().then_some(none)))
    }
}

/// An angle \[rad\] in degrees, without digits nobody set.
fn degrees(angle: f64) -> String {
    format!("{}°", with_minus(rounded(rad_to_shortest_deg(angle), 2).to_string()))
}

/// From where to where the angles of a map go.
fn ends(angles: &[f64]) -> String {
    match angles {
        [low, .., high] => format!("from {} to {}", degrees(*low), degrees(*high)),
        _ => String::new(),
    }
}
