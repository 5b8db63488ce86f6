//! What all ways to work have in common.

use super::options::SelectOptions;
use crate::model::cell::Cell;
use crate::model::posture::Posture;
use crate::plan::select::RoundReport;
use serde::{Deserialize, Serialize};
use std::fmt;

/// What the result holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// A plan from a global search.
    Global,
    /// A plan improved from an initial group.
    From,
    /// Postures beside given ones.
    Add,
    /// Given postures with some left out.
    Drop,
    /// The best value for each number of postures.
    Curve,
    /// Postures that cover the joint space evenly.
    SpaceFilling,
    /// The best postures of a list.
    Candidates,
}

/// Options of a result: what was asked, and what else it depends on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Options"))]
pub struct SelectResultOptions {
    /// How it was made.
    pub mode: Mode,
    /// What was asked.
    #[serde(flatten)]
    pub select: SelectOptions,
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
}

impl SelectResultOptions {
    pub(super) fn new(mode: Mode, options: &SelectOptions, cell: &Cell) -> Self {
        SelectResultOptions { mode, select: options.clone(), characteristic_length_m: cell.characteristic_length }
    }
}

/// A result `R` with the options that it depends on, and what to do with it.
#[derive(Debug, Clone)]
pub struct Planned<R> {
    /// The result.
    pub result: R,
    /// Options that the result depends on.
    pub options: SelectResultOptions,
    /// Seed of the random numbers, where there are any.
    pub seed: Option<u64>,
    /// The cell that the result holds for: with its characteristic length, where it has one, and with the load
    /// that was chosen.
    pub cell: Cell,
    /// The postures to drive to (new ones beside given ones; those that stay where some are left out), under
    /// their names; none for a curve.
    pub postures: Vec<Posture>,
}

/// What the work is at; its words are those of [`fmt::Display`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Stage {
    /// A round of the search is over.
    Round(RoundReport),
    /// Begins to bound what any plan of as many postures can give.
    Bounding {
        /// Number of postures.
        postures: usize,
    },
    /// Begins to bound what each joint can have.
    BoundingJoints,
    /// Begins to select the last group of a curve.
    LastSize {
        /// Number of postures.
        postures: usize,
    },
    /// Begins to bound what a group of any size can give.
    BoundingSizes,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Stage::Round(round) => write!(f, "selecting: round {}", round.rounds),
            Stage::Bounding { postures: 1 } => f.write_str("bounding what 1 posture can give"),
            Stage::Bounding { postures } => write!(f, "bounding what {postures} postures can give"),
            Stage::BoundingJoints => f.write_str("bounding what each joint can have"),
            Stage::LastSize { postures } => {
                write!(f, "selecting {postures} postures, the last size")
            }
            Stage::BoundingSizes => f.write_str("bounding what any group can give"),
        }
    }
}
