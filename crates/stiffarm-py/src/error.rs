//! The library's error as the package's one exception.

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};
use stiffarm::{Code, Error};

static EXCEPTION: PyOnceLock<Py<PyType>> = PyOnceLock::new();

/// `stiffarm.StiffarmError` with message, code, place and hint.
pub fn to_python(py: Python<'_>, error: &Error) -> PyErr {
    if error.code() == Code::Interrupted {
        return PyKeyboardInterrupt::new_err(error.message().to_string());
    }
    match raised(py, error) {
        Ok(error) | Err(error) => error,
    }
}

fn raised(py: Python<'_>, error: &Error) -> PyResult<PyErr> {
    let class = EXCEPTION.import(py, "stiffarm._errors", "StiffarmError")?;
    let place = PyDict::new(py);
    let at = error.place();
    if let Some(file) = &at.file {
        place.set_item("file", file)?;
    }
    if let Some(line) = at.line {
        place.set_item("line", line)?;
    }
    if let Some(column) = at.column {
        place.set_item("column", column)?;
    }
    if let Some(key) = &at.key {
        place.set_item("key", key)?;
    }
    let arguments = (error.message(), error.code().as_str(), place, error.hint_text());
    Ok(PyErr::from_value(class.call1(arguments)?))
}

/// Results of the library in functions of Python.
pub trait Raised<T> {
    /// The value, or the exception.
    ///
    /// # Errors
    /// The library's error as an exception.
    fn raised(self, py: Python<'_>) -> PyResult<T>;
}

impl<T> Raised<T> for stiffarm::Result<T> {
    fn raised(self, py: Python<'_>) -> PyResult<T> {
        self.map_err(|error| to_python(py, &error))
    }
}
