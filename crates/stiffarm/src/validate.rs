//! Validation on postures that took no part in the identification, Eq. (22).

use crate::cell::Cell;
use crate::error::{Code, Error, Result};
use crate::identify::rms;
use crate::measurement::{Displacement, MeasuredPosture};
use crate::observation::PostureTerms;
use crate::posture::Posture;
use crate::simulate::draw_noise;
use crate::stiffness::{displacement_between, equilibrium, joint_compliance, linear_displacement};
use crate::streams::run_rng;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// How displacements are calculated from the joint stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// Linear, Eq. (7).
    Linear,
    /// Exact static equilibrium.
    Equilibrium,
}

/// Eq. (22) at one measuring point of one posture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PointDeviation {
    /// `m-n`: measuring point n of posture m, as in Table 7.
    pub label: String,
    /// Posture.
    pub posture: String,
    /// Load state.
    pub state: String,
    /// Measuring point.
    pub point: String,
    /// Measured displacement \[m\], base axes.
    pub measured_m: [f64; 3],
    /// Calculated displacement \[m\], base axes.
    pub calculated_m: [f64; 3],
    /// δb = ‖measured − calculated‖ \[m\], Eq. (22).
    pub deviation_m: f64,
}

/// Result of a validation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Validation {
    /// Model behind the calculated displacements.
    pub model: Model,
    /// Eq. (22), row by row.
    pub points: Vec<PointDeviation>,
    /// RMS of δb \[m\].
    pub deviation_rms_m: f64,
    /// Largest δb \[m\].
    pub deviation_max_m: f64,
    /// RMS norm of the measured displacements \[m\].
    pub displacement_rms_m: f64,
    /// Expected δb if the cell's noise were the only error, 2σ·sqrt(2/π) \[m\].
    pub noise_expectation_m: f64,
    /// Tolerance on the largest δb \[m\], where given.
    pub tolerance_m: Option<f64>,
    /// True when every δb is within the tolerance.
    pub passed: Option<bool>,
}

/// Calculated displacements of all measuring points of one posture, point by
/// point \[m\], including a known series compliance.
///
/// # Errors
/// As [`PostureTerms::new`] and [`joint_compliance`].
pub fn calculated_displacements(
    cell: &Cell,
    measured: &MeasuredPosture,
    stiffness: &[f64],
    model: Model,
) -> Result<Vec<Vector3<f64>>> {
    joint_compliance(&cell.setup.robot, stiffness)?;
    let q = &measured.posture.q;
    let terms = PostureTerms::new(&cell.setup, q, measured.wrench.as_ref())?;
    let known = terms.known_displacement(&cell.setup.tool);
    let tool = &cell.setup.tool;
    // One equilibrium per posture moves all its points.
    let after = match model {
        Model::Linear => None,
        Model::Equilibrium => {
            Some(equilibrium(&cell.setup, q, stiffness, measured.wrench.as_ref())?.frames)
        }
    };
    (0..tool.point_count())
        .map(|a| {
            let twist = match &after {
                None => linear_displacement(
                    &cell.setup,
                    &terms,
                    &terms.measuring_points()[a],
                    stiffness,
                    None,
                )?,
                Some(after) => {
                    let point = &tool.measuring_points[a].position;
                    displacement_between(terms.frames(), after, point)
                }
            };
            Ok(Vector3::new(twist[0], twist[1], twist[2]) + known.fixed_rows::<3>(3 * a))
        })
        .collect()
}

/// Compares calculated with measured displacements, Eq. (22).
///
/// # Errors
/// No measurements, a point the tool does not have, or a stiffness that is not
/// positive.
pub fn validate(
    cell: &Cell,
    stiffness: &[f64],
    measured: &[MeasuredPosture],
    model: Model,
    tolerance_m: Option<f64>,
) -> Result<Validation> {
    let finite = |d: &Displacement| d.value.iter().all(|v| v.is_finite());
    if !measured.iter().all(|m| m.displacements.iter().all(finite)) {
        return Err(Error::new(
            Code::NotFinite,
            "A displacement is not a finite number.",
        ));
    }
    if tolerance_m.is_some_and(|t| t.is_nan() || t < 0.0) {
        return Err(Error::new(
            Code::InvalidValue,
            "The tolerance must be 0 or above.",
        ));
    }
    let mut points = Vec::new();
    let names: Vec<&str> = cell
        .setup
        .tool
        .measuring_points
        .iter()
        .map(|p| p.name.as_str())
        .collect();
    for (m, posture) in measured.iter().enumerate() {
        let calculated = calculated_displacements(cell, posture, stiffness, model)?;
        for displacement in &posture.displacements {
            let (Some(c), Some(name)) = (
                calculated.get(displacement.point),
                names.get(displacement.point),
            ) else {
                return Err(Error::new(
                    Code::UnknownName,
                    "A displacement names a point the tool does not have.",
                ));
            };
            // δb, Eq. (22)
            let deviation = (displacement.value - c).norm();
            points.push(PointDeviation {
                label: format!("{}-{}", m + 1, displacement.point + 1),
                posture: posture.posture.name.clone(),
                state: posture.state.clone(),
                point: (*name).to_string(),
                measured_m: displacement.value.into(),
                calculated_m: (*c).into(),
                deviation_m: deviation,
            });
        }
    }
    if points.is_empty() {
        return Err(Error::new(
            Code::TooFewData,
            "There are no displacements to validate with.",
        ));
    }
    let deviations: Vec<f64> = points.iter().map(|p| p.deviation_m).collect();
    let norms: Vec<f64> = points
        .iter()
        .map(|p| Vector3::from(p.measured_m).norm())
        .collect();
    let largest = deviations.iter().copied().fold(0.0, f64::max);
    // Mean of the norm of three independent normal components.
    let sigma = (cell.noise.displacement_variance() + cell.noise.posture_common_std.powi(2)).sqrt();
    Ok(Validation {
        model,
        deviation_rms_m: rms(&deviations),
        deviation_max_m: largest,
        displacement_rms_m: rms(&norms),
        noise_expectation_m: 2.0 * sigma * std::f64::consts::FRAC_2_PI.sqrt(),
        tolerance_m,
        passed: tolerance_m.map(|t| largest <= t),
        points,
    })
}

/// Simulated measurements of `postures`: displacements by `model` with the
/// stiffness `truth`, plus the cell's noise from `seed` and `stream`.
///
/// # Errors
/// As [`calculated_displacements`].
pub fn simulate_measurements(
    cell: &Cell,
    postures: &[Posture],
    truth: &[f64],
    model: Model,
    seed: u64,
    stream: usize,
) -> Result<Vec<MeasuredPosture>> {
    let points = cell.setup.tool.point_count();
    let mut rng = run_rng(seed, 1 << 16, 0, stream);
    let noise = draw_noise(&mut rng, &cell.noise, postures.len(), points);
    postures
        .iter()
        .enumerate()
        .map(|(p, posture)| {
            let mut measured = MeasuredPosture {
                posture: posture.clone(),
                state: "loaded".to_string(),
                wrench: None,
                servo_give: None,
                displacements: Vec::new(),
            };
            let exact = calculated_displacements(cell, &measured, truth, model)?;
            measured.displacements = exact
                .iter()
                .enumerate()
                .map(|(point, value)| {
                    let noise = noise.fixed_rows::<3>(3 * (points * p + point));
                    Displacement::new(point, value + noise)
                })
                .collect();
            Ok(measured)
        })
        .collect()
}
