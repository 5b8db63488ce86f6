//! Registration from the unloaded readings: the measuring points as the tracker
//! sees them against where the kinematic model puts them.
//! A wrong posture (a mistyped angle, exchanged points) is left out, not averaged in.
//!
//! Leave out postures, not points, when the unloaded readings register the
//! tracker. The errors of an arm are common to a posture's points; a limit of
//! eight times the others' residual leaves out fewer than one sound posture in
//! 500 (`tests/reduction_noise.rs`).

mod fit;

use super::base_motion::on_a_line;
use super::messages::{length, postures, postures_first};
use crate::error::{Code, Error, Result};
use crate::findings::{Finding, Severity, codes};
use crate::measure::registration::{Pair, PointPair, Registration, rms};
use crate::measure::series::{PostureSeries, StateSamples};
use crate::model::cell::Cell;
use crate::model::kinematics::Frames;
use crate::model::measurement::Role;
use fit::{ABOVE_NOISE, Fit, ROUNDING, jackknife, robust_fit};
use nalgebra::{Isometry3, Point3, Vector3};
use serde::{Deserialize, Serialize};

/// Residual above which the model as a whole is in doubt \[m\]: calibrated or
/// not, an industrial arm is better than this.
const LARGE_RESIDUAL: f64 = 3e-3;
/// A given transform whose residual is so many times that of the best one is wrong.
const WRONG_TRANSFORM_RATIO: f64 = 3.0;

/// Residual of one measuring point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UnloadedPointResidual {
    /// Measuring point.
    pub point: String,
    /// Position by the model minus measured position, base axes \[m\].
    pub residual_m: [f64; 3],
}

/// Unloaded points of one posture after registration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UnloadedPostureResidual {
    /// Posture.
    pub posture: String,
    /// False where it disagrees with the others and was left out of the fit.
    pub used: bool,
    /// RMS of its residuals' lengths \[m\].
    pub rms_m: f64,
    /// Its points.
    pub points: Vec<UnloadedPointResidual>,
}

/// Tracker against base, by the unloaded readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UnloadedRegistration {
    /// True where the transform was given and the readings only check it.
    pub given: bool,
    /// Rotation from tracker to base axes, row by row.
    pub rotation: [[f64; 3]; 3],
    /// Origin of the tracker frame in the base frame \[m\].
    pub translation_m: [f64; 3],
    /// RMS of the residuals' lengths over the postures used \[m\].
    pub rms_m: f64,
    /// Standard error of the turn about each base axis \[rad\], by leaving out
    /// one posture at a time (jackknife): the errors of the arm are common to a
    /// posture's points. `None` below three postures or for a given transform.
    pub turn_standard_error_rad: Option<[f64; 3]>,
    /// Residuals, posture by posture.
    pub postures: Vec<UnloadedPostureResidual>,
    /// The fit over the postures used; `None` for a given transform.
    #[serde(skip)]
    pub fit: Option<Registration>,
}

/// The unloaded points of one posture in both frames.
struct UnloadedPosture<'a> {
    posture: &'a str,
    points: Vec<usize>,
    pairs: Vec<PointPair>,
}

impl<'a> UnloadedPosture<'a> {
    /// `None` where no point was read without load, nor under a preload.
    fn new(cell: &Cell, posture: &PostureSeries<'a>) -> Option<Self> {
        let tool = &cell.setup.tool;
        let role = match posture.states(Role::Unloaded).next() {
            Some(_) => Role::Unloaded,
            None => posture.reference,
        };
        let planned = &posture.readings.posture.q;
        // Each state at its own angles.
        let frames: Vec<Frames> = posture
            .readings
            .states
            .iter()
            .map(|s| Frames::new(&cell.setup.robot, s.angles.as_ref().unwrap_or(planned)))
            .collect();
        let (mut points, mut pairs) = (Vec::new(), Vec::new());
        for (index, series) in &posture.points {
            let states: Vec<&StateSamples<'_>> = series.states.iter().filter(|s| s.role == role).collect();
            let count: usize = states.iter().map(|s| s.count()).sum();
            if count == 0 {
                continue;
            }
            let point = &tool.measuring_points[*index];
            let mean = |of: &dyn Fn(&StateSamples<'_>) -> Vector3<f64>| {
                let weighted = states.iter().map(|s| of(s) * s.count() as f64);
                weighted.sum::<Vector3<f64>>() / count as f64
            };
            points.push(*index);
            pairs.push(PointPair {
                name: format!("posture {}, point {}", posture.name(), point.name),
                tracker: mean(&|s| s.position),
                base: mean(&|s| frames[s.state].point(&point.position)),
            });
        }
        (!pairs.is_empty()).then_some(UnloadedPosture { posture: posture.name(), points, pairs })
    }

    /// Tracker and base position of each point.
    fn positions(&self) -> impl Iterator<Item = Pair> + '_ {
        self.pairs.iter().map(|p| (p.tracker, p.base))
    }

    fn mean_square(&self, transform: &Isometry3<f64>) -> f64 {
        let squares = self.pairs.iter().map(|p| residual(p, transform).norm_squared());
        squares.sum::<f64>() / self.pairs.len() as f64
    }
}

fn residual(pair: &PointPair, transform: &Isometry3<f64>) -> Vector3<f64> {
    pair.base - (transform * Point3::from(pair.tracker)).coords
}

/// Registers from the unloaded readings, or checks a `stated_transform` with them.
/// The second value is the transform; findings are added to `findings`.
///
/// # Errors
/// No transform given, and fewer than three unloaded points or all on a line;
/// as [`register`].
pub(super) fn registration(
    cell: &Cell,
    series: &[PostureSeries<'_>],
    stated_transform: Option<&Isometry3<f64>>,
    reading_std: f64,
    findings: &mut Vec<Finding>,
) -> Result<(Option<UnloadedRegistration>, Isometry3<f64>)> {
    let seen: Vec<UnloadedPosture<'_>> = series.iter().filter_map(|p| UnloadedPosture::new(cell, p)).collect();
    let fitted = enough(&seen).and_then(|()| robust_fit(&seen, reading_std));
    if let Some(transform) = stated_transform {
        let all = vec![true; seen.len()];
        let summary = (!seen.is_empty()).then(|| describe(cell, &seen, &all, transform, true));
        if let (Some(summary), Ok(best)) = (&summary, fitted) {
            check_given(summary, transform, &best, &seen, reading_std, findings);
        }
        return Ok((summary, *transform));
    }
    let fit = fitted?;
    let transform = fit.registration.base_from_tracker;
    let mut summary = describe(cell, &seen, &fit.used, &transform, false);
    summary.turn_standard_error_rad = jackknife(&seen, &fit);
    check_own(&summary, findings);
    summary.fit = Some(fit.registration);
    Ok((Some(summary), transform))
}

/// Registers readings by themselves: the transform from tracker to base, and the pairs of the postures that agree.
///
/// # Errors
/// As [`registration`] without a transform that is given.
pub(in crate::measure) fn by_themselves(
    cell: &Cell,
    series: &[PostureSeries<'_>],
) -> Result<(Isometry3<f64>, Vec<Pair>)> {
    let seen: Vec<UnloadedPosture<'_>> = series.iter().filter_map(|p| UnloadedPosture::new(cell, p)).collect();
    enough(&seen)?;
    let fit = robust_fit(&seen, cell.noise.reading_variance.sqrt())?;
    let used = seen.iter().zip(&fit.used).filter(|(_, used)| **used);
    let pairs = used.flat_map(|(posture, _)| posture.positions()).collect();
    Ok((fit.registration.base_from_tracker, pairs))
}

/// True where a transform fits pairs as well as the best one does, which leaves `best` \[m\].
pub(in crate::measure) fn fits(cell: &Cell, transform: &Isometry3<f64>, pairs: &[Pair], best: f64) -> bool {
    let noise = ABOVE_NOISE * cell.noise.reading_variance.sqrt();
    rms(transform, pairs) <= (WRONG_TRANSFORM_RATIO * best).max(noise).max(ROUNDING)
}

/// At least three points that are not on a line.
fn enough(seen: &[UnloadedPosture<'_>]) -> Result<()> {
    let points: Vec<Vector3<f64>> = seen.iter().flat_map(|s| &s.pairs).map(|p| p.tracker).collect();
    let mean = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
    let from_mean: Vec<Vector3<f64>> = points.iter().map(|p| p - mean).collect();
    let (code, message) = match points.len() {
        count @ 0..3 => (
            Code::TooFewData,
            format!(
                "The tracker's place takes at least 3 unloaded points that are not on a line; the table has {count}."
            ),
        ),
        _ if on_a_line(&from_mean) => (
            Code::InvalidValue,
            "All unloaded points lie on a line: they cannot say how the tracker is turned about it.".to_string(),
        ),
        _ => return Ok(()),
    };
    Err(Error::new(code, message).hint(
        "give tracker.xyz_mm and tracker.rpy_deg in the cell, or a registration; zeros where the readings are \
         already in base axes",
    ))
}

fn describe(
    cell: &Cell,
    seen: &[UnloadedPosture<'_>],
    used: &[bool],
    transform: &Isometry3<f64>,
    is_stated: bool,
) -> UnloadedRegistration {
    let names = &cell.setup.tool.measuring_points;
    let rotation = transform.rotation.to_rotation_matrix();
    let count: usize = seen.iter().zip(used).filter(|(_, u)| **u).map(|(s, _)| s.pairs.len()).sum();
    let sum: f64 =
        seen.iter().zip(used).filter(|(_, u)| **u).map(|(s, _)| s.mean_square(transform) * s.pairs.len() as f64).sum();
    UnloadedRegistration {
        given: is_stated,
        rotation: std::array::from_fn(|i| std::array::from_fn(|j| rotation[(i, j)])),
        translation_m: transform.translation.vector.into(),
        rms_m: (sum / count.max(1) as f64).sqrt(),
        turn_standard_error_rad: None,
        postures: seen
            .iter()
            .zip(used)
            .map(|(s, used)| UnloadedPostureResidual {
                posture: s.posture.to_string(),
                used: *used,
                rms_m: s.mean_square(transform).sqrt(),
                points: s
                    .points
                    .iter()
                    .zip(&s.pairs)
                    .map(|(index, pair)| UnloadedPointResidual {
                        point: names[*index].name.clone(),
                        residual_m: residual(pair, transform).into(),
                    })
                    .collect(),
            })
            .collect(),
        fit: None,
    }
}

/// What the residuals of our own fit say.
fn check_own(summary: &UnloadedRegistration, findings: &mut Vec<Finding>) {
    let left_out: Vec<&UnloadedPostureResidual> = summary.postures.iter().filter(|p| !p.used).collect();
    if !left_out.is_empty() {
        let names: Vec<&str> = left_out.iter().map(|p| p.posture.as_str()).collect();
        let worst = left_out.iter().map(|p| p.rms_m).fold(0.0, f64::max);
        findings.push(Finding::caution(
            codes::REGISTRATION_OUTLIER,
            names.join(", "),
            format!(
                "{}: the unloaded points lie up to {} from where the model puts them, the others within {}. Left out \
                 of the registration; look for a mistyped angle or exchanged points.",
                postures_first(&names),
                length(worst),
                length(summary.rms_m)
            ),
        ));
    }
    if summary.rms_m > LARGE_RESIDUAL {
        findings.push(Finding::caution(
            codes::REGISTRATION_RESIDUAL,
            "registration",
            format!(
                "After registration the unloaded points still lie {} (RMS) from where the model puts them, more than \
                 an industrial arm is wrong by. Check units, joint signs, coupling and the tool's points.",
                length(summary.rms_m)
            ),
        ));
    }
}

/// Compares a given transform with the best one for the readings.
fn check_given(
    summary: &UnloadedRegistration,
    stated_transform: &Isometry3<f64>,
    best: &Fit,
    seen: &[UnloadedPosture<'_>],
    reading_std: f64,
    findings: &mut Vec<Finding>,
) {
    let fit = &best.registration.base_from_tracker;
    let typical = |transform: &Isometry3<f64>| {
        let chosen = seen.iter().zip(&best.used).filter(|(_, used)| **used);
        let squares: Vec<f64> = chosen.map(|(s, _)| s.mean_square(transform)).collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
    };
    let (ours, theirs) = (typical(fit), typical(stated_transform));
    let limit = (WRONG_TRANSFORM_RATIO * ours).max(ABOVE_NOISE * reading_std).max(ROUNDING);
    if theirs > limit {
        let turn = (stated_transform.rotation * fit.rotation.inverse()).angle();
        findings.push(Finding::new(
            codes::GIVEN_REGISTRATION,
            if turn > 0.02 { Severity::Serious } else { Severity::Caution },
            "tracker",
            format!(
                "With the given transform the unloaded points lie {} (RMS) from where the model puts them; a transform \
                 turned by {:.2} mrad against it brings them to {}. Displacements are off by that turn.",
                length(theirs),
                turn * 1e3,
                length(ours)
            ),
        ));
    }
    let odd: Vec<&str> =
        summary.postures.iter().zip(&best.used).filter(|(_, used)| !**used).map(|(p, _)| p.posture.as_str()).collect();
    if !odd.is_empty() {
        findings.push(Finding::caution(
            codes::REGISTRATION_OUTLIER,
            odd.join(", "),
            format!(
                "The unloaded points of {} disagree with those of the other postures: look for a mistyped angle or \
                 exchanged points.",
                postures(&odd)
            ),
        ));
    }
}
