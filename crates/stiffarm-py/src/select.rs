//! Plans: every way to choose postures.

use crate::cell::PyCell;
use crate::inputs::{Given, GivenPostures, Inputs};
use crate::long::watched;
use pyo3::prelude::*;
use std::time::Duration;
use stiffarm::files::source::Source;
use stiffarm::plan::certificate::{CertificateOptions, certify_further};
use stiffarm::plan::index::Index;
use stiffarm::plan::planned::{
    CandidateRequest, CurveRequest, DropRequest, PlanRequest, SpaceFillingRequest, Stage, plan,
    plan_candidates, plan_curve, plan_drop, plan_space_filling,
};
use stiffarm::units::mm_to_m;
use stiffarm::{Code, Error, Result};

/// How long to search, and with which random numbers.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Budget {
    rounds: Option<u64>,
    time_limit_s: Option<f64>,
    seed: Option<u64>,
}

impl Budget {
    fn time_limit(&self) -> Result<Option<Duration>> {
        let seconds = |s: f64| {
            let limit = Duration::try_from_secs_f64(s).ok().filter(|t| !t.is_zero());
            limit.ok_or_else(|| {
                let message = format!("The time limit must be above 0 s, got {s} s.");
                Error::new(Code::InvalidValue, message).key("time_limit_s")
            })
        };
        self.time_limit_s.map(seconds).transpose()
    }
}

/// What of the load may be chosen: boxes by their lowest and highest corner.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Load {
    anchor_box_mm: Option<[[f64; 3]; 2]>,
    loading_point_box_mm: Option<[[f64; 3]; 2]>,
    largest_load_n: Option<f64>,
}

/// Steps of angles, none at 0.
fn step(degrees: f64) -> Option<f64> {
    (degrees != 0.0).then_some(degrees)
}

/// `select`: by global search, from an initial group, or beside given postures.
#[pyfunction]
#[pyo3(signature = (cell, index, count, initial, given, max_iterations, budget, angle_step_deg, load, certificate,
                    sensitivity, prices, accept, progress))]
pub fn select(
    py: Python<'_>,
    cell: &PyCell,
    index: &str,
    count: usize,
    initial: Option<GivenPostures<'_>>,
    given: Option<GivenPostures<'_>>,
    max_iterations: u64,
    budget: Budget,
    angle_step_deg: f64,
    load: Load,
    certificate: bool,
    sensitivity: bool,
    prices: bool,
    accept: Option<Py<PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    let initial = initial.map(|given| given.owned(py)).transpose()?;
    let given = given.map(|given| given.owned(py)).transpose()?;
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let robot = &cell.cell.setup.robot;
        let initial = initial.map(|given| inputs.postures("initial", given, robot));
        let given = given.map(|given| inputs.postures("given", given, robot));
        let mut request = PlanRequest::default();
        request.index = Index::from_name(index)?;
        request.postures = count;
        request.initial = initial.transpose()?;
        request.given = given.transpose()?.unwrap_or_default();
        request.max_iterations = max_iterations;
        request.rounds = budget.rounds;
        request.time_limit = budget.time_limit()?;
        request.seed = budget.seed.unwrap_or(request.seed);
        request.angle_step_deg = step(angle_step_deg);
        let corners = |corners: [[f64; 3]; 2]| corners.map(|c| c.map(mm_to_m).into());
        request.load.anchor = load.anchor_box_mm.map(corners);
        request.load.loading_point = load.loading_point_box_mm.map(corners);
        request.load.magnitude = load.largest_load_n;
        request.accept = accept.map(|function| watched.accept(function));
        request.certificate = certificate;
        request.sensitivity = sensitivity;
        request.prices = prices;
        let rounds = budget.rounds;
        let mut tell = |stage| told(watched, stage, rounds);
        let found = watched.with(|control| plan(cell.complete(), &request, &mut tell, control))?;
        let found = found.with_forecast();
        inputs.document("select", found.seed, found.options, found.result)
    })
}

/// Words about a stage of the work.
fn told(watched: &crate::long::Watched, stage: Stage, rounds: Option<u64>) {
    match (stage, rounds) {
        (Stage::Round(round), Some(of)) => {
            let count = |n: u64| usize::try_from(n).unwrap_or(usize::MAX);
            watched.tell("selecting", count(round.rounds), count(of));
        }
        (stage, _) => watched.tell(&stage.to_string(), 0, 0),
    }
}

/// `select --candidates`.
#[pyfunction]
#[pyo3(signature = (cell, index, count, candidates, seed, certificate, progress))]
pub fn select_candidates(
    py: Python<'_>,
    cell: &PyCell,
    index: &str,
    count: usize,
    candidates: Given,
    seed: Option<u64>,
    certificate: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let from = inputs.name(candidates);
        let (candidates, measured) = inputs.read_candidates(&from, cell.complete())?;
        let mut request = CandidateRequest::default();
        request.index = Index::from_name(index)?;
        request.postures = count;
        request.seed = seed.unwrap_or(request.seed);
        // The limits of a measured posture are the machine's, which held it.
        request.limits = !measured;
        request.certificate = certificate;
        let found = watched
            .with(|control| plan_candidates(cell.complete(), &candidates, &request, control))?
            .with_forecast();
        inputs.document("select", found.seed, found.options, found.result)
    })
}

/// `select --space-filling`.
#[pyfunction]
#[pyo3(signature = (cell, count, seed, angle_step_deg, progress))]
pub fn select_space_filling(
    py: Python<'_>,
    cell: &PyCell,
    count: usize,
    seed: Option<u64>,
    angle_step_deg: f64,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let mut request = SpaceFillingRequest::default();
        request.postures = count;
        request.seed = seed.unwrap_or(request.seed);
        request.angle_step_deg = step(angle_step_deg);
        let found =
            watched.with(|control| plan_space_filling(cell.complete(), &request, control))?;
        inputs.document("select", found.seed, found.options, found.result)
    })
}

/// `select --given … --drop`.
#[pyfunction]
#[pyo3(signature = (cell, index, given, drop, progress))]
pub fn select_drop(
    py: Python<'_>,
    cell: &PyCell,
    index: &str,
    given: GivenPostures<'_>,
    drop: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    let given = given.owned(py)?;
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let given = inputs.postures("given", given, &cell.cell.setup.robot)?;
        let mut request = DropRequest::default();
        request.index = Index::from_name(index)?;
        request.drop = drop;
        let found =
            watched.with(|control| plan_drop(cell.complete(), &given, &request, control))?;
        inputs.document("select", found.seed, found.options, found.result)
    })
}

/// `select --curve`.
#[pyfunction]
#[pyo3(signature = (cell, index, largest, budget, certificate, progress))]
pub fn select_curve(
    py: Python<'_>,
    cell: &PyCell,
    index: &str,
    largest: usize,
    budget: Budget,
    certificate: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let mut request = CurveRequest::default();
        request.index = Index::from_name(index)?;
        request.postures = largest;
        request.rounds = budget.rounds;
        request.time_limit = budget.time_limit()?;
        request.seed = budget.seed.unwrap_or(request.seed);
        request.certificate = certificate;
        let mut tell = |stage| told(watched, stage, None);
        let found =
            watched.with(|control| plan_curve(cell.complete(), &request, &mut tell, control))?;
        inputs.document("select", found.seed, found.options, found.result)
    })
}

/// How good a plan is beside the best possible one; no command prints this alone.
#[pyfunction]
#[pyo3(signature = (cell, index, postures, given, samples, progress))]
pub fn certificate(
    py: Python<'_>,
    cell: &PyCell,
    index: &str,
    postures: GivenPostures<'_>,
    given: Option<GivenPostures<'_>>,
    samples: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    let postures = postures.owned(py)?;
    let given = given.map(|given| given.owned(py)).transpose()?;
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let robot = &cell.cell.setup.robot;
        let postures = inputs.postures("postures", postures, robot)?;
        let given = given.map(|given| inputs.postures("given", given, robot));
        let given = given.transpose()?.unwrap_or_default();
        let mut options = CertificateOptions::default();
        options.samples = samples.unwrap_or(options.samples);
        let index = Index::from_name(index)?;
        let found = watched.with(|control| {
            certify_further(cell.complete(), index, &given, &postures, &options, control)
        })?;
        inputs.document("certificate", None, options, found)
    })
}
