//! `--drop`: which given postures are least worth their measuring time.

use super::super::postures::name_of;
use super::super::worth::{index_number, index_says};
use crate::selection::{IndexUnit, index_name, worth_figure};
use crate::tell::Given;
use crate::tell::{Block, DataTable, Section, Text, Told};
use serde::Deserialize;
use stiffarm::Result;
use stiffarm::findings::{list, visible};
use stiffarm::model::posture::PostureGroup;
use stiffarm::plan::select::Dropped;
use stiffarm::units::deg_to_rad;

/// What `select --drop` writes.
#[derive(Deserialize)]
struct DropResult {
    #[serde(default)]
    posture_names: Vec<String>,
    #[serde(default)]
    postures_deg: Vec<Vec<f64>>,
    #[serde(flatten)]
    dropped: Dropped,
}

/// The part of a page for postures of which some are left out.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    let result: DropResult = context.saved.result()?;
    let dropped = &result.dropped;
    let index = dropped.index;
    let names = |positions: &[usize]| -> Vec<String> {
        let each = positions.iter().map(|p| name_of(&result.posture_names, *p));
        each.collect()
    };
    let all = dropped.values.len();
    let done = match dropped.exhaustive {
        true => Text::new(format!(
            "Of {all} given postures, every way of leaving out {} was compared.",
            dropped.dropped.len()
        )),
        false => Text::new(format!(
            "Of {all} given postures, {} were left out one after the other, each time the one least missed.",
            dropped.dropped.len()
        )),
    };
    let came = Text::new(index_says(index))
        .number(index_number(context, index, "/value"))
        .words(format!(
            " without {}, against ",
            list(&names(&dropped.dropped))
        ))
        .number(index_number(context, index, "/before"))
        .words(format!(" with all {all}."));
    let next = Text::new(format!(
        "Measure the other {}, where that loss is worth the time saved; else keep them all.",
        dropped.kept.len()
    ));
    let unit = match IndexUnit::of(index).unit {
        "" => String::new(),
        unit => format!(" [{unit}]"),
    };
    let mut key = DataTable::new(
        "What is lost without one posture, the least first",
        [
            "posture".to_string(),
            format!("{} without it{unit}", index_name(index)),
            "loss [%]".to_string(),
            "verdict".to_string(),
        ],
    );
    for (v, value) in dropped.values.iter().enumerate() {
        let verdict = match (dropped.dropped.contains(&value.posture), value.loss) {
            (true, _) => Text::default().strong("leave out"),
            (false, None) => Text::from("needed: a joint is undetermined without it"),
            (false, Some(_)) => Text::from("keep"),
        };
        let cells = [
            index_number(context, index, &format!("/worth/{v}/value"))
                .bare()
                .into(),
            context
                .number(&format!("/worth/{v}/loss"))
                .percent()
                .bare()
                .decimals(2)
                .into(),
            verdict,
        ];
        key.row(name_of(&result.posture_names, value.posture), cells);
    }
    let mut sections = Vec::new();
    let group = |name: &str, positions: &[usize]| {
        let angles = positions.iter().filter_map(|p| result.postures_deg.get(*p));
        let angles = angles.map(|q| q.iter().copied().map(deg_to_rad).collect());
        PostureGroup::named(name, &names(positions), angles)
    };
    if !result.postures_deg.is_empty() {
        let groups = [
            group("postures that stay", &dropped.kept),
            group("left out", &dropped.dropped),
        ];
        sections.push(context.cell_section(
            &groups,
            "Step through the postures that stay, and lay those that are left out over them.",
        )?);
    }
    let shown: Vec<String> = result
        .posture_names
        .iter()
        .map(|name| visible(name).into_owned())
        .collect();
    let figure = worth_figure(&dropped.values, &shown);
    sections.push(Section::new(
        "worth",
        "What each posture is worth",
        vec![Block::Figure(figure)],
    ));
    let verdict = [done, came, next];
    Ok(context.told(
        "Postures to leave out".to_string(),
        verdict,
        Some(key),
        sections,
    ))
}
