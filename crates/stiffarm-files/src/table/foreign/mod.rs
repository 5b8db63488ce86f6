//! Tables that another software wrote: names that hold several names, times as clocks show them,
//! several files as one table, names that stand in a sheet beside them.
//!
//! What a file needs beyond its headings stands in `[columns]` of the cell file
//! ([`Columns`]). After [`finish`] a table is like one of our own.

mod by_sheet;
mod join;
mod names;
mod order;
mod times;

pub(super) use by_sheet::{put, take};
pub(super) use join::join;
pub(super) use names::Names;
pub(super) use times::DATED;

use super::grid::Table;
use stiffarm::error::Result;
use stiffarm::model::cell::Columns;

/// Makes a table one of our own: compound names split, clock times in seconds.
///
/// # Errors
/// A name that does not fit the pattern, a time that cannot be read, dates whose order of day
/// and month nothing tells.
pub(super) fn finish(table: &mut Table<'_>, foreign: &Columns, names: &Names<'_>) -> Result<()> {
    if let Some(pattern) = &foreign.name_pattern {
        names::split(table, pattern, names)?;
    }
    times::to_seconds(table, foreign.dates)
}
