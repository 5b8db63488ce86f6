//! Deflection at postures or along a path.

use super::band::{Bands, with_bands};
use super::{CartesianStiffness, LoadedArm, PathExtremes, TipBand};
use crate::error::{Code, Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::identify::rms;
use crate::findings::{Finding, Severity, length, percent};
use crate::model::cell::Cell;
use crate::model::implausible;
use crate::model::observation::PostureTerms;
use crate::model::path::LoadedPosture;
use crate::model::stiffness::Model;
use crate::numerics::control::Control;
use crate::work::at_work::forbidden;
use crate::work::beyond_data::{IdentifiedRange, beyond_data};
use nalgebra::{Isometry3, Vector3};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The linear model suffices where it differs by less than this share of the
/// band, or of the deflection where there is none.
const LINEAR_BAND_SHARE: f64 = 0.1;
/// The same share of a deflection without band.
const LINEAR_DEFLECTION_SHARE: f64 = 0.01;

/// Where wrenches act.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum LoadPoint {
    /// The tool tip.
    #[default]
    Tip,
    /// The loading point of the identification; a wrench that is the cell's own
    /// load there follows the point as that load does.
    LoadingPoint,
}

/// What to predict.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct PredictOptions {
    /// The deflection itself: equilibrium, or the linear model, Eq. (7).
    pub model: Model,
    /// Relative standard uncertainty of the load at work (fraction).
    pub load_uncertainty: f64,
    /// Where the wrenches act: at the tip, or at the cell's loading point.
    pub load_at: LoadPoint,
    /// Whether to give the Cartesian stiffness of each point.
    pub stiffness: bool,
    /// Size of the largest displacement of a point that the identification has seen \[m\], where
    /// it is known: deflections beyond it extrapolate.
    pub measured_up_to: Option<f64>,
    /// Size of the largest force that it has seen \[N\], where it is known.
    pub loaded_up_to: Option<f64>,
}

/// Deflection at one point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PointPrediction {
    /// Name of the point.
    pub point: Arc<str>,
    /// Controller angles \[rad\].
    #[serde(rename = "q_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub q: Vec<f64>,
    /// Position of the unloaded tip, base frame \[m\].
    pub tip_m: [f64; 3],
    /// Force on the robot, base axes \[N\].
    pub force_n: [f64; 3],
    /// Moment about the loaded point, base axes \[N·m\].
    pub moment_nm: [f64; 3],
    /// Shift of the tip, base axes \[m\].
    pub shift_m: [f64; 3],
    /// Turn of the tip as a rotation vector, base axes \[rad\].
    pub turn_rad: [f64; 3],
    /// Size of the shift \[m\].
    pub deflection_m: f64,
    /// Size of the difference between equilibrium and linear model \[m\].
    pub linear_difference_m: f64,
    /// How sure the shift is; `null` where the stiffness comes without covariance.
    pub band: Option<TipBand>,
    /// Cartesian stiffness, where asked for.
    pub stiffness: Option<Box<CartesianStiffness>>,
}

/// Deflections at postures or along a path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Prediction {
    /// Model behind the deflections.
    pub model: Model,
    /// Confidence of the bands.
    pub confidence: Option<f64>,
    /// RMS of the deflections \[m\].
    pub deflection_rms_m: f64,
    /// Largest deflection \[m\].
    pub deflection_max_m: f64,
    /// Where it is.
    pub deflection_max_point: String,
    /// Largest difference between equilibrium and linear model \[m\].
    pub linear_difference_max_m: f64,
    /// True where the linear model would have done: within a tenth of the bands and of the
    /// deflections, without bands within a hundredth of the deflections.
    pub linear_suffices: bool,
    /// RMS of the error that the bands stand for, all axes together \[m\].
    pub error_rms_m: Option<f64>,
    /// Joint stiffness that the prediction was made with \[N·m/rad\], one per spring; `null` for one
    /// without a positive stiffness.
    pub stiffness_nm_per_rad: Vec<Option<f64>>,
    /// Name of the measuring point that stands for the tip; `null` where the cell gives the tip.
    pub tip_point: Option<String>,
    /// Where the tip bends least and most, and how it gives way there.
    pub extremes: Option<PathExtremes>,
    /// What to know about it, in sentences.
    pub findings: Vec<Finding>,
    /// Point by point.
    pub points: Vec<PointPrediction>,
}

/// Predicts the deflection of the tip at `postures`, each under its own wrench.
///
/// The bands are to first order in the unknowns. They leave out what the model
/// leaves out: `validate` shows how much that is on the real arm.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::estimate::compliance::IdentifiedCompliance;
/// use stiffarm::{Control, LoadedPosture, Wrench, predict};
/// use stiffarm_files::builtin;
///
/// let cell = builtin::cell("comau")?;
/// let catalogue = IdentifiedCompliance::from_stiffness(&cell, cell.require_prior()?)?;
/// let force = Wrench::force([0.0, 300.0, 0.0]);
/// let work = [LoadedPosture::new("mill", vec![0.0, -0.5, -1.8, 0.3, 0.9, 0.2], force)];
/// let bend = predict(&cell, &catalogue, &work, &Default::default(), Control::default())?;
/// assert!(bend.deflection_max_m > 1e-5);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// No postures; an unknown that is not determined and gives way; angles of the wrong number
/// or not finite; a load that buckles the arm; interrupted.
pub fn predict(
    cell: &Cell,
    predictor: &IdentifiedCompliance,
    postures: &[LoadedPosture],
    options: &PredictOptions,
    control: Control<'_>,
) -> Result<Prediction> {
    let mut arm = LoadedArm::new(cell, predictor)?;
    if options.load_at == LoadPoint::LoadingPoint {
        arm = arm.loaded_by(cell);
    }
    predict_on((cell, &arm), predictor, postures, options, control)
}

/// The same on the arm of `cell` with the values of `predictor`, loaded where `options` say.
///
/// # Errors
/// As [`predict`].
pub(crate) fn predict_on(
    (cell, arm): (&Cell, &LoadedArm),
    predictor: &IdentifiedCompliance,
    postures: &[LoadedPosture],
    options: &PredictOptions,
    control: Control<'_>,
) -> Result<Prediction> {
    if postures.is_empty() {
        return Err(Error::new(Code::TooFewData, "There is no point to predict."));
    }
    let bands = Bands::new(predictor, options.load_uncertainty)?;
    let points = with_bands(
        (arm, bands.as_ref()),
        postures,
        ("bending", control),
        |posture, terms| {
            let predicted = point(arm, posture, options, terms);
            predicted.map_err(|e| predictor.explain(posture.at(e)))
        },
        |point| (point.shift_m, &mut point.band),
    )?;
    let mut out = summarise(points, options, bands.map(|b| b.confidence));
    out.stiffness_nm_per_rad = predictor.spring_stiffness(cell);
    let sizes = out.points.iter().map(|p| (p.q.as_slice(), p.deflection_m));
    out.extremes = arm.extremes(sizes)?;
    out.findings.splice(0..0, predictor.doubts.iter().cloned());
    out.findings.extend(implausible::process(cell));
    out.tip_point = cell.work.tip_point(&cell.setup.tool);
    out.findings.extend(cell.work.tip_assumed(&cell.setup.tool));
    let loads = postures.iter().map(|p| (&*p.name, &p.wrench));
    out.findings.extend(implausible::load(arm.robot(), loads));
    let forces = postures.iter().map(|p| p.wrench.force.norm());
    let sizes = out.points.iter().map(|p| p.deflection_m).zip(forces);
    let seen = IdentifiedRange { displacement: options.measured_up_to, force: options.loaded_up_to };
    let beyond = beyond_data("deflection", &sizes.collect::<Vec<_>>(), seen);
    out.findings.extend(beyond);
    out.findings.extend(forbidden(arm.at_work(), postures, control)?);
    Ok(out)
}

fn point(
    arm: &LoadedArm,
    posture: &LoadedPosture,
    options: &PredictOptions,
    terms: &mut PostureTerms,
) -> Result<PointPrediction> {
    let wrench = &posture.wrench;
    let bent = arm.deflect_in(&posture.q, wrench, terms)?;
    let twist = match options.model {
        Model::Linear => bent.linear,
        Model::Equilibrium => bent.displacement,
    };
    let shift: Vector3<f64> = twist.fixed_rows::<3>(0).into_owned();
    let difference: Vector3<f64> = (bent.displacement - bent.linear).fixed_rows::<3>(0).into_owned();
    Ok(PointPrediction {
        point: posture.name.clone(),
        q: posture.q.clone(),
        tip_m: position(&bent.before),
        force_n: wrench.force.into(),
        moment_nm: wrench.moment.into(),
        shift_m: shift.into(),
        turn_rad: [twist[3], twist[4], twist[5]],
        deflection_m: shift.norm(),
        linear_difference_m: difference.norm(),
        band: None,
        stiffness: if options.stiffness { Some(Box::new(arm.cartesian(&posture.q, wrench)?)) } else { None },
    })
}

impl PointPrediction {
    fn is_loaded(&self) -> bool {
        [self.force_n, self.moment_nm] != [[0.0; 3]; 2]
    }
}

fn position(pose: &Isometry3<f64>) -> [f64; 3] {
    pose.translation.vector.into()
}

fn summarise(points: Vec<PointPrediction>, options: &PredictOptions, confidence: Option<f64>) -> Prediction {
    // Rapid moves, which carry no load, do not dilute the path.
    let loaded = || points.iter().filter(|p| p.is_loaded());
    let sizes: Vec<f64> = loaded().map(|p| p.deflection_m).collect();
    let largest = points.iter().max_by(|a, b| a.deflection_m.total_cmp(&b.deflection_m));
    let differences = points.iter().map(|p| p.linear_difference_m);
    let suffices = |p: &PointPrediction| {
        let allowed = match &p.band {
            Some(band) => LINEAR_BAND_SHARE * band.size_m[3].min(p.deflection_m),
            None => LINEAR_DEFLECTION_SHARE * p.deflection_m,
        };
        p.linear_difference_m <= allowed
    };
    let errors: Option<Vec<f64>> = loaded().map(|p| p.band.map(|b| b.rms_m)).collect();
    let mut out = Prediction {
        model: options.model,
        confidence,
        deflection_rms_m: rms(&sizes),
        deflection_max_m: largest.map_or(0.0, |p| p.deflection_m),
        deflection_max_point: largest.map_or_else(String::new, |p| p.point.to_string()),
        linear_difference_max_m: differences.fold(0.0, f64::max),
        linear_suffices: points.iter().all(suffices),
        error_rms_m: errors.map(|e| rms(&e)),
        stiffness_nm_per_rad: Vec::new(),
        tip_point: None,
        extremes: None,
        findings: Vec::new(),
        points,
    };
    out.findings = findings(&out);
    out
}

fn findings(result: &Prediction) -> Vec<Finding> {
    let mut out = Vec::new();
    let gap = length(result.linear_difference_max_m);
    let has_bands = result.points.iter().any(|p| p.band.is_some());
    let small = if has_bands {
        "less than a tenth of the ± and of the deflection everywhere"
    } else {
        "less than a hundredth of the deflection everywhere"
    };
    let sentence = match (result.model, result.linear_suffices) {
        (Model::Equilibrium, true) => format!(
            "Deflections are those of the exact equilibrium; the linear model, Eq. (7), differs by at most {gap}, \
             {small}, and would do."
        ),
        (Model::Equilibrium, false) => format!(
            "Deflections are those of the exact equilibrium; the linear model, Eq. (7), differs by up to {gap}."
        ),
        (Model::Linear, true) => format!(
            "Deflections are those of the linear model, Eq. (7), which suffices: the exact equilibrium differs by at \
             most {gap}, {small}."
        ),
        (Model::Linear, false) => format!(
            "Deflections are those of the linear model, Eq. (7), which leaves out up to {gap}: use the equilibrium."
        ),
    };
    let severity = match (result.model, result.linear_suffices) {
        (Model::Linear, false) => Severity::Caution,
        _ => Severity::Note,
    };
    out.push(Finding::new("model", severity, "model", sentence));
    if result.points.iter().all(|p| p.band.is_none()) {
        out.push(Finding::caution(
            "no-band",
            "stiffness",
            "The joint stiffness comes without covariance: nothing says how sure these deflections are.",
        ));
    }
    if result.deflection_rms_m == 0.0 {
        out.push(Finding::caution("no-load", "load", "No point has a load, so nothing bends."));
    }
    let dominated = result.points.iter().filter_map(|p| p.band.as_ref()).filter(|b| b.size_m[1] > b.size_m[0]).count();
    if 2 * dominated > result.points.len() {
        out.push(Finding::note(
            "common-error-dominates",
            "band",
            format!(
                "Systematic errors are most of the band at {} of the points: what `identify` names as the largest of \
                 them would narrow it most.",
                percent(dominated as f64 / result.points.len() as f64)
            ),
        ));
    }
    out
}
