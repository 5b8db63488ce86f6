//! Simulated experiments, registration, and what groups of postures are worth.

use crate::cell::PyCell;
use crate::error::Raised;
use crate::identify::FitChoices;
use crate::inputs::{Given, GivenPostures, Inputs, Postures, choice};
use crate::long::watched;
use pyo3::prelude::*;
use serde::Serialize;
use stiffarm::Result;
use stiffarm::estimate::coverage::{CoverageCase, ErrorModel, coverage as count_coverage};
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::estimate::identify::IdentifyOptions;
use stiffarm::estimate::simulate::{simulate as simulate_axes, simulate_elastic};
use stiffarm::estimate::simulated::{ElasticOptions, ErrorRequest, Options, Request};
use stiffarm::estimate::validate::{Model, simulate_measurements as simulated};
use stiffarm::files::source::Source;
use stiffarm::files::table::{read_pairs, write_displacements, write_readings};
use stiffarm::measure::experiment::{Experiment, experiment};
use stiffarm::measure::registered::Options as RegisterOptions;
use stiffarm::measure::registration::RegistrationRecord;
use stiffarm::plan::index::{Evaluated, EvaluatedOptions};

/// Groups by name.
type Groups<'py> = Vec<(String, GivenPostures<'py>)>;

fn owned(py: Python<'_>, groups: Groups<'_>) -> PyResult<Vec<(String, Postures)>> {
    let own = |(name, group): (String, GivenPostures<'_>)| Ok((name, group.owned(py)?));
    groups.into_iter().map(own).collect()
}

/// `evaluate`.
#[pyfunction]
pub fn evaluate(py: Python<'_>, cell: &PyCell, groups: Groups<'_>) -> PyResult<(String, bool)> {
    let groups = owned(py, groups)?;
    watched(py, None, |_| {
        let inputs = Inputs::of(cell);
        let groups = inputs.groups(groups, &cell.cell.setup.robot)?;
        let cell = cell.complete();
        let found = Evaluated::new(cell, &groups)?.with_forecast(cell);
        inputs.document("evaluate", None, EvaluatedOptions::of(cell), found)
    })
}

/// Standard deviations of errors of the model.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Errors {
    force_scale_percent: f64,
    force_percent: f64,
    joint_angle_deg: f64,
    loading_point_mm: f64,
    anchor_mm: f64,
}

/// `simulate`.
#[pyfunction]
#[pyo3(signature = (cell, groups, runs, levels, elastic, seed, errors, progress))]
pub fn simulate(
    py: Python<'_>,
    cell: &PyCell,
    groups: Groups<'_>,
    runs: Option<usize>,
    levels: Option<Vec<f64>>,
    elastic: Option<String>,
    seed: u64,
    errors: Errors,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    let groups = owned(py, groups)?;
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let request = Request {
            levels: levels.unwrap_or_default(),
            runs,
            seed,
            errors: ErrorRequest {
                force_scale_percent: errors.force_scale_percent,
                force_percent: errors.force_percent,
                joint_angle_deg: errors.joint_angle_deg,
                loading_point_mm: errors.loading_point_mm,
                anchor_mm: errors.anchor_mm,
            },
        };
        let elastic = elastic.as_ref().map(|name| choice("elastic", name));
        let cell = &cell.cell;
        match elastic.transpose()? {
            None | Some(ElasticChoice::Axes) => {
                let options = request.simulation_options()?;
                let groups = inputs.groups(groups, &cell.setup.robot)?;
                let found =
                    watched.with(|control| simulate_axes(cell, &groups, &options, control))?;
                inputs.document("simulate", Some(seed), Options::from(&options), found)
            }
            Some(elastic) => {
                let options = request.elastic_options(elastic)?;
                let groups = inputs.groups(groups, &cell.setup.robot)?;
                let found =
                    watched.with(|control| simulate_elastic(cell, &groups, &options, control))?;
                inputs.document(
                    "simulate",
                    Some(seed),
                    ElasticOptions::from(&options),
                    found,
                )
            }
        }
    })
}

/// The text of one simulated table: displacements, or raw readings.
#[pyfunction]
pub fn simulate_measurements(
    py: Python<'_>,
    cell: &PyCell,
    postures: GivenPostures<'_>,
    seed: u64,
    readings: bool,
) -> PyResult<String> {
    let postures = postures.owned(py)?;
    let made = || -> Result<String> {
        let cell_of = &cell.cell;
        let postures = Inputs::of(cell).postures("postures_1", postures, &cell_of.setup.robot)?;
        let truth = cell_of.require_prior()?;
        if readings {
            let done = Experiment::as_measured(cell_of);
            let table = experiment(cell_of, &postures, truth, &done, seed, 0)?;
            return Ok(write_readings(&table, cell_of));
        }
        let measured = simulated(cell_of, &postures, truth, Model::Equilibrium, seed, 0)?;
        Ok(write_displacements(&measured, cell_of))
    };
    py.detach(made).raised(py)
}

/// What coverage was counted for.
#[derive(Serialize)]
struct CoverageOptions {
    runs: usize,
    confidence: f64,
    estimator: &'static str,
    bootstrap: Option<usize>,
}

/// Coverage of the intervals; no command prints this.
#[pyfunction]
#[pyo3(signature = (cell, postures, runs, seed, fit, bootstrap, progress))]
pub fn coverage(
    py: Python<'_>,
    cell: &PyCell,
    postures: GivenPostures<'_>,
    runs: usize,
    seed: u64,
    fit: FitChoices,
    bootstrap: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    let postures = postures.owned(py)?;
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let postures = inputs.postures("postures", postures, &cell.cell.setup.robot)?;
        let options: IdentifyOptions = fit.options(&cell.cell)?;
        let said = CoverageOptions {
            runs,
            confidence: options.confidence,
            estimator: options.estimator.as_str(),
            bootstrap,
        };
        let case = CoverageCase {
            experiments: runs,
            seed,
            resamples: bootstrap,
            options,
            world: ErrorModel::default(),
        };
        let found =
            watched.with(|control| count_coverage(&cell.cell, &postures, &case, control))?;
        inputs.document("coverage", Some(seed), said, found)
    })
}

/// `register`.
#[pyfunction]
#[pyo3(signature = (pairs, std_mm, exclude))]
pub fn register(
    py: Python<'_>,
    pairs: Given,
    std_mm: Option<f64>,
    exclude: Vec<String>,
) -> PyResult<String> {
    let made = || -> Result<String> {
        let inputs = Inputs::none();
        let (file, bytes) = inputs.read("pairs", &inputs.name(pairs))?;
        let options = RegisterOptions { std_mm, exclude };
        let pairs = options.kept(read_pairs(&bytes, &file)?)?;
        let found = options.register(&pairs).map_err(|e| e.file(&file))?;
        let record = RegistrationRecord::from(&found);
        inputs.document("register", None, options, record)
    };
    py.detach(made).raised(py)
}
