//! Identification of the joint compliances, Eqs. (12)–(14), with its statistics.
//!
//! Estimators for H by column-scaled QR and SVD, never by the normal equations
//! (Eq. (14) as printed squares the condition number), k_j = 1/H_j.

mod combinations;
mod estimate;
mod huber;
mod leave_out;
mod non_negative;
mod plausibility;
mod solve;
mod system;
mod whitened;

pub use combinations::Combination;
pub use estimate::{JointEstimate, Verdict};
pub use leave_out::{Fold, Influence, LeaveOneOut, folds, leave_one_out, prediction_error};
pub use plausibility::implausible_scale;
pub use solve::{Assumptions, Estimator, Prepared, PriorKnowledge, Scale, Solution};
pub use system::{Block, MeasuredSystem, RowLabel, Weights, measured_system};
pub use whitened::{Restricted, Whitened};

use crate::cell::Cell;
use crate::error::{Code, Error, Result};
use crate::information::Factor;
use crate::measurement::MeasuredPosture;
use crate::observation::ExtraTerm;
use estimate::{estimate, quantile};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

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

/// Standard deviation of one reading per axis from repeats.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReadingScatter {
    /// Standard deviation of one reading per axis \[m\].
    pub reading_std_m: f64,
    /// Degrees of freedom behind it.
    pub degrees_of_freedom: usize,
}

/// Options of an identification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
            prior_std: 0.3,
            scatter: None,
        }
    }
}

/// A further term that is an angle: lost motion.
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

/// Residuals of one posture in one load state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PostureResidual {
    /// Posture.
    pub posture: String,
    /// Load state.
    pub state: String,
    /// RMS of its displacement components \[m\].
    pub displacement_rms_m: f64,
    /// RMS of its residual components \[m\].
    pub residual_rms_m: f64,
}

/// Residuals of one measuring point over all postures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PointResidual {
    /// Measuring point.
    pub point: String,
    /// RMS of its residual components \[m\].
    pub residual_rms_m: f64,
    /// Mean residual, base axes \[m\].
    pub mean_m: [f64; 3],
}

/// Weight that Huber's estimator gave a displacement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DisplacementWeight {
    /// Posture.
    pub posture: String,
    /// Load state.
    pub state: String,
    /// Measuring point.
    pub point: String,
    /// The weight: 1 where the displacement fits.
    pub weight: f64,
}

/// Result of an identification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Identification {
    /// One estimate per joint (spring).
    pub joints: Vec<JointEstimate>,
    /// Further springs: tilts of joints and of the base.
    pub extra_springs: Vec<JointEstimate>,
    /// Lost motion.
    pub lost_motion: Vec<AngleEstimate>,
    /// The further terms, as they were asked for.
    pub extra: Vec<ExtraTerm>,
    /// How the unknowns were estimated.
    pub estimator: Estimator,
    /// Displacement components used.
    pub rows: usize,
    /// rows − rank.
    pub degrees_of_freedom: usize,
    /// Degrees of freedom behind the quantile of the intervals; `None` for
    /// normal quantiles.
    pub interval_degrees_of_freedom: Option<usize>,
    /// True where the errors of all rows count as independent because the data
    /// cannot tell what a posture's points share, or the estimator assumes it.
    pub independent_rows: bool,
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
    /// cond(Ψ), `None` when a joint is undetermined.
    pub condition: Option<f64>,
    /// Condition number of the column-scaled Ψ.
    pub scaled_condition: Option<f64>,
    /// Names of the unknowns: rows and columns of `covariance` and `correlation`.
    pub unknowns: Vec<String>,
    /// Covariance of the unknowns, row by row \[rad²/(N·m)²; rad² for lost
    /// motion\]; `None` beside undetermined ones.
    pub covariance: Vec<Vec<Option<f64>>>,
    /// Correlation of the unknowns, row by row; `None` beside undetermined ones.
    pub correlation: Vec<Vec<Option<f64>>>,
    /// Names of unknowns the data do not determine.
    pub undetermined_joints: Vec<String>,
    /// What the data do determine where they cannot separate the unknowns.
    pub combinations: Vec<Combination>,
    /// Where the size of the noise came from.
    pub noise: NoiseSource,
    /// Confidence of the intervals.
    pub confidence: f64,
    /// Residuals posture by posture.
    pub postures: Vec<PostureResidual>,
    /// Residuals point by point.
    pub points: Vec<PointResidual>,
    /// Huber's weights, smallest first, where that estimator was used.
    pub weights: Vec<DisplacementWeight>,
}

impl Identification {
    /// Stiffness of all joints, if each has a positive one.
    pub fn stiffness(&self) -> Option<Vec<f64>> {
        self.joints
            .iter()
            .map(|j| j.stiffness.filter(|k| *k > 0.0))
            .collect()
    }

    /// True when every joint has a stiffness with a closed interval.
    pub fn is_complete(&self) -> bool {
        self.joints.iter().all(|j| j.verdict == Verdict::Determined)
    }
}

/// Identifies the joint stiffness from measured displacements.
///
/// # Errors
/// As [`measured_system`]; a confidence outside (0, 1); options that contradict
/// each other. Joints without information, also for want of rows, are not an
/// error: they are named in the result.
pub fn identify(
    cell: &Cell,
    measured: &[MeasuredPosture],
    options: &IdentifyOptions,
) -> Result<Identification> {
    check(options)?;
    let system = measured_system(cell, measured, &options.extra, options.weights)?;
    let prepared = Prepared::new(&system, options.estimator)?;
    let assumed = assumptions(cell, options)?;
    let solution = prepared.solve(&system.delta, &assumed)?;
    describe(cell, measured, &system, &prepared, &solution, options)
}

/// What the options and the cell make an estimator assume.
///
/// # Errors
/// Repeats without scatter, or a prior estimate without prior stiffness.
pub fn assumptions(cell: &Cell, options: &IdentifyOptions) -> Result<Assumptions> {
    let noise = &cell.noise;
    let variance = noise.displacement_variance();
    let declared_ratio = match variance > 0.0 {
        true => noise.posture_common_std.powi(2) / variance,
        false => 0.0,
    };
    let scale = match (options.noise, options.scatter) {
        (NoiseSource::Estimated, _) => Scale::Estimated,
        (NoiseSource::Known, _) => Scale::Known {
            sigma: noise.displacement_std(),
            gamma: declared_ratio,
        },
        (NoiseSource::Repeats, Some(scatter)) => Scale::Repeats {
            sigma: scatter.reading_std_m * f64::from(noise.readings_per_displacement).sqrt(),
            degrees_of_freedom: scatter.degrees_of_freedom,
        },
        (NoiseSource::Repeats, None) => {
            return Err(Error::new(
                Code::TooFewData,
                "The noise cannot come from repeats: no reading was repeated.",
            )
            .hint("measure each point twice, or take the noise from the residuals or the cell"));
        }
    };
    let prior = match options.estimator {
        Estimator::Prior => Some(PriorKnowledge {
            compliance: cell.require_prior()?.iter().map(|k| 1.0 / k).collect(),
            relative_std: options.prior_std,
        }),
        _ => None,
    };
    Ok(Assumptions {
        estimator: options.estimator,
        scale,
        declared_ratio,
        prior,
    })
}

fn check(options: &IdentifyOptions) -> Result<()> {
    if !(options.confidence > 0.0 && options.confidence < 1.0) {
        return Err(Error::new(
            Code::InvalidValue,
            "The confidence must lie between 0 and 1.",
        ));
    }
    if !(options.prior_std.is_finite() && options.prior_std > 0.0) {
        return Err(Error::new(
            Code::InvalidValue,
            "The relative standard deviation of the prior must be above zero.",
        ));
    }
    let estimator = options.estimator;
    if options.noise == NoiseSource::Repeats
        && (estimator.has_shifts() || estimator == Estimator::Huber)
    {
        let message = format!(
            "The {} estimator finds the size of the noise itself.",
            estimator.as_str()
        );
        return Err(Error::new(Code::Conflict, message)
            .hint("noise from repeats goes with the estimators ordinary and weighted"));
    }
    Ok(())
}

/// Puts a solution into words and numbers.
fn describe(
    cell: &Cell,
    measured: &[MeasuredPosture],
    system: &MeasuredSystem,
    prepared: &Prepared,
    solution: &Solution,
    options: &IdentifyOptions,
) -> Result<Identification> {
    let count = system.unknowns.len();
    let known = |j: usize| !solution.undetermined.contains(&j);
    let error = |j: usize| {
        let covariance = solution.covariance.as_ref().filter(|_| known(j))?;
        Some(covariance[(j, j)].max(0.0).sqrt())
    };
    let quantile = match (&solution.covariance, solution.t_degrees_of_freedom) {
        (None, _) | (_, Some(0)) => None,
        (_, dof) => Some(quantile(dof, options.confidence)?),
    };
    let value = |j: usize| known(j).then(|| solution.values[j]);
    let spring = |j: usize| estimate(&system.unknowns[j], value(j), error(j), quantile);
    let mut joints: Vec<JointEstimate> = (0..system.springs).map(spring).collect();
    for &j in &solution.at_bound {
        joints[j].hold_at_bound();
    }
    let is_spring = |j: usize| system.extra[j - system.springs].is_spring();
    let further = system.springs..count;
    let lost_motion = further.clone().filter(|j| !is_spring(*j)).map(|j| {
        let half = error(j).zip(quantile).map(|(e, t)| e * t);
        let ends = value(j).zip(half);
        AngleEstimate {
            name: system.unknowns[j].clone(),
            angle: value(j),
            standard_error: error(j),
            interval: [ends.map(|(v, h)| v - h), ends.map(|(v, h)| v + h)],
        }
    });
    let matrix = |entry: &dyn Fn(usize, usize) -> Option<f64>| -> Vec<Vec<Option<f64>>> {
        (0..count)
            .map(|i| (0..count).map(|j| entry(i, j)).collect())
            .collect()
    };
    let covariance = matrix(&|i, j| {
        let covariance = solution.covariance.as_ref()?;
        (known(i) && known(j)).then(|| covariance[(i, j)])
    });
    let inverse = solution.factor.inverse_information();
    let correlation = matrix(&|i, j| {
        (known(i) && known(j)).then(|| match i == j {
            true => 1.0,
            false => inverse[(i, j)] / (inverse[(i, i)] * inverse[(j, j)]).sqrt(),
        })
    });
    let residual = &system.delta - &system.psi * &solution.values;
    let condition = match solution.undetermined.is_empty() && options.extra.is_empty() {
        true => {
            let s = Factor::new(&system.psi)?.singular_values(|_| 1.0)?;
            Some(s[0] / s[count - 1])
        }
        false => None,
    };
    let free = solution.degrees_of_freedom;
    let left = prepared
        .whitened()
        .residual(&prepared.whitened().whiten(&system.delta))
        .norm_squared();
    let estimates_shifts = options.estimator.has_shifts() && !solution.independent_rows;
    Ok(Identification {
        joints,
        extra_springs: further.filter(|j| is_spring(*j)).map(spring).collect(),
        lost_motion: lost_motion.collect(),
        extra: system.extra.clone(),
        estimator: options.estimator,
        rows: system.psi.nrows(),
        degrees_of_freedom: free,
        interval_degrees_of_freedom: solution.t_degrees_of_freedom,
        independent_rows: solution.independent_rows,
        residual_rms_m: rms(residual.as_slice()),
        displacement_rms_m: rms(system.delta.as_slice()),
        residual_std_m: solution.residual_std,
        posture_common_std_m: solution
            .sigma
            .filter(|_| estimates_shifts)
            .map(|s| s * solution.gamma.sqrt()),
        total_std_m: (free > 0).then(|| (left / free as f64).sqrt()),
        expected_std_m: cell.noise.displacement_std(),
        condition,
        scaled_condition: solution.factor.scaled_condition(),
        unknowns: system.unknowns.clone(),
        covariance,
        correlation,
        undetermined_joints: solution
            .undetermined
            .iter()
            .map(|&j| system.unknowns[j].clone())
            .collect(),
        combinations: combinations::combinations(system, solution, &reference_sizes(cell, system)),
        noise: options.noise,
        confidence: options.confidence,
        postures: by_posture(measured, system, &residual),
        points: by_point(cell, measured, system, &residual),
        weights: displacement_weights(cell, measured, system, solution),
    })
}

/// Size of each unknown against which an error counts as large: the prior
/// compliance, else what would explain its share of the displacements alone.
fn reference_sizes(cell: &Cell, system: &MeasuredSystem) -> Vec<f64> {
    let count = system.unknowns.len();
    let share = system.delta.norm() / (count as f64).sqrt();
    (0..count)
        .map(|j| {
            let prior = cell.prior.as_ref().filter(|_| j < system.springs);
            let norm = system.psi.column(j).norm();
            match prior {
                Some(prior) => 1.0 / prior[j],
                None if norm > 0.0 && share > 0.0 => share / norm,
                None => 1e-6,
            }
        })
        .collect()
}

fn by_posture(
    measured: &[MeasuredPosture],
    system: &MeasuredSystem,
    residual: &DVector<f64>,
) -> Vec<PostureResidual> {
    let mut parts = vec![(Vec::new(), Vec::new()); measured.len()];
    for (i, label) in system.labels.iter().enumerate() {
        let (displacements, residuals) = &mut parts[label.measured];
        displacements.extend_from_slice(system.delta.rows(3 * i, 3).into_owned().as_slice());
        residuals.extend_from_slice(residual.rows(3 * i, 3).into_owned().as_slice());
    }
    measured
        .iter()
        .zip(parts)
        .map(|(m, (displacements, residuals))| PostureResidual {
            posture: m.posture.name.clone(),
            state: m.state.clone(),
            displacement_rms_m: rms(&displacements),
            residual_rms_m: rms(&residuals),
        })
        .collect()
}

/// The displacement behind each three rows, with its point.
fn point_of(measured: &[MeasuredPosture], label: &RowLabel) -> usize {
    measured[label.measured].displacements[label.displacement].point
}

fn by_point(
    cell: &Cell,
    measured: &[MeasuredPosture],
    system: &MeasuredSystem,
    residual: &DVector<f64>,
) -> Vec<PointResidual> {
    let points = &cell.setup.tool.measuring_points;
    let mut out = Vec::with_capacity(points.len());
    for (p, point) in points.iter().enumerate() {
        let mut own = DMatrix::<f64>::zeros(3, 0);
        for (i, label) in system.labels.iter().enumerate() {
            if point_of(measured, label) == p {
                let at = own.ncols();
                own = own.insert_column(at, 0.0);
                own.column_mut(at).copy_from(&residual.rows(3 * i, 3));
            }
        }
        if own.ncols() == 0 {
            continue;
        }
        let mean = own.column_mean();
        out.push(PointResidual {
            point: point.name.clone(),
            residual_rms_m: rms(own.as_slice()),
            mean_m: [mean[0], mean[1], mean[2]],
        });
    }
    out
}

fn displacement_weights(
    cell: &Cell,
    measured: &[MeasuredPosture],
    system: &MeasuredSystem,
    solution: &Solution,
) -> Vec<DisplacementWeight> {
    let Some(weights) = &solution.weights else {
        return Vec::new();
    };
    let mut out: Vec<DisplacementWeight> = system
        .labels
        .iter()
        .zip(weights)
        .map(|(label, weight)| DisplacementWeight {
            posture: measured[label.measured].posture.name.clone(),
            state: measured[label.measured].state.clone(),
            point: cell.setup.tool.measuring_points[point_of(measured, label)]
                .name
                .clone(),
            weight: *weight,
        })
        .collect();
    out.sort_by(|a, b| a.weight.total_cmp(&b.weight));
    out
}

/// Root mean square; zero for no values.
pub fn rms(values: &[f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}
