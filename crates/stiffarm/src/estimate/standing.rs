//! How an experiment stands while it is measured: what the readings so far give, what the postures that are
//! left are expected to bring, and whether that is enough.
//!
//! What is expected is what `identify` would print ([`forecast`](super::forecast)), not a bound: the scale of the
//! force stays what it is, and no number of postures brings a joint below that.

use super::forecast::forecast_with;
use super::identify::Fit;
use super::next_posture::{NextPosture, PlannedErrors};
use super::systematic::SystematicErrors;
use crate::error::{Code, Result};
use crate::findings::{Finding, Severity, percent};
use crate::numerics::half_width::Level;
use crate::plan::check::determinable;
use serde::{Deserialize, Serialize};

/// The source of common error that is the scale of every force.
const FORCE_SCALE: &str = "force-scale";
/// A posture of one's own choice is worth naming if it beats the planned one by this share.
const WORTH_NAMING: f64 = 0.85;

/// How one joint stands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointStanding {
    /// Name of the joint.
    pub name: String,
    /// Stiffness \[N·m/rad\], where the readings determine it.
    pub stiffness_nm_per_rad: Option<f64>,
    /// ± of its interval with all errors, as `identify` prints it (fraction of k).
    pub total: Option<f64>,
    /// Half width by the common errors alone, as far as the readings so far leave them (fraction of k).
    pub systematic: Option<f64>,
    /// What `total` is expected to be with the next planned posture.
    pub with_next: Option<f64>,
    /// What it is expected to be with all planned postures.
    pub with_all: Option<f64>,
}

/// How an experiment stands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Standing {
    /// The joints.
    pub joints: Vec<JointStanding>,
    /// Confidence of the half widths.
    pub confidence: f64,
    /// Largest half width of the joints that the load turns; `None` while one of them is not determined.
    pub largest: Option<f64>,
    /// Whether each of them is known to the goal; `None` without one.
    pub reached: Option<bool>,
    /// Planned postures after which the goal is expected to be reached; `None` without a goal,
    /// where it is reached, or where that is not expected with all of them.
    pub postures_to_goal: Option<usize>,
    /// What to know about the goal and of joints that no goal is asked of, in sentences.
    pub findings: Vec<Finding>,
}

/// How the experiment behind `fit` stands; `systematic` are its systematic errors, `planned` the postures that
/// are left (controller angles, rad), in order, and `goal` the largest half width that is good enough
/// (fraction of k).
///
/// # Errors
/// A decomposition that fails; stopped.
pub fn standing<Q: AsRef<[f64]>>(
    fit: &Fit,
    systematic: &SystematicErrors,
    planned: &[Q],
    goal: Option<f64>,
) -> Result<Standing> {
    let found = fit.identification()?;
    // Without a stiffness or a load to assume nothing is foreseen; stopped is stopped.
    let expected = |count: usize| -> Result<Option<Vec<Option<f64>>>> {
        match forecast_with(fit, systematic, &planned[..count]) {
            Ok(joints) => Ok(Some(joints.iter().map(|joint| joint.total).collect())),
            Err(error) if error.code() == Code::Interrupted => Err(error),
            Err(_) => Ok(None),
        }
    };
    let (with_next, with_all) = match planned.len() {
        0 => (None, None),
        1 => (expected(1)?, expected(1)?),
        count => (expected(1)?, expected(count)?),
    };
    let of = |all: &Option<Vec<Option<f64>>>, j: usize| all.as_ref()?.get(j).copied().flatten();
    let joints: Vec<JointStanding> = found
        .estimates
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            let own = systematic.uncertainty.get(j);
            let usable = joint.interval[1].is_some();
            JointStanding {
                name: joint.name.clone(),
                stiffness_nm_per_rad: joint.stiffness,
                total: own.and_then(|own| own.total).filter(|_| usable),
                systematic: own.and_then(|own| own.systematic),
                with_next: of(&with_next, j),
                with_all: of(&with_all, j),
            }
        })
        .collect();
    // The load of the cell says nothing of these, and no measured force did either.
    let (_, mut findings) = determinable(fit.cell().clone());
    findings.retain(|f| found.estimates.undetermined_joints.contains(&f.subject));
    let left_out = |j: &usize| findings.iter().any(|f| f.subject == joints[*j].name);
    let turned: Vec<usize> = (0..joints.len()).filter(|j| !left_out(j)).collect();
    let worst = |part: &dyn Fn(usize) -> Option<f64>| {
        let all: Option<Vec<f64>> = turned.iter().map(|j| part(*j)).collect();
        all?.into_iter().reduce(f64::max)
    };
    let largest = worst(&|j| joints[j].total);
    let reached = goal.map(|goal| largest.is_some_and(|largest| largest <= goal));
    let enough = |all: &Option<Vec<Option<f64>>>| {
        goal.zip(worst(&|j| of(all, j)))
            .is_some_and(|(goal, largest)| largest <= goal)
    };
    let mut postures_to_goal = None;
    if reached == Some(false) && enough(&with_all) {
        // Each posture brings something, so that halving finds the first count.
        let (mut too_few, mut count) = (0, planned.len());
        while count - too_few > 1 {
            let middle = too_few.midpoint(count);
            match enough(&expected(middle)?) {
                true => count = middle,
                false => too_few = middle,
            }
        }
        postures_to_goal = Some(count);
    }
    if let (Some(goal), Some(false)) = (goal, reached) {
        findings.extend(out_of_reach(systematic, found.estimates.confidence, goal)?);
    }
    Ok(Standing {
        joints,
        confidence: found.estimates.confidence,
        largest,
        reached,
        postures_to_goal,
        findings,
    })
}

/// Says where the scale of the force alone is beyond the goal: no residual ever shows it.
fn out_of_reach(
    systematic: &SystematicErrors,
    confidence: f64,
    goal: f64,
) -> Result<Option<Finding>> {
    let quantile = Level::new(confidence)?.quantile();
    let scale = systematic
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
/// relative standard error, RMS over the joints that the load turns.
pub fn is_better(found: &NextPosture, planned: &PlannedErrors) -> bool {
    let Some(next) = planned.after.first() else {
        return true;
    };
    // What no load turns is open either way.
    let pairs = next.iter().zip(&found.after);
    let all: Option<Vec<f64>> = pairs
        .filter(|(_, after)| after.is_some())
        .map(|(own, _)| *own)
        .collect();
    match all {
        Some(all) => found.expected_error < WORTH_NAMING * super::identify::rms(&all),
        // The planned one leaves a joint undetermined, and this one does not.
        None => found.expected_error.is_finite(),
    }
}
