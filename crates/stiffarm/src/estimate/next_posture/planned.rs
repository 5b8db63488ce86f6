//! What planned postures are expected to bring, one after the other.

use super::{FitInformation, load, share, stiffness, typical};
use crate::error::Result;
use crate::estimate::identify::Fit;
use crate::model::load::{Load, Wrench};
use crate::model::measurement::MeasuredPosture;
use crate::model::observation::PostureTerms;
use crate::model::posture::Posture;
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
    let mut information = FitInformation::new(fit, &cell)?;
    let relative = |factor: &Factor, sigma: f64| -> Vec<Option<f64>> {
        let errors = factor.standard_errors();
        let of_springs = errors.iter().zip(&stiffness);
        of_springs.map(|(error, k)| error.map(|e| e * k * sigma)).collect()
    };
    let now = relative(&Factor::new(&information.seen)?, information.sigma);
    let mut after = Vec::with_capacity(planned.len());
    for q in planned {
        let factor = information.with(&cell, q.as_ref())?;
        after.push(relative(&factor, information.sigma));
        information.seen = factor.seen();
    }
    Ok(PlannedErrors { now, after })
}

/// `planned` postures (controller angles, rad) measured as [`next_posture`](super::next_posture) assumes; their
/// displacements are those of the posture that they are measured like, and mean nothing.
///
/// # Errors
/// As [`planned_errors`].
pub(in crate::estimate) fn measured_alike<Q: AsRef<[f64]>>(fit: &Fit, planned: &[Q]) -> Result<Vec<MeasuredPosture>> {
    let mut setup = fit.cell().setup.clone();
    if setup.load == Load::Measured {
        setup.load = load::assumed_load(fit.cell(), fit.postures())?.0;
    }
    let setups = setup.cases();
    let labels = fit.system().labels_of(typical(fit.system())?);
    let mut states: Vec<usize> = labels.iter().map(|label| label.measured).collect();
    states.dedup();
    let mut out = Vec::with_capacity(planned.len() * states.len());
    for (q, number) in planned.iter().zip(1..) {
        for m in &states {
            let mut new = fit.postures()[*m].clone();
            if let Some(wrench) = &mut new.wrench {
                let setup = &setups[setup.load.case_of(&new.state)?];
                let like = &fit.postures()[*m];
                let share = share(setup, like, fit.experiment().terms(*m))?;
                let terms = PostureTerms::new(setup, q.as_ref(), None)?;
                *wrench = Wrench {
                    force: terms.wrench().force * share,
                    // Where a sensor measures the moment, its scatter says so.
                    moment: terms.wrench().moment * share + wrench.moment,
                };
                // The preload is as large a part of the load as it was there.
                let part = like
                    .preload
                    .zip(like.wrench)
                    .map(|(light, whole)| light.force.dot(&whole.force) / whole.force.norm_squared());
                new.preload = part.map(|part| Wrench::force(wrench.force * part));
            }
            new.posture = Posture { name: format!("planned {number}"), q: q.as_ref().to_vec() };
            out.push(new);
        }
    }
    Ok(out)
}
