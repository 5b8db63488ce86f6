//! Errors that are common to the whole experiment and show in no residual: how
//! far each moves the joint stiffness.
//!
//! For each source the truth is made to differ from the nominal cell by one
//! standard uncertainty, the displacements follow from the model with the
//! estimated compliance, and the same estimator looks at them with the nominal
//! Ψ. Both steps are exact: the model is evaluated at the perturbed set-up, and
//! k' = 1/H' is compared with k. Only what the estimator takes from the data
//! besides (weights, the ratio of the two variances) is held.

mod sources;

use crate::error::Result;
use crate::estimate::identify::Fit;
use crate::findings::{Finding, Severity, length, list, percent};
use nalgebra::DVector;
use serde::{Deserialize, Serialize};
use sources::{Part, Source, sources};

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
    /// `base-tilt`, `sensor`, `lost-motion`.
    pub name: String,
    /// Standard uncertainty, SI.
    pub size: f64,
    /// Unit of `size`; `1` for a fraction.
    pub unit: String,
    /// True where the cell declares the size, false where it is assumed.
    pub declared: bool,
    /// Change of each joint's stiffness (fraction): with its sign where the
    /// source is one number, the root sum of squares of its parts otherwise.
    pub change: Vec<Option<f64>>,
    /// Sum of the sizes of all parts: all at once, each in its worst direction.
    /// `None` where the source is one number.
    pub worst: Option<Vec<Option<f64>>>,
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
    /// Root sum of squares of all sources, joint by joint (fraction of k).
    pub combined: Vec<Option<f64>>,
    /// Relative standard error of the estimates, joint by joint (fraction of k).
    pub statistical: Vec<Option<f64>>,
    /// What matters, in sentences.
    pub findings: Vec<Finding>,
}

/// How far each common error moves the joint stiffness that
/// [`identify`](crate::estimate::identify::identify()) finds. Sizes come from
/// [`Cell::uncertainty`](crate::model::cell::Cell::uncertainty) or are assumed and marked so.
///
/// - `force-scale`: all readings of force, and the stated force of a rope or
///   weight, too large by this fraction. Every k comes out too large by as much.
/// - `anchor`: where the rope's force comes from the cell, or points along the
///   rope.
/// - `loading-point`: coordinates in flange axes. A wrench whose moment a sensor
///   has measured is known at the sensor and does not depend on it.
/// - `registration`: turns the displacements. A wrench that is measured at the
///   flange, or given by anchor and loading point, does not turn with it; a
///   sensor in the cell whose pose came from the same registration would, and
///   then part of this change cancels.
/// - `base-tilt`, `sensor`, `lost-motion`: elements that nobody models; each
///   makes k too small. Displacements against a light preload are free of lost
///   motion: declare 0 for them.
///
/// # Errors
/// As [`identify`](crate::estimate::identify::identify()).
pub fn systematic_errors(fit: &Fit) -> Result<SystematicErrors> {
    let joints = fit.system().unknowns[..fit.system().springs].to_vec();
    let mut out = Vec::new();
    for source in sources(fit)? {
        out.push(describe(fit, source)?);
    }
    let count = joints.len();
    let combined = (0..count)
        .map(|j| root_sum(out.iter().map(|source| source.change[j])))
        .collect();
    let statistical = (0..count).map(|j| relative_error(fit, j)).collect();
    let mut budget = SystematicErrors {
        joints,
        sources: out,
        combined,
        statistical,
        findings: Vec::new(),
    };
    budget.findings = findings(&budget);
    Ok(budget)
}

fn describe(fit: &Fit, source: Source) -> Result<SystematicSource> {
    let count = fit.system().springs;
    let mut parts = Vec::with_capacity(source.parts.len());
    for Part { name, shift } in source.parts {
        fit.control().check()?;
        parts.push(SystematicPart {
            name,
            change: changes(fit, &shift)?,
        });
    }
    let one = matches!(parts.as_slice(), [part] if part.name.is_empty());
    let of = |j: usize| parts.iter().map(move |part| part.change[j]);
    let sum = |j: usize| of(j).map(|c| c.map(f64::abs)).sum();
    let (change, worst) = match one {
        true => (parts[0].change.clone(), None),
        false => (
            (0..count).map(|j| root_sum(of(j))).collect(),
            Some((0..count).map(sum).collect()),
        ),
    };
    Ok(SystematicSource {
        name: source.name.to_string(),
        size: source.size,
        unit: source.unit.to_string(),
        declared: source.declared,
        change,
        worst,
        parts: if one { Vec::new() } else { parts },
    })
}

/// k'/k − 1 of each joint when the displacements change by `shift`.
fn changes(fit: &Fit, shift: &DVector<f64>) -> Result<Vec<Option<f64>>> {
    let change = fit.response(shift)?;
    let solution = fit.solution();
    Ok((0..fit.system().springs)
        .map(|j| {
            let h = solution.values[j];
            let moved = h + change[j];
            let known = !solution.undetermined.contains(&j) && h > 0.0 && moved > 0.0;
            known.then(|| h / moved - 1.0)
        })
        .collect())
}

/// σ_H/H, to first order the relative standard error of k.
fn relative_error(fit: &Fit, j: usize) -> Option<f64> {
    let solution = fit.solution();
    let covariance = solution.covariance.as_ref()?;
    let known = !solution.undetermined.contains(&j) && solution.values[j] > 0.0;
    known.then(|| covariance[(j, j)].max(0.0).sqrt() / solution.values[j])
}

/// Root sum of squares; `None` with any part missing.
fn root_sum(changes: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let squares: Option<f64> = changes.map(|c| c.map(|c| c * c)).sum();
    squares.map(f64::sqrt)
}

impl SystematicSource {
    /// The source in words, with its size.
    fn words(&self) -> String {
        let minutes = || format!("{:.2} arc-minutes", 60.0 * self.size.to_degrees());
        let stiffness = || format!("{:.1e} N·m/rad", 1.0 / self.size);
        match self.name.as_str() {
            "force-scale" => format!("force scale ({})", percent(self.size)),
            "anchor" => format!("rope anchor ({} an axis)", length(self.size)),
            "loading-point" => format!("loading point ({} an axis)", length(self.size)),
            "registration" => format!("registration ({:.2} mrad an axis)", 1e3 * self.size),
            "base-tilt" => format!("tilt of the base ({})", stiffness()),
            "sensor" => format!("compliance between flange and reflectors ({})", stiffness()),
            _ => format!("lost motion ({} each joint)", minutes()),
        }
    }
}

fn findings(budget: &SystematicErrors) -> Vec<Finding> {
    let mut out = Vec::new();
    let names = &budget.joints;
    if let Some(force) = budget.sources.first() {
        let assumed = if force.declared { "" } else { " (assumed)" };
        out.push(Finding::new(
            "force-scale",
            Severity::Note,
            "uncertainty",
            format!(
                "A force that is read {} too large{assumed} makes every k {0} too large and shows in no residual.",
                percent(force.size)
            ),
        ));
    }
    for source in &budget.sources {
        let own: Vec<String> = names
            .iter()
            .enumerate()
            .filter_map(|(j, name)| {
                let size = source.change[j]?.abs();
                let largest = budget
                    .sources
                    .iter()
                    .filter_map(|s| s.change[j])
                    .fold(0.0, |m: f64, c| m.max(c.abs()));
                (size > 0.0 && size >= largest).then(|| format!("{name} ({})", percent(size)))
            })
            .collect();
        if !own.is_empty() {
            let message = format!(
                "Of the errors that show in no residual, {} is the largest for {}.",
                source.words(),
                list(&own)
            );
            out.push(Finding::new(
                "largest-common-error",
                Severity::Note,
                &source.name,
                message,
            ));
        }
    }
    for (j, name) in names.iter().enumerate() {
        let lost = budget.sources.iter().find(|s| {
            s.change[j].is_none() && budget.sources.iter().any(|other| other.change[j].is_some())
        });
        if let Some(source) = lost {
            let message = format!(
                "The {} can explain all of the give of {name}.",
                source.words()
            );
            out.push(Finding::new(
                "common-error-explains-all",
                Severity::Caution,
                name,
                message,
            ));
        }
    }
    let beyond: Vec<String> = names
        .iter()
        .enumerate()
        .filter_map(|(j, name)| {
            let (common, statistical) = (budget.combined[j]?, budget.statistical[j]?);
            (common > statistical).then(|| {
                format!(
                    "{name} ({} against {})",
                    percent(common),
                    percent(statistical)
                )
            })
        })
        .collect();
    if !beyond.is_empty() {
        let message = format!(
            "The common errors are larger than the standard error for {}: more readings of this kind would not help.",
            list(&beyond)
        );
        out.push(Finding::new(
            "common-error-dominates",
            Severity::Caution,
            "uncertainty",
            message,
        ));
    }
    let assumed: Vec<String> = budget
        .sources
        .iter()
        .filter(|s| !s.declared)
        .map(SystematicSource::words)
        .collect();
    if !assumed.is_empty() {
        let message = format!("Assumed, not declared in the cell: {}.", list(&assumed));
        out.push(Finding::new(
            "assumed-uncertainty",
            Severity::Note,
            "uncertainty",
            message,
        ));
    }
    out
}
