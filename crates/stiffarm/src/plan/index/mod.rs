//! Indices of a group of postures: the paper's, the literature's and ours.

pub(crate) mod criterion;

mod drop_one;
mod error_bound;
mod evaluate;
mod facts;
mod function;
mod groups;
pub(crate) mod inputs;
pub(crate) mod kernel;
mod kinds;
pub(crate) mod minimax;
pub(crate) mod prediction;

pub use error_bound::{ErrorBound, error_bound};
pub use evaluate::{FIRST_ORDER_LIMIT, Forecast, GroupEvaluation, Indices, evaluate, expected_deviation};
pub(crate) use evaluate::{evaluate_for, evaluate_terms, posture_terms};
pub use function::IndexFunction;
pub use groups::evaluate_groups;
pub use kinds::{Index, Origin};
pub use minimax::Smoothed;

/// What tests judge many groups with.
pub(crate) mod internals {
    pub use super::evaluate::evaluate_for;
}
