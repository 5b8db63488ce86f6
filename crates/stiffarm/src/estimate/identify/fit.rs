//! One estimator applied to one set of measurements, with everything that a
//! budget, a profile or a diagnosis goes on from.

use super::solve::{Assumptions, Estimator, Prepared, Solution};
use super::system::{MeasuredSystem, measured_system};
use super::{IdentifyOptions, assumptions, check};
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::measurement::MeasuredPosture;
use crate::numerics::information::Factor;
use nalgebra::DVector;

/// A system with its estimate.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Ψ x = Δ.
    pub system: MeasuredSystem,
    /// What depends on Ψ only.
    pub prepared: Prepared,
    /// What was assumed.
    pub assumed: Assumptions,
    /// The estimate.
    pub solution: Solution,
}

/// Fits the unknowns to measured displacements.
///
/// # Errors
/// As [`identify`](super::identify()).
pub fn fit(cell: &Cell, measured: &[MeasuredPosture], options: &IdentifyOptions) -> Result<Fit> {
    check(options)?;
    let system = measured_system(cell, measured, &options.extra, options.weights)?;
    let prepared = Prepared::new(&system, options.estimator)?;
    let assumed = assumptions(cell, options)?;
    let solution = prepared.solve(&system.delta, &assumed)?;
    Ok(Fit {
        system,
        prepared,
        assumed,
        solution,
    })
}

impl Fit {
    /// Change of the estimates when the displacements change by `shift` (rows
    /// as in the system, m) and everything that the estimator took from the
    /// data besides stays: the ratio of the two variances, Huber's weights, the
    /// compliances held at zero. So it is linear in `shift`.
    ///
    /// # Errors
    /// A decomposition that fails.
    ///
    /// # Panics
    /// If `shift` does not have one entry per row of the system.
    pub fn response(&self, shift: &DVector<f64>) -> Result<DVector<f64>> {
        let solution = &self.solution;
        let white = self.prepared.whitened().whiten(shift);
        let (psi, white) = self.prepared.shifted(&white, solution.gamma);
        if let Some(weights) = &solution.weights {
            let (mut psi, mut white) = (psi, white);
            for (d, weight) in weights.iter().enumerate() {
                psi.rows_mut(3 * d, 3).scale_mut(weight.sqrt());
                white.rows_mut(3 * d, 3).scale_mut(weight.sqrt());
            }
            return Ok(Factor::new(&psi)?.solve(&white));
        }
        match self.assumed.estimator {
            Estimator::NonNegative => {
                let free: Vec<usize> = (0..psi.ncols())
                    .filter(|j| !solution.at_bound.contains(j))
                    .collect();
                let mut out = DVector::zeros(psi.ncols());
                if !free.is_empty() {
                    let change = Factor::new(&psi.select_columns(&free))?.solve(&white);
                    for (j, value) in free.into_iter().zip(change.iter()) {
                        out[j] = *value;
                    }
                }
                Ok(out)
            }
            Estimator::Prior => {
                // The rows of the prior do not change.
                let rows = white.len() + self.system.springs;
                Ok(solution.factor.solve(&white.resize_vertically(rows, 0.0)))
            }
            _ => Ok(solution.factor.solve(&white)),
        }
    }
}
