//! Validation on postures that took no part in the identification, Eq. (22),
//! with the bands within which the measured displacements should lie.

mod band;
mod folds;

pub use crate::model::stiffness::Model;
use band::PointBands;
pub use band::{BandShare, PointBand};
pub use folds::{cross_validate, cross_validate_mixed};

use crate::error::{Code, Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::identify::{Experiment, Weights, known_displacement, rms, rounding, sees_only_known};
use crate::estimate::noise::draw_noise;
use crate::findings::Finding;
use crate::measure::Measured;
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::measurement::{Displacement, MeasuredPosture, ReferencePart};
use crate::model::observation::PostureTerms;
use crate::model::posture::Posture;
use crate::model::stiffness::{compliance_of_springs, displacement_between, joint_compliance, settle};
use crate::numerics::streams::run_rng;
use nalgebra::{DMatrix, DVector, Vector3, Vector6};
use serde::{Deserialize, Serialize};

/// Eq. (22) at one measuring point of one posture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PointDeviation {
    /// `m-n`: measuring point n of posture m, as in Table 7.
    pub label: String,
    /// Posture.
    pub posture: String,
    /// Load state.
    pub state: String,
    /// Measuring point.
    pub point: String,
    /// Measured displacement \[m\], base axes.
    pub measured_m: [f64; 3],
    /// Calculated displacement \[m\], base axes.
    pub calculated_m: [f64; 3],
    /// δb = ‖measured − calculated‖ \[m\], Eq. (22).
    pub deviation_m: f64,
    /// How far the measured displacement may lie from the calculated one, where
    /// the identification says how sure it is.
    pub band: Option<PointBand>,
}

/// A posture of a validation in one load state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ValidatedPosture {
    /// Posture.
    pub posture: String,
    /// Load state.
    pub state: String,
    /// Its controller angles \[rad\].
    #[serde(rename = "q_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub angles: Vec<f64>,
    /// Measured force and moment on the robot at the loading point, base axes \[N; N·m\];
    /// `None` where the cell's load gives them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrench: Option<[f64; 6]>,
}

/// Result of a validation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Validation {
    /// Model behind the calculated displacements.
    pub model: Model,
    /// Eq. (22), row by row.
    pub points: Vec<PointDeviation>,
    /// The postures with their load states, in the order of the measurements.
    pub postures: Vec<ValidatedPosture>,
    /// RMS of δb \[m\].
    pub deviation_rms_m: f64,
    /// Largest δb \[m\].
    pub deviation_max_m: f64,
    /// RMS of the components of measured minus calculated displacements \[m\], to
    /// be held beside the residual RMS of the identification.
    pub component_rms_m: f64,
    /// RMS norm of the measured displacements \[m\].
    pub displacement_rms_m: f64,
    /// How many times smaller the errors would have been, had these displacements
    /// been compensated as calculated: RMS displacement over the RMS of δb without the cell's noise. Between postures
    /// and loads like these, on this arm.
    pub compensation_factor: Option<f64>,
    /// True where δb cannot be told from that noise: the factor is at least so large.
    #[serde(default)]
    pub compensation_factor_is_bound: bool,
    /// Expected δb if the cell's noise were the only error, 2σ·sqrt(2/π) \[m\].
    pub noise_expectation_m: f64,
    /// Tolerance on the largest δb \[m\], where given.
    pub tolerance_m: Option<f64>,
    /// True when every δb is within the tolerance, and every posture was predicted.
    pub passed: Option<bool>,
    /// Folds of a cross-validation; `None` where the postures took no part.
    pub folds: Option<usize>,
    /// Postures that could not be predicted: what was identified, in a cross-validation from
    /// the others, does not determine all that moves them.
    pub unpredicted: Vec<String>,
    /// How many components lie inside their bands, where there are bands.
    pub band: Option<BandShare>,
    /// What the bands say.
    pub findings: Vec<Finding>,
}

/// Calculated displacements of all measuring points of one posture, point by
/// point \[m\], including a known series compliance and the controller giving way.
///
/// # Errors
/// As [`PostureTerms::new`] and [`joint_compliance`].
pub fn calculated_displacements(
    cell: &Cell,
    measured: &MeasuredPosture,
    stiffness: &[f64],
    model: Model,
) -> Result<Vec<Vector3<f64>>> {
    let compliance = joint_compliance(&cell.setup.robot, stiffness)?;
    displacements(cell, measured, &compliance, model)
}

/// The same from K_θ⁻¹, n × n, which need not be invertible.
fn displacements(
    cell: &Cell,
    measured: &MeasuredPosture,
    compliance: &DMatrix<f64>,
    model: Model,
) -> Result<Vec<Vector3<f64>>> {
    let (q, wrench) = (&measured.posture.q, measured.wrench.as_ref());
    let setup = &*cell.setup.of_state(&measured.state)?;
    let terms = PostureTerms::new(setup, q, wrench)?;
    let offset = known_displacement(&cell.setup, &terms, measured)?;
    let tool = &cell.setup.tool;
    // One equilibrium per posture moves all its points.
    let after = match model {
        Model::Linear => None,
        Model::Equilibrium => {
            let mut moved = terms.clone();
            settle(setup, compliance, &mut moved, wrench)?;
            Some(moved.frames)
        }
    };
    // Δq = K_θ⁻¹ Γ, Eq. (5).
    let deflection = compliance * DVector::from_column_slice(terms.torque());
    (0..tool.point_count())
        .map(|a| {
            let twist = match &after {
                None => {
                    // Δ = J^m Δq, Eq. (6).
                    let moved = terms.frames().jacobian(&terms.measuring_points()[a]) * &deflection;
                    Vector6::from_iterator(moved.iter().copied())
                }
                Some(after) => {
                    let point = &tool.measuring_points[a].position;
                    displacement_between(terms.frames(), after, point)
                }
            };
            Ok(Vector3::new(twist[0], twist[1], twist[2]) + offset.fixed_rows::<3>(3 * a))
        })
        .collect()
}

/// Compares calculated with measured displacements, Eq. (22), for a stiffness
/// alone: without bands.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::estimate::validate::validate;
/// use stiffarm::model::stiffness::Model;
/// use stiffarm::{prepare, simulated_readings};
/// use stiffarm_files::builtin;
///
/// let cell = builtin::cell("comau")?;
/// let postures = builtin::postures("comau-group1", &cell.setup.robot)?;
/// let measured = prepare(&cell, simulated_readings(&cell, &postures, 1)?, &Default::default())?;
/// // The cell's prior is the truth of the simulation: only noise is left.
/// let found = validate(&cell, cell.require_prior()?, &measured, Model::Equilibrium, None)?;
/// assert!(found.deviation_rms_m < 5e-5);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// As [`validate_with`]; a stiffness that is not positive.
pub fn validate(
    cell: &Cell,
    stiffness: &[f64],
    measured: impl Into<Measured>,
    model: Model,
    tolerance_m: Option<f64>,
) -> Result<Validation> {
    let predictor = IdentifiedCompliance::from_stiffness(cell, stiffness)?;
    validate_with(cell, &predictor, measured, model, tolerance_m)
}

/// Compares calculated with measured displacements, Eq. (22), with the band of
/// each where the predictor says how sure it is. The bands are those of the
/// linear model for either model.
///
/// # Errors
/// No measurements, a point the tool does not have, a number that is not
/// finite, or extra terms with [`Model::Equilibrium`].
pub fn validate_with(
    cell: &Cell,
    predictor: &IdentifiedCompliance,
    measured: impl Into<Measured>,
    model: Model,
    tolerance_m: Option<f64>,
) -> Result<Validation> {
    check_tolerance(tolerance_m)?;
    let readings: Measured = measured.into();
    let measured = &readings.postures;
    let finite = |d: &Displacement| d.value.iter().all(|v| v.is_finite());
    if !measured.iter().all(|m| m.displacements.iter().all(finite)) {
        return Err(Error::new(Code::NotFinite, "A displacement is not a finite number."));
    }
    if measured.iter().all(|m| m.displacements.is_empty()) {
        return Err(Error::new(Code::TooFewData, "There are no displacements to validate with."));
    }
    let experiment = Experiment::new(cell, readings)?;
    let (cell, measured) = (&experiment.cell, experiment.postures());
    let exact = match model {
        Model::Linear => None,
        Model::Equilibrium => {
            let springs = predictor.springs(model.as_str())?;
            let compliance = compliance_of_springs(&cell.setup.robot, springs);
            let of = |m| {
                let calculated = displacements(cell, m, &compliance, model);
                calculated.map_err(|e| predictor.explain(e))
            };
            Some(measured.iter().map(of).collect::<Result<Vec<_>>>()?)
        }
    };
    let system = experiment.system(&predictor.extra, Weights::Readings)?;
    let errors = &system.delta - &system.psi * &predictor.values;
    let bands = PointBands::new(predictor, &system)?;
    let rounding = rounding(&system);
    let mut unpredicted = Vec::new();
    let mut points = Vec::with_capacity(system.labels.len());
    for (b, block) in system.blocks.iter().enumerate() {
        if !sees_only_known(&system, b, &predictor.undetermined, rounding) {
            unpredicted.push(block.posture.clone());
            continue;
        }
        for label in system.labels_of(block) {
            let posture = &measured[label.measured];
            let displacement = &posture.displacements[label.displacement];
            let calculated = match &exact {
                None => displacement.value - errors.fixed_rows::<3>(label.rows.start),
                Some(exact) => exact[label.measured][displacement.point],
            };
            let value = &displacement.value;
            points.push(Point {
                measured: label.measured,
                displacement: label.displacement,
                calculated,
                band: bands.of(block, label, value, &calculated),
            });
        }
    }
    if points.is_empty() {
        return Err(Error::new(
            Code::NotIdentifiable,
            "No posture can be predicted: the identification did not determine every joint that moves there.",
        )
        .hint("identify again with more postures, or with --estimator prior"));
    }
    points.sort_by_key(|p| (p.measured, p.displacement));
    let mut result = summarise(cell, measured, points, model, tolerance_m);
    result.passed = result.passed.map(|passed| passed && unpredicted.is_empty());
    result.unpredicted = unpredicted;
    if let Some(spread) = &predictor.spread {
        result.band = band::share(&result.points, spread.confidence);
        result.findings = band::findings(&result);
    }
    Ok(result)
}

/// One displacement with its prediction.
#[derive(Debug, Clone)]
struct Point {
    measured: usize,
    displacement: usize,
    calculated: Vector3<f64>,
    band: Option<PointBand>,
}

impl ValidatedPosture {
    fn of(measured: &MeasuredPosture) -> Self {
        ValidatedPosture {
            posture: measured.posture.name.clone(),
            state: measured.state.clone(),
            angles: measured.posture.q.clone(),
            wrench: measured.wrench.as_ref().map(Wrench::components),
        }
    }
}

fn check_tolerance(tolerance_m: Option<f64>) -> Result<()> {
    if tolerance_m.is_some_and(|t| t.is_nan() || t < 0.0) {
        Err(Error::invalid("The tolerance must be 0 or above."))
    } else {
        Ok(())
    }
}

/// Eq. (22) of predicted displacements, in the order of the measurements.
fn summarise(
    cell: &Cell,
    measured: &[MeasuredPosture],
    predicted: Vec<Point>,
    model: Model,
    tolerance_m: Option<f64>,
) -> Validation {
    let mut points = Vec::with_capacity(predicted.len());
    let mut components = Vec::with_capacity(3 * predicted.len());
    for point in predicted {
        let posture = &measured[point.measured];
        let displacement = &posture.displacements[point.displacement];
        let name = &cell.setup.tool.measuring_points[displacement.point].name;
        let error = displacement.value - point.calculated;
        components.extend_from_slice(error.as_slice());
        points.push(PointDeviation {
            label: format!("{}-{}", point.measured + 1, displacement.point + 1),
            posture: posture.posture.name.clone(),
            state: posture.state.clone(),
            point: name.clone(),
            measured_m: displacement.value.into(),
            calculated_m: point.calculated.into(),
            // δb, Eq. (22)
            deviation_m: error.norm(),
            band: point.band,
        });
    }
    let deviations: Vec<f64> = points.iter().map(|p| p.deviation_m).collect();
    let norms: Vec<f64> = points.iter().map(|p| Vector3::from(p.measured_m).norm()).collect();
    let largest = deviations.iter().copied().fold(0.0, f64::max);
    let (deviation, displacement) = (rms(&deviations), rms(&norms));
    // Mean of the norm of three independent normal components.
    let sigma = (cell.noise.displacement_variance() + cell.noise.posture_common_std.powi(2)).sqrt();
    // What a fit takes for noise besides is the model's, and stays.
    let error = without_noise(deviation.powi(2), 3.0 * sigma * sigma, components.len());
    Validation {
        model,
        deviation_rms_m: deviation,
        deviation_max_m: largest,
        component_rms_m: rms(&components),
        displacement_rms_m: displacement,
        compensation_factor: error.map(|(error, _)| displacement / error),
        compensation_factor_is_bound: error.is_some_and(|(_, is_bound)| is_bound),
        noise_expectation_m: 2.0 * sigma * std::f64::consts::FRAC_2_PI.sqrt(),
        tolerance_m,
        passed: tolerance_m.map(|t| largest <= t),
        folds: None,
        unpredicted: Vec::new(),
        band: None,
        findings: Vec::new(),
        points,
        postures: measured.iter().map(ValidatedPosture::of).collect(),
    }
}

/// Standard errors by which deviations have to be beyond their noise for their error to have a size.
const BEYOND_NOISE: f64 = 2.0;

/// RMS of the errors behind `count` components of deviations with this mean square, of which `noise` is that of the
/// readings, and whether it is but a bound; `None` without any deviation.
fn without_noise(square: f64, noise: f64, count: usize) -> Option<(f64, bool)> {
    let least = BEYOND_NOISE * square.max(noise) * (2.0 / count as f64).sqrt();
    let left = square - noise;
    let (error, is_bound) = if left > least { (left, false) } else { ((left.max(0.0) + least).min(square), true) };
    (square > 0.0).then(|| (error.sqrt(), is_bound))
}

/// Simulated measurements of `postures`: displacements by `model` with the
/// stiffness `truth`, plus the cell's noise from `seed` and `stream`.
///
/// # Errors
/// As [`calculated_displacements`].
pub fn simulate_measurements(
    cell: &Cell,
    postures: &[Posture],
    truth: &[f64],
    model: Model,
    seed: u64,
    stream: usize,
) -> Result<Vec<MeasuredPosture>> {
    let points = cell.setup.tool.point_count();
    let mut rng = run_rng(seed, 1 << 16, 0, stream);
    let cases = cell.setup.load.cases();
    let loads = cases.len().max(1);
    let noise = draw_noise(&mut rng, &cell.noise, postures.len() * loads, points);
    let states = postures.iter().flat_map(|posture| (0..loads).map(move |load| (posture, load)));
    states
        .enumerate()
        .map(|(p, (posture, load))| {
            let mut measured = MeasuredPosture::new(posture.clone(), Vec::new());
            if let Some(case) = cases.get(load) {
                measured.state.clone_from(&case.name);
            }
            let exact = calculated_displacements(cell, &measured, truth, model)?;
            measured.displacements = exact
                .iter()
                .enumerate()
                .map(|(point, value)| {
                    let noise = noise.fixed_rows::<3>(3 * (points * p + point));
                    Displacement {
                        // Each load has an unloaded reading of its own.
                        reference: vec![ReferencePart::reading(load as u32)],
                        ..Displacement::new(point, value + noise)
                    }
                })
                .collect();
            Ok(measured)
        })
        .collect()
}
