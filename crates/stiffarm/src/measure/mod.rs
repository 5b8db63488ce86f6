//! From raw readings to displacements: registration, reduction, faults in the
//! readings themselves, and simulated experiments.

pub mod experiment;
mod measured;
mod pending;
pub mod reduction;
pub mod registered;
pub mod registration;
mod resolution;
pub mod screening;
mod series;

pub use measured::{Measured, prepare};
pub(crate) use measured::{all_excluded, check_names};
pub use pending::{
    CARRIED_DOWN, HIDDEN_CELLS, LOADS_FROM_NAMES, MERGED_CELLS, NAMES_BY_SHEET, NOT_MEASURED_YET,
    READING_RESOLUTION, ROWS_LEFT_OUT, is_of_table, not_measured_yet,
};
pub use reduction::StationRegistration;
