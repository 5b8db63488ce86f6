//! Headings of tables that another software writes.

use std::collections::BTreeMap;

/// How the headings of measurement tables and paths translate: matched without case and
/// outer spaces.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Columns {
    /// Our heading, with the unit that the table has, to theirs:
    /// `x_mm` to `Center X`.
    pub names: BTreeMap<String, String>,
    /// Their headings of columns that do not matter.
    pub ignore: Vec<String>,
}
