//! The joint stiffness that a calculation starts from: saved by `identify`, or the
//! cell's prior.

use crate::error::Result;
use crate::estimate::compliance::IdentifiedCompliance;
use crate::model::cell::Cell;

/// Stands for the cell's prior stiffness where a file name could stand.
pub const PRIOR: &str = "prior";

/// A stiffness as `identify` saved it.
#[derive(Debug, Clone, PartialEq)]
pub struct Saved {
    /// What calculates displacements.
    pub predictor: IdentifiedCompliance,
    /// Postures it was identified from.
    pub postures: Vec<String>,
    /// SHA-256 of the cell it was identified in.
    pub cell: Option<String>,
    /// RMS displacement of the posture that moved most in the identification \[m\].
    pub largest_displacement: Option<f64>,
    /// Name of the file, or `prior`.
    pub name: String,
}

impl Saved {
    /// The cell's prior stiffness, without covariance.
    ///
    /// # Errors
    /// A cell without prior.
    pub fn prior(cell: &Cell) -> Result<Self> {
        Ok(Saved {
            predictor: IdentifiedCompliance::from_stiffness(cell, cell.require_prior()?)?,
            postures: Vec::new(),
            cell: None,
            largest_displacement: None,
            name: PRIOR.to_string(),
        })
    }

    /// True where the stiffness was identified in another version of the cell
    /// whose hash is `cell`.
    pub fn is_of_another_cell(&self, cell: Option<&str>) -> bool {
        self.cell.is_some() && self.cell.as_deref() != cell
    }
}
