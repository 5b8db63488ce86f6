//! Which postures to measure: indices, selection, how far a plan is from the best
//! possible, and what is suspicious about a cell.

mod active_limits;
mod random;

pub mod certificate;
pub mod characteristic_length;
pub mod check;
pub mod evaluated;
pub mod feasibility;
pub mod index;
pub mod route;
pub mod select;
pub mod zones;
