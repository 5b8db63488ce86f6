//! What to know before relying on the stiffness, in the order in which one acts.

use super::{counted, shown};
use crate::summary::{Block, Section, Text};
use stiffarm::ask::identify::{Identified, IdentifiedOptions};
use stiffarm::estimate::identify::Estimates;
use stiffarm::findings::{Finding, Severity, list};
use stiffarm::measure::is_of_table;

/// Findings about data and fit.
pub(super) struct Findings {
    /// What the readings say of themselves, then what the fit says.
    pub data: Vec<Finding>,
    /// What only follows from a wrong scale.
    pub held_back: Option<Section>,
}

/// The findings of a result.
pub(super) fn of(options: &IdentifiedOptions, identified: &Identified) -> Findings {
    let mut data: Vec<Finding> = identified.of_readings().cloned().collect();
    data.extend(stopped(&identified.not_computed));
    data.extend(no_systematic(options, identified));
    let mut fit = together(&identified.identification.estimates);
    fit.extend(identified.of_fit().cloned());
    let mut scales = identified.screening().into_iter().flat_map(|screening| screening.scales());
    let misread = scales.any(Finding::is_serious);
    let held_back = if misread {
        held_back(fit)
    } else {
        data.extend(fit);
        None
    };
    let mut seen = Vec::new();
    data.retain(|finding| {
        let is_new = !seen.contains(finding) && !is_noted(finding);
        seen.push(finding.clone());
        is_new
    });
    Findings { data, held_back }
}

/// Whether a finding is a remark on the table, which stands with what the result rests on.
pub(super) fn is_noted(finding: &Finding) -> bool {
    finding.severity == Severity::Note && is_of_table(finding)
}

/// The gravest first.
pub(super) fn sort(findings: &mut [Finding]) {
    findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
}

/// Unknowns that the data tell apart only together.
fn together(estimates: &Estimates) -> Vec<Finding> {
    let said = estimates.collinear.iter().map(|set| {
        let determined = match set.determined {
            1 => "only one combination of them is".to_string(),
            count => format!("only {count} combinations of them are"),
        };
        let names = list(&shown(&set.unknowns));
        let sentence = format!(
            "These measurements hardly tell {names} apart: their columns are nearly collinear, {determined} \
             determined. Their single values mean nothing; other postures or loads would separate them."
        );
        Finding::caution("nearly-collinear", names, sentence)
    });
    said.collect()
}

/// What the user did not wait for.
fn stopped(not_computed: &[String]) -> Option<Finding> {
    let words = |name: &String| match name.as_str() {
        "bootstrap" => "the bootstrap intervals",
        "elastic" => "what gives way beyond the joint axes",
        "profile" => "the profile of the likelihood",
        "systematic_errors" => "the errors common to the whole experiment",
        "diagnosis" => "the diagnosis (readings that do not fit, leave-one-out, extra terms)",
        _ => "the next posture",
    };
    let names: Vec<&str> = not_computed.iter().map(words).collect();
    let verb = if names.len() == 1 { "was" } else { "were" };
    let sentence = format!(
        "The command was stopped before it was done: {} {verb} not computed. The estimates and their intervals by the \
         scatter of the readings are complete.",
        list(&names)
    );
    (!names.is_empty()).then(|| Finding::caution("stopped", "identify", sentence))
}

/// What is missing without systematic errors.
fn no_systematic(options: &IdentifiedOptions, identified: &Identified) -> Option<Finding> {
    if identified.systematic_errors.is_some() {
        return None;
    }
    let why = if options.brief { " (--brief)" } else { "" };
    let rest =
        if identified.diagnosis.is_some() { "" } else { ", and nothing has looked for readings that do not fit" };
    let sentence = format!(
        "Systematic errors were not examined{why}: force, geometry, registration and lost motion can make each k wrong \
         by more than its ±{rest}."
    );
    let code = "no-systematic-errors";
    Some(Finding::caution(code, "systematic_errors", sentence))
}

/// What mostly follows from a wrong scale, folded away.
fn held_back(held: Vec<Finding>) -> Option<Section> {
    let summary = counted(held.len(), "finding");
    let blocks = vec![
        Block::Text(Text::new("It mostly follows from the wrong scale: settle that first.")),
        Block::Details(summary, vec![Block::Findings(held.clone())]),
    ];
    (!held.is_empty()).then(|| Section::new("held-back", "What the fit says besides", blocks))
}
