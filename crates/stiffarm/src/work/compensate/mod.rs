//! What to command so that the loaded tool follows the nominal path.
//!
//! The loaded tool is where it should be when the joints, bent by the load
//! there, stand at the nominal posture. The springs' deflection at *that* state
//! is known, so the command is found from the end: θ_command = θ_loaded −
//! K_θ⁻¹ J(θ_loaded)ᵀ W, with θ_loaded the nominal serial angles where the
//! joints alone give way. This is the limit of the mirror correction, iterated
//! on the equilibrium. A series compliance, tilts and lost motion move the tip
//! beyond the joints; θ_loaded then solves for the pose that makes up for them.
//! Whatever the way, the command is checked by the equilibrium from its side.

mod command;

use command::command_in;
pub use command::{Command, command};

use crate::error::{Code, Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::identify::rms;
use crate::findings::{Finding, Severity, length};
use crate::model::cell::Cell;
use crate::model::implausible;
use crate::model::observation::PostureTerms;
use crate::model::path::LoadedPosture;
use crate::numerics::control::Control;
use crate::units::{rad_to_deg, rad_to_sentence_deg};
use crate::work::at_work::forbidden;
use crate::work::beyond_data::{BEYOND, IdentifiedRange, beyond_data};
use crate::work::predict::{Bands, LoadedArm, PathExtremes, TipBand, motion, with_bands};
use nalgebra::{Vector3, Vector6};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What to compensate, and how sure the load is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct CompensateOptions {
    /// Relative standard uncertainty of the load at work (fraction).
    pub load_uncertainty: f64,
    /// Size of the largest displacement of a point that the identification has seen \[m\], where
    /// it is known: corrections beyond it extrapolate.
    pub measured_up_to: Option<f64>,
    /// Size of the largest force that it has seen \[N\], where it is known.
    pub loaded_up_to: Option<f64>,
}

/// One point with its command.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PointCompensation {
    /// Name of the point.
    pub point: Arc<str>,
    /// Nominal controller angles \[rad\].
    #[serde(rename = "q_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub nominal: Vec<f64>,
    /// Position of the nominal tip, base frame \[m\].
    pub tip_m: [f64; 3],
    /// Force on the robot at the tip, base axes \[N\].
    pub force_n: [f64; 3],
    /// Moment about the tip, base axes \[N·m\].
    pub moment_nm: [f64; 3],
    /// Controller angles to command \[rad\].
    #[serde(rename = "command_q_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub command: Vec<f64>,
    /// Shift of the command's unloaded tip from the nominal one, base axes \[m\].
    pub correction_m: [f64; 3],
    /// Turn of the command's unloaded tip, rotation vector, base axes \[rad\].
    pub correction_rad: [f64; 3],
    /// Size of the shift \[m\].
    pub correction_size_m: f64,
    /// Shift of the tip at the nominal posture without compensation, base axes \[m\].
    pub uncompensated_shift_m: [f64; 3],
    /// Its size \[m\].
    pub uncompensated_m: f64,
    /// Distance of the loaded tip from the nominal one with this command, by the
    /// model that was compensated \[m\].
    pub residual_m: f64,
    /// How far the loaded tip may yet be from the nominal one: the uncertainty of
    /// the deflection; `null` where the stiffness comes without covariance.
    pub band: Option<TipBand>,
}

impl PointCompensation {
    fn is_loaded(&self) -> bool {
        [self.force_n, self.moment_nm] != [[0.0; 3]; 2]
    }
}

/// A compensated path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Compensation {
    /// Confidence of the bands.
    pub confidence: Option<f64>,
    /// RMS of the deflections without compensation \[m\].
    pub uncompensated_rms_m: f64,
    /// Largest of them \[m\].
    pub uncompensated_max_m: f64,
    /// RMS of what is left by the model that was compensated \[m\].
    pub residual_rms_m: f64,
    /// Largest of what is left \[m\].
    pub residual_max_m: f64,
    /// RMS of the error that the bands stand for, all axes together \[m\]: what
    /// can be expected of the real arm as far as the bands know \[m\].
    pub error_rms_m: Option<f64>,
    /// RMS without compensation over that.
    pub expected_factor: Option<f64>,
    /// Largest size of a correction \[m\].
    pub correction_max_m: f64,
    /// Points at which the correction is larger than its half width.
    pub beyond_uncertainty: Option<usize>,
    /// Joint stiffness that the commands were found with \[N·m/rad\], one per spring; `null` for one
    /// without a positive stiffness.
    pub stiffness_nm_per_rad: Vec<Option<f64>>,
    /// Name of the measuring point that stands for the tip; `null` where the cell gives the tip.
    pub tip_point: Option<String>,
    /// Where the tip bends least and most without compensation, and how it gives way there.
    pub extremes: Option<PathExtremes>,
    /// What to know about it, in sentences.
    pub findings: Vec<Finding>,
    /// Point by point.
    pub points: Vec<PointCompensation>,
}

impl Compensation {
    /// How many points carry a load.
    pub fn loaded(&self) -> usize {
        self.points.iter().filter(|p| p.is_loaded()).count()
    }

    /// What speaks against commanding the path: what is serious, and that it goes beyond the data.
    pub fn objections(&self) -> impl Iterator<Item = &Finding> + Clone {
        let findings = self.findings.iter();
        findings.filter(|f| f.severity == Severity::Serious || BEYOND.contains(&f.code.as_str()))
    }
}

/// Finds the commands for `postures`, each under its own wrench.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::estimate::compliance::IdentifiedCompliance;
/// use stiffarm::{Control, LoadedPosture, Wrench, compensate};
/// use stiffarm_files::builtin;
///
/// let cell = builtin::cell("comau")?;
/// let catalogue = IdentifiedCompliance::from_stiffness(&cell, cell.require_prior()?)?;
/// let force = Wrench::force([0.0, 300.0, 0.0]);
/// let work = [LoadedPosture::new("mill", vec![0.0, -0.5, -1.8, 0.3, 0.9, 0.2], force)];
/// let found = compensate(&cell, &catalogue, &work, &Default::default(), Control::default())?;
/// assert!(found.residual_max_m < 1e-9);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// As [`command`], with the line of the point; no points; a command outside the
/// machine's limits; interrupted.
pub fn compensate(
    cell: &Cell,
    predictor: &IdentifiedCompliance,
    postures: &[LoadedPosture],
    options: &CompensateOptions,
    control: Control<'_>,
) -> Result<Compensation> {
    let arm = LoadedArm::new(cell, predictor)?;
    compensate_on((cell, &arm), predictor, postures, options, control)
}

/// The same on the arm of `cell` with the values of `predictor`.
///
/// # Errors
/// As [`compensate`].
pub(crate) fn compensate_on(
    (cell, arm): (&Cell, &LoadedArm),
    predictor: &IdentifiedCompliance,
    postures: &[LoadedPosture],
    options: &CompensateOptions,
    control: Control<'_>,
) -> Result<Compensation> {
    if postures.is_empty() {
        return Err(Error::new(Code::TooFewData, "There is no point to compensate."));
    }
    let bands = Bands::new(predictor, options.load_uncertainty)?;
    let points = with_bands(
        (arm, bands.as_ref()),
        postures,
        ("compensating", control),
        |posture, terms| point(arm, posture, terms).map_err(|e| predictor.explain(posture.at(e))),
        |point| (point.uncompensated_shift_m, &mut point.band),
    )?;
    let confidence = bands.map(|b| b.confidence);
    let mut out = summarise(points, options, confidence);
    out.stiffness_nm_per_rad = predictor.spring_stiffness(cell);
    let sizes = out.points.iter();
    out.extremes = arm.extremes(sizes.map(|p| (p.nominal.as_slice(), p.uncompensated_m)))?;
    out.findings.splice(0..0, predictor.doubts.iter().cloned());
    out.findings.extend(implausible::process(cell));
    out.tip_point = cell.work.tip_point(&cell.setup.tool);
    out.findings.extend(cell.work.tip_assumed(&cell.setup.tool));
    let loads = postures.iter().map(|p| (&*p.name, &p.wrench));
    out.findings.extend(implausible::load(arm.robot(), loads));
    // Where the loaded arm stands: its command is off by as much as it gives way.
    out.findings.extend(forbidden(arm.at_work(), postures, control)?);
    Ok(out)
}

fn point(arm: &LoadedArm, posture: &LoadedPosture, terms: &mut PostureTerms) -> Result<PointCompensation> {
    let wrench = &posture.wrench;
    let command = command_in(arm, &posture.q, wrench, terms)?;
    let robot = arm.robot();
    if let Some((j, angle)) = robot.outside_limits(&command.q)
        && robot.outside_limits(&posture.q).is_none()
    {
        let joint = &robot.joints()[j];
        let [low, high] = joint.limits.map(rad_to_sentence_deg);
        let message = format!(
            "Point {}: the command would move {} to {:.4}°, outside the machine's limits, {low}° to {high}°.",
            posture.name,
            joint.name,
            rad_to_deg(angle)
        );
        return Err(Error::new(Code::OutsideLimits, message)
            .hint("choose another posture for this point, farther from the limit"));
    }
    let bent = arm.deflect_in(&posture.q, wrench, terms)?;
    let shift: Vector3<f64> = bent.displacement.fixed_rows::<3>(0).into_owned();
    let correction = motion(&command.nominal, &command.unloaded);
    let left = motion(&command.nominal, &command.loaded);
    let shift_of = |twist: &Vector6<f64>| -> Vector3<f64> { twist.fixed_rows::<3>(0).into_owned() };
    Ok(PointCompensation {
        point: posture.name.clone(),
        nominal: posture.q.clone(),
        tip_m: command.nominal.translation.vector.into(),
        force_n: wrench.force.into(),
        moment_nm: wrench.moment.into(),
        command: command.q.clone(),
        correction_m: shift_of(&correction).into(),
        correction_rad: [correction[3], correction[4], correction[5]],
        correction_size_m: shift_of(&correction).norm(),
        uncompensated_shift_m: shift.into(),
        uncompensated_m: shift.norm(),
        residual_m: shift_of(&left).norm(),
        band: None,
    })
}

fn summarise(points: Vec<PointCompensation>, options: &CompensateOptions, confidence: Option<f64>) -> Compensation {
    // Rapid moves, which carry no load, do not dilute the path.
    let loaded = || points.iter().filter(|p| p.is_loaded());
    let of = |pick: fn(&PointCompensation) -> f64| loaded().map(pick).collect::<Vec<f64>>();
    let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let (before, after) = (of(|p| p.uncompensated_m), of(|p| p.residual_m));
    let errors: Option<Vec<f64>> = loaded().map(|p| p.band.map(|b| b.rms_m)).collect();
    let error = errors.map(|e| rms(&e));
    let beyond: Option<usize> = loaded().map(|p| p.band.map(|b| usize::from(p.correction_size_m > b.size_m[3]))).sum();
    let mut out = Compensation {
        confidence,
        uncompensated_rms_m: rms(&before),
        uncompensated_max_m: largest(&before),
        residual_rms_m: rms(&after),
        residual_max_m: largest(&after),
        error_rms_m: error,
        expected_factor: error.filter(|e| *e > 0.0).map(|e| rms(&before) / e),
        correction_max_m: largest(&of(|p| p.correction_size_m)),
        beyond_uncertainty: beyond,
        stiffness_nm_per_rad: Vec::new(),
        tip_point: None,
        extremes: None,
        findings: Vec::new(),
        points,
    };
    out.findings = findings(&out, options);
    out
}

fn findings(result: &Compensation, options: &CompensateOptions) -> Vec<Finding> {
    let mut out = Vec::new();
    let count = result.loaded();
    match result.beyond_uncertainty {
        None => out.push(Finding::caution(
            "no-band",
            "stiffness",
            "The joint stiffness comes without covariance: nothing says whether this compensation helps or harms.",
        )),
        Some(beyond) if beyond < count => {
            let within = count - beyond;
            out.push(Finding::caution(
                "correction-within-uncertainty",
                "correction",
                format!(
                    "At {within} of {count} points the correction is smaller than its own uncertainty: there it may as \
                     well harm."
                ),
            ));
        }
        Some(_) => out.push(Finding::note(
            "correction-beyond-uncertainty",
            "correction",
            format!(
                "At all {count} points the correction, up to {}, is larger than its own uncertainty.",
                length(result.correction_max_m)
            ),
        )),
    }
    let points = result.points.iter();
    let points: Vec<(f64, f64)> = points.map(|p| (p.uncompensated_m, Vector3::from(p.force_n).norm())).collect();
    let seen = IdentifiedRange { displacement: options.measured_up_to, force: options.loaded_up_to };
    out.extend(beyond_data("correction", &points, seen));
    out
}
