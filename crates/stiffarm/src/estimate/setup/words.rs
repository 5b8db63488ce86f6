//! What the readings ask of the set-up, in sentences.

use super::quantity::{Kind, Place, anchor, gravity, loading_point};
use super::{Freed, REJECTS};
use crate::findings::{Finding, length, list};
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::units::{m_to_mm, rad_to_deg};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Standard gravity \[m/s²\].
const GRAVITY: f64 = 9.806_65;
/// Standard errors of what is printed behind ±.
const COVERAGE: f64 = 2.0;

/// Stable name.
pub(super) fn name(kind: Kind) -> &'static str {
    match kind {
        Kind::Anchor(_) => "anchor",
        Kind::LoadingPoint(_) => "loading-point",
        Kind::Gravity => "gravity",
        Kind::Beside => "force-beside",
        Kind::Offset => "force-offset",
        Kind::Sign => "sign",
        Kind::SensorInBase => "sensor-in-base-axes",
        Kind::Points => "measuring-points",
        Kind::Shift => "common-shift",
        Kind::SensorAxes => "sensor-axes",
        Kind::SensorOrigin => "sensor-origin",
        Kind::TableAxes => "table-axes",
        Kind::Angle(_) => "joint-angle",
        Kind::Coupling => "coupling",
        Kind::Rows => "rows",
        Kind::LostMotion => "lost-motion",
    }
}

/// The key of the cell that states it, else what it is about.
fn key(cell: &Cell, kind: Kind) -> String {
    let of_load = |i: usize, key: &str| match cell.setup.load.cases().len() {
        0 => format!("load.{key}"),
        _ => format!("load.case[{i}].{key}"),
    };
    match kind {
        Kind::Anchor(i) => of_load(i, "anchor_mm"),
        Kind::LoadingPoint(None) => "tool.loading_point_mm".to_string(),
        Kind::LoadingPoint(Some(i)) => of_load(i, "loading_point_mm"),
        Kind::Gravity => "robot.down".to_string(),
        Kind::SensorAxes => "sensor.rpy_deg".to_string(),
        Kind::SensorOrigin => "sensor.xyz_mm".to_string(),
        Kind::Angle(_) | Kind::Coupling => "robot.theta_from_q".to_string(),
        Kind::Rows => format!("robot.dh_{}", cell.setup.robot.convention().name()),
        Kind::Points => "tool.measuring_point".to_string(),
        Kind::SensorInBase => "sensor".to_string(),
        Kind::Beside | Kind::Offset | Kind::Sign => "load".to_string(),
        Kind::Shift | Kind::TableAxes | Kind::LostMotion => "measurements".to_string(),
    }
}

/// What it is, as another explanation.
fn what(cell: &Cell, kind: Kind) -> String {
    match kind {
        Kind::Anchor(_) => format!("another anchor of the {}", cell.setup.load.line()),
        Kind::LoadingPoint(_) => "another loading point".to_string(),
        Kind::Gravity => "another direction of gravity".to_string(),
        Kind::Beside => "a constant force beside the load".to_string(),
        Kind::Offset => "a force along the load in every loaded state".to_string(),
        Kind::Sign => "the opposite sign of the load".to_string(),
        Kind::SensorInBase => "forces in base axes".to_string(),
        Kind::Points => "other places of the measuring points".to_string(),
        Kind::Shift => "a shift common to all loaded readings".to_string(),
        Kind::SensorAxes => "other axes of the sensor".to_string(),
        Kind::SensorOrigin => "another origin of the sensor".to_string(),
        Kind::TableAxes => "other axes of the table".to_string(),
        Kind::Angle(j) => format!("another count of {}", cell.setup.robot.joints()[j].name),
        Kind::Coupling => "axis 3 coupled to axis 2 in another way".to_string(),
        Kind::Rows => "rows of the other convention".to_string(),
        Kind::LostMotion => "lost motion in the joints".to_string(),
    }
}

/// What the cell states.
pub(super) fn stated(cell: &Cell, kind: Kind) -> Vec<f64> {
    let vector = |v: Vector3<f64>| v.iter().copied().collect();
    match kind {
        Kind::Anchor(i) => vector(anchor(cell, i)),
        Kind::LoadingPoint(_) => vector(loading_point(cell, kind)),
        Kind::Gravity => vector(down(cell)),
        Kind::Angle(_) | Kind::Coupling | Kind::Offset => vec![0.0],
        Kind::Sign => vec![1.0],
        Kind::SensorInBase | Kind::Rows => vec![0.0],
        Kind::Points => vec![0.0; 6],
        Kind::LostMotion => vec![0.0; cell.setup.robot.joint_count()],
        _ => vec![0.0; 3],
    }
}

fn down(cell: &Cell) -> Vector3<f64> {
    let direction = |load: &Load| match load {
        Load::Weight { direction, .. } => Some(*direction),
        _ => None,
    };
    let own = cell.setup.load.each().find_map(direction);
    own.unwrap_or(*cell.setup.robot.gravity_direction())
}

/// What the readings ask for.
pub(super) fn asked(cell: &Cell, kind: Kind, place: &Place) -> Vec<f64> {
    let vector = |v: Vector3<f64>| v.iter().copied().collect();
    match kind {
        Kind::Anchor(i) => vector(anchor(cell, i) + place.vector()),
        Kind::LoadingPoint(_) => vector(loading_point(cell, kind) + place.vector()),
        Kind::Gravity => vector(gravity(&down(cell), place)),
        Kind::SensorAxes | Kind::TableAxes => vector(turn_vector(&place.rotated())),
        Kind::Coupling | Kind::Sign | Kind::SensorInBase | Kind::Rows => vec![place.turn[(0, 0)]],
        Kind::Points => [
            vector(place.vector()),
            vector(turn_vector(&place.rotated())),
        ]
        .concat(),
        _ => place.values.iter().copied().collect(),
    }
}

/// Axis times angle of a turn, of a mirrored one that of its opposite.
fn turn_vector(turn: &Matrix3<f64>) -> Vector3<f64> {
    let proper = turn * turn.determinant().signum();
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(proper)).scaled_axis()
}

/// Axes as columns are named: `x is y, y is −x`, where they are exchanged or flipped, else the turn.
fn axes(turn: &Matrix3<f64>) -> String {
    const NAMES: [&str; 3] = ["x", "y", "z"];
    let nearest = turn.map(f64::round);
    let is_exchange =
        (turn - nearest).norm() < 0.05 && (nearest.determinant().abs() - 1.0).abs() < 1e-9;
    if !is_exchange || nearest == Matrix3::identity() {
        let axis = turn_vector(turn);
        let unit = axis.try_normalize(1e-12).unwrap_or_default();
        return format!(
            "turned by {:.1}° about ({:.2}, {:.2}, {:.2}){}",
            rad_to_deg(axis.norm()),
            unit.x,
            unit.y,
            unit.z,
            if turn.determinant() < 0.0 {
                " and mirrored"
            } else {
                ""
            }
        );
    }
    let mut out = Vec::new();
    for i in 0..3 {
        let j = (0..3).find(|j| nearest[(i, *j)] != 0.0).unwrap_or(i);
        if nearest[(i, j)] != 1.0 || i != j {
            let sign = if nearest[(i, j)] < 0.0 { "−" } else { "" };
            out.push(format!("{} is {sign}{}", NAMES[i], NAMES[j]));
        }
    }
    list(&out)
}

/// Millimetres in brackets, with the digits that the errors allow.
fn place_mm(values: &[f64], errors: &[f64]) -> String {
    let largest = errors.iter().copied().fold(0.0, f64::max) * COVERAGE;
    let digits = if largest < 1e-4 {
        2
    } else {
        usize::from(largest < 2e-3)
    };
    let one = |v: &f64| format!("{:.digits$}", m_to_mm(*v) + 0.0);
    let all: Vec<String> = values.iter().map(one).collect();
    match largest {
        l if l.is_finite() && l > 0.0 => {
            format!("({}) ± {:.digits$} mm", all.join(", "), m_to_mm(l))
        }
        _ => format!("({}) mm", all.join(", ")),
    }
}

fn bare_mm(values: &[f64]) -> String {
    let all: Vec<String> = values
        .iter()
        .map(|v| format!("{:.0}", m_to_mm(*v) + 0.0))
        .collect();
    format!("({})", all.join(", "))
}

/// The finding about the quantity that explains most.
pub(super) fn finding(
    cell: &Cell,
    kind: Kind,
    place: &Place,
    own: &Freed,
    alike: &[Kind],
) -> Finding {
    let key = key(cell, kind);
    let errors: Vec<f64> = own
        .standard_error
        .iter()
        .map(|e| e.unwrap_or(0.0))
        .collect();
    let (asked, errors) = (&own.asked, &errors);
    let (wanted, remedy) = match kind {
        Kind::Anchor(_) => (
            format!(
                "The readings ask for the anchor at {}; {key} has {}",
                place_mm(asked, errors),
                bare_mm(&own.stated)
            ),
            "Measure the rope's fixed end with the tracker (where a pulley deflects it: the point where it leaves the pulley)",
        ),
        Kind::LoadingPoint(_) => (
            format!(
                "The readings ask for the loading point at {} in flange axes; {key} has {}{}",
                place_mm(asked, errors),
                bare_mm(&own.stated),
                known_point(cell, asked, errors)
            ),
            "Measure where the load acts on the tool",
        ),
        Kind::Gravity => (
            format!(
                "The readings ask for gravity along ({:.3}, {:.3}, {:.3}) in base axes; {key} has ({:.3}, {:.3}, {:.3})",
                asked[0] + 0.0,
                asked[1] + 0.0,
                asked[2] + 0.0,
                own.stated[0],
                own.stated[1],
                own.stated[2]
            ),
            "Give the direction of gravity as the base stands",
        ),
        Kind::Beside => {
            let force = place.vector();
            let vertical = force.dot(cell.setup.robot.gravity_direction());
            let mass = if vertical > 0.9 * force.norm() {
                format!(", the weight of {:.1} kg", vertical / GRAVITY)
            } else {
                String::new()
            };
            let error = errors.iter().copied().fold(0.0, f64::max) * COVERAGE;
            (
                format!(
                    "The readings ask for a constant force beside the load, ({:.1}, {:.1}, {:.1}) ± {error:.1} N in base axes{mass}",
                    force.x + 0.0,
                    force.y + 0.0,
                    force.z + 0.0
                ),
                "Weigh what hangs on the rope (hook, shackle, load cell), or take differences against a preload that has it too",
            )
        }
        Kind::Shift => (
            format!(
                "The readings ask for a shift common to all loaded readings, {}",
                place_mm(asked, errors)
            ),
            "The tracker, its stand or the base moved between the unloaded and the loaded readings: read each posture unloaded, loaded and unloaded again",
        ),
        Kind::Offset => (
            format!(
                "The readings ask for {:+.0} ± {:.0} N along the load in every loaded state",
                asked[0],
                COVERAGE * errors[0]
            ),
            "The rope was not slack in the unloaded readings, or the load cell does not read zero without load",
        ),
        Kind::Sign => (
            "The points move against the stated load: the readings ask for its opposite sign"
                .to_string(),
            match cell.sensor {
                Some(_) => {
                    "Look up whether the sensor reports the force on the robot or by it (sensor.reports); a displacement is the loaded position less the unloaded one"
                }
                None => {
                    "Check the direction of the load; a displacement is the loaded position less the unloaded one"
                }
            },
        ),
        Kind::SensorInBase => (
            "The readings ask for forces that are given in base axes, not in those of the sensor"
                .to_string(),
            "Take [sensor] out of the cell, or export the sensor's own axes",
        ),
        Kind::Points => (
            format!(
                "The readings ask for measuring points moved by {} in flange axes and {}",
                place_mm(&asked[..3], &errors[..3]),
                axes(&place.rotated())
            ),
            "Check the origin and the axes in which tool.measuring_point is given: those of the flange",
        ),
        Kind::SensorAxes => (
            format!(
                "The readings ask for the sensor's axes {}",
                axes(&place.rotated())
            ),
            "Check how the sensor sits on the flange, and which way its axes point",
        ),
        Kind::SensorOrigin => (
            format!(
                "The readings ask for the sensor's origin {} from where {key} has it, in flange axes",
                place_mm(asked, errors)
            ),
            "Look up to which point the sensor refers its moments",
        ),
        Kind::TableAxes => (
            format!(
                "The readings ask for other axes of the table of displacements: {}",
                axes(&place.rotated())
            ),
            "Check in which axes the displacements were exported; they must be those of the base",
        ),
        Kind::Angle(j) => {
            let joint = &cell.setup.robot.joints()[j].name;
            let offset = rad_to_deg(place.values[0]);
            let offset = (offset + 180.0).rem_euclid(360.0) - 180.0;
            let sign = place.turn[(0, 0)] < 0.0;
            let error = COVERAGE * rad_to_deg(errors[0]);
            let off = format!("off by {offset:.1}° ± {error:.1}°");
            let said = match (sign, offset.abs() < 0.5) {
                (true, true) => "turning the other way".to_string(),
                (true, false) => format!("turning the other way and {off}"),
                (false, _) => off,
            };
            (
                format!("The readings ask for {joint} {said}"),
                "Check robot.theta_from_q and the offsets of robot.dh against the pendant",
            )
        }
        Kind::Coupling => (
            format!(
                "The readings ask for axis 3 that counts {:+.0} times axis 2",
                place.turn[(0, 0)]
            ),
            "Check robot.theta_from_q against the pendant",
        ),
        Kind::Rows => (
            format!(
                "The readings ask for {} rows; the cell has them as {key}",
                cell.setup.robot.convention().other().name()
            ),
            "Name the rows of the robot by their convention",
        ),
        Kind::LostMotion => {
            let most = asked.iter().copied().fold(0.0, f64::max);
            (
                format!(
                    "The readings ask for lost motion in the joints, up to {:.2} arc-minutes",
                    60.0 * rad_to_deg(most)
                ),
                "Take differences against a light preload",
            )
        }
    };
    let names: Vec<String> = alike.iter().map(|other| what(cell, *other)).collect();
    let others = match names.as_slice() {
        [] => String::new(),
        names => format!(
            " As well explained by {}.",
            list(names).replace(" and ", " or ")
        ),
    };
    let [before, after] = own.residual_rms_m.map(length);
    let fits = match kind {
        Kind::Sign => "With that no joint yields against its torque.".to_string(),
        _ => format!("With that the joint axes alone leave {after} instead of {before} (RMS)."),
    };
    let sentence = format!("{wanted}. {fits}{others} {remedy}");
    match kind {
        // No error of the set-up: it is measured around.
        Kind::LostMotion => Finding::caution("lost-motion-seen", key, sentence + "."),
        _ => Finding::serious(
            REJECTS,
            key,
            sentence + "; until then no stiffness is known.",
        ),
    }
}

/// A point of the tool that lies where the readings want the loading point.
fn known_point(cell: &Cell, asked: &[f64], errors: &[f64]) -> String {
    let at = Vector3::from_column_slice(asked);
    let within = 3.0 * Vector3::from_column_slice(errors).norm();
    let points = cell.setup.tool.measuring_points.iter();
    let near = points.filter(|point| (point.position - at).norm() < within.max(2e-3));
    let nearest = near.min_by(|a, b| {
        (a.position - at)
            .norm()
            .total_cmp(&(b.position - at).norm())
    });
    nearest.map_or_else(String::new, |point| {
        format!(" (measuring point {} lies there)", point.name)
    })
}
