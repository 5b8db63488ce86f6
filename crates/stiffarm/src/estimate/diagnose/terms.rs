//! Extra terms of the model, each tried alone and judged by how well the
//! other postures predict each posture (leave-one-out cross-validation: Stone, J. R.
//! Stat. Soc. B 36, 1974, 111–147, doi:10.1111/j.2517-6161.1974.tb00994.x).

use super::tails::{LEVEL, two_sided};
use crate::error::Result;
use crate::estimate::identify::{Estimates, Fit, JointEstimate};
use crate::findings::{Finding, codes, length, list, percent};
use crate::model::observation::ExtraTerm;
use crate::numerics::jobs::in_order;
use serde::{Deserialize, Serialize};

/// The RMS must fall by this share for a term to be recommended.
const WORTHWHILE: f64 = 0.1;
/// 1 − cosine of two columns below which two terms act alike.
const SAME_COLUMN: f64 = 1e-9;

/// One extra term, tried alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TermTrial {
    /// Name of the term.
    pub name: String,
    /// The term.
    pub term: ExtraTerm,
    /// Leave-one-posture-out RMS with it \[m\]; `None` where the data do not
    /// determine it without some posture.
    pub rms_m: Option<f64>,
    /// That over the RMS without extra terms.
    pub ratio: Option<f64>,
    /// Its estimate \[rad/(N·m); rad for lost motion\].
    pub value: Option<f64>,
    /// Its standard error.
    pub standard_error: Option<f64>,
    /// Probability of an estimate at least as large if the term were absent,
    /// times the number of terms tried.
    pub p_value: Option<f64>,
    /// Extra terms that act alike in these data, so that nothing tells them
    /// from this one; they are not tried again.
    pub same_as: Vec<String>,
    /// Joints that have a positive estimate without it and none with it.
    pub lost_joints: Vec<String>,
    /// Joints whose interval is closed without it and that have only a lower
    /// bound with it.
    pub open_joints: Vec<String>,
}

/// All terms that were tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TermTrials {
    /// Leave-one-posture-out RMS of the model as it is \[m\].
    pub rms_m: Option<f64>,
    /// True where that model has the joint axes only.
    pub axis_only: bool,
    /// Each extra term beside it, the lowest RMS first.
    pub trials: Vec<TermTrial>,
}

/// Tries the tilt of each joint and of the base and the lost motion of each
/// joint, one at a time, beside the terms that `options` has.
///
/// # Errors
/// As [`Fit::leave_one_out`].
pub fn try_terms(fit: &Fit) -> Result<TermTrials> {
    let options = fit.options();
    let robot = &fit.cell().setup.robot;
    let n = robot.joint_count();
    let rms_m = fit.leave_one_out()?.rms_m;
    let base = fit.identification()?;
    let tilts = (0..n).map(ExtraTerm::JointTilt);
    // Of postures reached from the side of their load no reading shows it, nor does one against a preload.
    let is_shown = fit.cell().route.approach.is_none() && !fit.measured().is_against_preload();
    let lost = (0..n).filter(|_| is_shown).map(ExtraTerm::LostMotion);
    let terms: Vec<ExtraTerm> = [ExtraTerm::BaseTilt].into_iter().chain(tilts).chain(lost).collect();
    let columns = fit.columns(&terms);
    let column = |i: usize| columns.column(i);
    let same = |i: usize, j: usize| {
        let product = column(i).norm() * column(j).norm();
        column(i).dot(&column(j)).abs() >= (1.0 - SAME_COLUMN) * product
    };
    let is_fitted = |i: usize| options.extra.contains(&terms[i]);
    let tried: Vec<usize> = (0..terms.len())
        .filter(|&i| {
            let earlier = (0..i).any(|j| same(i, j)) || (0..terms.len()).any(|j| is_fitted(j) && same(i, j));
            !(is_fitted(i) || earlier && column(i).norm() > 0.0)
        })
        .collect();
    let mut trials = in_order(&tried, |(_, &i)| {
        let term = terms[i];
        let later = (i + 1..terms.len()).filter(|&j| column(j).norm() > 0.0 && same(i, j));
        let same_as = later.map(|j| terms[j].name(robot)).collect();
        let name = term.name(robot);
        let with = fit.with_term(term, &column(i).into_owned())?;
        let result = with.estimates()?;
        let loo = with.leave_one_out()?;
        let determined = !result.undetermined_joints.contains(&name);
        let rms = loo.rms_m.filter(|_| determined);
        let (value, standard_error) = estimate_of(&result, &name);
        let t = value.zip(standard_error).filter(|(_, error)| *error > 0.0);
        let tail = |(value, error): (f64, f64)| {
            let both = two_sided(value / error, result.interval_degrees_of_freedom)?;
            Some(if value > 0.0 { 0.5 * both } else { 1.0 - 0.5 * both })
        };
        Ok(TermTrial {
            rms_m: rms,
            ratio: rms.zip(rms_m).filter(|(_, b)| *b > 0.0).map(|(a, b)| a / b),
            value,
            standard_error,
            p_value: t.and_then(tail),
            same_as,
            lost_joints: joints_that(&base.estimates.joints, &result.joints, |b, a| has_value(b) && !has_value(a)),
            open_joints: joints_that(&base.estimates.joints, &result.joints, |b, a| {
                let closed = |j: &JointEstimate| j.interval[1].is_some();
                closed(b) && !closed(a) && has_value(a)
            }),
            name,
            term,
        })
    })?;
    let count = trials.len() as f64;
    for trial in &mut trials {
        trial.p_value = trial.p_value.map(|p| (p * count).min(1.0));
    }
    trials.sort_by(|a, b| {
        let size = |t: &TermTrial| t.rms_m.unwrap_or(f64::INFINITY);
        size(a).total_cmp(&size(b))
    });
    Ok(TermTrials { rms_m, axis_only: options.extra.is_empty(), trials })
}

/// Value and standard error of the estimate of an extra term.
fn estimate_of(result: &Estimates, name: &str) -> (Option<f64>, Option<f64>) {
    if let Some(spring) = result.extra_springs.iter().find(|s| s.name == name) {
        return (spring.compliance, spring.compliance_standard_error);
    }
    let angle = result.lost_motion.iter().find(|a| a.name == name);
    angle.map_or((None, None), |a| (a.angle, a.standard_error))
}

fn has_value(joint: &JointEstimate) -> bool {
    joint.stiffness.is_some_and(|k| k > 0.0)
}

/// Names of the joints for which `is` holds before and after.
fn joints_that(
    before: &[JointEstimate],
    after: &[JointEstimate],
    is: impl Fn(&JointEstimate, &JointEstimate) -> bool,
) -> Vec<String> {
    let both = before.iter().zip(after);
    both.filter(|(b, a)| is(b, a)).map(|(_, a)| a.name.clone()).collect()
}

impl TermTrials {
    /// The best term where it lowers the leave-one-out RMS by more than 10 %
    /// and its estimate is positive beyond doubt (1 %).
    pub fn finding(&self) -> Option<Finding> {
        let base = self.rms_m?;
        let good =
            |t: &&TermTrial| t.p_value.is_some_and(|p| p < LEVEL) && t.ratio.is_some_and(|r| r < 1.0 - WORTHWHILE);
        let best = self.trials.iter().find(good)?;
        let words = |t: &TermTrial| {
            let rms = length(t.rms_m.unwrap_or(f64::NAN));
            (percent(1.0 - t.ratio.unwrap_or(1.0)), rms)
        };
        let alike = match best.same_as.as_slice() {
            [] => String::new(),
            others => format!(" (or the {}, which acts alike here)", list(others)),
        };
        let (fall, rms) = words(best);
        let mut message =
            format!("The {}{alike} lowers the leave-one-out RMS by {fall}, from {} to {rms}", best.name, length(base));
        if best.lost_joints.is_empty() {
            message += &bounds(best);
        } else {
            let verb = if best.lost_joints.len() == 1 { "has" } else { "have" };
            message += &format!(", but then {} {verb} no positive estimate", list(&best.lost_joints));
            let keeps = |t: &&TermTrial| good(t) && t.lost_joints.is_empty();
            if let Some(other) = self.trials.iter().find(keeps) {
                let (fall, rms) = words(other);
                message += &format!("; the {} lowers it by {fall}, to {rms}, and leaves every joint one", other.name);
                message += &bounds(other);
            }
        }
        let model = if self.axis_only { "the axis-only model" } else { "the model as it is" };
        message += &format!(". So {model} is rejected.");
        Some(Finding::caution(codes::FURTHER_TERM, &best.name, message))
    }
}

/// Joints that keep only a lower bound, in words.
fn bounds(trial: &TermTrial) -> String {
    match trial.open_joints.as_slice() {
        [] => String::new(),
        open => format!(" ({} with a lower bound only)", list(open)),
    }
}
