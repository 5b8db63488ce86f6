//! Errors that are common to the whole experiment: how far each moves the joint
//! stiffness, how much of its size the readings leave, and how sure the
//! stiffness is with all of them.
//!
//! For each source the truth is made to differ from the nominal cell by one
//! standard uncertainty, the displacements follow from the model with the
//! estimated compliance, and the same estimator looks at them with the nominal
//! Ψ. Both steps are exact: the model is evaluated at the perturbed set-up, and
//! k' = 1/H' is compared with k. Only what the estimator takes from the data
//! besides (weights, the ratio of the two variances) is held. What the residuals
//! say of the sizes is in `posterior.rs`.

mod findings;
pub(crate) mod posterior;
mod predicting_model;
mod predictor;
mod preload;
mod sources;
mod total;

use crate::error::Result;
pub use crate::estimate::common::{PosteriorPart, SystematicPosterior};
use crate::estimate::identify::Fit;
use crate::estimate::mixed::MixedFit;
use crate::estimate::quantity::facts::Quantity;
use crate::findings::Finding;
use nalgebra::DVector;
use predicting_model::PredictingModel;
use serde::{Deserialize, Serialize};
use sources::{Part, Source, sources};
pub use total::JointUncertainty;

/// One axis, or one joint, of a source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SystematicPart {
    /// `x`, `y`, `z`, or the name of a joint.
    pub name: String,
    /// k'/k − 1 of each joint (fraction), for a deviation of this part in its
    /// positive direction; `None` where the joint has no positive stiffness or
    /// keeps none.
    pub change: Vec<Option<f64>>,
}

/// One source of common error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SystematicSource {
    /// Stable name: `force-scale`, `anchor`, `loading-point`, `registration`,
    /// `base-tilt`, `sensor`, `force-beside`, `common-shift`, `lost-motion`, `springs`; with `free` any that was
    /// identified.
    pub name: String,
    /// Standard uncertainty, SI.
    pub size: f64,
    /// Unit of `size`; `1` for a fraction.
    pub unit: String,
    /// True where the cell declares the size or the readings give it, false where it is assumed.
    pub declared: bool,
    /// True where it was identified beside the stiffness: before the readings its size counts as unknown.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub free: bool,
    /// True where the readings want it elsewhere than is stated: its size is how far.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub doubtful: bool,
    /// Change of each joint's stiffness (fraction) by one standard uncertainty:
    /// with its sign where the source is one number, the root sum of squares of
    /// its parts otherwise.
    pub change: Vec<Option<f64>>,
    /// Sum of the sizes of all parts: all at once, each in its worst direction.
    /// `None` where the source is one number.
    pub worst: Option<Vec<Option<f64>>>,
    /// How much of its size the readings leave (fraction; RMS of its parts): 1 where
    /// they say nothing of it, above 1 where they show more than was stated.
    pub remaining: Option<f64>,
    /// Relative standard uncertainty that it leaves in each joint's stiffness given
    /// the readings (fraction, first order).
    pub bounded: Vec<Option<f64>>,
    /// The parts of a source that has several.
    pub parts: Vec<SystematicPart>,
}

/// Common errors beside the statistical ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SystematicErrors {
    /// Names of the joints.
    pub joints: Vec<String>,
    /// The sources; the force scale is always the first.
    pub sources: Vec<SystematicSource>,
    /// Relative standard uncertainty by all sources together, as far as the
    /// readings leave them, joint by joint (fraction of k, first order).
    pub combined: Vec<Option<f64>>,
    /// Relative standard error of the estimates, joint by joint (fraction of k).
    pub statistical: Vec<Option<f64>>,
    /// Relative standard uncertainty by readings and sources together, joint by
    /// joint (fraction of k, first order).
    pub total: Vec<Option<f64>>,
    /// Confidence of `uncertainty`.
    pub confidence: f64,
    /// How sure each joint's stiffness is with everything together.
    pub uncertainty: Vec<JointUncertainty>,
    /// What the readings leave of the sizes.
    pub posterior: SystematicPosterior,
    /// What matters, in sentences.
    pub findings: Vec<Finding>,
}

/// The moments of all parts as they are saved.
fn posterior_of(sources: &[Source], parts: &posterior::Parts) -> SystematicPosterior {
    let all = sources.iter().flat_map(|s| s.parts.iter().map(move |p| (s, p)));
    let covariance = &parts.covariance;
    SystematicPosterior {
        parts: all
            .enumerate()
            .map(|(i, (source, part))| PosteriorPart {
                source: source.facts.name.to_string(),
                part: part.name.clone(),
                response: parts.response.column(i).iter().copied().collect(),
                at_work: part.at_work,
                size: source.size,
            })
            .collect(),
        mean: parts.mean.iter().copied().collect(),
        covariance: (0..covariance.nrows()).map(|i| (0..=i).map(|k| covariance[(i, k)]).collect()).collect(),
    }
}

/// How far each common error moves the joint stiffness that
/// [`identify`](crate::estimate::identify::identify()) finds, and how much of it the
/// readings leave possible. Sizes come from
/// [`Cell::uncertainty`](crate::model::cell::Cell::uncertainty) or are assumed and marked so.
///
/// - `force-scale`: all readings of force, and the stated force of a rope or
///   weight, too large by this fraction. Every k comes out too large by as much,
///   and no residual shows it.
/// - `anchor`: where the rope's force comes from the cell, or points along the
///   rope.
/// - `loading-point`: coordinates in flange axes. A wrench whose moment a sensor
///   has measured is known at the sensor and does not depend on it.
/// - `registration`: turns the displacements. A wrench that is measured at the
///   flange, or given by anchor and loading point, does not turn with it; a
///   sensor in the cell whose pose came from the same registration would, and
///   then part of this change cancels.
/// - `base-tilt`, `sensor`, `lost-motion`: elements that nobody models; each
///   makes k too small. Those that the fit has among its unknowns are left out.
///   Displacements against a light preload are free of lost motion; the way from no load to the preload, where it was
///   read, shows it, and at work it is there again.
/// - `springs`, of the mixed model alone: half of what would be found otherwise if springs alone were expected, without
///   bearings and beams. The readings do not tell which an arm has.
///
/// # Errors
/// As [`identify`](crate::estimate::identify::identify()).
pub fn systematic_errors(fit: &Fit) -> Result<SystematicErrors> {
    systematic_errors_with(fit, None, None)
}

/// The same for the mixed model. What its springs hold, tilts of the base among it, is
/// no common error any more.
///
/// # Errors
/// As [`systematic_errors`].
pub fn mixed_systematic_errors(mixed: &MixedFit) -> Result<SystematicErrors> {
    systematic_errors_with(mixed.fit(), Some(mixed), None)
}

/// The same of either, where a quantity may be `off` by as much, as the readings ask for: what is stated of it does not
/// hold then.
///
/// # Errors
/// As [`systematic_errors`].
pub(crate) fn systematic_errors_with(
    fit: &Fit,
    mixed: Option<&MixedFit>,
    off: Option<(Quantity, f64)>,
) -> Result<SystematicErrors> {
    let mut believed = match mixed {
        Some(mixed) => PredictingModel::of_mixed(mixed)?,
        None => PredictingModel::of_fit(fit)?,
    };
    believed.off = off;
    errors_of(&believed)
}

/// The same as readings of the experiment behind `fit` are expected to give it. The fit takes the size of the
/// scatter as known, and its displacements do not count: the unknowns are `values`, and `left` is what they leave of
/// the displacements (rows as in the system, m), nothing of those that are not there yet.
///
/// # Errors
/// As [`systematic_errors`].
pub(crate) fn expected_errors(fit: &Fit, values: &DVector<f64>, left: &DVector<f64>) -> Result<SystematicErrors> {
    errors_of(&PredictingModel::expected(fit, values, left)?)
}

fn errors_of(believed: &PredictingModel<'_>) -> Result<SystematicErrors> {
    let fit = believed.fit;
    let springs = fit.system().springs;
    let sources = sources(believed, fit.experiment(), fit.system())?;
    let parts = posterior::parts(believed, &sources)?;
    let mut at = 0;
    let mut described = Vec::with_capacity(sources.len());
    for source in &sources {
        fit.control().check()?;
        described.push(describe(believed, source, &parts, at));
        at += source.parts.len();
    }
    let count = parts.mean.len();
    let statistical: Vec<Option<f64>> = (0..springs).map(|j| relative_error(believed, j)).collect();
    let combined: Vec<Option<f64>> = (0..springs).map(|j| bounded(believed, &parts, 0..count, j)).collect();
    let both = statistical.iter().zip(&combined);
    let mut systematic = SystematicErrors {
        joints: fit.system().unknowns[..springs].to_vec(),
        total: both.map(|(a, b)| Some((*a)?.hypot((*b)?))).collect(),
        confidence: fit.options().confidence,
        uncertainty: total::uncertainty(believed, &described, &parts)?,
        posterior: posterior_of(&sources, &parts),
        sources: described,
        combined,
        statistical,
        findings: Vec::new(),
    };
    systematic.findings = findings::findings(&systematic, findings::ReadingReference::of(fit.measured()));
    if fit.cell().route.approach.is_some() {
        systematic.findings.push(findings::reached_from_load());
    }
    if fit.measured().is_against_preload() && preload::ways(believed).is_empty() {
        systematic.findings.push(findings::not_read_unloaded());
    }
    Ok(systematic)
}

/// One source, whose parts begin at `from` among all.
fn describe(believed: &PredictingModel<'_>, source: &Source, all: &posterior::Parts, from: usize) -> SystematicSource {
    let count = believed.fit.system().springs;
    let part = |(i, part): (usize, &Part)| SystematicPart {
        name: part.name.clone(),
        change: changes(believed, &all.joints.column(from + i).into_owned()),
    };
    let parts: Vec<SystematicPart> = source.parts.iter().enumerate().map(part).collect();
    let columns = from..from + parts.len();
    let moment = |i: usize| all.covariance[(i, i)] + all.mean[i].powi(2);
    let squares = columns.clone().map(moment);
    let remaining = (squares.sum::<f64>() / parts.len() as f64).sqrt();
    let one = matches!(parts.as_slice(), [part] if part.name.is_empty());
    let of = |j: usize| parts.iter().map(move |part| part.change[j]);
    let sum = |j: usize| of(j).map(|c| c.map(f64::abs)).sum();
    let (change, worst) = if one {
        (parts[0].change.clone(), None)
    } else {
        ((0..count).map(|j| root_sum(of(j))).collect(), Some((0..count).map(sum).collect()))
    };
    SystematicSource {
        name: source.facts.name.to_string(),
        size: source.size,
        unit: source.facts.unit.to_string(),
        declared: source.declared,
        free: source.free,
        doubtful: source.doubtful,
        change,
        worst,
        remaining: Some(remaining),
        bounded: (0..count).map(|j| bounded(believed, all, columns.clone(), j)).collect(),
        parts: if one { Vec::new() } else { parts },
    }
}

/// k'/k − 1 of each joint when the joints' compliance changes by `change`.
fn changes(believed: &PredictingModel<'_>, change: &DVector<f64>) -> Vec<Option<f64>> {
    (0..believed.fit.system().springs)
        .map(|j| {
            let h = believed.joints[j];
            let moved = h + change[j];
            let has_stiffness = believed.has_stiffness(j) && moved > 0.0;
            has_stiffness.then(|| h / moved - 1.0)
        })
        .collect()
}

/// √(R M Rᵀ) of joint `j` over its compliance, for the parts `which`.
fn bounded(
    believed: &PredictingModel<'_>,
    all: &posterior::Parts,
    which: std::ops::Range<usize>,
    j: usize,
) -> Option<f64> {
    let (from, count) = (which.start, which.len());
    let row = all.joints.view((j, from), (1, count));
    let covariance = all.covariance.view((from, from), (count, count));
    let mean = (row * all.mean.rows(from, count))[(0, 0)];
    let square = (row * covariance * row.transpose())[(0, 0)] + mean * mean;
    let has_stiffness = believed.has_stiffness(j);
    has_stiffness.then(|| square.max(0.0).sqrt() / believed.joints[j])
}

/// σ_H/H, to first order the relative standard error of k.
fn relative_error(believed: &PredictingModel<'_>, j: usize) -> Option<f64> {
    let error = believed.errors[j]?;
    let has_stiffness = believed.has_stiffness(j);
    has_stiffness.then(|| error / believed.joints[j])
}

/// Root sum of squares; `None` with any part missing.
fn root_sum(changes: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let squares: Option<f64> = changes.map(|c| c.map(|c| c * c)).sum();
    squares.map(f64::sqrt)
}
