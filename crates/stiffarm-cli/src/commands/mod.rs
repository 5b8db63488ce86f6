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
use stiffarm::model::cell::Cell;
use stiffarm::plan::characteristic_length;
use stiffarm::units::m_to_mm;

/// The cell with the characteristic length of Eq. (20), and a line that says
/// so where it had to be computed. A robot that has none stays without: the
/// indices that need it do not exist, or say why.
fn with_length(cell: Cell) -> (Cell, String) {
    if cell.characteristic_length.is_some() {
        return (cell, String::new());
    }
    let (cell, missing) = characteristic_length::with_length(cell);
    let line = match cell.characteristic_length {
        Some(length) => format!(
            "characteristic length: {:.1} mm, computed (robot.characteristic_length_mm is not set)\n",
            m_to_mm(length)
        ),
        None => format!(
            "characteristic length: none; {}\n",
            missing.unwrap_or_default()
        ),
    };
    (cell, line)
}

/// A finding as a line of its own.
pub fn finding_line(finding: &Finding) -> String {
    let severity = weight(finding.severity);
    // Many sentences begin with what they are about.
    match finding
        .sentence
        .to_lowercase()
        .starts_with(&finding.subject.to_lowercase())
    {
        true => format!("{severity}: {}\n", finding.sentence),
        false => format!("{severity}: {}: {}\n", finding.subject, finding.sentence),
    }
}

/// A finding in lines of the terminal's width, without a line end.
pub fn wrapped_line(finding: &Finding) -> String {
    wrapped(finding_line(finding).trim_end(), columns())
}
