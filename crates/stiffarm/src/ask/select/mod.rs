//! All that `select` says: one function for each way to work, all under the same [`SelectOptions`].
//!
//! | way | function |
//! |:--|:--|
//! | a plan by global search, from an initial group, or beside given postures | [`plan()`] |
//! | the best postures of a list | [`plan_candidates`] |
//! | postures that cover the joint space evenly | [`plan_space_filling`] |
//! | given postures with some left out | [`plan_drop`] |
//! | the best value for each number of postures | [`plan_curve`] |
//!
//! Each completes the cell by its characteristic length, searches, brings the postures into the order and the
//! angles in which they are driven, and hands on a [`Planned`]: the result and the options as `--json` prints them,
//! and the postures with the cell that they hold for.

mod bounds;
mod candidates;
mod curve;
mod driven;
mod drop;
mod in_time;
mod kinds;
mod options;
mod plan;

mod result;
mod space_filling;

pub use candidates::{Chosen, plan_candidates};
pub use curve::{Curve, CurveSize, plan_curve};
pub use drop::{DropResult, plan_drop};
pub use in_time::InTime;
pub use kinds::{Mode, Planned, SelectResultOptions, Stage};
pub use options::{NOT_WITH, SelectInputs, SelectOptions};
pub use plan::plan;
pub use result::Plan;
pub use space_filling::{SpaceFillingPlan, plan_space_filling};
