//! Findings as lines of the terminal.

use crate::screen::{columns, wrapped};
use crate::table::weight;
use stiffarm::findings::Finding;
use stiffarm::units::sentence_with_minus;

/// A finding as a line of its own.
pub fn finding_line(finding: &Finding) -> String {
    let severity = weight(finding.severity);
    // Many sentences begin with what they are about.
    let sentence = sentence_with_minus(&finding.sentence);
    if finding.sentence.to_lowercase().starts_with(&finding.subject.to_lowercase()) {
        format!("{severity}: {sentence}\n")
    } else {
        format!("{severity}: {}: {sentence}\n", finding.subject)
    }
}

/// A finding in lines of the terminal's width, without a line end.
pub fn wrapped_line(finding: &Finding) -> String {
    wrapped(finding_line(finding).trim_end(), columns())
}
