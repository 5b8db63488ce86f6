//! All that `measure` says: what the readings so far are worth, and what to measure next.

#[cfg(feature = "clap")]
use crate::ask::values::seed;
use crate::error::{Code, Result};
use crate::estimate::diagnosed::doubts;
use crate::estimate::identify::{Fit, IdentifyOptions};
use crate::estimate::next_posture::{NextPosture, next_posture, planned_errors};
use crate::estimate::setup;
use crate::estimate::standing::{InterimEstimate, Standing, is_better, standing};
use crate::findings::{Finding, Severity, codes, each_once};
use crate::measure::prepare;
use crate::measure::reduction::ReduceOptions;
use crate::model::cell::Cell;
use crate::model::measurement::Measurements;
use crate::model::posture::Posture;
use crate::numerics::control::Control;
use crate::plan::route::rounded;
use crate::plan::select::GlobalOptions;
#[cfg(feature = "clap")]
use crate::units::mm_to_m;
use crate::work::predict::{PredictOptions, predict};
use crate::work::tasks::tasks;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Goals are shares of k; beyond this one says nothing.
#[cfg(feature = "clap")]
const WIDEST: f64 = 0.5;
/// Rounds of the search for a better posture.
const ROUNDS: u64 = 1;
/// Findings on what single joints carry and what residuals cannot tell yet: other postures may bring it.
const MAY_COME: [&str; 5] =
    [codes::WEAK_JOINT, codes::UNLOADED_JOINT, codes::CORRELATED, codes::POSTURE_NEEDED, codes::RESIDUALS_UNTESTED];
/// Steps of the angles of a posture that is proposed \[deg\].
const STEP_DEG: f64 = 0.01;

/// What is asked of a day of measuring.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Options"))]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct MeasureOptions {
    /// When it is enough, at 95 % with all errors together: `2%` means that every joint's stiffness is known to 2 %,
    /// `0.05mm` that the deflection at each of the cell's tasks is predicted to 0.05 mm
    #[cfg_attr(feature = "clap", arg(long, value_name = "2%|0.05mm", value_parser = goal))]
    pub until: Option<Goal>,
    /// Do not search for a posture that would help more than the next planned one
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_search: bool,
    /// Seed of the search for a better posture
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", default_value_t = 1, value_parser = seed()))]
    pub seed: u64,
}

impl Default for MeasureOptions {
    fn default() -> Self {
        MeasureOptions { until: None, no_search: false, seed: 1 }
    }
}

/// What is good enough.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Goal {
    /// Half width of every joint's stiffness (fraction of k).
    Stiffness(f64),
    /// Half width of the deflection at each task \[m\].
    #[serde(rename = "deflection_m")]
    Deflection(f64),
}

impl Goal {
    /// The share of k, where that is the goal.
    pub fn stiffness(self) -> Option<f64> {
        match self {
            Goal::Stiffness(part) => Some(part),
            Goal::Deflection(_) => None,
        }
    }

    /// The length, where that is the goal \[m\].
    pub fn deflection(self) -> Option<f64> {
        match self {
            Goal::Stiffness(_) => None,
            Goal::Deflection(length) => Some(length),
        }
    }
}

/// How the day stands.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Judgement {
    /// Postures of the plan.
    pub planned: usize,
    /// Postures of which a displacement can be formed, in the order of the readings.
    pub measured: Vec<String>,
    /// Postures that are begun.
    pub begun: Vec<String>,
    /// Planned postures that are left, in order; those begun are among them.
    pub left: Vec<String>,
    /// The first of those that are left; `null` where none is.
    pub next: Option<Planned>,
    /// What is suspicious about the readings, by themselves and by what they give, as `identify` says it.
    pub readings: Vec<Finding>,
    /// What they give; `null` while that cannot be said.
    pub standing: Option<Standing>,
    /// Why that cannot be said yet.
    pub standing_missing: Option<String>,
    /// How well the deflection at the cell's tasks is predicted; `null` unless that is the goal.
    pub deflection: Option<DeflectionStanding>,
    /// A posture that would help much more than the next planned one; `null` where there is none, or none
    /// was looked for.
    pub better: Option<NextPosture>,
}

impl Judgement {
    /// Every finding of the result, each once.
    pub fn every_finding(&self) -> Vec<Finding> {
        let standing = self.standing.iter().flat_map(|standing| &standing.findings);
        each_once(self.readings.iter().chain(standing))
    }
}

/// A planned posture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Planned {
    /// Its name.
    pub name: String,
    /// Its controller angles \[rad\].
    #[serde(rename = "posture_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub angles: Vec<f64>,
}

/// How well the deflection at the tasks is predicted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DeflectionStanding {
    /// Largest half width of all tasks \[m\]; `null` while it is not known.
    pub largest_m: Option<f64>,
    /// The task that has it.
    pub task: String,
    /// Whether that is the goal or less.
    pub reached: bool,
}

impl Judgement {
    /// Before anything can be said of the stiffness.
    fn not_yet(plan: &[Posture], left: &[Posture]) -> Self {
        let next = left.first().map(|posture| Planned { name: posture.name.clone(), angles: posture.q.clone() });
        Judgement {
            planned: plan.len(),
            left: left.iter().map(|posture| posture.name.clone()).collect(),
            next,
            ..Judgement::default()
        }
    }

    /// Whether the goal is reached; `None` without one, or while nothing can be said.
    pub fn reached(&self) -> Option<bool> {
        match &self.deflection {
            Some(deflection) => Some(deflection.reached),
            None => self.standing.as_ref()?.reached,
        }
    }

    /// Whether the plan is measured and the goal is not reached.
    pub fn is_missed(&self) -> bool {
        self.left.is_empty() && self.reached() == Some(false)
    }

    /// Whether something about the readings must be settled.
    pub fn is_serious(&self) -> bool {
        let mut findings = self.readings.iter();
        findings.any(|f| f.severity == Severity::Serious)
    }
}

/// What `measurements` are worth beside a plan; `measurements` are the error of a table in which no posture is complete
/// yet where there is none.
///
/// # Errors
/// Readings that cannot be read or hold something wrong, a goal at tasks that the cell does not have, stopped.
pub fn judge(
    (cell, plan): (&Cell, &[Posture]),
    measurements: Result<Measurements>,
    reduce: &ReduceOptions,
    options: &MeasureOptions,
    control: Control<'_>,
) -> Result<Judgement> {
    let begun = measurements.as_ref().map_or_else(|_| Vec::new(), begun);
    let measured = match measurements.and_then(|measurements| prepare(cell, measurements, reduce)) {
        Ok(measured) => measured,
        // Nothing but a heading yet, or the first posture is not complete.
        Err(error) if error.code() == Code::TooFewData => {
            return Ok(Judgement {
                begun,
                standing_missing: Some(error.message().to_string()),
                ..Judgement::not_yet(plan, plan)
            });
        }
        Err(error) => return Err(error),
    };
    let mut done: Vec<String> = Vec::new();
    for posture in &measured.postures {
        if !done.contains(&posture.posture.name) {
            done.push(posture.posture.name.clone());
        }
    }
    let measured_names: BTreeSet<String> = done.iter().cloned().collect();
    let left = plan.iter().filter(|posture| !measured_names.contains(&posture.name));
    let left: Vec<Posture> = left.cloned().collect();
    let readings = measured.findings().filter(|f| f.code != codes::NOT_MEASURED_YET);
    let mut out = Judgement {
        begun: begun.into_iter().filter(|name| !measured_names.contains(name)).collect(),
        measured: done,
        readings: readings.cloned().collect(),
        ..Judgement::not_yet(plan, &left)
    };
    let fit = Fit::new(cell, measured, &IdentifyOptions::default())?;
    let judged = InterimEstimate::new(&fit).and_then(|so_far| {
        let standing = standing(&so_far, &left, options.until.and_then(Goal::stiffness))?;
        Ok((standing, so_far))
    });
    let so_far = match judged {
        Ok((standing, so_far)) => {
            out.standing = Some(standing);
            so_far
        }
        Err(error) => {
            out.standing_missing = Some(error.message().to_string());
            return Ok(out);
        }
    };
    let of_fit = of_fit(&fit, &so_far, left.len())?;
    if of_fit.iter().any(|finding| finding.code == codes::SET_UP) {
        out.readings.retain(|finding| !setup::is_explained(finding));
    }
    out.readings.extend(of_fit);
    if let Some(goal) = options.until.and_then(Goal::deflection) {
        let mut deflection_standing = deflection(&fit, &so_far, goal)?;
        deflection_standing.reached &= so_far.missing_postures(left.len()) == 0;
        out.deflection = Some(deflection_standing);
        if let Some(standing) = &mut out.standing {
            standing.findings.extend(so_far.too_few(left.len()));
        }
    }
    if !options.no_search && !out.is_serious() && out.reached() != Some(true) {
        out.better = better(&fit, cell, &left, options.seed, control)?;
        if let Some(better) = out.better.as_mut().filter(|_| so_far.is_mixed()) {
            better.scale_to(&so_far.joints()?);
        }
    }
    Ok(out)
}

/// What `identify` would say against the readings so far. What the postures that are `left` may still bring is no
/// finding yet.
fn of_fit(fit: &Fit, so_far: &InterimEstimate<'_>, left: usize) -> Result<Vec<Finding>> {
    let mut estimates = fit.identification()?.estimates.clone();
    estimates.joints = so_far.joints()?;
    let joints = estimates.findings().into_iter();
    let is_due = |f: &Finding| f.severity > Severity::Note && (left == 0 || !MAY_COME.contains(&f.code.as_str()));
    // A joint that yields against its torque follows from a set-up that is rejected.
    let diagnosis = so_far.diagnosis.as_ref();
    let is_rejected = diagnosis.is_some_and(|diagnosis| diagnosis.rejected().is_some());
    let joints = joints.filter(|f| f.code == codes::NEGATIVE_COMPLIANCE && !is_rejected);
    let of_fit = doubts(fit, diagnosis)?;
    Ok(joints.chain(of_fit.into_iter().filter(is_due)).collect())
}

/// How well the deflection at the cell's tasks is predicted with what is known so far.
///
/// # Errors
/// The cell has no tasks, or tasks with different tips.
fn deflection(fit: &Fit, so_far: &InterimEstimate<'_>, goal: f64) -> Result<DeflectionStanding> {
    let mut cell = fit.cell().clone();
    let (tip, tasks) = tasks(&cell)?;
    cell.work.tip = Some(tip);
    // While a joint is open below, nothing is predicted.
    let options = PredictOptions::default();
    let compliance = so_far.compliance();
    let predicted = compliance.and_then(|compliance| predict(&cell, &compliance, &tasks, &options, Control::default()));
    let mut out = DeflectionStanding { largest_m: None, task: String::new(), reached: false };
    let Ok(predicted) = predicted else {
        return Ok(out);
    };
    for point in &predicted.points {
        let Some(band) = &point.band else { continue };
        if out.largest_m.is_none_or(|largest| band.size_m[3] > largest) {
            out.largest_m = Some(band.size_m[3]);
            out.task = point.point.to_string();
        }
    }
    out.reached = out.largest_m.is_some_and(|largest| largest <= goal);
    Ok(out)
}

/// A posture that helps much more than the next planned one, with angles that one can type.
fn better(fit: &Fit, cell: &Cell, left: &[Posture], seed: u64, control: Control<'_>) -> Result<Option<NextPosture>> {
    let options = GlobalOptions { seed, rounds: Some(ROUNDS), ..GlobalOptions::default() };
    let Ok(planned) = planned_errors(fit, left) else {
        return Ok(None);
    };
    // Stopped, or no posture helps: the plan stands.
    let Ok(mut posture) = next_posture(fit, &options, control) else {
        return Ok(None);
    };
    if !is_better(&posture, &planned) {
        return Ok(None);
    }
    posture.angles = rounded(cell, &[&posture.angles], STEP_DEG)?.swap_remove(0);
    Ok(Some(posture))
}

/// Postures with a reading.
fn begun(measurements: &Measurements) -> Vec<String> {
    match measurements {
        Measurements::Readings(table) => {
            let postures = table.postures.iter().chain(&table.incomplete);
            let names = postures.map(|posture| posture.posture.name.clone());
            names.filter(|name| table.has_readings_of(name)).collect()
        }
        Measurements::Displacements(postures) => postures.iter().map(|p| p.posture.name.clone()).collect(),
    }
}

/// `2%` or `0.05mm`.
#[cfg(feature = "clap")]
fn goal(text: &str) -> std::result::Result<Goal, String> {
    let wrong = || "give a percentage of the stiffness up to 50, such as 2%, or a length, such as 0.05mm".to_string();
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|v| *v > 0.0 && v.is_finite());
    let text = text.trim();
    if let Some(mm) = text.strip_suffix("mm") {
        let mm = number(mm).filter(|mm| (1e-6..=1e3).contains(mm)).ok_or_else(wrong)?;
        return Ok(Goal::Deflection(mm_to_m(mm)));
    }
    let percent = text.strip_suffix('%').and_then(number).ok_or_else(wrong)?;
    if percent <= 100.0 * WIDEST { Ok(Goal::Stiffness(percent / 100.0)) } else { Err(wrong()) }
}
