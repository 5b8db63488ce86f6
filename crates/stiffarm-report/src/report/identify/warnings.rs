//! What to look at, in the order in which the terminal says it.

use super::story::brief;
use crate::page::{Block, Section, Text};
use crate::report::context::Context;
use stiffarm::estimate::identified::Identified;
use stiffarm::findings::{Finding, Severity};

/// The gravest first; among equals what the readings themselves say, then what became of them, then what the fit says.
pub(super) fn sort(warnings: &mut [Finding], found: &Identified) {
    let screening = found.screening();
    let scales = screening.into_iter().flat_map(|s| s.scales());
    let faults = screening.into_iter().flat_map(|s| &s.findings);
    let reduction = found.readings.iter().flat_map(|r| &r.reduction.findings);
    let readings = scales.chain(faults).chain(reduction);
    let order: Vec<&Finding> = readings.chain(computed(found)).collect();
    warnings.sort_by_key(|finding| {
        let place = order.iter().position(|own| *own == finding);
        (
            std::cmp::Reverse(finding.severity),
            place.unwrap_or(order.len()),
        )
    });
}

/// What the fit says.
fn computed(found: &Identified) -> impl Iterator<Item = &Finding> {
    let diagnosed = found.diagnosis.iter().flat_map(|d| &d.findings);
    let budget = found.budget.iter().flat_map(|b| &b.findings);
    let profiled = found.profile.iter().map(|p| &p.finding);
    diagnosed.chain(budget).chain(profiled)
}

/// Takes away what follows from a wrong scale, and folds it into a section of its own.
pub(super) fn held_back(warnings: &mut Vec<Finding>, found: &Identified) -> Option<Section> {
    let mut scales = found.screening().into_iter().flat_map(|s| s.scales());
    if !scales.any(|finding| finding.severity == Severity::Serious) {
        return None;
    }
    let of_fit: Vec<&Finding> = computed(found).collect();
    let (held, kept): (Vec<Finding>, Vec<Finding>) = std::mem::take(warnings)
        .into_iter()
        .partition(|finding| of_fit.contains(&finding));
    *warnings = kept;
    let summary = match held.len() {
        0 => return None,
        1 => "1 caution".to_string(),
        count => format!("{count} cautions"),
    };
    let blocks = vec![
        Block::Text(Text::new(
            "It mostly follows from the wrong scale: settle that first.",
        )),
        Block::Details(summary, vec![Block::Findings(held)]),
    ];
    Some(Section::new(
        "held-back",
        "What the fit says besides",
        blocks,
    ))
}

/// What is missing without a budget of systematic errors.
pub(super) fn no_budget(context: &Context<'_>, found: &Identified) -> Option<Finding> {
    if found.budget.is_some() {
        return None;
    }
    let why = match brief(context) {
        true => " (--brief)",
        false => "",
    };
    let rest = match found.diagnosis.is_some() {
        true => "",
        false => ", and nothing has looked for readings that do not fit",
    };
    let sentence = format!(
        "There is no budget of systematic errors{why}: force, geometry, registration and lost motion can make each k \
         wrong by more than its ±{rest}."
    );
    let code = "no-systematic-errors";
    Some(Finding::new(code, Severity::Caution, "budget", sentence))
}
