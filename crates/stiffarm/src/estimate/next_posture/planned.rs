//! What planned postures are expected to bring, one after the other.

use super::{Known, load, stiffness};
use crate::error::Result;
use crate::estimate::identify::Fit;
use crate::model::load::Load;
use crate::numerics::information::Factor;
use serde::{Deserialize, Serialize};

/// Relative standard errors that planned postures lead to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlannedErrors {
    /// Relative standard error of each joint's stiffness as the fit has it (fraction); `None` where the
    /// fit does not determine the joint.
    pub now: Vec<Option<f64>>,
    /// The same after the first planned posture, after the first two, and so on.
    pub after: Vec<Vec<Option<f64>>>,
}

/// What the relative standard errors of a fit become when `planned` postures (controller angles, rad) are
/// measured too, one after the other. Assumed is what [`next_posture`](super::next_posture) assumes.
///
/// # Errors
/// No stiffness to weigh joints by, measured forces from which no load can be assumed, angles that do
/// not fit the robot.
pub fn planned_errors<Q: AsRef<[f64]>>(fit: &Fit, planned: &[Q]) -> Result<PlannedErrors> {
    let mut cell = fit.cell().clone();
    let stiffness = stiffness(&cell, fit.identification()?)?;
    if cell.setup.load == Load::Measured {
        cell.setup.load = load::assumed_load(&cell, fit.postures())?.0;
    }
    let mut known = Known::new(fit, &cell)?;
    let relative = |factor: &Factor, sigma: f64| -> Vec<Option<f64>> {
        let errors = factor.standard_errors();
        let of_springs = errors.iter().zip(&stiffness);
        of_springs
            .map(|(error, k)| error.map(|e| e * k * sigma))
            .collect()
    };
    let now = relative(&Factor::new(&known.seen)?, known.sigma);
    let mut after = Vec::with_capacity(planned.len());
    for q in planned {
        let factor = known.with(&cell, q.as_ref())?;
        after.push(relative(&factor, known.sigma));
        known.seen = factor.seen();
    }
    Ok(PlannedErrors { now, after })
}
