//! From readings to joint stiffness, and how it holds elsewhere.

use crate::cell::PyCell;
use crate::error::Raised;
use crate::inputs::{Given, GivenPostures, Inputs, Postures, choice};
use crate::long::watched;
use pyo3::prelude::*;
use stiffarm::estimate::clamped::{Options as ClampedOptions, identify_clamped, without};
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::estimate::identified::{Identified, Options, Wanted};
use stiffarm::estimate::identify::{Estimator, Fit, IdentifyOptions};
use stiffarm::estimate::validated::{Folds, Request};
use stiffarm::files::source::Source;
use stiffarm::files::table::read_clamped;
use stiffarm::measure::{Measured, prepare};
use stiffarm::model::observation::ExtraTerm;
use stiffarm::units::deg_to_rad;
use stiffarm::{Code, Error, Result};

/// How a stiffness is estimated.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct FitChoices {
    estimator: Option<String>,
    terms: Vec<String>,
    elastic: Option<String>,
    weights: Option<String>,
    prior_std_percent: Option<f64>,
    noise: Option<String>,
    confidence: Option<f64>,
}

impl FitChoices {
    /// The options for the robot of `cell`.
    pub fn options(&self, cell: &stiffarm::Cell) -> Result<IdentifyOptions> {
        let mut options = IdentifyOptions::default();
        if let Some(name) = &self.estimator {
            let wanted = name.replace('_', "-");
            let known = Estimator::ALL.into_iter().find(|e| e.as_str() == wanted);
            options.estimator = known.ok_or_else(|| {
                let names = Estimator::ALL.map(Estimator::as_str).join(", ");
                Error::new(
                    Code::UnknownName,
                    format!("There is no estimator \"{name}\"."),
                )
                .key("estimator")
                .hint(format!("known: {names}"))
            })?;
        }
        for word in &self.terms {
            let terms = ExtraTerm::parse(word, &cell.setup.robot);
            options.extra.extend(terms.map_err(|e| e.key("terms"))?);
        }
        if let Some(name) = &self.weights {
            options.weights = choice("weights", name)?;
        }
        if let Some(name) = &self.noise {
            options.noise = choice("noise", name)?;
        }
        if let Some(percent) = self.prior_std_percent {
            options.prior_std = percent / 100.0;
        }
        if let Some(confidence) = self.confidence {
            options.confidence = confidence;
        }
        Ok(options)
    }

    fn elastic(&self) -> Result<Option<ElasticChoice>> {
        let name = self.elastic.as_ref();
        name.map(|name| choice("elastic", name)).transpose()
    }
}

/// What was measured, and how it becomes displacements.
pub struct Data {
    measurements: Vec<Given>,
    postures: Option<Postures>,
    registration: Option<Given>,
}

impl Data {
    pub fn new(
        py: Python<'_>,
        measurements: Vec<Given>,
        postures: Option<GivenPostures<'_>>,
        registration: Option<Given>,
    ) -> PyResult<Self> {
        Ok(Data {
            measurements,
            postures: postures.map(|given| given.owned(py)).transpose()?,
            registration,
        })
    }

    fn prepared(self, inputs: &Inputs, cell: &stiffarm::Cell) -> Result<Measured> {
        let postures = self.postures.map(|given| match given {
            Postures::Table(table) => inputs.name(table),
            Postures::Values(postures) => inputs.name(Given::Memory(
                "<postures>".to_string(),
                stiffarm::files::table::write_postures(&postures).into_bytes(),
            )),
        });
        let names = inputs.names(self.measurements);
        let read = inputs.read_measurements(&names, postures.as_deref(), cell)?;
        let registration = self.registration.map(|given| inputs.name(given));
        let reduce = inputs.read_registration(registration.as_deref())?;
        prepare(cell, read, &reduce)
    }
}

/// `identify`: the document of the result, and whether it was stopped.
#[pyfunction]
#[pyo3(signature = (cell, measurements, postures, registration, exclude, fit, bootstrap, seed, brief, progress))]
pub fn identify(
    py: Python<'_>,
    cell: &PyCell,
    measurements: Vec<Given>,
    postures: Option<GivenPostures<'_>>,
    registration: Option<Given>,
    exclude: Vec<String>,
    fit: FitChoices,
    bootstrap: Option<u64>,
    seed: u64,
    brief: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    let data = Data::new(py, measurements, postures, registration)?;
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        let options = fit.options(&cell.cell)?;
        let elastic = fit.elastic()?;
        let mut measured = data.prepared(&inputs, &cell.cell)?;
        measured.exclude(&exclude).map_err(|e| e.key("exclude"))?;
        let wanted = {
            let mut wanted = Wanted::default();
            wanted.bootstrap = bootstrap;
            wanted.elastic = elastic.unwrap_or(ElasticChoice::Axes);
            wanted.seed = seed;
            wanted.brief = brief;
            wanted
        };
        let fit = Fit::watched(&cell.cell, measured, &options, watched.shared())?;
        let result = watched.with(|control| Identified::new(&fit, &wanted, control))?;
        let described = Options::new(&options, &wanted, elastic, &exclude);
        inputs.document("identify", Some(seed), described, result)
    })
}

/// `identify --clamped`: the flange was fixed.
#[pyfunction]
#[pyo3(signature = (cell, measurements, postures, exclude, fit, angle_noise_deg))]
pub fn identify_with_flange_fixed(
    py: Python<'_>,
    cell: &PyCell,
    measurements: Given,
    postures: Option<GivenPostures<'_>>,
    exclude: Vec<String>,
    fit: FitChoices,
    angle_noise_deg: Option<f64>,
) -> PyResult<String> {
    let postures = postures.map(|given| given.owned(py)).transpose()?;
    py.detach(|| {
        let inputs = Inputs::of(cell);
        let robot = &cell.cell.setup.robot;
        let postures = postures.map(|given| inputs.postures("postures", given, robot));
        let postures = postures.transpose()?;
        let (file, bytes) = inputs.read("measurements", &inputs.name(measurements))?;
        let clamped = read_clamped(&bytes, &file, &cell.cell, postures.as_deref())?;
        let clamped = without(clamped, &exclude)?;
        let options = fit.options(&cell.cell)?;
        let noise = angle_noise_deg.map(deg_to_rad);
        let result = identify_clamped(&cell.cell, &clamped, noise, &options)?;
        let described = ClampedOptions::new(&options, angle_noise_deg, &exclude);
        inputs.document("identify", None, described, result)
    })
    .raised(py)
}

/// `validate` of a saved stiffness, or fold by fold without one; `folds` 0 leaves out one posture at a time.
#[pyfunction]
#[pyo3(signature = (cell, stiffness, measurements, postures, registration, model, tolerance_mm, only, folds, fit, progress))]
pub fn validate(
    py: Python<'_>,
    cell: &PyCell,
    stiffness: Option<Given>,
    measurements: Vec<Given>,
    postures: Option<GivenPostures<'_>>,
    registration: Option<Given>,
    model: &str,
    tolerance_mm: Option<f64>,
    only: Vec<String>,
    folds: usize,
    fit: FitChoices,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, bool)> {
    let data = Data::new(py, measurements, postures, registration)?;
    let request = Request {
        model: choice("model", model).raised(py)?,
        tolerance_mm,
        only,
    };
    watched(py, progress, |watched| {
        let inputs = Inputs::of(cell);
        request.check()?;
        let Some(stiffness) = stiffness else {
            let options = fit.options(&cell.cell)?;
            let elastic = fit.elastic()?;
            let mut measured = data.prepared(&inputs, &cell.cell)?;
            request.keep_only(&mut measured)?;
            let fit = Fit::watched(&cell.cell, measured, &options, watched.shared())?;
            let folds = match folds {
                0 => Folds::All,
                count => Folds::Count(count),
            };
            let (result, described) = request.by_folds(&fit, elastic, folds)?;
            return inputs.document("validate", None, request.options(Some(described)), result);
        };
        let saved = inputs.read_stiffness(&inputs.name(stiffness), &cell.cell)?;
        let measured = data.prepared(&inputs, &cell.cell)?;
        let hash = inputs.cell_hash();
        let result = request.held_out(&cell.cell, hash.as_deref(), &saved, measured)?;
        inputs.document("validate", None, request.options(None), result)
    })
}
