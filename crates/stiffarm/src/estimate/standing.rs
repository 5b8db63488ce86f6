//! How an experiment stands while it is measured: what the readings so far give, what the postures that are
//! left are expected to bring, and whether that is enough.
//!
//! What is expected is a forecast, not a bound: the scatter of the readings is taken as it is so far, though a
//! few postures tell it badly; the standard errors shrink as the information of the planned postures says;
//! and the common errors stay what they are, though further readings bound most of them. Never the scale
//! of the force: no number of postures brings a joint below that.

use super::identify::{Fit, Verdict};
use super::next_posture::{NextPosture, PlannedErrors, planned_errors};
use super::systematic::{JointUncertainty, SystematicErrors};
use crate::error::Result;
use crate::findings::{Finding, Severity, percent};
use crate::numerics::half_width::Level;
use serde::Serialize;

/// The source of common error that is the scale of every force.
const FORCE_SCALE: &str = "force-scale";
/// A posture of one's own choice is worth naming if it beats the planned one by this share.
const WORTH_NAMING: f64 = 0.85;

/// How one joint stands.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointStanding {
    /// Name of the joint.
    pub name: String,
    /// Stiffness \[N·m/rad\], where the readings determine it.
    pub stiffness_nm_per_rad: Option<f64>,
    /// Half width of its interval with all errors (fraction of k).
    pub total: Option<f64>,
    /// Half width by the common errors alone, as far as the readings so far leave them (fraction of k).
    pub systematic: Option<f64>,
    /// What `total` is expected to be with the next planned posture.
    pub with_next: Option<f64>,
    /// What it is expected to be with all planned postures.
    pub with_all: Option<f64>,
}

/// How an experiment stands.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Standing {
    /// The joints.
    pub joints: Vec<JointStanding>,
    /// Confidence of the half widths.
    pub confidence: f64,
    /// Largest half width of all joints; `None` while a joint is not determined.
    pub largest: Option<f64>,
    /// Whether every joint is known to the goal; `None` without one.
    pub reached: Option<bool>,
    /// Planned postures after which the goal is expected to be reached; `None` without a goal,
    /// where it is reached, or where that is not expected with all of them.
    pub postures_to_goal: Option<usize>,
    /// What to know about the goal, in sentences.
    pub findings: Vec<Finding>,
}

/// How the experiment behind `fit` stands; `budget` are its systematic errors, `planned` the postures that
/// are left (controller angles, rad), in order, and `goal` the largest half width that is good enough
/// (fraction of k).
///
/// # Errors
/// As [`planned_errors`].
pub fn standing<Q: AsRef<[f64]>>(
    fit: &Fit,
    budget: &SystematicErrors,
    planned: &[Q],
    goal: Option<f64>,
) -> Result<Standing> {
    let found = fit.identification()?;
    let forecast = planned_errors(fit, planned).ok();
    let expected = |j: usize, after: usize| -> Option<f64> {
        let own = budget.uncertainty.get(j)?;
        total_after(own, forecast.as_ref()?, j, after)
    };
    let joints: Vec<JointStanding> = found
        .estimates
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            let own = budget.uncertainty.get(j);
            let usable = joint.verdict == Verdict::Determined;
            JointStanding {
                name: joint.name.clone(),
                stiffness_nm_per_rad: joint.stiffness,
                total: own.and_then(|own| own.total).filter(|_| usable),
                systematic: own.and_then(|own| own.systematic),
                with_next: (!planned.is_empty()).then(|| expected(j, 0)).flatten(),
                with_all: planned
                    .len()
                    .checked_sub(1)
                    .and_then(|last| expected(j, last)),
            }
        })
        .collect();
    let largest = worst(joints.iter().map(|joint| joint.total));
    let reached = goal.map(|goal| largest.is_some_and(|largest| largest <= goal));
    let postures_to_goal = goal.filter(|_| reached == Some(false)).and_then(|goal| {
        let enough = |after: &usize| {
            worst((0..joints.len()).map(|j| expected(j, *after))).is_some_and(|all| all <= goal)
        };
        (0..planned.len()).find(enough).map(|after| after + 1)
    });
    let findings = match (goal, reached) {
        (Some(goal), Some(false)) => out_of_reach(budget, found.estimates.confidence, goal)?
            .into_iter()
            .collect(),
        _ => Vec::new(),
    };
    Ok(Standing {
        joints,
        confidence: found.estimates.confidence,
        largest,
        reached,
        postures_to_goal,
        findings,
    })
}

/// The largest, where all are known.
fn worst(parts: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let all: Option<Vec<f64>> = parts.collect();
    all?.into_iter().reduce(f64::max)
}

/// Half width with all errors after so many further postures: the scatter shrinks as its standard error
/// does, the common errors stay. Where a joint is not determined yet, its standard error alone is known.
fn total_after(
    own: &JointUncertainty,
    forecast: &PlannedErrors,
    j: usize,
    after: usize,
) -> Option<f64> {
    let then = forecast.after.get(after)?.get(j).copied().flatten()?;
    let now = forecast.now.get(j).copied().flatten()?;
    let statistical = own.statistical? * then / now;
    Some(statistical.hypot(own.systematic.unwrap_or(0.0)))
}

/// Says where the scale of the force alone is beyond the goal: no residual ever shows it.
fn out_of_reach(budget: &SystematicErrors, confidence: f64, goal: f64) -> Result<Option<Finding>> {
    let quantile = Level::new(confidence)?.quantile();
    let scale = budget
        .sources
        .iter()
        .find(|source| source.name == FORCE_SCALE);
    let Some(scale) = scale.filter(|source| quantile * source.size > goal) else {
        return Ok(None);
    };
    let sentence = format!(
        "The force is known to {} (one standard uncertainty{}), which alone leaves ± {} of every stiffness: no number of \
         postures reaches ± {}. Declare uncertainty.force_scale_percent where it is known better, or ask for less.",
        percent(scale.size),
        if scale.declared { "" } else { ", assumed" },
        percent(quantile * scale.size),
        percent(goal)
    );
    let finding = Finding::new("goal-out-of-reach", Severity::Caution, "goal", sentence);
    Ok(Some(finding))
}

/// Whether a posture that was searched for is worth measuring instead of the next planned one: by the
/// relative standard error, RMS over joints.
pub fn is_better(found: &NextPosture, planned: &PlannedErrors) -> bool {
    let Some(next) = planned.after.first() else {
        return true;
    };
    let all: Option<Vec<f64>> = next.iter().copied().collect();
    match all {
        Some(all) => found.expected_error < WORTH_NAMING * super::identify::rms(&all),
        // The planned one leaves a joint undetermined, and this one does not.
        None => found.expected_error.is_finite(),
    }
}
