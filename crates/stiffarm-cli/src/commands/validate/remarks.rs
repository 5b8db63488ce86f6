//! What else to know about a validation: its readings, its stiffness.

use crate::table::yellow;
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::estimate::saved::Saved;
use stiffarm::estimate::validate::Validation;
use stiffarm::findings::{Finding, Severity, list};

/// The validation with what else to know.
#[derive(Serialize, JsonSchema)]
pub struct Validated {
    /// The validation.
    #[serde(flatten)]
    pub validation: Validation,
    /// What to know about the readings and the stiffness.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<Finding>,
}

/// What to know about the stiffness before reading on.
pub(super) fn notes(saved: &Saved, same_cell: bool, result: &Validation) -> Vec<Finding> {
    let mut out = Vec::new();
    let mut add = |code: &str, sentence: String| {
        out.push(Finding::new(code, Severity::Caution, "stiffness", sentence));
    };
    for doubt in &saved.predictor.doubts {
        add(&doubt.code, doubt.sentence.clone());
    }
    if !same_cell {
        let sentence = "The stiffness was identified with another version of this cell.";
        add("other-cell", sentence.to_string());
    }
    let mut seen: Vec<&str> = result
        .points
        .iter()
        .map(|p| p.posture.as_str())
        .filter(|p| saved.postures.iter().any(|s| s == p))
        .collect();
    seen.dedup();
    if !seen.is_empty() {
        let (verb, them) = if seen.len() == 1 {
            ("Posture", "its deviations")
        } else {
            ("Postures", "their deviations")
        };
        let sentence = format!(
            "{verb} {} took part in the identification: {them} say little.",
            list(&seen)
        );
        add("seen-postures", sentence);
    }
    out
}

/// The same as lines.
pub(super) fn said(notes: &[Finding]) -> String {
    let note = yellow("note");
    let line = |finding: &Finding| format!("{note}: {}\n", finding.sentence);
    notes.iter().map(line).collect()
}
