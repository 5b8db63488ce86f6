//! An index as a function of all controller angles, with its gradient.

use crate::arrays::check_radians;
use crate::cell::PyCell;
use crate::error::{Raised, to_python};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use stiffarm::plan::index::{Index, IndexFunction};
use stiffarm::{Code, Error};

/// An index of groups of one size.
#[pyclass(module = "stiffarm._stiffarm")]
pub struct Objective {
    function: IndexFunction,
    index: Index,
    size: usize,
}

impl Objective {
    fn check(&self, py: Python<'_>, q: &PyReadonlyArray1<'_, f64>) -> PyResult<()> {
        let message = if q.len() != self.size {
            format!("{} angles are needed, got {}.", self.size, q.len())
        } else if q.as_slice()?.iter().any(|q| !q.is_finite()) {
            "An angle is not a finite number.".to_string()
        } else {
            return check_radians(q.as_slice()?).raised(py);
        };
        let code = if q.len() == self.size { Code::NotFinite } else { Code::Dimension };
        Err(to_python(py, &Error::new(code, message)))
    }
}

#[pymethods]
impl Objective {
    #[new]
    fn new(
        py: Python<'_>,
        cell: &PyCell,
        index: &str,
        postures: usize,
        given: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Self> {
        let index = Index::from_name(index).raised(py)?;
        let held = crate::arrays::postures(&given)?;
        let cell = cell.complete();
        let function = IndexFunction::with_given(cell, index, postures, &held).raised(py)?;
        Ok(Objective { function, index, size: postures * cell.setup.robot.joint_count() })
    }

    /// Name of the index.
    #[getter]
    fn index(&self) -> &'static str {
        self.index.as_str()
    }

    /// The index; infinite where it does not exist (zero for one of which larger is better).
    fn value(&mut self, py: Python<'_>, q: PyReadonlyArray1<'_, f64>) -> PyResult<f64> {
        self.check(py, &q)?;
        Ok(self.index.of_log(self.function.value(q.as_slice()?)))
    }

    /// [`value`](Self::value), so many times in one call: what a call itself costs is the rest.
    fn _repeated(&mut self, py: Python<'_>, q: PyReadonlyArray1<'_, f64>, times: u32) -> PyResult<f64> {
        self.check(py, &q)?;
        let q = q.as_slice()?;
        let mut sum = 0.0;
        for _ in 0..times {
            sum += std::hint::black_box(self.function.value(std::hint::black_box(q)));
        }
        Ok(sum)
    }

    /// ln of the index (of its reciprocal where larger is better) and its gradient \[1/rad\]; where several
    /// postures or joints share the largest value, the gradient of the first of them.
    fn log_and_gradient<'py>(
        &mut self,
        py: Python<'py>,
        q: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<(f64, Bound<'py, PyArray1<f64>>)> {
        self.check(py, &q)?;
        let (value, gradient) = self.function.log_and_gradient(q.as_slice()?);
        Ok((value, PyArray1::from_vec(py, gradient)))
    }

    /// The same of one smooth function, off by at most ln(count)/sharpness, and the exact ln beside it.
    fn smoothed<'py>(
        &mut self,
        py: Python<'py>,
        q: PyReadonlyArray1<'py, f64>,
        sharpness: f64,
    ) -> PyResult<(f64, f64, Bound<'py, PyArray1<f64>>)> {
        self.check(py, &q)?;
        if !(sharpness.is_finite() && sharpness > 0.0) {
            let message = format!("The sharpness must be above zero, got {sharpness}.");
            return Err(to_python(py, &Error::invalid(message)));
        }
        let mut gradient = vec![0.0; self.size];
        let smoothed = self.function.smoothed(q.as_slice()?, sharpness, &mut gradient);
        Ok((smoothed.objective, smoothed.exact, PyArray1::from_vec(py, gradient)))
    }
}
