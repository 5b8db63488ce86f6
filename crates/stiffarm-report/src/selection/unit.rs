//! How indices are named and in which units they are shown.

use stiffarm::plan::index::Index;

/// The unit that people read an index in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IndexUnit {
    /// The shown number is the value times this.
    pub factor: f64,
    /// Its unit; empty for a pure number.
    pub unit: &'static str,
}

impl IndexUnit {
    /// The unit of an index.
    pub fn of(index: Index) -> Self {
        let (factor, unit) = if index.is_relative_error() {
            (100.0, "%")
        } else if index.is_length() {
            (1e3, "mm")
        } else {
            (1.0, "")
        };
        IndexUnit { factor, unit }
    }
}

/// The name of an index in words: `expected error`.
pub fn index_name(index: Index) -> String {
    index.as_str().replace('_', " ")
}
