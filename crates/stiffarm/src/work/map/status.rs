//! Whether the arm may be at a pose, and if not, why.

use serde::{Deserialize, Serialize};

/// Whether the arm may hold the tip there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// It may.
    Reachable,
    /// Every posture within the cell's bounds violates a limit of the cell.
    Forbidden,
    /// Every posture is outside the cell's bounds, or the machine's limits.
    OutsideJointLimits,
    /// There is no posture.
    Unreachable,
    /// Of a path: no posture can be followed along it.
    Discontinuous,
    /// The user stopped the work before it was looked at.
    NotComputed,
}

impl Status {
    /// Words for tables and legends.
    pub fn describe(self) -> &'static str {
        match self {
            Status::Reachable => "reachable",
            Status::Forbidden => "forbidden by the cell's limits",
            Status::OutsideJointLimits => "outside the joint limits",
            Status::Unreachable => "unreachable",
            Status::Discontinuous => "not in one go",
            Status::NotComputed => "not computed",
        }
    }
}
