//! One file per command: read, call the library, write.

pub mod capsules;
pub mod check;
pub mod compensate;
pub mod completions;
pub mod coverage;
pub mod docs;
mod earlier;
pub mod evaluate;
pub mod export;
#[cfg(feature = "schema")]
pub mod generated;
pub mod identify;
pub mod init;
pub mod man;
pub mod map;
pub mod measure;
pub mod pose;
pub mod predict;
pub mod register;
pub mod report;
pub mod robots;
pub mod route;
pub mod schema;
pub mod select;
pub mod simulate;
pub mod study;
pub mod validate;
pub mod zones;

use crate::screen::{columns, wrapped};
use crate::table::weight;
use stiffarm::findings::Finding;

/// A finding as a line of its own.
pub fn finding_line(finding: &Finding) -> String {
    let severity = weight(finding.severity);
    // Many sentences begin with what they are about.
    if finding
        .sentence
        .to_lowercase()
        .starts_with(&finding.subject.to_lowercase())
    {
        format!("{severity}: {}\n", finding.sentence)
    } else {
        format!("{severity}: {}: {}\n", finding.subject, finding.sentence)
    }
}

/// A finding in lines of the terminal's width, without a line end.
pub fn wrapped_line(finding: &Finding) -> String {
    wrapped(finding_line(finding).trim_end(), columns())
}
