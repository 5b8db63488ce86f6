//! What to know about the stiffness, in lines.

use crate::table::yellow;
use stiffarm::findings::Finding;

/// Notes as lines.
pub(super) fn said(notes: &[Finding]) -> String {
    let note = yellow("note");
    let line = |finding: &Finding| format!("{note}: {}\n", finding.sentence);
    notes.iter().map(line).collect()
}
