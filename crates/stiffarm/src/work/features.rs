//! What the deflection does to the features of a part: how far they come out beside where they should be.

use crate::error::Result;
use crate::findings::{Finding, length, length_with_error};
use crate::model::cell::Cell;
use crate::model::path::{LoadedPosture, feed_axes};
use crate::numerics::control::Control;
use crate::work::predict::LoadedArm;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::sync::Arc;

/// Features named in the sentence about those that are not within their tolerance.
const MOST_NAMED: usize = 3;

/// What is known of a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Deviation {
    /// Shift of the tip, base axes \[m\].
    pub shift_m: [f64; 3],
    /// Half width of its size \[m\]; `None` where the stiffness comes without covariance.
    pub half_width_m: Option<f64>,
    /// What is left of it by the command, by the model \[m\].
    pub residual_m: Option<f64>,
}

/// How a feature comes out: the moves of a path that share a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Feature {
    /// Its name in the path; `path` where that names none.
    pub name: String,
    /// How many of its points carry a load.
    pub points: usize,
    /// Name of the point where it deviates most.
    pub worst: String,
    /// Largest deviation across the feed \[m\]; what lies along it leaves the shape as it is.
    pub across_max_m: f64,
    /// Largest deviation along the feed \[m\].
    pub feed_max_m: f64,
    /// Largest deviation across feed and tool axis \[m\].
    pub cross_max_m: f64,
    /// Largest deviation along the tool axis \[m\].
    pub axis_max_m: f64,
    /// Half width of the deflection at the worst point \[m\].
    pub half_width_m: Option<f64>,
    /// What may be left where the path is compensated: the largest residual with its half width \[m\].
    pub compensated_m: Option<f64>,
    /// What is allowed \[m\].
    pub tolerance_m: Option<f64>,
    /// Whether the deviation across the feed keeps to it.
    pub verdict: Option<Verdict>,
    /// Whether what may be left does.
    pub compensated_verdict: Option<Verdict>,
}

/// Whether a deviation keeps to its tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It does, its half width included.
    Passes,
    /// The tolerance lies within the half width.
    Open,
    /// It does not.
    Fails,
}

impl Verdict {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Passes => "passes",
            Verdict::Open => "open",
            Verdict::Fails => "fails",
        }
    }

    fn of(deviation: f64, half_width: f64, tolerance: f64) -> Self {
        match (deviation + half_width <= tolerance, deviation - half_width > tolerance) {
            (true, _) => Verdict::Passes,
            (_, true) => Verdict::Fails,
            _ => Verdict::Open,
        }
    }
}

/// The features of a path, with what is to be said about their tolerances \[m\], the cell's or else the
/// `default_tolerance`; none where the path names none and no tolerance is given.
///
/// # Errors
/// Angles of the wrong number.
pub(crate) fn features(
    (cell, arm): (&Cell, &LoadedArm),
    postures: &[LoadedPosture],
    default_tolerance: Option<f64>,
    deviation: impl Fn(usize) -> Deviation,
    control: Control<'_>,
) -> Result<(Vec<Feature>, Option<Finding>)> {
    if default_tolerance.is_none() && postures.iter().all(|posture| posture.feature.is_none()) {
        return Ok((Vec::new(), None));
    }
    let angles: Vec<&[f64]> = postures.iter().map(|p| p.q.as_slice()).collect();
    let tips = arm.tip_poses(&angles, control.quiet())?;
    let feeds = feed_axes(&tips);
    // In the order in which they come first.
    let mut groups: Vec<(Arc<str>, Vec<usize>)> = Vec::new();
    let mut places: HashMap<Arc<str>, usize> = HashMap::new();
    for i in (0..postures.len()).filter(|i| !postures[*i].wrench.is_zero()) {
        let name = postures[i].feature.clone().unwrap_or_else(|| Arc::from("path"));
        let place = *places.entry(name.clone()).or_insert(groups.len());
        if place == groups.len() {
            groups.push((name, Vec::new()));
        }
        groups[place].1.push(i);
    }
    let groups = groups.into_iter().map(|(name, points)| {
        let parts = |i: usize| {
            let shift = Vector3::from(deviation(i).shift_m);
            match &feeds[i] {
                Some(axes) => axes.inverse() * shift,
                // Where the path moves along the tool axis that is the feed.
                None => {
                    let axis = tips[i].rotation * Vector3::z();
                    let along = axis.dot(&shift);
                    Vector3::new(along, (shift - axis * along).norm(), 0.0)
                }
            }
        };
        let largest = |of: &dyn Fn(Vector3<f64>) -> f64| {
            let sizes = points.iter().map(|i| of(parts(*i)).abs());
            sizes.fold(0.0, f64::max)
        };
        let across = |i: usize| parts(i).yz().norm();
        let worst = points.iter().copied();
        let worst = worst.reduce(|a, b| if across(b) > across(a) { b } else { a });
        let worst = worst.unwrap_or_default();
        let half_width = deviation(worst).half_width_m;
        let left = points.iter().map(|i| {
            let point_deviation = deviation(*i);
            Some(point_deviation.residual_m? + point_deviation.half_width_m?)
        });
        let left = left.reduce(|a, b| Some(a?.max(b?))).flatten();
        let across_max_m = across(worst);
        let tolerance = cell.work.feature(&name).and_then(|feature| feature.tolerance);
        let tolerance = tolerance.or(default_tolerance);
        Feature {
            name: name.to_string(),
            points: points.len(),
            worst: postures[worst].name.to_string(),
            across_max_m,
            feed_max_m: largest(&|v| v.x),
            cross_max_m: largest(&|v| v.y),
            axis_max_m: largest(&|v| v.z),
            half_width_m: half_width,
            compensated_m: left,
            tolerance_m: tolerance,
            verdict: tolerance.map(|tolerance| Verdict::of(across_max_m, half_width.unwrap_or(0.0), tolerance)),
            compensated_verdict: tolerance.zip(left).map(|(tolerance, left)| Verdict::of(left, 0.0, tolerance)),
        }
    });
    let features: Vec<Feature> = groups.collect();
    let finding = judged(&features);
    Ok((features, finding))
}

/// Whether features keep to their tolerance, as they are or, where that is known, compensated.
fn judged(features: &[Feature]) -> Option<Finding> {
    let is_out = |feature: &&Feature| match feature.compensated_verdict {
        Some(verdict) => verdict != Verdict::Passes,
        None => feature.verdict.is_some_and(|verdict| verdict != Verdict::Passes),
    };
    let out: Vec<&Feature> = features.iter().filter(is_out).collect();
    let named: Vec<String> = out.iter().take(MOST_NAMED).map(|feature| feature.sentence()).collect();
    let more = match out.len().saturating_sub(MOST_NAMED) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    let count = features.len();
    let sentence = match (out.len(), count) {
        (0, _) => {
            let tolerances = features.iter().filter_map(|feature| feature.tolerance_m);
            let (low, high) = (tolerances.clone().reduce(f64::min)?, tolerances.reduce(f64::max)?);
            let tolerance = if low == high {
                format!("tolerance of {}", length(low))
            } else {
                format!("tolerances of {} to {}", length(low), length(high))
            };
            let compensated =
                features.iter().all(|feature| feature.tolerance_m.is_none() || feature.compensated_verdict.is_some());
            let words = if compensated { "Compensated, the" } else { "The" };
            let sentence = format!("{words} path keeps to its {tolerance}.");
            return Some(Finding::note("tolerance", "path", sentence));
        }
        (1, 1) => format!("It does not surely keep to its tolerance: {}.", named.join("; ")),
        (some, _) => {
            format!("{some} of {count} features do not surely keep to their tolerance: {}{more}.", named.join("; "))
        }
    };
    Some(Finding::caution("tolerance", "path", sentence))
}

impl Feature {
    /// `pocket 3: 0.210 ± 0.040 mm of 0.300 mm, passes; compensated 0.030 mm`.
    fn sentence(&self) -> String {
        let deviation = match self.half_width_m {
            Some(half) => length_with_error(self.across_max_m, half),
            None => length(self.across_max_m),
        };
        let allowed = self.tolerance_m.map(|tolerance| format!(" of {}", length(tolerance)));
        let verdict = self.verdict.map(|verdict| format!(", {}", verdict.word()));
        let left = self.compensated_m.map(|left| format!("; compensated {}", length(left)));
        let parts = [allowed, verdict, left].into_iter().flatten().collect::<String>();
        format!("{}: {deviation}{parts}", self.name)
    }
}
