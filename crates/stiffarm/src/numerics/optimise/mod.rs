//! Bounded, constrained minimisation behind one function.

mod slsqp;
pub(crate) mod smooth;

pub use slsqp::{Evaluation, Minimum, Options, Problem, minimise};
