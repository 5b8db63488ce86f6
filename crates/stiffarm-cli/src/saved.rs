//! The joint stiffness that a command works with: saved by `identify`, or the
//! cell's prior.

use crate::session::Session;
use stiffarm::Result;
use stiffarm::estimate::compliance::IdentifiedCompliance;
use stiffarm::files::stiffness::read_stiffness;
use stiffarm::model::cell::Cell;
use stiffarm::model::observation::ExtraTerm;

/// Stands for the cell's prior stiffness where a file name could stand.
const PRIOR: &str = "prior";

/// A stiffness as `identify` saved it.
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
    fn prior(cell: &Cell) -> Result<Self> {
        Ok(Saved {
            predictor: IdentifiedCompliance::from_stiffness(cell, cell.require_prior()?)?,
            postures: Vec::new(),
            cell: None,
            largest_displacement: None,
            name: PRIOR.to_string(),
        })
    }

    /// Where the stiffness comes from, as a line below the cell's.
    pub fn line(&self) -> String {
        let errors = &self.predictor.common;
        let is_mixed = |term: &ExtraTerm| matches!(term, ExtraTerm::Spring { .. });
        let mixed = self.predictor.extra.iter().any(is_mixed);
        let with = match (&self.predictor.spread, errors.is_empty()) {
            (_, true) if mixed => "the mixed elastic model and its covariance",
            (_, false) if mixed => "the mixed elastic model, its covariance and common-mode errors",
            (Some(_), false) => "covariance and common-mode errors",
            (Some(_), true) => "covariance",
            (None, _) => "no covariance",
        };
        match self.name == PRIOR {
            true => {
                "stiffness: the cell's prior, which says nothing about how sure it is\n".to_string()
            }
            false => format!("stiffness: {} (with {with})\n", self.name),
        }
    }

    /// True where the stiffness was identified in another version of the cell
    /// whose hash is `cell`.
    pub fn is_of_another_cell(&self, cell: Option<&String>) -> bool {
        self.cell.is_some() && self.cell.as_ref() != cell
    }
}

impl Session {
    /// Reads a joint stiffness of `cell`: a result of `identify`, a bare list,
    /// or `prior` for the cell's own (a file of that name is `./prior`).
    ///
    /// # Errors
    /// A file that cannot be read, anything wrong with it, or a cell without prior.
    pub fn read_stiffness(&self, from: &str, cell: &Cell) -> Result<Saved> {
        if from == PRIOR {
            return Saved::prior(cell);
        }
        let (name, bytes) = self.read("stiffness", from)?;
        let saved = read_stiffness(&bytes, &name, cell)?;
        Ok(Saved {
            predictor: saved.compliance,
            postures: saved.postures,
            cell: saved.cell,
            largest_displacement: saved.largest_displacement,
            name,
        })
    }
}
