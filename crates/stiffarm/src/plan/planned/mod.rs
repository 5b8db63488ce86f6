//! All that `select` says of a plan: one request and one function for each way to work.
//!
//! | way | request | function |
//! |:--|:--|:--|
//! | a plan by global search, from an initial group, or beside given postures | [`PlanRequest`] | [`plan()`] |
//! | the best postures of a list | [`CandidateRequest`] | [`plan_candidates`] |
//! | postures that cover the joint space evenly | [`SpaceFillingRequest`] | [`plan_space_filling`] |
//! | given postures with some left out | [`DropRequest`] | [`plan_drop`] |
//! | the best value for each number of postures | [`CurveRequest`] | [`plan_curve`] |
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
mod plan;
mod request;
mod result;
mod space_filling;

pub use candidates::{CandidateRequest, Chosen, plan_candidates};
pub use curve::{Curve, CurveRequest, CurveSize, plan_curve};
pub use drop::{DropRequest, DropResult, plan_drop};
pub use in_time::InTime;
pub use kinds::{Asked, MOST_POSTURES, Mode, Planned, Stage};
pub use plan::plan;
pub use request::PlanRequest;
pub use result::{LoadOptions, Plan, PlanOptions};
pub use space_filling::{SpaceFillingPlan, SpaceFillingRequest, plan_space_filling};
