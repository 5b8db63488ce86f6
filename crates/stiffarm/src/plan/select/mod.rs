//! Choosing postures: the paper's procedure, from an initial group (Section
//! III.B), global search, and what goes with them.

mod accept;
mod candidates;
mod error_by_count;
mod exchange;
mod from_group;
mod global;
mod load_design;
mod posture_value;
mod predicting;
mod price;
mod repair;
mod search;
mod selection;
mod sensitivity;
mod space_filling;

pub use super::random::{SMALL_WRIST_RAD, StartKind, random_group};
pub use crate::numerics::optimise::Options as LocalOptions;
pub use accept::Accept;
pub use candidates::{CandidateOptions, CandidateSelection, ForbiddenCandidate, select_candidates};
pub(crate) use error_by_count::error_at_count;
pub use error_by_count::{ErrorAtCount, error_by_count};
pub use from_group::select_from;
pub use global::{GlobalOptions, select, select_watched};
pub use load_design::{DesignedLoad, LoadDesign};
pub use posture_value::{Dropped, PostureValue, drop_postures, evaluations as drop_evaluations};
pub use price::{LimitPrice, limit_prices};
pub use selection::{RoundReport, Selection, different, limits_of, repeats, smallest_margin};
pub use sensitivity::{PriorCase, Sensitivity, SensitivityOptions, Spread, WORTH_CHANGING, sensitivity};
pub use space_filling::{SpaceFilling, joint_distance, smallest_distance, space_filling};

/// Most postures of one plan: more is a slip.
pub const MOST_POSTURES: usize = 1000;
