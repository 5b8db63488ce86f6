//! From raw readings to displacements: registration, reduction, faults in the
//! readings themselves, and simulated experiments.

pub mod experiment;
mod measured;
mod pending;
pub mod reduction;
pub mod registration;
mod resolution;
pub mod screening;
mod series;

pub use measured::{Measured, prepare};
pub(crate) use measured::{all_excluded, check_names};
pub use pending::{is_of_table, not_measured_yet};
pub use reduction::StationRegistration;
