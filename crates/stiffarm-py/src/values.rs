//! Small conversions: degrees, posture tables, cell files as dictionaries.

use crate::arrays::check_radians;
use crate::cell::{PyCell, rows};
use crate::error::Raised;
use crate::paths::Files;
use crate::plans::named;
use numpy::{
    PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArray2, PyReadonlyArrayDyn, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use stiffarm::units::{deg_to_rad, rad_to_shortest_deg};
use stiffarm::{Code, Error};
use stiffarm_files::source::Source;
use stiffarm_files::table::{read_postures as read_table, write_postures};

/// The door of all angles that come as arrays: radians of degrees, as files are read, or the array itself, unless its
/// angles are so large that they must be degrees.
#[pyfunction]
pub fn radians<'py>(
    py: Python<'py>,
    angles: PyReadonlyArrayDyn<'py, f64>,
    degrees: bool,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let values = angles.as_slice()?;
    if !degrees {
        check_radians(values).raised(py)?;
        return Ok((*angles).clone());
    }
    let values = values.iter().map(|v| deg_to_rad(*v));
    PyArray1::from_iter(py, values).reshape(angles.shape().to_vec())
}

/// Degrees of radians, in the fewest digits that are read back as the same.
#[pyfunction]
pub fn degrees<'py>(py: Python<'py>, angles: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let values = angles.as_slice()?.iter().map(|v| rad_to_shortest_deg(*v));
    rows(py, angles.shape()[1], values)
}

/// Names and angles \[rad\] of a posture table.
#[pyfunction]
pub fn read_postures<'py>(
    py: Python<'py>,
    cell: &PyCell,
    from: &str,
) -> PyResult<(Vec<String>, Bound<'py, PyArray2<f64>>)> {
    let robot = &cell.cell.setup.robot;
    let read = Files.read("postures", from);
    let postures = read.and_then(|(name, bytes)| read_table(&bytes, &name, robot));
    let postures = postures.raised(py)?;
    let angles = postures.iter().flat_map(|posture| posture.q.iter().copied());
    let angles = rows(py, robot.joint_count(), angles)?;
    Ok((postures.into_iter().map(|posture| posture.name).collect(), angles))
}

/// The text of a posture table.
#[pyfunction]
pub fn posture_text(py: Python<'_>, names: Vec<String>, angles: PyReadonlyArray2<'_, f64>) -> PyResult<String> {
    Ok(write_postures(&named(py, names, &angles)?))
}

/// The text of a cell file with the keys of a JSON object.
#[pyfunction]
pub fn toml_of_json(py: Python<'_>, json: &str) -> PyResult<String> {
    let made = || {
        let value: toml::Table = serde_json::from_str(json).map_err(|error| {
            let said = error.to_string();
            let said = said.split(" at line ").next().unwrap_or_default();
            let message = if said.contains("expected value") {
                "A value is not a finite number, or none that a cell file can hold.".to_string()
            } else {
                format!("A cell file cannot hold this: {said}.")
            };
            Error::new(Code::WrongType, message).hint(
                "keys are text; values are text, numbers, true, false, lists and dictionaries; leave out what is None",
            )
        })?;
        toml::to_string(&value)
            .map_err(|error| Error::new(Code::WrongType, format!("A cell file cannot hold this: {error}.")))
    };
    made().raised(py)
}

/// The keys of a cell file as a JSON object.
#[pyfunction]
pub fn json_of_toml(py: Python<'_>, text: &str) -> PyResult<String> {
    let fault = |error: &dyn std::fmt::Display| Error::new(Code::TomlSyntax, format!("The text is not TOML: {error}."));
    let made = || {
        let value: toml::Table = toml::from_str(text).map_err(|error| fault(&error.message()))?;
        serde_json::to_string(&value).map_err(|error| fault(&error))
    };
    made().raised(py)
}
