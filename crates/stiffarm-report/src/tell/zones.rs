//! The page of `zones`: where dexterity is high and K_C matters little.

use crate::tell::Given;
use crate::tell::{Block, DataTable, Section, Text, Told};
use crate::zones::zones_figure;
use stiffarm::Result;
use stiffarm::findings::visible;
use stiffarm::model::posture::PostureGroup;
use stiffarm::plan::zones::Zones;

/// What a result says of `zones`.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    let mut zones: Zones = context.saved.result()?;
    for joint in &mut zones.joints {
        *joint = visible(joint).into_owned();
    }
    let [horizontal, vertical] = &zones.joints;
    let done = Text::new(format!(
        "Dexterity and the influence of K_C, what the load adds to the stiffness, were mapped at {} postures over {horizontal} and {vertical}, the other joints held; ",
        zones.postures
    ))
    .number(context.number("/within_limits").decimals(0))
    .words(" of them meet the limits of the cell.");
    let angle = |below: &str| context.number(below).decimals(0);
    let came = match &zones.best {
        Some(_) => Text::new(format!("The best zone is {horizontal} from "))
            .number(angle("/best/q2_deg/0").unit("°"))
            .words(" to ")
            .number(angle("/best/q2_deg/1").unit("°"))
            .words(format!(" and {vertical} from "))
            .number(angle("/best/q3_deg/0").unit("°"))
            .words(" to ")
            .number(angle("/best/q3_deg/1").unit("°"))
            .words(": dexterity 1/k(J_N) up to ")
            .number(context.number("/best/inverse_condition").significant(3))
            .words(", K_C changes the translation by ")
            .number(
                context
                    .number("/best/translation_deviation")
                    .percent()
                    .significant(2),
            )
            .words(" there."),
        None => Text::new("No posture of the map is both dexterous and little touched by K_C."),
    };
    let next = match &zones.best {
        Some(_) => Text::new("Place measuring postures there, as Dumas et al. do, or let ")
            .code("stiffarm select")
            .words(" weigh what they tell of the stiffness itself."),
        None => Text::new("Hold the other joints elsewhere (")
            .code("--q-deg")
            .words("), widen the limits, or choose postures with ")
            .code("stiffarm select")
            .words("."),
    };
    let has_zone = zones.best.is_some();
    let mut key = match has_zone {
        true => DataTable::new(
            "Range over the map, and the most dexterous posture of the best zone",
            ["quantity", "smallest", "median", "largest", "best posture"],
        ),
        false => DataTable::new(
            "Range over the map",
            ["quantity", "smallest", "median", "largest"],
        ),
    };
    let rows = [
        (
            "dexterity 1/k(J_N)",
            "inverse_condition_range",
            "inverse_condition",
            1.0,
        ),
        (
            "translation with against without K_C [%]",
            "translation_range",
            "translation_deviation",
            100.0,
        ),
        (
            "rotation with against without K_C [%]",
            "rotation_range",
            "rotation_deviation",
            100.0,
        ),
    ];
    for (name, range, best, factor) in rows {
        let of = |below: String| {
            let number = context.number(&below).times(factor);
            Text::from(number.significant(3))
        };
        let ends = ["smallest", "median", "largest"].map(|end| of(format!("/{range}/{end}")));
        let best = has_zone.then(|| of(format!("/best/{best}")));
        key.row(name, ends.into_iter().chain(best));
    }
    let mut sections = Vec::new();
    if let Some(best) = &zones.best {
        let group = PostureGroup::from_angles("best posture", [best.best_q.clone()]);
        sections.push(context.cell_section(
            &[group],
            "The cell at the most dexterous posture of the best zone.",
        )?);
    }
    let map = Block::Figure(zones_figure(&zones));
    sections.insert(0, Section::new("zones", "The maps", vec![map]));
    let heading = "Zones for stiffness identification".to_string();
    let told = context.told(heading, [done, came, next], Some(key), sections);
    let none = "No posture of the map is in a good zone.";
    Ok(told.caution("zones", zones.best.is_none().then_some(none)))
}
