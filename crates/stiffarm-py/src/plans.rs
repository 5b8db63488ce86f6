//! What no command answers: bounds of a plan of one's own, a simulated measurement as a table, and a cell as a drawing.

use crate::arrays::postures;
use crate::cell::PyCell;
use crate::error::Raised;
use crate::long::watched;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use stiffarm::estimate::validate::{Model, simulate_measurements as simulated};
use stiffarm::measure::experiment::{Experiment, experiment};
use stiffarm::model::posture::Posture;
use stiffarm::plan::certificate::{CertificateOptions, certify_further};
use stiffarm::plan::index::Index;
use stiffarm::{Code, Error};
use stiffarm_files::envelope::to_json;
use stiffarm_files::table::{write_simulated, write_simulated_readings};

/// Postures of their names and angles \[rad\].
pub fn named(py: Python<'_>, names: Vec<String>, angles: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Posture>> {
    let rows = postures(angles)?;
    if names.len() != rows.len() {
        let message = "There are not as many names as postures.";
        return Err(Error::new(Code::Dimension, message)).raised(py);
    }
    let named = names.into_iter().zip(rows);
    Ok(named.map(|(name, q)| Posture { name, q: q.to_vec() }).collect())
}

/// How good a plan is beside the best possible one, as JSON.
#[pyfunction]
#[pyo3(signature = (cell, index, angles, given, samples, progress))]
pub fn certificate(
    py: Python<'_>,
    cell: &PyCell,
    index: &str,
    angles: PyReadonlyArray2<'_, f64>,
    given: PyReadonlyArray2<'_, f64>,
    samples: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    let numbered = |angles: &PyReadonlyArray2<'_, f64>| {
        let count = angles.as_array().nrows();
        named(py, (1..=count).map(|i| i.to_string()).collect(), angles)
    };
    let (postures, held) = (numbered(&angles)?, numbered(&given)?);
    watched(py, progress, |watched| {
        let mut options = CertificateOptions::default();
        options.samples = samples.unwrap_or(options.samples);
        let index = Index::from_name(index)?;
        let certificate =
            watched.with(|control| certify_further(cell.complete(), index, &held, &postures, &options, control))?;
        to_json(&certificate)
    })
}

/// The text of one simulated table: displacements, or raw readings.
#[pyfunction]
pub fn simulate_measurements(
    py: Python<'_>,
    cell: &PyCell,
    names: Vec<String>,
    angles: PyReadonlyArray2<'_, f64>,
    seed: u64,
    readings: bool,
) -> PyResult<String> {
    let postures = named(py, names, &angles)?;
    let cell = &cell.cell;
    py.detach(|| {
        let truth = cell.require_prior()?;
        if readings {
            let done = Experiment::as_measured(cell);
            let table = experiment(cell, &postures, truth, &done, seed, 0)?;
            return Ok(write_simulated_readings(table, cell));
        }
        let measured = simulated(cell, &postures, truth, Model::Equilibrium, seed, 0)?;
        Ok(write_simulated(measured, cell))
    })
    .raised(py)
}

/// The drawing of a cell at these postures as JSON, one of them in full; without postures at one within its limits.
#[pyfunction]
pub fn drawing(
    py: Python<'_>,
    cell: &PyCell,
    names: Vec<String>,
    angles: PyReadonlyArray2<'_, f64>,
    full: usize,
) -> PyResult<String> {
    let postures = named(py, names, &angles)?;
    py.detach(|| stiffarm_cli::drawing(&cell.cell, &postures, full)).raised(py)
}
