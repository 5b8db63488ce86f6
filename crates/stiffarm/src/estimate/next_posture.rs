//! What to measure next: the posture that would help an identification most.

use crate::error::{Code, Error, Result};
use crate::estimate::identify::{Fit, Identification, Verdict};
use crate::model::cell::Cell;
use crate::model::load::{Axes, Load, Wrench};
use crate::model::measurement::MeasuredPosture;
use crate::model::observation::PostureTerms;
use crate::model::posture::Posture;
use crate::numerics::control::Control;
use crate::numerics::information::symmetric_eigen;
use crate::numerics::sample::median;
use crate::plan::index::{Index, evaluate};
use crate::plan::select::{GlobalOptions, select};
use nalgebra::{DMatrix, Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Directions of force whose mean is shorter than this are too many to assume one.
const ONE_DIRECTION: f64 = 0.7;
/// Lines of force meet where half of them pass the common point within this
/// angle \[rad\].
const MEETING: f64 = 0.15;
/// Lines are parallel where their common point is this badly determined: the
/// smallest eigenvalue of the mean of I − u uᵀ.
const PARALLEL: f64 = 0.02;

/// The load assumed where the cell's is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AssumedLoad {
    /// Anchor of a rope, base frame \[m\].
    pub anchor_m: Option<[f64; 3]>,
    /// Direction of a constant force, base axes.
    pub direction: Option<[f64; 3]>,
    /// Its size: the median of the measured forces \[N\].
    pub magnitude_n: f64,
}

/// The posture that would help most.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NextPosture {
    /// Its controller angles \[rad\].
    #[serde(rename = "posture_deg", with = "crate::units::degrees")]
    #[cfg_attr(
        feature = "schema",
        schemars(with = "Vec<f64>", description = "Its controller angles \\[deg\\].")
    )]
    pub angles: Vec<f64>,
    /// Relative standard error of each joint's stiffness with the postures so
    /// far (fraction); `None` where they do not determine it.
    pub before: Vec<Option<f64>>,
    /// The same with the new posture.
    pub after: Vec<Option<f64>>,
    /// Relative standard error, RMS over joints, with the new posture.
    pub expected_error: f64,
    /// The load assumed at the new posture, where the cell's is measured.
    pub assumed_load: Option<AssumedLoad>,
}

/// The posture within the cell's bounds and limits which, measured besides the
/// others, makes the relative standard errors (RMS over joints) smallest. The
/// identified stiffness stands for the prior where it is positive, the
/// residuals for the noise.
///
/// # Errors
/// No stiffness to weigh joints by, measured forces from which no
/// load can be assumed, or as [`select`].
pub fn next_posture(
    fit: &Fit,
    options: &GlobalOptions,
    control: Control<'_>,
) -> Result<NextPosture> {
    let (result, measured) = (fit.identification()?, fit.postures());
    let mut cell = fit.cell().clone();
    cell.prior = Some(stiffness(&cell, result)?);
    let two = f64::from(cell.noise.readings_per_displacement);
    if let Some(sigma) = result.residual_std_m.filter(|s| *s > 0.0) {
        cell.noise.reading_variance = sigma * sigma / two;
    }
    cell.noise.posture_common_std = result.posture_common_std_m.unwrap_or(0.0);
    let mut assumed = None;
    if cell.setup.load == Load::Measured {
        let (load, description) = assumed_load(&cell, measured)?;
        cell.setup.load = load;
        assumed = Some(description);
    }
    let mut given: Vec<Posture> = Vec::new();
    for posture in measured.iter().map(|m| &m.posture) {
        if given.iter().all(|p| p.name != posture.name) {
            given.push(posture.clone());
        }
    }
    let search = GlobalOptions {
        given: given.iter().map(|posture| posture.q.clone()).collect(),
        ..options.clone()
    };
    let selection = select(&cell, Index::ExpectedError, 1, &search, control)?;
    let before = evaluate(&cell, "before", &given)?;
    Ok(NextPosture {
        angles: selection.group.concat(),
        before: before.relative_standard_error,
        after: selection.evaluation.relative_standard_error,
        expected_error: selection.value,
        assumed_load: assumed,
    })
}

/// Stiffness of each joint: identified, else the prior, else the middle of the
/// identified ones.
fn stiffness(cell: &Cell, result: &Identification) -> Result<Vec<f64>> {
    let own: Vec<Option<f64>> = result
        .estimates
        .joints
        .iter()
        .map(|joint| {
            let usable = joint.verdict != Verdict::SignOrModelFault;
            joint.stiffness.filter(|k| usable && *k > 0.0)
        })
        .collect();
    let mut known: Vec<f64> = own.iter().flatten().copied().collect();
    known.sort_by(f64::total_cmp);
    let middle = known.get(known.len() / 2).copied();
    own.iter()
        .enumerate()
        .map(|(j, k)| {
            let prior = cell.prior.as_ref().map(|prior| prior[j]);
            k.or(prior).or(middle).ok_or_else(|| {
                Error::new(
                    Code::NotIdentifiable,
                    "No joint has a positive stiffness by which to weigh the next posture.",
                )
            })
        })
        .collect()
}

/// The load that the measured forces look like: a rope where their lines meet,
/// else a constant force where they point alike.
fn assumed_load(cell: &Cell, measured: &[MeasuredPosture]) -> Result<(Load, AssumedLoad)> {
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
        Error::new(
            Code::InvalidValue,
            "The measured forces neither meet in a point nor point alike: no load can be assumed at another posture.",
        )
        .hint("set load.kind to what will load the robot, and use `select --given`")
    };
    if lines.is_empty() {
        return Err(no_load());
    }
    let magnitude = median(&sizes);
    if let Some(anchor) = common_anchor(&lines) {
        let assumed = AssumedLoad {
            anchor_m: Some(anchor.into()),
            direction: None,
            magnitude_n: magnitude,
        };
        return Ok((Load::Rope { anchor, magnitude }, assumed));
    }
    let mean = lines.iter().map(|(_, u)| u).sum::<Vector3<f64>>() / lines.len() as f64;
    if mean.norm() <= ONE_DIRECTION {
        return Err(no_load());
    }
    let direction = mean.normalize();
    let assumed = AssumedLoad {
        anchor_m: None,
        direction: Some(direction.into()),
        magnitude_n: magnitude,
    };
    let wrench = Wrench::force(direction * magnitude);
    let axes = Axes::Base;
    Ok((Load::Constant { wrench, axes }, assumed))
}

/// The point nearest to all lines of force, where most of them pass it closely
/// and pull towards it.
fn common_anchor(lines: &[(Vector3<f64>, Vector3<f64>)]) -> Option<Vector3<f64>> {
    let mut normal = Matrix3::zeros();
    let mut moment = Vector3::zeros();
    for (point, direction) in lines {
        let across = Matrix3::identity() - direction * direction.transpose();
        normal += across;
        moment += across * point;
    }
    let (sizes, _) = symmetric_eigen(DMatrix::from_iterator(3, 3, normal.iter().copied()))?;
    if sizes[0] < PARALLEL * lines.len() as f64 {
        return None;
    }
    let anchor = normal.cholesky()?.solve(&moment);
    let angles: Vec<f64> = lines
        .iter()
        .map(|(point, direction)| (anchor - point).angle(direction))
        .collect();
    (median(&angles) < MEETING).then_some(anchor)
}
