//! What the readings so far are worth: everything that one look at the files gives.

use crate::args::{Goal, MeasureArgs};
use crate::session::Session;
use serde::Serialize;
use std::collections::BTreeSet;
use stiffarm::Result;
use stiffarm::estimate::compliance::IdentifiedCompliance;
use stiffarm::estimate::identify::{Fit, IdentifyOptions};
use stiffarm::estimate::next_posture::{NextPosture, next_posture, planned_errors};
use stiffarm::estimate::standing::{Standing, is_better, standing};
use stiffarm::estimate::systematic::{SystematicErrors, systematic_errors};
use stiffarm::files::source::Source;
use stiffarm::findings::{Finding, Severity};
use stiffarm::measure::prepare;
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::Measurements;
use stiffarm::model::posture::Posture;
use stiffarm::plan::route::rounded;
use stiffarm::plan::select::GlobalOptions;
use stiffarm::work::predict::{PredictOptions, predict};
use stiffarm::work::predicted::tasks;
use stiffarm::{Control, Error};

/// Rounds of the search for a better posture.
const ROUNDS: u64 = 1;
/// Steps of the angles of a posture that is proposed \[deg\].
const STEP_DEG: f64 = 0.01;

/// How the day stands.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Judgement {
    /// Postures of which a displacement can be formed, in the order of the readings.
    pub measured: Vec<String>,
    /// Postures that are begun.
    pub begun: Vec<String>,
    /// Planned postures that are left, in order; those begun are among them.
    pub left: Vec<String>,
    /// What is suspicious about the readings.
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

/// How well the deflection at the tasks is predicted.
#[derive(Debug, Clone, Serialize)]
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
    /// Before the first posture is complete.
    fn not_yet(error: &Error, begun: Vec<String>, plan: &[Posture]) -> Self {
        Judgement {
            measured: Vec::new(),
            begun,
            left: names(plan),
            readings: Vec::new(),
            standing: None,
            standing_missing: Some(error.message().to_string()),
            deflection: None,
            better: None,
        }
    }

    /// Whether the goal is reached; `None` without one, or while nothing can be said.
    pub fn reached(&self) -> Option<bool> {
        match &self.deflection {
            Some(deflection) => Some(deflection.reached),
            None => self.standing.as_ref()?.reached,
        }
    }
}

/// Looks at the files once.
///
/// # Errors
/// Files that cannot be read or hold something wrong.
pub fn judge(
    session: &Session,
    cell: &Cell,
    plan: &[Posture],
    args: &MeasureArgs,
    control: Control<'_>,
) -> Result<Judgement> {
    let read = session.read_growing_measurements(&args.readings, Some(&args.plan), cell);
    let measurements = match read {
        Ok(measurements) => measurements,
        // Nothing but a heading yet.
        Err(error) if error.code() == stiffarm::Code::TooFewData => {
            return Ok(Judgement::not_yet(&error, Vec::new(), plan));
        }
        Err(error) => return Err(error),
    };
    let reduce = session.read_registration(args.registration.as_deref())?;
    let begun = begun(&measurements);
    let measured = match prepare(cell, measurements, &reduce) {
        Ok(measured) => measured,
        // The first posture is not complete yet.
        Err(error) if error.code() == stiffarm::Code::TooFewData => {
            return Ok(Judgement::not_yet(&error, begun, plan));
        }
        Err(error) => return Err(error),
    };
    let mut done: Vec<String> = Vec::new();
    for posture in &measured.postures {
        if !done.contains(&posture.posture.name) {
            done.push(posture.posture.name.clone());
        }
    }
    let known: BTreeSet<String> = done.iter().cloned().collect();
    let left: Vec<Posture> = plan
        .iter()
        .filter(|posture| !known.contains(&posture.name))
        .cloned()
        .collect();
    let readings: Vec<Finding> = measured
        .findings()
        .filter(|f| f.code != stiffarm::measure::NOT_MEASURED_YET)
        .cloned()
        .collect();
    let mut out = Judgement {
        begun: begun
            .into_iter()
            .filter(|name| !known.contains(name))
            .collect(),
        measured: done,
        left: names(&left),
        readings,
        standing: None,
        standing_missing: None,
        deflection: None,
        better: None,
    };
    let fit = Fit::new(cell, measured, &IdentifyOptions::default())?;
    let goal = args.until.and_then(Goal::stiffness);
    let found = systematic_errors(&fit)
        .and_then(|budget| Ok((standing(&fit, &budget, &left, goal)?, budget)));
    let budget = match found {
        Ok((found, budget)) => {
            out.standing = Some(found);
            budget
        }
        Err(error) => {
            out.standing_missing = Some(error.message().to_string());
            return Ok(out);
        }
    };
    if let Some(goal) = args.until.and_then(Goal::deflection) {
        out.deflection = Some(deflection(&fit, &budget, goal)?);
    }
    let sound = out.readings.iter().all(|f| f.severity != Severity::Serious);
    if !args.no_search && sound && out.reached() != Some(true) {
        out.better = better(&fit, cell, &left, args.seed, control)?;
    }
    Ok(out)
}

/// How well the deflection at the cell's tasks is predicted with what is known so far.
///
/// # Errors
/// The cell has no tasks, or tasks with different tips.
fn deflection(fit: &Fit, budget: &SystematicErrors, goal: f64) -> Result<DeflectionStanding> {
    let mut cell = fit.cell().clone();
    let (tip, tasks) = tasks(&cell)?;
    cell.work.tip = Some(tip);
    // While a joint is not determined nothing is predicted.
    let known = IdentifiedCompliance::from_identification(&cell, fit.identification()?);
    let options = PredictOptions::default();
    let predicted = known.map(|known| known.with_systematic_errors(budget));
    let predicted =
        predicted.and_then(|known| predict(&cell, &known, &tasks, &options, Control::default()));
    let mut out = DeflectionStanding {
        largest_m: None,
        task: String::new(),
        reached: false,
    };
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
fn better(
    fit: &Fit,
    cell: &Cell,
    left: &[Posture],
    seed: u64,
    control: Control<'_>,
) -> Result<Option<NextPosture>> {
    let mut options = GlobalOptions::default();
    options.seed = seed;
    options.rounds = Some(ROUNDS);
    let Ok(planned) = planned_errors(fit, left) else {
        return Ok(None);
    };
    // Stopped, or no posture helps: the plan stands.
    let Ok(mut found) = next_posture(fit, &options, control) else {
        return Ok(None);
    };
    if !is_better(&found, &planned) {
        return Ok(None);
    }
    found.angles = rounded(cell, &[&found.angles], STEP_DEG)?.swap_remove(0);
    Ok(Some(found))
}

/// Postures with a reading.
fn begun(measurements: &Measurements) -> Vec<String> {
    match measurements {
        Measurements::Readings(table) => {
            let postures = table.postures.iter().chain(&table.incomplete);
            let names = postures.map(|posture| posture.posture.name.clone());
            names.filter(|name| table.has_readings_of(name)).collect()
        }
        Measurements::Displacements(postures) => {
            postures.iter().map(|p| p.posture.name.clone()).collect()
        }
    }
}

fn names(postures: &[Posture]) -> Vec<String> {
    postures
        .iter()
        .map(|posture| posture.name.clone())
        .collect()
}
