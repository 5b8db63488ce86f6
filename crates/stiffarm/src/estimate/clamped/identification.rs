//! Identification from clamped postures.
//!
//! Residuals that are angles have keys that say so. Free and clamped
//! end-effector share `Estimates` (flat in both results); what has a unit is
//! `…_m` in one and `…_rad` in the other.

use super::friction::{JointFriction, friction};
use super::{ClampedPosture, LoopClosure, closures, system};
use crate::error::{Code, Error, Result};
use crate::estimate::compliance::{FittedNoise, IdentifiedCompliance};
use crate::estimate::identify::{
    Assumptions, Estimates, IdentifyOptions, MeasuredSystem, NoiseSource, Prepared, Scale, Solution, Verdict, Weights,
    check, prior_knowledge, rms,
};
use crate::estimate::saved::{Sealed, flange_of, once};
use crate::findings::{Finding, codes, list};
use crate::model::cell::Cell;
use crate::numerics::order::sort_by_number;
use serde::{Deserialize, Serialize};

/// Friction above this share of a joint's torque is named.
const FRICTION_SHARE: f64 = 0.05;
/// Residuals this many times the expected errors of the angles hold more than those.
const MORE_THAN_NOISE: f64 = 1.5;

/// Residuals of one clamped posture in one load state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ClampedResidual {
    /// Posture.
    pub posture: String,
    /// Load state.
    pub state: String,
    /// RMS of the angles that the flange holds \[rad\].
    pub motor_rms_rad: f64,
    /// RMS of their residuals \[rad\].
    pub residual_rms_rad: f64,
    /// The posture's controller angles \[rad\].
    #[serde(rename = "q_deg", with = "crate::units::degrees", default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub angles: Vec<f64>,
}

/// Weight that Huber's estimator gave a state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StateWeight {
    /// Posture.
    pub posture: String,
    /// Load state.
    pub state: String,
    /// The weight: 1 where the state fits.
    pub weight: f64,
}

/// Result of an identification with a clamped end-effector: that of a free one,
/// with residuals that are angles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ClampedIdentification {
    /// The estimates.
    #[serde(flatten)]
    pub estimates: Estimates,
    /// RMS of the angles that the flange holds, less the known motion of the
    /// fixture \[rad\].
    pub motor_rms_rad: f64,
    /// RMS of the residuals, sqrt(RSS/rows) \[rad\].
    pub residual_rms_rad: f64,
    /// σ of an angle as the residuals show it \[rad\]; `None` without degrees of
    /// freedom.
    pub residual_std_rad: Option<f64>,
    /// σ of an angle difference as it was given \[rad\].
    pub expected_std_rad: Option<f64>,
    /// The cell's prior stiffness, joint by joint \[N·m/rad\]; empty where it has none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub prior_stiffness: Vec<f64>,
    /// Residuals posture by posture.
    pub postures: Vec<ClampedResidual>,
    /// Huber's weights, smallest first, where that estimator was used.
    pub weights: Vec<StateWeight>,
    /// Friction joint by joint, where loads went up and down.
    pub friction: Vec<JointFriction>,
    /// What to know before relying on the result.
    pub findings: Vec<Finding>,
    /// What later commands calculate with; `None` where the readings determine nothing.
    pub sealed: Option<Sealed>,
}

/// Identifies the joint stiffness from clamped postures. `angle_std` is σ of an
/// angle difference \[rad\], which [`NoiseSource::Known`] needs. The points of a
/// posture share nothing here, so that the estimators with two variances count
/// all rows as independent (`independent_rows`).
///
/// # Errors
/// As [`clamped_system`](super::clamped_system); options that a clamped
/// end-effector does not have: weights of a tracker, noise from repeats.
pub fn identify_clamped(
    cell: &Cell,
    clamped: &[ClampedPosture],
    angle_std: Option<f64>,
    options: &IdentifyOptions,
) -> Result<ClampedIdentification> {
    check(options)?;
    let closures = closures(cell, clamped)?;
    let system = system(cell, clamped, &options.extra, &closures)?;
    let prepared = Prepared::new(&system, options.estimator)?;
    let solution = prepared.solve(&system.delta, &assumptions(cell, angle_std, options)?)?;
    let estimates = Estimates {
        // There are no shifts here, whatever the estimator.
        independent_rows: true,
        ..Estimates::new(cell, &system, &solution, options)?
    };
    let residual = &system.delta - &system.psi * &solution.values;
    let friction = friction(cell, clamped, &closures, &system, &solution.values)?;
    let postures = system
        .labels
        .iter()
        .map(|label| ClampedResidual {
            posture: clamped[label.measured].posture.name.clone(),
            state: clamped[label.measured].state.clone(),
            motor_rms_rad: rms(&system.delta.as_slice()[label.rows.clone()]),
            residual_rms_rad: rms(&residual.as_slice()[label.rows.clone()]),
            angles: clamped[label.measured].posture.q.clone(),
        })
        .collect();
    let mut result = ClampedIdentification {
        motor_rms_rad: rms(system.delta.as_slice()),
        residual_rms_rad: rms(residual.as_slice()),
        residual_std_rad: solution.residual_std,
        expected_std_rad: angle_std,
        prior_stiffness: cell.prior.clone().unwrap_or_default(),
        postures,
        weights: weights(clamped, &system, &solution),
        friction,
        findings: Vec::new(),
        sealed: None,
        estimates,
    };
    result.findings = findings(clamped, &closures, &result);
    // Angles say nothing of the noise of displacements.
    let noise = FittedNoise::default();
    let compliance = IdentifiedCompliance::from_estimates(cell, &result.estimates, noise).ok();
    let forces = clamped.iter().map(|c| c.wrench.force.norm());
    result.sealed = compliance.map(|compliance| Sealed {
        springs: cell.setup.robot.spring_names(),
        flange_m: Some(flange_of(cell).into()),
        predictor: compliance.with_doubts(&result.findings),
        postures: once(result.postures.iter().map(|p| &p.posture)),
        largest_displacement_m: None,
        largest_force_n: forces.reduce(f64::max),
        loads: Vec::new(),
    });
    Ok(result)
}

fn assumptions(cell: &Cell, angle_std: Option<f64>, options: &IdentifyOptions) -> Result<Assumptions> {
    if angle_std.is_some_and(|s| !(s.is_finite() && s > 0.0)) {
        return Err(Error::invalid("The standard deviation of the angles must be above zero."));
    }
    if options.weights == Weights::Tracker {
        return Err(Error::new(
            Code::Conflict,
            "A clamped end-effector is measured without a tracker, so weights by tracker cannot be used.",
        ));
    }
    let scale = match (options.noise, angle_std) {
        (NoiseSource::Estimated, _) => Scale::Estimated,
        (NoiseSource::Known, Some(sigma)) => Scale::Known { sigma, gamma: 0.0 },
        (NoiseSource::Known, None) => {
            return Err(Error::new(
                Code::MissingKey,
                "Known noise of a clamped end-effector needs the standard deviation of its angles.",
            )
            .hint("give it, or take the noise from the residuals"));
        }
        (NoiseSource::Repeats, _) => {
            return Err(Error::new(
                Code::Conflict,
                "The noise of a clamped end-effector cannot come from repeated readings of a tracker.",
            ));
        }
    };
    Ok(Assumptions { estimator: options.estimator, scale, declared_ratio: 0.0, prior: prior_knowledge(cell, options)? })
}

fn weights(clamped: &[ClampedPosture], system: &MeasuredSystem, solution: &Solution) -> Vec<StateWeight> {
    let Some(weights) = &solution.weights else {
        return Vec::new();
    };
    let mut out: Vec<StateWeight> = system
        .labels
        .iter()
        .zip(weights)
        .map(|(label, weight)| StateWeight {
            posture: clamped[label.measured].posture.name.clone(),
            state: clamped[label.measured].state.clone(),
            weight: *weight,
        })
        .collect();
    sort_by_number(&mut out, |a| a.weight);
    out
}

fn findings(clamped: &[ClampedPosture], closures: &[LoopClosure], result: &ClampedIdentification) -> Vec<Finding> {
    let mut out = Vec::new();
    out.extend(sign(&result.estimates));
    out.extend(near_singular(clamped, closures));
    out.extend(noise(result));
    out.extend(friction_findings(&result.friction));
    let rigid = clamped.iter().any(|c| c.fixture_motion.is_none());
    out.push(Finding::note(
        "clamped-errors",
        "measurements",
        if rigid {
            "A fixture that gives way makes joints seem softer, and friction of the gears makes them seem softer with \
             rising and stiffer with falling loads. Neither shows in an interval. Measure how the clamp moves, and \
             load up and down."
        } else {
            "Friction of the gears makes joints seem softer with rising and stiffer with falling loads, and does not \
             show in an interval. Load up and down."
        },
    ));
    out
}

/// Compliances that come out negative as a whole: the sign of the wrench.
fn sign(estimates: &Estimates) -> Option<Finding> {
    let faulty = |verdict: Verdict| verdict == Verdict::SignOrModelFault;
    let determined: Vec<_> = estimates.joints.iter().filter(|j| j.determined).collect();
    let negative = determined.iter().filter(|j| j.compliance < Some(0.0)).count();
    if !determined.iter().any(|j| faulty(j.verdict)) || 2 * negative <= determined.len() {
        return None;
    }
    Some(Finding::serious(
        "wrench-sign",
        "measurements",
        format!(
            "The compliance of {negative} of {} joints comes out negative: a sign or model fault. The wrench seems to \
             be that of the robot on the fixture, and the one of the fixture on the robot is needed. Check which way \
             the sensor counts (sensor.reports of the cell), and that the angles are loaded minus reference.",
            determined.len()
        ),
    ))
}

fn near_singular(clamped: &[ClampedPosture], closures: &[LoopClosure]) -> Option<Finding> {
    let mut names: Vec<&str> = clamped
        .iter()
        .zip(closures)
        .filter(|(_, closure)| closure.hidden > 0)
        .map(|(c, _)| c.posture.name.as_str())
        .collect();
    // The states of a posture need not stand together.
    names.sort_unstable();
    names.dedup();
    if names.is_empty() {
        return None;
    }
    let said = match names.len() {
        1 => format!("Posture {} is", names[0]),
        _ => format!("Postures {} are", list(&names)),
    };
    Some(Finding::caution(
        "near-singular",
        list(&names),
        format!(
            "{said} near a singularity: the flange does not hold all joints there, and what it does not hold is left \
             out."
        ),
    ))
}

fn noise(result: &ClampedIdentification) -> Option<Finding> {
    let (std, expected) = result.residual_std_rad.zip(result.expected_std_rad)?;
    let ratio = std / expected;
    // Scatter of a standard deviation estimated from this many degrees of freedom.
    let scatter = 3.0 / (2.0 * result.estimates.degrees_of_freedom as f64).sqrt();
    (ratio > MORE_THAN_NOISE.max(1.0 + scatter)).then(|| {
        Finding::caution(
            codes::RESIDUALS_ABOVE_NOISE,
            "measurements",
            format!(
                "The residuals are {ratio:.1} times the errors of the angles: friction, the fixture, the wrench or \
                 the model limit this result, not the reading of the angles."
            ),
        )
    })
}

fn friction_findings(friction: &[JointFriction]) -> Vec<Finding> {
    friction
        .iter()
        .filter_map(|f| {
            let torque = f.torque_nm?;
            (f.load_rms_nm > 0.0 && torque > FRICTION_SHARE * f.load_rms_nm).then(|| {
                Finding::caution(
                    "friction",
                    f.joint.clone(),
                    format!(
                        "{}: loads going up and down differ by ±{torque:.0} N·m, {:.0} % of its torque (RMS). Only \
                         the mean of both directions is free of it.",
                        f.joint,
                        100.0 * torque / f.load_rms_nm
                    ),
                )
            })
        })
        .collect()
}
