//! Residuals by posture and by point, and the weights behind a robust fit.

use super::labels::RowLabel;
use super::rms;
use super::solve::Solution;
use super::system::MeasuredSystem;
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::measurement::MeasuredPosture;
use crate::numerics::order::sort_by_number;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

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
    /// Its controller angles \[rad\].
    #[serde(rename = "q_deg", with = "crate::units::degrees", default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub angles: Vec<f64>,
    /// Measured force and moment on the robot at the loading point, base axes \[N; N·m\];
    /// `None` where the cell's load gives them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrench: Option<[f64; 6]>,
    /// Its displacements, in the order of the measurements.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub residuals: Vec<DisplacementResidual>,
}

/// Residual of one displacement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DisplacementResidual {
    /// Measuring point.
    pub point: String,
    /// Measured minus calculated displacement, base axes \[m\].
    pub residual_m: [f64; 3],
    /// Standard deviation of a component by the cell's noise and the number of readings,
    /// RMS over the axes \[m\].
    pub expected_std_m: f64,
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

pub(super) fn by_posture(
    cell: &Cell,
    measured: &[MeasuredPosture],
    system: &MeasuredSystem,
    residual: &DVector<f64>,
) -> Vec<PostureResidual> {
    let mut parts = vec![(Vec::new(), Vec::new(), Vec::new()); measured.len()];
    let std = cell.noise.displacement_std();
    for block in &system.blocks {
        for label in system.labels_of(block) {
            let (displacements, residuals, vectors) = &mut parts[label.measured];
            displacements.extend_from_slice(&system.delta.as_slice()[label.rows.clone()]);
            let components = &residual.as_slice()[label.rows.clone()];
            residuals.extend_from_slice(components);
            let point = point_of(measured, label);
            let covariance = block.covariance.of_point(label.rows.start - block.rows.start);
            let vector = DisplacementResidual {
                point: cell.setup.tool.measuring_points[point].name.clone(),
                residual_m: std::array::from_fn(|i| components[i]),
                expected_std_m: std * (covariance.trace() / 3.0).sqrt(),
            };
            vectors.push((label.displacement, vector));
        }
    }
    measured
        .iter()
        .zip(parts)
        .map(|(m, (displacements, residuals, mut vectors))| {
            vectors.sort_by_key(|(number, _)| *number);
            PostureResidual {
                posture: m.posture.name.clone(),
                state: m.state.clone(),
                displacement_rms_m: rms(&displacements),
                residual_rms_m: rms(&residuals),
                angles: m.posture.q.clone(),
                wrench: m.wrench.as_ref().map(Wrench::components),
                residuals: vectors.into_iter().map(|(_, vector)| vector).collect(),
            }
        })
        .collect()
}

/// The measuring point of a displacement.
fn point_of(measured: &[MeasuredPosture], label: &RowLabel) -> usize {
    measured[label.measured].displacements[label.displacement].point
}

pub(super) fn by_point(
    cell: &Cell,
    measured: &[MeasuredPosture],
    system: &MeasuredSystem,
    residual: &DVector<f64>,
) -> Vec<PointResidual> {
    let points = &cell.setup.tool.measuring_points;
    let mut out = Vec::with_capacity(points.len());
    for (p, point) in points.iter().enumerate() {
        let mut residuals = DMatrix::<f64>::zeros(3, 0);
        for label in &system.labels {
            if point_of(measured, label) == p {
                let at = residuals.ncols();
                residuals = residuals.insert_column(at, 0.0);
                residuals.column_mut(at).copy_from(&residual.rows(label.rows.start, 3));
            }
        }
        if residuals.ncols() == 0 {
            continue;
        }
        let mean = residuals.column_mean();
        out.push(PointResidual {
            point: point.name.clone(),
            residual_rms_m: rms(residuals.as_slice()),
            mean_m: [mean[0], mean[1], mean[2]],
        });
    }
    out
}

pub(super) fn displacement_weights(
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
            point: cell.setup.tool.measuring_points[point_of(measured, label)].name.clone(),
            weight: *weight,
        })
        .collect();
    sort_by_number(&mut out, |a| a.weight);
    out
}
