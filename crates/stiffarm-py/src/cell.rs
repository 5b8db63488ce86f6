//! The cell: text and meshes that it was made from, beside what they say.

use crate::error::{Raised, to_python};
use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use stiffarm::plan::check::prepared;
use stiffarm::{Cell, Code, Error, Result};
use stiffarm_files::builtin;
use stiffarm_files::cell::parse_cell_bytes_with;
use stiffarm_files::table::sha256_hex;

/// A robot cell, ready to be used.
#[pyclass(frozen, module = "stiffarm._stiffarm", name = "Cell")]
pub struct PyCell {
    /// What the text says.
    pub cell: Cell,
    /// Its name in messages.
    pub name: String,
    /// The text as it was read.
    pub text: Vec<u8>,
    /// The meshes that it names.
    pub files: BTreeMap<String, Vec<u8>>,
    /// The cell with its characteristic length, once somebody needs that.
    complete: OnceLock<Cell>,
    hashes: OnceLock<BTreeMap<String, String>>,
}

impl PyCell {
    fn read(name: &str, text: Vec<u8>, meshes: BTreeMap<String, Vec<u8>>, folder: Option<&Path>) -> Result<Self> {
        let files = RefCell::new(BTreeMap::new());
        let read = |file: &str| -> Result<Vec<u8>> {
            let bytes = match meshes.get(file) {
                Some(bytes) => bytes.clone(),
                None => mesh(name, file, folder)?,
            };
            files.borrow_mut().insert(file.to_string(), bytes.clone());
            Ok(bytes)
        };
        let cell = parse_cell_bytes_with(&text, name, &read)?;
        Ok(PyCell {
            cell,
            name: name.to_string(),
            text,
            files: files.into_inner(),
            complete: OnceLock::new(),
            hashes: OnceLock::new(),
        })
    }

    /// The cell with the characteristic length of Eq. (20), where the robot has one, and the springs that its load can
    /// determine.
    pub fn complete(&self) -> &Cell {
        self.complete.get_or_init(|| prepared(&self.cell, true).0)
    }

    /// SHA-256 of the text and of each mesh, by its role; meshes are large, and every call asks.
    pub fn hashes(&self) -> &BTreeMap<String, String> {
        self.hashes.get_or_init(|| {
            let meshes = self.files.iter();
            let meshes = meshes.map(|(file, bytes)| (format!("cell mesh {file}"), sha256_hex(bytes)));
            let text = ("cell".to_string(), sha256_hex(&self.text));
            meshes.chain([text]).collect()
        })
    }
}

/// The class and the arguments that make a cell again.
type Reduced<'py> = (Bound<'py, PyAny>, (String, Bound<'py, PyBytes>, Bound<'py, PyDict>));

/// The bytes of a mesh that a cell names.
fn mesh(cell: &str, file: &str, folder: Option<&Path>) -> Result<Vec<u8>> {
    if cell.starts_with(builtin::PREFIX) || file.starts_with(builtin::PREFIX) {
        let name = file.strip_prefix(builtin::PREFIX).unwrap_or(file);
        return builtin::mesh_text(name).map(|text| text.as_bytes().to_vec()).ok_or_else(|| {
            let message = format!("There is no built-in mesh \"{name}\".");
            Error::new(Code::UnknownName, message)
        });
    }
    let path = folder.map_or_else(|| PathBuf::from(file), |folder| folder.join(file));
    std::fs::read(&path).map_err(|error| Error::new(Code::FileRead, format!("The file cannot be read: {error}.")))
}

#[pymethods]
impl PyCell {
    #[new]
    #[pyo3(signature = (name, text, files, folder=None))]
    fn new(
        py: Python<'_>,
        name: &str,
        text: Vec<u8>,
        files: BTreeMap<String, Vec<u8>>,
        folder: Option<PathBuf>,
    ) -> PyResult<Self> {
        PyCell::read(name, text, files, folder.as_deref()).raised(py)
    }

    #[staticmethod]
    fn built_in(py: Python<'_>, name: &str) -> PyResult<Self> {
        let text = builtin::cell_text(name).ok_or_else(|| {
            let message = format!("There is no built-in cell \"{name}\".");
            let names = builtin::cell_names().join(", ");
            let error = Error::new(Code::UnknownName, message).hint(format!("built in: {names}"));
            to_python(py, &error)
        })?;
        let name = format!("{}{name}", builtin::PREFIX);
        PyCell::read(&name, text.as_bytes().to_vec(), BTreeMap::new(), None).raised(py)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let class = py.get_type::<PyCell>().into_any();
        let arguments = (self.name.clone(), self.text(py), self.files(py)?);
        Ok((class, arguments))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    #[getter]
    fn title(&self) -> &str {
        &self.cell.name
    }

    #[getter]
    fn text<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.text)
    }

    #[getter]
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let files = PyDict::new(py);
        for (name, bytes) in &self.files {
            files.set_item(name, PyBytes::new(py, bytes))?;
        }
        Ok(files)
    }

    #[getter]
    fn inputs(&self) -> BTreeMap<String, String> {
        self.hashes().clone()
    }

    #[getter]
    fn robot_name(&self) -> &str {
        self.cell.setup.robot.name()
    }

    #[getter]
    fn joint_count(&self) -> usize {
        self.cell.setup.robot.joint_count()
    }

    #[getter]
    fn joint_names(&self) -> Vec<&str> {
        let joints = self.cell.setup.robot.joints();
        joints.iter().map(|joint| joint.name.as_str()).collect()
    }

    #[getter]
    fn spring_names(&self) -> Vec<String> {
        self.cell.setup.robot.spring_names()
    }

    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let joints = self.cell.setup.robot.joints().iter();
        pairs(py, joints.map(|joint| joint.limits).collect())
    }

    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pairs(py, self.cell.bounds.clone())
    }

    #[getter]
    fn prior<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.cell.prior.as_ref().map(|prior| prior.to_pyarray(py))
    }

    #[getter]
    fn noise_std(&self) -> f64 {
        self.cell.noise.displacement_std()
    }

    #[getter]
    fn characteristic_length(&self) -> Option<f64> {
        self.cell.characteristic_length
    }

    #[getter]
    fn measuring_point_names(&self) -> Vec<&str> {
        let points = self.cell.setup.tool.measuring_points.iter();
        points.map(|point| point.name.as_str()).collect()
    }

    #[getter]
    fn measuring_points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = self.cell.setup.tool.measuring_points.iter();
        rows(py, 3, points.flat_map(|point| vector(&point.position)))
    }

    #[getter]
    fn loading_point<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(&self.cell.setup.tool.loading_point).to_pyarray(py)
    }
}

fn vector(v: &Vector3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z]
}

fn pairs(py: Python<'_>, pairs: Vec<[f64; 2]>) -> PyResult<Bound<'_, PyArray2<f64>>> {
    rows(py, 2, pairs.into_iter().flatten())
}

/// An array of rows of `width` numbers.
pub fn rows<'py>(
    py: Python<'py>,
    width: usize,
    values: impl Iterator<Item = f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let values: Vec<f64> = values.collect();
    let count = values.len() / width.max(1);
    numpy::PyArray1::from_vec(py, values).reshape([count, width])
}
