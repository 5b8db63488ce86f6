//! Identification of the joint compliances, Eqs. (12)–(14), with its statistics.
//!
//! Estimators for H by column-scaled QR and SVD, never by the normal equations
//! (Eq. (14) as printed squares the condition number), k_j = 1/H_j.

mod assumptions;
mod bootstrap;
mod covariance;
mod estimable;
mod estimate;
mod estimates;
mod experiment;
mod fit;
mod huber;
mod labels;
mod leave_out;
mod leave_out_solver;
mod non_negative;
mod plausibility;
mod profile;
mod residuals;
mod response;
mod restricted;
mod solve;
mod system;
mod whitened;

pub use assumptions::Estimator;
pub(crate) use assumptions::{Assumptions, PriorKnowledge, Scale};
pub use bootstrap::{Bootstrap, bootstrap};
pub(crate) use bootstrap::{Rows, resampled};
pub(crate) use covariance::{ALIKE_TORQUE_COSINE, Covariance};
pub use estimable::{CollinearSet, EstimableCombination};
pub use estimate::{IntervalHolds, JointEstimate, LARGEST_HALF_WIDTH, Verdict, WELL_KNOWN_HALF_WIDTH};
pub(crate) use estimate::{estimate, quantile};
pub use estimates::Estimates;
pub(crate) use experiment::Experiment;
pub use fit::Fit;
pub(crate) use labels::RowLabel;
pub use labels::Weights;
pub(crate) use leave_out::{Fold, RESIDUAL_ROUNDING, missed, prediction_error, rounding, sees_only_known};
pub use leave_out::{Influence, LeaveOneOut};
pub use plausibility::implausible_scale;
pub(crate) use plausibility::implausible_stiffness;
pub use profile::{JointProfile, Profile, profile};
pub use residuals::{DisplacementResidual, DisplacementWeight, PointResidual, PostureResidual};
pub(crate) use response::Response;
pub(crate) use solve::{Prepared, Solution};
pub(crate) use system::{Block, MeasuredSystem, NO_LOAD};
pub(crate) use system::{by_name, known_displacement, unknowns};
pub(crate) use whitened::Whitened;

use crate::error::{Code, Error, Result};
use crate::measure::Measured;
use crate::model::cell::Cell;
use crate::model::measurement::ReadingScatter;
use crate::model::observation::ExtraTerm;
pub(crate) use estimate::{estimates, interval_quantile};
use serde::{Deserialize, Serialize};

/// What the tests of the estimators look into.
pub(crate) mod internals {
    pub use super::assumptions::{Assumptions, PriorKnowledge, Scale};
    pub use super::covariance::Covariance;
    pub use super::estimate::{estimates, quantile};
    pub use super::experiment::measured_system;
    pub use super::labels::RowLabel;
    pub use super::leave_out::solutions_without;
    pub use super::solve::{Prepared, Solution};
    pub use super::system::{Block, MeasuredSystem};
    pub use super::whitened::Whitened;
}

/// Where the size of the noise comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum NoiseSource {
    /// From the residuals, s² = RSS/(rows − rank), with Student's t quantiles.
    #[default]
    Estimated,
    /// From the cell, with normal quantiles.
    Known,
    /// From repeated readings, with Student's t on their degrees of freedom.
    Repeats,
}

/// Confidences that intervals can have: beyond them quantiles are rounding.
pub const CONFIDENCE: [f64; 2] = [0.01, 0.999_999];

/// Options of an identification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct IdentifyOptions {
    /// How the unknowns are estimated.
    pub estimator: Estimator,
    /// Where the relative size of single errors comes from.
    pub weights: Weights,
    /// Where the size of the noise comes from.
    pub noise: NoiseSource,
    /// Confidence of the intervals, between 0 and 1.
    pub confidence: f64,
    /// Further unknowns beside the joint springs.
    pub extra: Vec<ExtraTerm>,
    /// Quantities of the set-up that are identified beside the stiffness, by name
    /// ([`free`](crate::estimate::setup::free)); their uncertainty is then what the readings leave of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub free: Vec<String>,
    /// Relative standard deviation of the cell's prior stiffness, for
    /// [`Estimator::Prior`] (fraction).
    pub prior_std: f64,
    /// Scatter of repeated readings, for [`NoiseSource::Repeats`].
    pub scatter: Option<ReadingScatter>,
}

impl Default for IdentifyOptions {
    fn default() -> Self {
        IdentifyOptions {
            estimator: Estimator::TwoVariance,
            weights: Weights::Readings,
            noise: NoiseSource::Estimated,
            confidence: 0.95,
            extra: Vec::new(),
            free: Vec::new(),
            prior_std: 0.3,
            scatter: None,
        }
    }
}

/// An extra term that is an angle: lost motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AngleEstimate {
    /// Name of the term.
    pub name: String,
    /// The angle by which the joint gives way \[rad\]; `None` when undetermined.
    pub angle: Option<f64>,
    /// Its standard error \[rad\].
    pub standard_error: Option<f64>,
    /// Its interval \[rad\].
    pub interval: [Option<f64>; 2],
}

/// Result of an identification: the [`Estimates`] with the residuals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Identification {
    /// Values of the unknowns with what is known about them.
    #[serde(flatten)]
    pub estimates: Estimates,
    /// RMS of the residuals, sqrt(RSS/rows) \[m\].
    pub residual_rms_m: f64,
    /// RMS of the measured displacement components \[m\].
    pub displacement_rms_m: f64,
    /// s = sqrt(RSS/(rows − rank)) of the whitened residuals: σ of a
    /// displacement component as the data show it \[m\]; `None` without
    /// degrees of freedom.
    pub residual_std_m: Option<f64>,
    /// τ of a shift common to a posture's points, at the posture's largest
    /// load \[m\]; `None` where it is not estimated.
    pub posture_common_std_m: Option<f64>,
    /// s of the residuals of least squares with independent rows, for the
    /// comparison with the expected noise \[m\].
    pub total_std_m: Option<f64>,
    /// σ of a displacement component by the cell's noise \[m\].
    pub expected_std_m: f64,
    /// The cell's prior stiffness, joint by joint \[N·m/rad\]; empty where it has none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub prior_stiffness: Vec<f64>,
    /// Residuals posture by posture.
    pub postures: Vec<PostureResidual>,
    /// Residuals point by point.
    pub points: Vec<PointResidual>,
    /// Huber's weights, smallest first, where that estimator was used.
    pub weights: Vec<DisplacementWeight>,
}

impl Identification {
    /// The same with other joints: those of a model beside the axes alone.
    pub(crate) fn with_joints(&self, joints: Vec<JointEstimate>) -> Self {
        let estimates = Estimates { joints, ..self.estimates.clone() };
        Identification { estimates, ..self.clone() }
    }
}

/// Identifies the joint stiffness from measured displacements.
///
/// # Errors
/// No displacements; a point the tool does not have, a number that is not finite;
/// a measured load without forces; a confidence outside (0, 1); options that
/// contradict each other. Joints without information, also for want of rows, are not an
/// error: they are named in the result.
pub fn identify(cell: &Cell, measured: impl Into<Measured>, options: &IdentifyOptions) -> Result<Identification> {
    Fit::new(cell, measured, options)?.identification().cloned()
}

/// What the options and the cell make an estimator assume.
///
/// # Errors
/// Repeats without scatter, or a prior estimate without prior stiffness.
pub fn assumptions(cell: &Cell, options: &IdentifyOptions) -> Result<Assumptions> {
    let noise = &cell.noise;
    let declared_ratio = noise.common_ratio();
    let scale = match (options.noise, options.scatter) {
        (NoiseSource::Estimated, _) => Scale::Estimated,
        (NoiseSource::Known, _) => Scale::Known { sigma: noise.displacement_std(), gamma: declared_ratio },
        (NoiseSource::Repeats, Some(scatter)) => Scale::Repeats {
            sigma: scatter.reading_std_m * f64::from(noise.readings_per_displacement).sqrt(),
            degrees_of_freedom: scatter.degrees_of_freedom,
        },
        (NoiseSource::Repeats, None) => {
            return Err(Error::new(Code::TooFewData, "The noise cannot come from repeats: no reading was repeated.")
                .hint("measure each point twice, or take the noise from the residuals or the cell"));
        }
    };
    Ok(Assumptions { estimator: options.estimator, scale, declared_ratio, prior: prior_knowledge(cell, options)? })
}

/// The cell's prior compliance, for the estimator that uses it.
pub(crate) fn prior_knowledge(cell: &Cell, options: &IdentifyOptions) -> Result<Option<PriorKnowledge>> {
    Ok(match options.estimator {
        Estimator::Prior => Some(PriorKnowledge {
            compliance: cell.require_prior()?.iter().map(|k| 1.0 / k).collect(),
            relative_std: options.prior_std,
        }),
        _ => None,
    })
}

pub(crate) fn check(options: &IdentifyOptions) -> Result<()> {
    if !(CONFIDENCE[0]..=CONFIDENCE[1]).contains(&options.confidence) {
        return Err(Error::invalid(format!(
            "The confidence must lie between {} and {}.",
            CONFIDENCE[0], CONFIDENCE[1]
        )));
    }
    if !(options.prior_std.is_finite() && options.prior_std > 0.0) {
        return Err(Error::invalid("The relative standard deviation of the prior must be above zero."));
    }
    let estimator = options.estimator;
    if options.noise == NoiseSource::Repeats && (estimator.has_shifts() || estimator == Estimator::Huber) {
        let message = format!(
            "The {} estimator estimates the size of the noise itself, so noise from repeats cannot be used.",
            estimator.as_str()
        );
        return Err(Error::new(Code::Conflict, message)
            .hint("noise from repeats works with the estimators ordinary and weighted"));
    }
    Ok(())
}

/// Puts a solution into words and numbers.
fn describe(fit: &Fit) -> Result<Identification> {
    let (cell, system) = (fit.cell(), fit.system());
    let (prepared, solution) = (fit.prepared(), fit.solution());
    let estimates = Estimates::new(cell, system, solution, fit.options())?;
    let residual = fit.residual();
    let left = prepared.whitened().residual(fit.white()).norm_squared();
    let estimates_shifts =
        estimates.estimator.has_shifts() && !estimates.independent_rows && prepared.whitened().is_separable();
    let free = estimates.degrees_of_freedom;
    Ok(Identification {
        estimates,
        residual_rms_m: rms(residual.as_slice()),
        displacement_rms_m: rms(system.delta.as_slice()),
        residual_std_m: solution.residual_std,
        posture_common_std_m: solution.sigma.filter(|_| estimates_shifts).map(|s| s * solution.gamma.sqrt()),
        total_std_m: (free > 0).then(|| (left / free as f64).sqrt()),
        expected_std_m: cell.noise.displacement_std(),
        prior_stiffness: cell.prior.clone().unwrap_or_default(),
        postures: residuals::by_posture(cell, fit.postures(), system, &residual),
        points: residuals::by_point(cell, fit.postures(), system, &residual),
        weights: residuals::displacement_weights(cell, fit.postures(), system, solution),
    })
}

/// Root mean square; zero for no values.
pub fn rms(values: &[f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}
