//! From raw readings to displacements: registration, reduction, faults in the
//! readings themselves, and simulated experiments.

pub mod experiment;
pub mod reduction;
pub mod registration;
pub mod screening;
