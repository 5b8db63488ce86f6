//! The command in this process: words and inputs in, what it prints out.

use crate::cell::PyCell;
use crate::error::Raised;
use crate::long::watched;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::ffi::OsString;
use stiffarm_cli::{Host, SummaryForm, described, run_captured};
use stiffarm_files::envelope::to_json;
use stiffarm_files::source::beside;

/// An input that is no file.
#[derive(FromPyObject)]
pub enum Input<'py> {
    /// A cell with its meshes.
    Cell(PyRef<'py, PyCell>),
    /// The bytes of a table or of a saved result.
    Bytes(Vec<u8>),
}

/// Runs a command line, the program's name first: its exit code, what it prints on standard output and on standard
/// error, and whether Ctrl-C stopped it. `inputs` are read before files of their names.
#[pyfunction]
#[pyo3(signature = (words, inputs, accept, progress))]
pub fn run(
    py: Python<'_>,
    words: Vec<OsString>,
    inputs: BTreeMap<String, Input<'_>>,
    accept: Option<Py<PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(u8, String, String, bool)> {
    let mut memory = BTreeMap::new();
    for (name, input) in inputs {
        match input {
            Input::Cell(cell) => {
                let meshes = cell.files.iter();
                memory.extend(meshes.map(|(file, bytes)| (beside(&name, file), bytes.clone())));
                memory.insert(name, cell.text.clone());
            }
            Input::Bytes(bytes) => {
                memory.insert(name, bytes);
            }
        }
    }
    let (captured, interrupted) = watched(py, progress, |watched| {
        let host = Host {
            inputs: memory,
            watch: Some(watched.shared()),
            accept: accept.map(|function| watched.accept(function)),
        };
        Ok(run_captured(&words, host))
    })?;
    // A file beside the result could not be written.
    let out = captured.failure.unwrap_or(captured.out);
    Ok((captured.code, out, captured.err, interrupted))
}

/// What the commands take, as JSON.
#[pyfunction]
pub fn commands(py: Python<'_>) -> PyResult<String> {
    to_json(&described()).raised(py)
}

/// What a result says: `how` is "verdict", "summary", "details" or "html".
#[pyfunction]
#[pyo3(signature = (json, cell, how))]
pub fn summary(py: Python<'_>, json: &str, cell: Option<&PyCell>, how: &str) -> PyResult<String> {
    let how = match how {
        "verdict" => SummaryForm::Verdict,
        "details" => SummaryForm::Details,
        "html" => SummaryForm::Html,
        _ => SummaryForm::Summary,
    };
    let cell = cell.map(|cell| &cell.cell);
    py.detach(|| stiffarm_cli::summary(json, cell, how)).raised(py)
}

/// The page of a result.
#[pyfunction]
#[pyo3(signature = (json, cell))]
pub fn page(py: Python<'_>, json: &str, cell: Option<&PyCell>) -> PyResult<String> {
    let cell = cell.map(|cell| &cell.cell);
    py.detach(|| stiffarm_cli::page(json, cell)).raised(py)
}

/// Figures of a result's page as JSON.
#[pyfunction]
#[pyo3(signature = (json, cell))]
pub fn figures(py: Python<'_>, json: &str, cell: Option<&PyCell>) -> PyResult<String> {
    let cell = cell.map(|cell| &cell.cell);
    py.detach(|| stiffarm_cli::figures(json, cell)).raised(py)
}
