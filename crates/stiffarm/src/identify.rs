//! Identification of the joint compliances, Eqs. (12)–(14), with its statistics.
//!
//! Least squares for H by column-scaled QR and SVD, never by the normal
//! equations (Eq. (14) as printed squares the condition number), k_j = 1/H_j.

mod plausibility;

pub use plausibility::implausible_scale;

use crate::cell::Cell;
use crate::error::{Code, Error, Result};
use crate::information::{Factor, whiten_posture};
use crate::measurement::{MeasuredPosture, row_count};
use crate::observation::PostureTerms;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Where the size of the noise comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum NoiseSource {
    /// From the residuals, s² = RSS/(rows − rank), with Student's t quantiles.
    Estimated,
    /// From the cell, with normal quantiles.
    Known,
}

/// Options of an identification.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IdentifyOptions {
    /// Where the size of the noise comes from.
    pub noise: NoiseSource,
    /// Confidence of the intervals, between 0 and 1.
    pub confidence: f64,
}

impl Default for IdentifyOptions {
    fn default() -> Self {
        IdentifyOptions {
            noise: NoiseSource::Estimated,
            confidence: 0.95,
        }
    }
}

/// What an estimate says about its joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// A stiffness with an interval.
    Determined,
    /// The interval is open above: the data give only a lower bound.
    LowerBoundOnly,
    /// Even the upper end of the compliance is negative: sign or model fault.
    SignOrModelFault,
    /// A stiffness without an interval: no degrees of freedom, or no deflection.
    NoInterval,
    /// The data carry no information about this joint.
    Undetermined,
}

/// Estimate of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointEstimate {
    /// Name of the joint.
    pub name: String,
    /// k = 1/H \[N·m/rad\]; negative where the estimate is, `None` when undetermined.
    pub stiffness: Option<f64>,
    /// k²·σ_H \[N·m/rad\], first order.
    pub standard_error: Option<f64>,
    /// Interval of k \[N·m/rad\]: \[1/(H + tσ_H), 1/(H − tσ_H)\]; the upper end is
    /// `None` where the data give only a lower bound, both where there is none.
    pub interval: [Option<f64>; 2],
    /// H \[rad/(N·m)\].
    pub compliance: Option<f64>,
    /// σ_H \[rad/(N·m)\].
    pub compliance_standard_error: Option<f64>,
    /// True when the data determine this joint.
    pub determined: bool,
    /// The estimate in one word.
    pub verdict: Verdict,
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

/// Result of an identification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Identification {
    /// One estimate per joint.
    pub joints: Vec<JointEstimate>,
    /// Displacement components used.
    pub rows: usize,
    /// rows − rank.
    pub degrees_of_freedom: usize,
    /// RMS of the residuals, sqrt(RSS/rows) \[m\].
    pub residual_rms_m: f64,
    /// RMS of the measured displacement components \[m\].
    pub displacement_rms_m: f64,
    /// s = sqrt(RSS/(rows − rank)) of the whitened residuals \[m\], `None` without
    /// degrees of freedom.
    pub residual_std_m: Option<f64>,
    /// σ of a displacement component by the cell's noise \[m\].
    pub expected_std_m: f64,
    /// cond(Ψ), `None` when a joint is undetermined.
    pub condition: Option<f64>,
    /// Condition number of the column-scaled Ψ.
    pub scaled_condition: Option<f64>,
    /// Correlation of the estimates, row by row; `None` beside undetermined joints.
    pub correlation: Vec<Vec<Option<f64>>>,
    /// Names of joints the data do not determine.
    pub undetermined_joints: Vec<String>,
    /// Where the size of the noise came from.
    pub noise: NoiseSource,
    /// Confidence of the intervals.
    pub confidence: f64,
    /// Residuals posture by posture.
    pub postures: Vec<PostureResidual>,
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

/// Ψ and Δ of measured postures, with the posture each row belongs to.
#[derive(Debug, Clone)]
pub struct MeasuredSystem {
    /// Ψ, rows for posture, displacement, x, y, z.
    pub psi: DMatrix<f64>,
    /// Δ less the known displacement of a series compliance \[m\].
    pub delta: DVector<f64>,
    /// First row of each posture, and the end.
    pub starts: Vec<usize>,
}

/// Builds Ψ H = Δ from measurements, Eq. (10).
///
/// # Errors
/// No measurements, a point the tool does not have, or as [`PostureTerms::new`].
pub fn measured_system(cell: &Cell, measured: &[MeasuredPosture]) -> Result<MeasuredSystem> {
    let robot = &cell.setup.robot;
    let rows = row_count(measured);
    if rows == 0 {
        return Err(Error::new(
            Code::TooFewData,
            "There are no displacements to identify from.",
        ));
    }
    let mut psi = DMatrix::zeros(rows, robot.spring_count());
    let mut delta = DVector::zeros(rows);
    let mut starts = vec![0];
    let mut at = 0;
    for posture in measured {
        let terms = PostureTerms::new(&cell.setup, &posture.posture.q, posture.wrench.as_ref())?;
        let block = terms.block(robot);
        let known = terms.known_displacement(&cell.setup.tool);
        for displacement in &posture.displacements {
            let from = 3 * displacement.point;
            if from + 3 > block.nrows() {
                return Err(Error::new(
                    Code::UnknownName,
                    "A displacement names a point the tool does not have.",
                ));
            }
            psi.rows_mut(at, 3).copy_from(&block.rows(from, 3));
            delta
                .rows_mut(at, 3)
                .copy_from(&(displacement.value - known.fixed_rows::<3>(from)));
            at += 3;
        }
        starts.push(at);
    }
    if delta.iter().any(|v| !v.is_finite()) {
        return Err(Error::new(
            Code::NotFinite,
            "A displacement is not a finite number.",
        ));
    }
    Ok(MeasuredSystem { psi, delta, starts })
}

/// Identifies the joint stiffness from measured displacements.
///
/// Errors are taken as independent between displacement components, after
/// whitening against the cell's posture-common part where it has one.
///
/// # Errors
/// As [`measured_system`]; a confidence outside (0, 1). Joints without
/// information, also for want of rows, are not an error: they are named in the
/// result.
pub fn identify(
    cell: &Cell,
    measured: &[MeasuredPosture],
    options: IdentifyOptions,
) -> Result<Identification> {
    if !(options.confidence > 0.0 && options.confidence < 1.0) {
        return Err(Error::new(
            Code::InvalidValue,
            "The confidence must lie between 0 and 1.",
        ));
    }
    let system = measured_system(cell, measured)?;
    let (rows, n) = system.psi.shape();
    let whitened = whiten(cell, &system);
    let factor = Factor::new(&whitened.psi)?;
    let compliance = factor.solve(&whitened.delta);
    let weighted_residual = &whitened.delta - &whitened.psi * &compliance;
    let degrees_of_freedom = rows - factor.rank().min(rows);
    let residual_std = (degrees_of_freedom > 0)
        .then(|| (weighted_residual.norm_squared() / degrees_of_freedom as f64).sqrt());
    let expected_std = cell.noise.displacement_std();
    let (sigma, quantile) = match options.noise {
        NoiseSource::Known => (
            Some(expected_std),
            Some(quantile(None, options.confidence)?),
        ),
        NoiseSource::Estimated if degrees_of_freedom > 0 => (
            residual_std,
            Some(quantile(Some(degrees_of_freedom), options.confidence)?),
        ),
        NoiseSource::Estimated => (None, None),
    };
    let covariance = factor.inverse_information();
    let unit_errors = factor.standard_errors();
    let names = cell.setup.robot.spring_names();
    let joints = (0..n)
        .map(|j| {
            let error = unit_errors[j].zip(sigma).map(|(e, s)| e * s);
            let determined = unit_errors[j].is_some();
            estimate(
                &names[j],
                determined.then(|| compliance[j]),
                error,
                quantile,
            )
        })
        .collect();
    let correlation = (0..n)
        .map(|i| {
            (0..n)
                .map(|j| {
                    let (a, b) = (unit_errors[i]?, unit_errors[j]?);
                    Some(if i == j {
                        1.0
                    } else {
                        covariance[(i, j)] / (a * b)
                    })
                })
                .collect()
        })
        .collect();
    let residual = &system.delta - &system.psi * &compliance;
    let condition = match factor.undetermined().is_empty() {
        true => {
            // Without a posture-common part the whitened Ψ is Ψ.
            let s = match cell.noise.posture_common_std > 0.0 {
                true => Factor::new(&system.psi)?.singular_values(|_| 1.0)?,
                false => factor.singular_values(|_| 1.0)?,
            };
            Some(s[0] / s[n - 1])
        }
        false => None,
    };
    Ok(Identification {
        joints,
        rows,
        degrees_of_freedom,
        residual_rms_m: rms(residual.as_slice()),
        displacement_rms_m: rms(system.delta.as_slice()),
        residual_std_m: residual_std,
        expected_std_m: expected_std,
        condition,
        scaled_condition: factor.scaled_condition(),
        correlation,
        undetermined_joints: factor
            .undetermined()
            .iter()
            .map(|&j| names[j].clone())
            .collect(),
        noise: options.noise,
        confidence: options.confidence,
        postures: measured
            .iter()
            .zip(system.starts.windows(2))
            .map(|(m, w)| PostureResidual {
                posture: m.posture.name.clone(),
                state: m.state.clone(),
                displacement_rms_m: rms(&system.delta.as_slice()[w[0]..w[1]]),
                residual_rms_m: rms(&residual.as_slice()[w[0]..w[1]]),
            })
            .collect(),
    })
}

/// Root mean square; zero for no values.
pub fn rms(values: &[f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

fn whiten(cell: &Cell, system: &MeasuredSystem) -> MeasuredSystem {
    let mut out = system.clone();
    let n = system.psi.ncols();
    for w in system.starts.windows(2) {
        let count = w[1] - w[0];
        let weight = cell.noise.common_weight(count / 3);
        if weight <= 0.0 {
            continue;
        }
        // Ψ and Δ of the posture are whitened as one matrix.
        let mut joined = DMatrix::zeros(count, n + 1);
        joined
            .columns_mut(0, n)
            .copy_from(&system.psi.rows(w[0], count));
        joined
            .column_mut(n)
            .copy_from(&system.delta.rows(w[0], count));
        whiten_posture(&mut joined, weight);
        out.psi
            .rows_mut(w[0], count)
            .copy_from(&joined.columns(0, n));
        out.delta.rows_mut(w[0], count).copy_from(&joined.column(n));
    }
    out
}

/// Two-sided quantile of Student's t, or of the normal without degrees of freedom.
fn quantile(degrees_of_freedom: Option<usize>, confidence: f64) -> Result<f64> {
    let p = 0.5 + 0.5 * confidence;
    let failed = |_| Error::new(Code::Internal, "A quantile could not be computed.");
    Ok(match degrees_of_freedom {
        Some(dof) => StudentsT::new(0.0, 1.0, dof as f64)
            .map_err(|_| Error::new(Code::Internal, "A quantile could not be computed."))?
            .inverse_cdf(p),
        None => Normal::new(0.0, 1.0).map_err(failed)?.inverse_cdf(p),
    })
}

/// Estimate of k = 1/H with its interval; see the module of method.md §3.
fn estimate(
    name: &str,
    compliance: Option<f64>,
    error: Option<f64>,
    quantile: Option<f64>,
) -> JointEstimate {
    let mut out = JointEstimate {
        name: name.to_string(),
        stiffness: None,
        standard_error: None,
        interval: [None, None],
        compliance,
        compliance_standard_error: compliance.and(error),
        determined: compliance.is_some(),
        verdict: Verdict::Undetermined,
    };
    let Some(h) = compliance else { return out };
    out.verdict = Verdict::Determined;
    if h != 0.0 {
        out.stiffness = Some(1.0 / h);
        out.standard_error = error.map(|e| e / (h * h));
    }
    let Some(half) = error.zip(quantile).map(|(e, t)| e * t) else {
        out.verdict = Verdict::NoInterval;
        return out;
    };
    let (low, high) = (h - half, h + half);
    if high == 0.0 && low == 0.0 {
        out.verdict = Verdict::NoInterval;
    } else if high < 0.0 {
        out.verdict = Verdict::SignOrModelFault;
    } else if low <= 0.0 {
        out.verdict = Verdict::LowerBoundOnly;
        out.interval = [Some(1.0 / high), None];
    } else {
        out.interval = [Some(1.0 / high), Some(1.0 / low)];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interval_is_asymmetric_open_or_absent() {
        let t = Some(2.0);
        let closed = estimate("j", Some(1e-6), Some(1e-7), t);
        assert_eq!(closed.verdict, Verdict::Determined);
        let [low, high] = closed.interval.map(|v| v.unwrap_or(f64::NAN));
        assert!((low - 1.0 / 1.2e-6).abs() < 1e-3 && (high - 1.0 / 0.8e-6).abs() < 1e-3);
        let open = estimate("j", Some(1e-6), Some(1e-6), t);
        assert_eq!(
            (open.verdict, open.interval[1]),
            (Verdict::LowerBoundOnly, None)
        );
        let negative = estimate("j", Some(-1e-6), Some(1e-7), t);
        assert_eq!(
            (negative.verdict, negative.interval),
            (Verdict::SignOrModelFault, [None, None])
        );
        assert!(negative.stiffness.is_some_and(|k| k < 0.0));
    }

    #[test]
    fn quantiles_are_those_of_the_tables() {
        assert!((quantile(Some(66), 0.95).unwrap() - 1.996_564_4).abs() < 1e-6);
        assert!((quantile(None, 0.95).unwrap() - 1.959_964).abs() < 1e-6);
    }
}
