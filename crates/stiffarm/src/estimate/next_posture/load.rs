//! The load that measured forces look like at a posture not yet measured.

use crate::error::{Error, Result};
use crate::model::cell::Cell;
use crate::model::load::{Axes, Load, Wrench};
use crate::model::measurement::MeasuredPosture;
use crate::model::observation::PostureTerms;
use crate::numerics::information::symmetric_eigen;
use crate::numerics::sample::median;
use nalgebra::{DMatrix, Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Directions of force whose mean is shorter than this are too many to assume one.
const ONE_DIRECTION: f64 = 0.7;
/// Lines of force meet where half of them pass the common point within this
/// angle \[rad\].
const MEETING: f64 = 0.15;
/// Lines are parallel where their common point is this badly determined: the
/// smallest eigenvalue of the mean of I − u uᵀ.
const PARALLEL_EIGENVALUE: f64 = 0.02;

/// The load assumed where the cell's is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AssumedLoad {
    /// Anchor of a rope or of a cylinder that pushes, base frame \[m\].
    pub anchor_m: Option<[f64; 3]>,
    /// True where the forces point away from the anchor.
    pub pushes: bool,
    /// Direction of a constant force, base axes.
    pub direction: Option<[f64; 3]>,
    /// Its size: the median of the measured forces \[N\].
    pub magnitude_n: f64,
}

/// The load that the measured forces look like: a rope, or a cylinder that pushes, where their lines meet,
/// else a constant force where they point alike.
pub(super) fn assumed_load(cell: &Cell, measured: &[MeasuredPosture]) -> Result<(Load, AssumedLoad)> {
    let mut lines: Vec<(Vector3<f64>, Vector3<f64>)> = Vec::new();
    let mut sizes = Vec::new();
    for posture in measured {
        let Some(wrench) = &posture.wrench else {
            continue;
        };
        let terms = PostureTerms::new(&cell.setup, &posture.posture.q, Some(wrench))?;
        if let Some(direction) = wrench.force.try_normalize(f64::MIN_POSITIVE) {
            lines.push((*terms.loading_point(), direction));
            sizes.push(wrench.force.norm());
        }
    }
    let no_load = || {
        let message =
            "The measured forces neither meet in a point nor point alike: no load can be assumed at another posture.";
        Error::invalid(message).hint("set load.kind to what will load the robot, and use `select --given`")
    };
    if lines.is_empty() {
        return Err(no_load());
    }
    let size = median(&sizes);
    if let Some((anchor, pushes)) = common_anchor(&lines) {
        let assumed = AssumedLoad { anchor_m: Some(anchor.into()), pushes, direction: None, magnitude_n: size };
        let magnitude = if pushes { -size } else { size };
        return Ok((Load::Rope { anchor, magnitude }, assumed));
    }
    let mean = lines.iter().map(|(_, u)| u).sum::<Vector3<f64>>() / lines.len() as f64;
    if mean.norm() <= ONE_DIRECTION {
        return Err(no_load());
    }
    let direction = mean.normalize();
    let assumed = AssumedLoad { anchor_m: None, pushes: false, direction: Some(direction.into()), magnitude_n: size };
    let wrench = Wrench::force(direction * size);
    let axes = Axes::Base;
    Ok((Load::Constant { wrench, axes }, assumed))
}

/// The point nearest to all lines of force, where most of them pass it closely and pull towards it,
/// or push away from it: then with `true`.
fn common_anchor(lines: &[(Vector3<f64>, Vector3<f64>)]) -> Option<(Vector3<f64>, bool)> {
    let mut normal = Matrix3::zeros();
    let mut moment = Vector3::zeros();
    for (point, direction) in lines {
        let across = Matrix3::identity() - direction * direction.transpose();
        normal += across;
        moment += across * point;
    }
    let (sizes, _) = symmetric_eigen(DMatrix::from_iterator(3, 3, normal.iter().copied()))?;
    if sizes[0] < PARALLEL_EIGENVALUE * lines.len() as f64 {
        return None;
    }
    let anchor = normal.cholesky()?.solve(&moment);
    let angles: Vec<f64> = lines.iter().map(|(point, direction)| (anchor - point).angle(direction)).collect();
    let typical = median(&angles);
    let pushes = typical > PI - MEETING;
    (pushes || typical < MEETING).then_some((anchor, pushes))
}
