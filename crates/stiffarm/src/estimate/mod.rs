//! From displacements to joint stiffness and how sure it is: estimators and their
//! intervals, diagnosis, systematic errors, validation, coverage.

pub mod clamped;
pub mod common;
pub mod compliance;
pub mod coverage;
pub mod diagnose;
pub(crate) mod diagnosed;
pub mod elastic;
pub mod forecast;
pub mod freedom;
pub mod identify;
pub mod mixed;
pub mod next_posture;
mod noise;
pub(crate) mod quantity;
pub mod saved;
pub mod setup;
pub mod simulate;
pub mod standing;
pub mod systematic;
pub mod validate;
