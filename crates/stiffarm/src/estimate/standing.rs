//! How an experiment stands while it is measured: what the readings so far give, what the postures that are
//! left are expected to bring, and whether that is enough.
//!
//! What is known is what `identify` prints by default, springs beyond the axes included. What is expected narrows it as
//! the fit of the axes alone narrows ([`forecast`](super::forecast)); it is no bound: the scale of the force stays what
//! it is, and no number of postures brings a joint below that.

use super::compliance::IdentifiedCompliance;
use super::diagnose::Diagnosis;
use super::diagnosed::diagnosed;
use super::elastic::{ElasticChoice, FEWEST_POSTURES, carried};
use super::forecast::forecast_with;
use super::identify::{Fit, JointEstimate};
use super::mixed::MixedFit;
use super::next_posture::{NextPosture, PlannedErrors};
use super::systematic::{SystematicErrors, systematic_errors_with};
use crate::error::{Code, Result};
use crate::findings::{Finding, percent};
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
    /// Standard deviation of what the fit leaves of a displacement component \[m\]; `null` without a degree of freedom.
    pub residual_std_m: Option<f64>,
    /// What the cell's noise gives \[m\].
    pub expected_std_m: f64,
    /// What to know about the goal and of joints that no goal is asked of, in sentences.
    pub findings: Vec<Finding>,
}

/// What the readings behind a fit tell, as `identify` prints it by default.
pub struct InterimEstimate<'f> {
    fit: &'f Fit,
    /// Systematic errors if the axes alone gave way.
    axes: SystematicErrors,
    /// The mixed model with its systematic errors, where it predicts.
    mixed: Option<(MixedFit, SystematicErrors)>,
    /// What the residuals say; `None` for too few.
    pub(crate) diagnosis: Option<Diagnosis>,
    /// Half width of each joint if the axes alone gave way, where the mixed model predicts and something is foreseen.
    now: Option<Vec<Option<f64>>>,
}

impl<'f> InterimEstimate<'f> {
    /// Of a fit.
    ///
    /// # Errors
    /// As [`systematic_errors`](super::systematic::systematic_errors) and [`MixedFit::new`].
    pub fn new(fit: &'f Fit) -> Result<Self> {
        let is_mixed = ElasticChoice::or_default(None, fit.options()) == ElasticChoice::Mixed;
        let mixed = if is_mixed { carried(fit)?.ok() } else { None };
        // What every ± holds may be in doubt.
        let diagnosis = match diagnosed(fit, mixed.as_ref()) {
            Ok(diagnosis) => Some(diagnosis),
            Err(error) if error.code() == Code::Interrupted => return Err(error),
            // Too few readings to look at residuals.
            Err(_) => None,
        };
        let off = diagnosis.as_ref().and_then(Diagnosis::off);
        let axes = systematic_errors_with(fit, None, off)?;
        let with_errors = |mixed: MixedFit| {
            let errors = systematic_errors_with(fit, Some(&mixed), off)?;
            Ok((mixed, errors))
        };
        let mut out = InterimEstimate { fit, axes, mixed: mixed.map(with_errors).transpose()?, diagnosis, now: None };
        if out.is_mixed() {
            out.now = out.of_axes::<Vec<f64>>(&[])?;
        }
        Ok(out)
    }

    /// Whether the mixed model predicts.
    pub fn is_mixed(&self) -> bool {
        self.mixed.is_some()
    }

    /// Errors common to the whole experiment, as they move the stiffness that predicts.
    pub fn systematic(&self) -> &SystematicErrors {
        self.mixed.as_ref().map_or(&self.axes, |(_, errors)| errors)
    }

    /// What predicts deflections.
    ///
    /// # Errors
    /// A joint that is not determined.
    pub fn compliance(&self) -> Result<IdentifiedCompliance> {
        let compliance = match &self.mixed {
            Some((mixed, _)) => mixed.compliance().clone(),
            None => IdentifiedCompliance::from_identification(self.fit.cell(), self.fit.identification()?)?,
        };
        Ok(compliance.with_systematic_errors(self.systematic()))
    }

    /// The joints with the scatter of the readings.
    ///
    /// # Errors
    /// As [`MixedFit::joints`] and [`Fit::identification`].
    pub fn joints(&self) -> Result<Vec<JointEstimate>> {
        match &self.mixed {
            Some((mixed, _)) => mixed.joints(),
            None => Ok(self.fit.identification()?.estimates.joints.clone()),
        }
    }

    /// Half width of each joint with `planned` postures more; `None` where nothing is foreseen.
    ///
    /// # Errors
    /// Stopped.
    fn expected<Q: AsRef<[f64]>>(&self, planned: &[Q]) -> Result<Option<Vec<Option<f64>>>> {
        let then = self.of_axes(planned)?;
        let (Some((_, mixed)), Some(then), Some(now)) = (&self.mixed, &then, &self.now) else {
            return Ok(then);
        };
        let narrowed = then.iter().zip(now).zip(&mixed.uncertainty);
        let narrowed = narrowed.map(|((then, now), mixed)| Some(mixed.total? * ((*then)? / (*now)?).min(1.0)));
        Ok(Some(narrowed.collect()))
    }

    /// The same if the axes alone gave way.
    fn of_axes<Q: AsRef<[f64]>>(&self, planned: &[Q]) -> Result<Option<Vec<Option<f64>>>> {
        match forecast_with(self.fit, &self.axes, planned) {
            Ok(joints) => Ok(Some(joints.iter().map(|joint| joint.total).collect())),
            Err(error) if error.code() == Code::Interrupted => Err(error),
            // Without a stiffness or a load to assume nothing is foreseen.
            Err(_) => Ok(None),
        }
    }

    /// Of `left` postures those that are missing until the mixed model, which `identify` takes by default, can be
    /// fitted.
    pub fn missing_postures(&self, left: usize) -> usize {
        match ElasticChoice::or_default(None, self.fit.options()) {
            ElasticChoice::Mixed => {
                let postures = self.fit.system().blocks.len();
                FEWEST_POSTURES.saturating_sub(postures).min(left)
            }
            ElasticChoice::Axes => 0,
        }
    }

    /// Says that a goal counts as not reached while postures are missing.
    pub(crate) fn too_few(&self, left: usize) -> Option<Finding> {
        let sentence = format!(
            "Fewer than {FEWEST_POSTURES} postures do not show what gives way beyond the joint axes: until then ± \
             holds only if nothing does, and the goal counts as not reached."
        );
        (self.missing_postures(left) > 0).then(|| Finding::note("too-few-postures", "goal", sentence))
    }
}

/// How the experiment `so_far` stands; `planned` are the postures that are left (controller angles, rad), in order, and
/// `goal` is the largest half width that is good enough (fraction of k).
///
/// # Errors
/// A decomposition that fails; stopped.
pub fn standing<Q: AsRef<[f64]>>(so_far: &InterimEstimate<'_>, planned: &[Q], goal: Option<f64>) -> Result<Standing> {
    let (fit, systematic) = (so_far.fit, so_far.systematic());
    let identification = fit.identification()?;
    let expected = |count: usize| so_far.expected(&planned[..count]);
    let (with_next, with_all) = match planned.len() {
        0 => (None, None),
        1 => {
            let one = expected(1)?;
            (one.clone(), one)
        }
        count => (expected(1)?, expected(count)?),
    };
    let of = |all: &Option<Vec<Option<f64>>>, j: usize| all.as_ref()?.get(j).copied().flatten();
    let joints: Vec<JointStanding> = so_far
        .joints()?
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            let uncertainty = systematic.uncertainty.get(j);
            let usable = joint.interval[1].is_some();
            let foreseen = |all| of(all, j).filter(|_| usable || !so_far.is_mixed());
            JointStanding {
                name: joint.name.clone(),
                stiffness_nm_per_rad: joint.stiffness,
                total: uncertainty.and_then(|uncertainty| uncertainty.total).filter(|_| usable),
                systematic: uncertainty.and_then(|uncertainty| uncertainty.systematic),
                with_next: foreseen(&with_next),
                with_all: foreseen(&with_all),
            }
        })
        .collect();
    // The load of the cell says nothing of these, and no measured force did either.
    let (_, mut findings) = determinable(fit.cell().clone());
    findings.retain(|f| identification.estimates.undetermined_joints.contains(&f.subject));
    let left_out = |j: &usize| findings.iter().any(|f| f.subject == joints[*j].name);
    let turned: Vec<usize> = (0..joints.len()).filter(|j| !left_out(j)).collect();
    let worst = |part: &dyn Fn(usize) -> Option<f64>| {
        let all: Option<Vec<f64>> = turned.iter().map(|j| part(*j)).collect();
        all?.into_iter().reduce(f64::max)
    };
    let largest = worst(&|j| joints[j].total);
    // Too few postures show nothing beyond the axes: the next ones could widen what seems known.
    let missing = so_far.missing_postures(planned.len());
    let reached = goal.map(|goal| missing == 0 && largest.is_some_and(|largest| largest <= goal));
    let enough = |all: &Option<Vec<Option<f64>>>| {
        goal.zip(worst(&|j| of(all, j))).is_some_and(|(goal, largest)| largest <= goal)
    };
    let mut postures_to_goal = None;
    if reached == Some(false) && enough(&with_all) {
        // No posture takes anything away, so that halving finds the first count.
        let (mut too_few, mut count) = (0, planned.len());
        while count - too_few > 1 {
            let middle = too_few.midpoint(count);
            if enough(&expected(middle)?) { count = middle } else { too_few = middle }
        }
        postures_to_goal = Some(count.max(missing));
    }
    if let (Some(goal), Some(false)) = (goal, reached) {
        findings.extend(out_of_reach(systematic, identification.estimates.confidence, goal)?);
    }
    findings.extend(goal.and_then(|_| so_far.too_few(planned.len())));
    Ok(Standing {
        joints,
        confidence: identification.estimates.confidence,
        largest,
        reached,
        postures_to_goal,
        residual_std_m: match &so_far.mixed {
            Some((mixed, _)) => Some(mixed.result().total_std_m),
            None => identification.total_std_m,
        },
        expected_std_m: identification.expected_std_m,
        findings,
    })
}

/// Says where the scale of the force alone is beyond the goal: no residual ever shows it.
fn out_of_reach(systematic: &SystematicErrors, confidence: f64, goal: f64) -> Result<Option<Finding>> {
    let quantile = Level::new(confidence)?.quantile();
    let scale = systematic.sources.iter().find(|source| source.name == FORCE_SCALE);
    let Some(scale) = scale.filter(|source| quantile * source.size > goal) else {
        return Ok(None);
    };
    let sentence = format!(
        "The force is known to {} (one standard uncertainty{}), which alone leaves ± {} of every stiffness: no number \
         of postures reaches ± {}. Declare uncertainty.force_scale_percent where it is known better, or ask for less.",
        percent(scale.size),
        if scale.declared { "" } else { ", assumed" },
        percent(quantile * scale.size),
        percent(goal)
    );
    let finding = Finding::caution("goal-out-of-reach", "goal", sentence);
    Ok(Some(finding))
}

/// Whether a posture that was searched for is worth measuring instead of the next planned one: by the
/// relative standard error, RMS over the joints that the load turns.
pub fn is_better(candidate: &NextPosture, planned: &PlannedErrors) -> bool {
    let Some(next) = planned.after.first() else {
        return true;
    };
    // What no load turns is open either way.
    let pairs = next.iter().zip(&candidate.after);
    let all: Option<Vec<f64>> =
        pairs.filter(|(_, after)| after.is_some()).map(|(planned_error, _)| *planned_error).collect();
    match all {
        Some(all) => candidate.expected_error < WORTH_NAMING * super::identify::rms(&all),
        // The planned one leaves a joint undetermined, and this one does not.
        None => candidate.expected_error.is_finite(),
    }
}
