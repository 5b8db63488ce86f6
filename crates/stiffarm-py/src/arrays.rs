//! Functions from arrays to arrays: nothing between NumPy and the library's kernels.

use crate::cell::PyCell;
use crate::cores::on_cores;
use crate::error::{Raised, to_python};
use nalgebra::DMatrix;
use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods, npyffi::NPY_ORDER,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stiffarm::model::observation::{Rows, fill_observation_matrix, observation_shape};
use stiffarm::plan::index::{Index, evaluate_groups};
use stiffarm::{Code, Error};

/// No joint turns so far \[rad\]: two turns either way.
const FARTHEST: f64 = 4.0 * std::f64::consts::PI;

/// Refuses angles that are so large that they must be degrees.
///
/// # Errors
/// An angle beyond two turns, either way.
pub fn check_radians(angles: &[f64]) -> stiffarm::Result<()> {
    let is_far = |angle: &f64| angle.is_finite() && angle.abs() > FARTHEST;
    let far = angles.iter().copied().filter(is_far);
    match far.max_by(|a, b| a.abs().total_cmp(&b.abs())) {
        None => Ok(()),
        Some(angle) => {
            let degrees = angle.to_degrees();
            let message = format!("An angle is {angle} rad, which is {degrees:.0}°.");
            Err(Error::invalid(message)
                .hint("degrees=True, if the angles are in degrees; numpy.radians(...) where there is no such option"))
        }
    }
}

/// Rows of angles \[rad\], one posture each.
pub fn postures<'a>(angles: &'a PyReadonlyArray2<'_, f64>) -> PyResult<Vec<&'a [f64]>> {
    let joints = angles.shape()[1];
    let values = angles.as_slice()?;
    Ok(match joints {
        0 => vec![values; angles.shape()[0]],
        joints => values.chunks_exact(joints).collect(),
    })
}

/// A matrix of the library as an array, without a copy.
pub fn array(py: Python<'_>, matrix: DMatrix<f64>) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let shape = [matrix.nrows(), matrix.ncols()];
    let values: Vec<f64> = matrix.data.into();
    // Columns one after the other, as the library keeps them.
    PyArray1::from_vec(py, values).reshape_with_order(shape, NPY_ORDER::NPY_FORTRANORDER)
}

/// Ψ of Eqs. (9)–(11).
#[pyfunction]
#[pyo3(signature = (cell, angles, length=None))]
pub fn observation_matrix<'py>(
    py: Python<'py>,
    cell: &PyCell,
    angles: PyReadonlyArray2<'py, f64>,
    length: Option<f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let rows = match length {
        None => Rows::Translations,
        Some(length) => Rows::FullPose { length },
    };
    let postures = postures(&angles)?;
    let setup = &cell.cell.setup;
    let (height, width) = observation_shape(setup, postures.len(), rows);
    // Columns one after the other, as the library's matrices have them.
    let matrix = PyArray2::zeros(py, [height, width], true);
    let mut psi = matrix.readwrite();
    let psi = psi.as_slice_mut()?;
    py.detach(|| on_cores(|| fill_observation_matrix(setup, &postures, rows, psi))).raised(py)?;
    Ok(matrix)
}

/// Indices of many groups, each an array with an entry per group; NaN where one does not exist.
#[pyfunction]
pub fn indices<'py>(
    py: Python<'py>,
    cell: &PyCell,
    angles: PyReadonlyArray3<'py, f64>,
    names: Vec<String>,
) -> PyResult<Bound<'py, PyDict>> {
    let wanted: stiffarm::Result<Vec<Index>> = names.iter().map(|name| Index::from_name(name)).collect();
    let wanted = wanted.raised(py)?;
    let &[count, postures, joints] = angles.shape() else {
        let error = Error::new(Code::Dimension, "Groups are an array of three dimensions.");
        return Err(to_python(py, &error));
    };
    let values = angles.as_slice()?;
    let size = postures * joints;
    if size == 0 {
        let error = Error::new(Code::TooFewData, "The groups have no postures.");
        return Err(to_python(py, &error));
    }
    let evaluations = py.detach(|| {
        let groups: Vec<Vec<&[f64]>> =
            values.chunks_exact(size).map(|group| group.chunks_exact(joints).collect()).collect();
        on_cores(|| evaluate_groups(cell.complete(), &groups, &wanted))
    });
    let evaluations = evaluations.raised(py)?;
    debug_assert_eq!(evaluations.len(), count);
    let out = PyDict::new(py);
    for index in wanted {
        let column = evaluations.iter().map(|indices| indices.get(index).unwrap_or(f64::NAN));
        out.set_item(index.as_str(), PyArray1::from_iter(py, column))?;
    }
    Ok(out)
}

/// Of every index: name, meaning, whether larger is better, the unit that people read it in, and the factor to that.
#[pyfunction]
pub fn index_names() -> Vec<(&'static str, &'static str, bool, &'static str, f64)> {
    let described = |index: Index| {
        let (unit, factor) = index.shown_in();
        let larger = index.larger_is_better();
        (index.as_str(), index.meaning(), larger, unit, factor)
    };
    Index::ALL.into_iter().map(described).collect()
}
