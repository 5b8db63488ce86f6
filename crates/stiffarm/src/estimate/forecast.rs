//! What `identify` is expected to print of an experiment that is not measured yet, or not whole.
//!
//! The experiment is laid out as it will be measured. How its rows let the scatter of the readings and the common
//! errors move the stiffness, how far residuals will bound the common errors, and the ± of both together come from
//! the functions that `identify` uses; only the displacements are missing. The quantile is that of the degrees of
//! freedom that there will be. The noise is the cell's; readings that are there correct it, the more of them the
//! more, and what they leave counts; planned ones are taken to agree with them.

use super::identify::{Fit, IdentifyOptions, LARGEST_HALF_WIDTH, NoiseSource};
use super::next_posture::measured_alike;
use super::systematic::{JointUncertainty, SystematicErrors, expected_errors};
use super::validate::{Model, simulate_measurements};
use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::posture::Posture;
use crate::plan::check::determinable;
use crate::plan::evaluated::Evaluated;
use crate::plan::index::{Forecast, GroupEvaluation};
use crate::plan::select::MOST_POSTURES;
use nalgebra::DVector;

/// Degrees of freedom of residuals with which they weigh as much as the noise that the cell declares.
const AS_GOOD_AS_DECLARED: f64 = 10.0;

/// The ± of each joint once `postures` are measured: every measuring point once under the cell's load, or under each
/// of several, with the cell's noise and prior stiffness.
///
/// # Errors
/// A cell without prior stiffness; a load that is measured; as [`identify`](super::identify::identify()).
pub fn forecast(cell: &Cell, postures: &[Posture]) -> Result<Forecast> {
    let prior = cell.require_prior()?;
    let numbered = postures
        .iter()
        .zip(1..)
        .map(|(posture, number)| Posture { name: i32::to_string(&number), q: posture.q.clone() });
    let numbered: Vec<Posture> = numbered.collect();
    let measured = simulate_measurements(cell, &numbered, prior, Model::Linear, 0, 0)?;
    let fit = Fit::new(cell, measured, &known_noise(&IdentifyOptions::default()))?;
    let values = DVector::from_iterator(prior.len(), prior.iter().map(|k| 1.0 / k));
    let left = DVector::zeros(fit.system().delta.len());
    let uncertainty = expected_errors(&fit, &values, &left)?.uncertainty;
    let each = |of: &dyn Fn(&JointUncertainty) -> Option<f64>| uncertainty.iter().map(of).collect();
    Ok(Forecast {
        confidence: fit.options().confidence,
        total: each(&|joint| joint.total),
        readings: each(&|joint| joint.statistical),
        systematic: each(&|joint| joint.systematic),
        largest_source: uncertainty.iter().map(|j| j.largest_source.clone()).collect(),
    })
}

/// The same once `planned` postures (controller angles, rad) are measured beside those behind `fit`, each as the
/// posture in the middle was; `systematic` are the systematic errors of the fit.
///
/// # Errors
/// No stiffness to begin with; measured forces from which no load can be assumed; angles that do not fit the robot.
pub fn forecast_with<Q: AsRef<[f64]>>(
    fit: &Fit,
    systematic: &SystematicErrors,
    planned: &[Q],
) -> Result<Vec<JointUncertainty>> {
    let mut measured = fit.measured().clone();
    measured.postures.extend(measured_alike(fit, planned)?);
    let mut cell = fit.cell().clone();
    let [variance, ratio] = noise(fit);
    cell.noise.reading_variance = variance / f64::from(cell.noise.readings_per_displacement);
    cell.noise.posture_common_std = (variance * ratio).sqrt();
    let whole = Fit::new(&cell, measured, &known_noise(fit.options()))?;
    let mut values = fit.solution().values.clone();
    for (value, k) in values.iter_mut().zip(stiffness(fit, systematic)?) {
        *value = 1.0 / k;
    }
    // The planned rows come last, and agree with the estimate.
    let residual = fit.residual();
    let rows = whole.system().delta.len();
    let left = residual.resize_vertically(rows, 0.0);
    Ok(expected_errors(&whole, &values, &left)?.uncertainty)
}

/// Options under which the noise is the cell's.
fn known_noise(options: &IdentifyOptions) -> IdentifyOptions {
    IdentifyOptions { noise: NoiseSource::Known, ..options.clone() }
}

/// σ² of a displacement component \[m²\], and τ²/σ²: declared and seen, weighed by what stands behind them.
fn noise(fit: &Fit) -> [f64; 2] {
    let (declared, solution) = (fit.cell().noise, fit.solution());
    let variance = declared.displacement_variance();
    let ratio = declared.common_ratio();
    let degrees = solution.t_degrees_of_freedom.unwrap_or(0) as f64;
    let Some(seen) = solution.sigma.filter(|_| degrees > 0.0) else {
        return [variance, ratio];
    };
    if variance == 0.0 {
        return [seen * seen, solution.gamma];
    }
    let part = degrees / (degrees + AS_GOOD_AS_DECLARED);
    let mixed = |declared: f64, seen: f64| declared + part * (seen - declared);
    [mixed(variance, seen * seen), mixed(ratio, solution.gamma)]
}

/// Stiffness of each joint: identified where that has a ±, else the prior, else what was identified.
fn stiffness(fit: &Fit, systematic: &SystematicErrors) -> Result<Vec<f64>> {
    let joints = &fit.identification()?.estimates.joints;
    let prior = fit.cell().prior.as_deref();
    let of = |j: usize| {
        let identified = joints[j].stiffness.filter(|k| *k > 0.0);
        let half = systematic.uncertainty.get(j).and_then(|joint| joint.total);
        let bounded = identified.filter(|_| half.is_some_and(|half| half < LARGEST_HALF_WIDTH));
        let stiffness = bounded.or(prior.map(|prior| prior[j])).or(identified);
        stiffness.ok_or_else(|| {
            let message = format!("Nothing tells the stiffness of {} yet.", joints[j].name);
            Error::new(Code::NotIdentifiable, message)
        })
    };
    (0..joints.len()).map(of).collect()
}

/// Adds the ± that `identify` is expected to print of these postures, where there is one.
pub(crate) fn add_forecast(cell: &Cell, postures: &[Posture], evaluation: &mut GroupEvaluation) {
    let is_plan = postures.len() <= MOST_POSTURES && cell.prior.is_some();
    evaluation.forecast = if is_plan { forecast(cell, postures).ok() } else { None };
}

impl Evaluated {
    /// The same with the ± that `identify` is expected to print of each group, a plan in `cell`.
    #[must_use]
    pub fn with_forecast(mut self, cell: &Cell) -> Self {
        let (cell, _) = determinable(cell.clone());
        for group in &mut self.groups {
            let postures = group.group().postures;
            add_forecast(&cell, &postures, &mut group.evaluation);
        }
        self
    }
}
