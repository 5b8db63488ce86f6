//! The arm at work: deflections, commands that make up for them, maps and places.

use crate::cell::PyCell;
use crate::inputs::{Given, Inputs, choice};
use crate::long::watched;
use pyo3::prelude::*;
use stiffarm::files::source::Source;
use stiffarm::work::along::PathOptions;
use stiffarm::work::compensated::Options as CompensateOptions;
use stiffarm::work::map::{place, stiffness_map};
use stiffarm::work::region::{Plane, RegionRequest, Steps};
use stiffarm::work::{mapped, placed, predicted};
use stiffarm::{Code, Error, Result};

/// The path, its loads and its postures.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Along {
    axes: Option<String>,
    force_n: Option<[f64; 3]>,
    moment_nm: Option<[f64; 3]>,
    load_uncertainty_percent: f64,
    start_deg: Option<Vec<f64>>,
    max_step_deg: f64,
    free_turn: Option<u16>,
}

impl Along {
    fn options(&self) -> Result<PathOptions> {
        let axes = self.axes.as_ref().map(|name| choice("axes", name));
        Ok(PathOptions {
            axes: axes.transpose()?,
            force_n: self.force_n,
            moment_nm: self.moment_nm,
            load_uncertainty_percent: self.load_uncertainty_percent,
            start_deg: self.start_deg.clone(),
            max_step_deg: self.max_step_deg,
            free_turn: self.free_turn,
        })
    }
}

/// `predict`.
#[pyfunction]
#[pyo3(signature = (cell, stiffness, path, along, model, matrix, cell_load, load_case, progress))]
pub fn predict(
    py: Python<'_>,
    cell: &PyCell,
    stiffness: Given,
    path: Option<Given>,
    along: Along,
    model: &str,
    matrix: bool,
    cell_load: bool,
    load_case: Option<String>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let request = predicted::Request {
            path: along.options()?,
            model: choice("model", model)?,
            matrix,
            cell_load,
            load_case,
        };
        let saved = inputs.read_stiffness(&inputs.name(stiffness), &cell.cell)?;
        let under = request.under_case(cell.cell.clone())?;
        let path = path.map(|given| inputs.name(given));
        let path = path.map(|from| inputs.read_path(&from, &under, request.path.axes));
        let path = path.transpose()?;
        let points = path.as_ref().map(|path| path.table.points.as_slice());
        let result = watched.with(|control| {
            let loaded = request.loaded(under.clone(), &saved.predictor, points, control)?;
            request.predict(&loaded, &saved, control)
        });
        let result = match &path {
            Some(path) => result.map_err(|e| path.in_file(e))?,
            None => result?,
        };
        inputs.document("predict", None, request.options(), result)
    })
}

/// `compensate`.
#[pyfunction]
#[pyo3(signature = (cell, stiffness, path, along, progress))]
pub fn compensate(
    py: Python<'_>,
    cell: &PyCell,
    stiffness: Given,
    path: Given,
    along: Along,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let options = CompensateOptions {
            path: along.options()?,
        };
        let saved = inputs.read_stiffness(&inputs.name(stiffness), &cell.cell)?;
        let path = inputs.read_path(&inputs.name(path), &cell.cell, options.path.axes)?;
        let result = watched.with(|control| {
            let points = &path.table.points;
            let followed = options
                .path
                .follow(&cell.cell, &saved.predictor, points, control)?;
            options.compensate(&cell.cell, &saved, &followed, control)
        });
        let result = result.map_err(|e| path.in_file(e))?;
        inputs.document("compensate", None, options, result)
    })
}

/// Where to map.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Where {
    plane: Option<(String, f64)>,
    from_mm: Option<[f64; 3]>,
    to_mm: Option<[f64; 3]>,
    steps: Option<Vec<usize>>,
}

impl Where {
    fn request(&self) -> Result<RegionRequest> {
        let plane = |(name, mm): &(String, f64)| {
            let axis = ["x", "y", "z"].iter().position(|axis| axis == name);
            let plane = axis
                .filter(|_| mm.is_finite())
                .map(|axis| Plane { axis, mm: *mm });
            plane.ok_or_else(|| {
                let message = "A plane is x, y or z and its coordinate in mm.";
                Error::new(Code::InvalidValue, message).key("plane")
            })
        };
        let steps = |steps: &Vec<usize>| match steps.as_slice() {
            [longest @ 1..=1_000_000] => Ok(Steps::Longest(*longest)),
            [x @ 1..=1_000_000, y @ 1..=1_000_000, z @ 1..=1_000_000] => {
                Ok(Steps::Each([*x, *y, *z]))
            }
            _ => Err(
                Error::new(Code::InvalidValue, "Steps are one number from 1, or three.")
                    .key("steps"),
            ),
        };
        if self.from_mm.is_some() != self.to_mm.is_some() {
            let message = "Both corners of the region are needed, from_mm and to_mm.";
            return Err(Error::new(Code::MissingKey, message).key("from_mm"));
        }
        Ok(RegionRequest {
            plane: self.plane.as_ref().map(plane).transpose()?,
            from_mm: self.from_mm,
            to_mm: self.to_mm,
            steps: self.steps.as_ref().map(steps).transpose()?,
        })
    }
}

/// `map`.
#[pyfunction]
#[pyo3(signature = (cell, stiffness, region, rpy_deg, free_turn, force_n, moment_nm, direction, progress))]
pub fn map(
    py: Python<'_>,
    cell: &PyCell,
    stiffness: Given,
    region: Where,
    rpy_deg: Option<[f64; 3]>,
    free_turn: Option<usize>,
    force_n: Option<[f64; 3]>,
    moment_nm: Option<[f64; 3]>,
    direction: Option<[f64; 3]>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let request = mapped::Request {
            region: region.request()?,
            rpy_deg,
            free_turn,
            force_n,
            moment_nm,
            direction,
        };
        let saved = inputs.read_stiffness(&inputs.name(stiffness), &cell.cell)?;
        let cell = cell.complete();
        let (options, _) = request.map_options(cell)?;
        let found =
            watched.with(|control| stiffness_map(cell, &saved.predictor, &options, control))?;
        inputs.document("map", None, request.options(&options, cell), found)
    })
}

/// `map --place`.
#[pyfunction]
#[pyo3(signature = (cell, stiffness, path, axes, region, yaw_deg, refine, free_turn, progress))]
pub fn place_workpiece(
    py: Python<'_>,
    cell: &PyCell,
    stiffness: Given,
    path: Given,
    axes: Option<String>,
    region: Where,
    yaw_deg: Vec<f64>,
    refine: u8,
    free_turn: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let request = placed::Request {
            region: region.request()?,
            yaw_deg,
            refine,
            free_turn,
        };
        request.check()?;
        if refine > 8 {
            let message = "At most 8 finer grids are searched.";
            return Err(Error::new(Code::InvalidValue, message).key("refine"));
        }
        let cell = &cell.cell;
        let saved = inputs.read_stiffness(&inputs.name(stiffness), cell)?;
        let axes = axes.as_ref().map(|name| choice("axes", name)).transpose()?;
        let path = inputs.read_path(&inputs.name(path), cell, axes)?;
        let options = request.place_options(cell)?;
        let found = watched
            .with(|control| {
                place(
                    cell,
                    &saved.predictor,
                    &path.table.points,
                    &options,
                    control,
                )
            })
            .map_err(|e| path.in_file(e))?;
        inputs.document("map", None, request.options(&options), found)
    })
}
