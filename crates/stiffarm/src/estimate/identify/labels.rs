//! What stands behind the rows of a system, and how they are weighed.

use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Where the relative size of the errors of single displacements comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Weights {
    /// All readings alike, each counted as often as it was taken.
    #[default]
    Readings,
    /// From the uncertainty that the tracker states with each reading, else its range and angle model:
    /// `[tracker]` of the cell.
    Tracker,
}

/// Rows of a system that belong together: the three of a displacement, or those
/// that a clamped posture gives in one state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowLabel {
    /// Index of the measured posture (posture and load state).
    pub measured: usize,
    /// Index of the displacement in it; 0 for a clamped posture.
    pub displacement: usize,
    /// The rows.
    pub rows: Range<usize>,
}
