//! Whether the measured wrench can be that of the load: does its moment belong
//! to a force through the loading point, and does its force point along the rope?

use super::messages::{length, median, postures};
use crate::findings::{Finding, Severity, codes, each_once};
use crate::model::cell::Cell;
use crate::model::instruments::{Mount, Sensor};
use crate::model::kinematics::Frames;
use crate::model::load::{Load, Wrench};
use crate::model::measurement::{MeasuredPosture, WrenchColumns};
use crate::numerics::information::{Svd, svd};
use crate::units::STANDARD_GRAVITY;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};

/// Offsets of the application point are named above so many standard errors …
const STANDARD_ERRORS: f64 = 3.0;
/// … and above this length \[m\].
const OFFSET: f64 = 2e-3;
/// Moments that no point explains are named above this arm \[m\].
const UNEXPLAINED_ARM: f64 = 5e-3;
/// Forces count as parallel below this ratio of singular values.
const PARALLEL_FORCES: f64 = 1e-3;
/// Median angle between measured and expected force that is named \[rad\].
const TURNED: f64 = 0.035;
/// Angle of a single state that is named beside a good median \[rad\].
const ODD_STATE: f64 = 0.09;
/// Magnitudes further than this from the expected ones are named.
const MAGNITUDE: f64 = 0.05;

/// Where the measured force acts by its own moment: least squares for r in
/// M = r × F over all postures and states, flange axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ApplicationPoint {
    /// That point minus the stated loading point, flange axes \[m\].
    pub offset_m: [f64; 3],
    /// Length of the offset \[m\].
    pub distance_m: f64,
    /// Standard error of that length by the moments that remain \[m\]; `None`
    /// without degrees of freedom.
    pub distance_standard_error_m: Option<f64>,
    /// False where all forces are parallel in flange axes: the offset along them is
    /// not determined and taken as zero.
    pub determined: bool,
    /// RMS of the moments about the stated loading point \[N·m\].
    pub moment_rms_nm: f64,
    /// RMS of the moments about the point found \[N·m\].
    pub residual_moment_rms_nm: f64,
    /// RMS of the forces \[N\].
    pub force_rms_n: f64,
}

/// Measured against expected force of one state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForceDirection {
    /// Posture.
    pub posture: String,
    /// Load state.
    pub state: String,
    /// Angle between measured force and rope, cylinder or gravity \[rad\].
    pub angle_rad: f64,
    /// Measured over expected magnitude, where the table or the cell gives it for
    /// this state.
    pub magnitude_ratio: Option<f64>,
}

/// Consistency of the measured wrenches.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WrenchCheck {
    /// Where the force acts, where moments were read and the load is a rope, a
    /// weight or measured.
    pub application_point: Option<ApplicationPoint>,
    /// Directions, where the cell has a rope or weight.
    pub directions: Vec<ForceDirection>,
    /// The axis of the sensor with which counted the other way the forces point along the load, where they do not as
    /// they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mirrored_axis: Option<String>,
}

/// Checks the measured wrenches; `expected` has the force the rope or weight has
/// in each state of `measured`, loaded minus reference, where known \[N\].
/// `None` where nothing was measured.
pub(super) fn wrench_check(
    cell: &Cell,
    columns: WrenchColumns,
    measured: &[MeasuredPosture],
    expected: &[Option<f64>],
) -> Option<WrenchCheck> {
    if columns == WrenchColumns::None {
        return None;
    }
    let robot = &cell.setup.robot;
    let loads: Vec<(Frames, Wrench)> =
        measured.iter().filter_map(|m| Some((Frames::new(robot, &m.posture.q), m.wrench?))).collect();
    // Loads at points of their own have moments about the tool's loading point.
    let pure = |load: &Load| !matches!(load, Load::Constant { .. });
    let cases = cell.setup.load.cases();
    let pure_force = cell.setup.load.each().all(pure) && cases.iter().all(|case| case.loading_point.is_none());
    let directions = directions(cell, measured, expected, None);
    let mirrored_axis = mirrored(cell, measured, expected, &directions);
    Some(WrenchCheck {
        mirrored_axis: mirrored_axis.map(|axis| ["x", "y", "z"][axis].to_string()),
        application_point: if pure_force && columns == WrenchColumns::ForceAndMoment {
            application_point(&loads)
        } else {
            None
        },
        directions,
    })
}

/// The axis of the sensor with whose sign changed the forces point along the load, where they do not as they are.
fn mirrored(
    cell: &Cell,
    measured: &[MeasuredPosture],
    expected: &[Option<f64>],
    as_they_are: &[ForceDirection],
) -> Option<usize> {
    let typical = |directions: &[ForceDirection]| {
        let angles: Vec<f64> = directions.iter().map(|d| d.angle_rad).collect();
        (!angles.is_empty()).then(|| median(&angles))
    };
    // A sensor that is said to be mirrored, and one whose forces are right.
    let sensor = cell.sensor.as_ref().filter(|s| s.mirrored.is_none())?;
    typical(as_they_are).filter(|angle| *angle > TURNED)?;
    let with = |axis: usize| {
        let with = Sensor { mirrored: Some(axis), ..sensor.clone() };
        typical(&directions(cell, measured, expected, Some(&with)))
    };
    (0..3).find(|axis| with(*axis).is_some_and(|angle| angle < TURNED))
}

fn application_point(loads: &[(Frames, Wrench)]) -> Option<ApplicationPoint> {
    let rows = 3 * loads.len();
    let mut arms = DMatrix::zeros(rows, 3);
    let mut moments = DVector::zeros(rows);
    let mut squares = 0.0;
    for (i, (frames, wrench)) in loads.iter().enumerate() {
        let rotation = frames.flange().rotation;
        let force = rotation.inverse_transform_vector(&wrench.force);
        squares += force.norm_squared();
        // M = r × F = −F × r.
        arms.fixed_view_mut::<3, 3>(3 * i, 0).copy_from(&-force.cross_matrix());
        let moment = rotation.inverse_transform_vector(&wrench.moment);
        moments.fixed_rows_mut::<3>(3 * i).copy_from(&moment);
    }
    if squares <= 0.0 {
        return None;
    }
    let Svd { u, values, v } = svd(arms.clone())?;
    let rank = values.iter().filter(|s| **s > PARALLEL_FORCES * values[0]).count();
    let mut offset = DVector::zeros(3);
    let mut inverse = DMatrix::zeros(3, 3);
    for k in 0..rank {
        let right = v.column(k);
        offset += right * (u.column(k).dot(&moments) / values[k]);
        inverse += right * right.transpose() / values[k].powi(2);
    }
    let remaining = &moments - arms * &offset;
    let freedom = rows - rank;
    let distance = offset.norm();
    let along = if distance > 0.0 { &offset / distance } else { DVector::zeros(3) };
    let variance = remaining.norm_squared() / freedom.max(1) as f64;
    let count = loads.len() as f64;
    Some(ApplicationPoint {
        offset_m: [offset[0], offset[1], offset[2]],
        distance_m: distance,
        distance_standard_error_m: (freedom > 0).then(|| (variance * along.dot(&(inverse * &along))).sqrt()),
        determined: rank == 3,
        moment_rms_nm: (moments.norm_squared() / count).sqrt(),
        residual_moment_rms_nm: (remaining.norm_squared() / count).sqrt(),
        force_rms_n: (squares / count).sqrt(),
    })
}

fn directions(
    cell: &Cell,
    measured: &[MeasuredPosture],
    expected: &[Option<f64>],
    mirrored: Option<&Sensor>,
) -> Vec<ForceDirection> {
    let direction = |(m, expected): (&MeasuredPosture, &Option<f64>)| {
        let mut force = m.wrench?.force;
        let setup = cell.setup.of_state(&m.state).ok()?;
        if !matches!(setup.load, Load::Rope { .. } | Load::Weight { .. }) {
            return None;
        }
        let frames = Frames::new(&setup.robot, &m.posture.q);
        if let Some(sensor) = mirrored {
            // Into the axes of the sensor, and as they count with the mirrored one.
            let turn = match sensor.mount {
                Mount::Flange => frames.flange().rotation * sensor.pose.rotation,
                Mount::Base => sensor.pose.rotation,
            };
            force = turn * sensor.right_handed(turn.inverse_transform_vector(&force));
        }
        let at = frames.point(&setup.tool.loading_point);
        let along = setup.load.wrench(&frames, &at)?.force;
        // The angle between vectors, also where it is tiny.
        let angle = force.cross(&along).norm().atan2(force.dot(&along));
        Some(ForceDirection {
            posture: m.posture.name.clone(),
            state: m.state.clone(),
            angle_rad: angle,
            magnitude_ratio: expected.filter(|f| *f > 0.0).map(|f| force.norm() / f),
        })
    };
    measured.iter().zip(expected).filter_map(direction).collect()
}

/// What the check says in sentences.
pub(super) fn findings(cell: &Cell, check: &WrenchCheck) -> Vec<Finding> {
    let mut out = Vec::new();
    direction_findings(cell, check, &mut out);
    // A turned sensor moves the point too: the cause first.
    let directed = out.iter().all(|f| f.code == codes::FORCE_MAGNITUDE);
    if let (Some(point), true) = (&check.application_point, directed) {
        point_findings(cell, point, &mut out);
    }
    out
}

fn direction_findings(cell: &Cell, check: &WrenchCheck, out: &mut Vec<Finding>) {
    let directions = check.directions.as_slice();
    if directions.is_empty() {
        return;
    }
    let what = match cell.setup.load {
        Load::Weight { .. } => "gravity",
        Load::Cases(_) => "the loads of the cell",
        _ if cell.setup.load.line() == "cylinder" => "the cylinder's push",
        _ => "the rope",
    };
    let angles: Vec<f64> = directions.iter().map(|d| d.angle_rad).collect();
    let typical = median(&angles);
    let (subject, cure) = match cell.sensor {
        Some(_) => (
            "sensor.reports",
            "The force is reported by the robot, not on it, or the sensor's sign is wrong: set sensor.reports.",
        ),
        None => {
            ("measurements", "The table has the force by the robot, not on it: change the signs of forces and moments.")
        }
    };
    if typical > 0.8 * PI {
        out.push(Finding::serious(
            "force-sign",
            subject,
            format!(
                "The measured forces point away from {what}, by {:.0}° in the median. {cure}",
                typical.to_degrees()
            ),
        ));
        return;
    }
    if typical > TURNED {
        let severity = if typical > 0.3 { Severity::Serious } else { Severity::Caution };
        out.push(Finding::new(
            "force-direction",
            severity,
            if cell.sensor.is_some() { "sensor" } else { "measurements" },
            format!(
                "The measured forces differ from the direction of {what} by {:.1}° in the median. {}",
                typical.to_degrees(),
                match &check.mirrored_axis {
                    Some(axis) => format!(
                        "With {axis} of the sensor counted the other way they point along it: its axes are left-handed \
                         (set sensor.mirrored_axis = \"{axis}\"), or it is turned by half a turn."
                    ),
                    None if cell.sensor.is_none() =>
                        "Check how the sensor is turned, and the anchor or the direction of \
                                                      gravity."
                            .to_string(),
                    None => "Check how the sensor is turned, whether its axes are left-handed (sensor.mirrored_axis), \
                             and the anchor or the direction of gravity."
                        .to_string(),
                }
            ),
        ));
    } else {
        let odd: Vec<&ForceDirection> = directions.iter().filter(|d| d.angle_rad > ODD_STATE).collect();
        for state in odd {
            let severity = if state.angle_rad > FRAC_PI_2 { Severity::Serious } else { Severity::Caution };
            out.push(Finding::new(
                "force-direction",
                severity,
                state.posture.as_str(),
                format!(
                    "In posture {}, state {}, the measured force differs from the direction of {what} by {:.1}°, in \
                     the others by {:.1}° in the median.",
                    state.posture,
                    state.state,
                    state.angle_rad.to_degrees(),
                    typical.to_degrees()
                ),
            ));
        }
    }
    magnitude_findings(directions, out);
}

fn magnitude_findings(directions: &[ForceDirection], out: &mut Vec<Finding>) {
    let compared: Vec<&ForceDirection> = directions.iter().filter(|d| d.magnitude_ratio.is_some()).collect();
    let ratios: Vec<f64> = compared.iter().filter_map(|d| d.magnitude_ratio).collect();
    if ratios.is_empty() {
        return;
    }
    let typical = median(&ratios);
    let off = |ratio: f64| (ratio - 1.0).abs() > MAGNITUDE;
    if off(typical) {
        let units = [
            (1.0 / STANDARD_GRAVITY, "in kilograms"),
            (1.0 / 4.44822, "in pounds"),
            (1e-3, "in kilonewtons"),
            (1e3, "in millinewtons"),
        ];
        let unit = units.iter().find(|(factor, _)| !off(typical / factor));
        let severity = if typical > 0.5 && typical < 2.0 { Severity::Caution } else { Severity::Serious };
        out.push(Finding::new(
            codes::FORCE_MAGNITUDE,
            severity,
            "load",
            format!(
                "The measured forces are {typical:.3} times those the load should have{}",
                unit.map_or(".".to_string(), |(_, unit)| format!(": are they {unit}?"))
            ),
        ));
        return;
    }
    let odd: Vec<&str> = compared
        .iter()
        .filter(|d| d.magnitude_ratio.is_some_and(|r| off(r / typical)))
        .map(|d| d.posture.as_str())
        .collect();
    let odd = each_once(&odd);
    if !odd.is_empty() {
        out.push(Finding::caution(
            codes::FORCE_MAGNITUDE,
            odd.join(", "),
            format!(
                "In {} the measured force differs from that of the load by more than {:.0} %.",
                postures(&odd),
                MAGNITUDE * 100.0
            ),
        ));
    }
}

fn point_findings(cell: &Cell, point: &ApplicationPoint, out: &mut Vec<Finding>) {
    let [x, y, z] = point.offset_m.map(|v| v * 1e3 + 0.0);
    let error = point.distance_standard_error_m;
    if point.distance_m > OFFSET && error.is_some_and(|e| point.distance_m > STANDARD_ERRORS * e) {
        let open = if point.determined {
            ""
        } else {
            " (along the forces, which are parallel in flange axes, nothing can be said)"
        };
        let also = if cell.sensor.is_some() { ", or the sensor's origin" } else { "" };
        out.push(Finding::caution(
            codes::LOADING_POINT,
            "tool.loading_point_mm",
            format!(
                "By its moment the measured force acts {} ± {} (standard error) beside the stated loading point, \
                 at [{x:.1}, {y:.1}, {z:.1}] mm from it in flange axes{open}. Check tool.loading_point_mm{also}.",
                length(point.distance_m),
                length(error.unwrap_or_default())
            ),
        ));
    }
    let arm = point.residual_moment_rms_nm / point.force_rms_n;
    if arm > UNEXPLAINED_ARM {
        out.push(Finding::caution(
            codes::UNEXPLAINED_MOMENT,
            "load",
            format!(
                "Moments of {:.1} N·m (RMS) remain that no loading point explains, {} of arm at {:.0} N: the load is \
                 not a pure force, or the sensor's axes are not as stated.",
                point.residual_moment_rms_nm,
                length(arm),
                point.force_rms_n
            ),
        ));
    }
}
