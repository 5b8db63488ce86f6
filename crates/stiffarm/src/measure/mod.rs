//! From raw readings to displacements: registration, reduction, faults in the
//! readings themselves, and simulated experiments.

pub mod experiment;
mod measured;
pub mod reduction;
pub mod registration;
pub mod screening;
mod series;

pub use measured::{Measured, prepare};
