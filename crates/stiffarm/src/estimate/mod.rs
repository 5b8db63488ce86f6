//! From displacements to joint stiffness and how sure it is: estimators and their
//! intervals, diagnosis, systematic errors, validation, coverage.

pub mod advise;
pub mod budget;
pub mod clamped;
pub mod coverage;
pub mod diagnose;
pub mod identify;
pub mod predictor;
pub mod simulate;
pub mod validate;
