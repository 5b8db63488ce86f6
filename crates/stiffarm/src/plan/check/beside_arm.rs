//! What stands in a cell beside the arm: sizes, places and angles that no cell has, which are metres typed as
//! millimetres, radians as degrees, or points in the axes of another frame.

use super::FARTHEST_IN_CELL;
use crate::findings::{Finding, Severity};
use crate::model::cell::Cell;
use crate::model::robot::Robot;
use crate::model::scene::{Carrier, Part};
use crate::model::shape::Solid;
use crate::units::{m_to_mm, rad_to_deg};
use nalgebra::UnitQuaternion;
use std::f64::consts::PI;

/// A shape that is no longer is none \[m\].
const SHORTEST_SHAPE: f64 = 5e-3;
/// Nor one that is thinner \[m\].
const THINNEST_SHAPE: f64 = 1e-3;
/// What stands nearer to the base's origin stands inside the robot \[m\].
const NEAREST_TO_BASE: f64 = 10e-3;
/// A plane whose distance is not zero is known to no better \[m\].
const PLANE: f64 = 1e-3;
/// No robot drives so exactly past anything \[m\].
const CLEARANCE: f64 = 0.5e-3;
/// Heights of a limit that are not zero are farther from it \[m\].
const HEIGHT: f64 = 3e-3;
/// Tools reach so far on the smallest arms \[m\].
const TOOL: f64 = 0.5;
/// A full turn and half a radian: angles between them may be radians \[both read as deg\].
const LIKE_RADIANS: [f64; 2] = [0.5, 2.0 * PI];
/// Bounds beyond this let a posture lie elsewhere than near zero \[deg\].
const WIDE_BOUNDS: f64 = 30.0;
/// Angles are typed in steps of this, if they are degrees \[deg\].
const STEP: f64 = 0.5;
/// Angles about a workpiece are often multiples of 15°, as radians \[rad\].
const FRACTION: f64 = PI / 12.0;

/// A length with the range of what is plausible.
struct Length {
    key: String,
    what: String,
    metres: f64,
    range: [f64; 2],
    severity: Severity,
}

/// Every length beside the arm that is looked at; one of zero is none.
fn lengths(cell: &Cell) -> Vec<Length> {
    let mut out = Vec::new();
    let mut add = |severity, key: String, what: String, metres: f64, range: [f64; 2]| {
        out.push(Length { key, what, metres, range, severity });
    };
    for part in cell.scene.parts() {
        let key = key_of(part);
        for solid in &part.solids {
            let Some([least, most]) = dimensions(solid) else {
                continue;
            };
            let serious = Severity::Serious;
            let what = |size: &str| format!("The {size} side of {}", part.name);
            add(serious, key.clone(), what("longest"), most, [SHORTEST_SHAPE, FARTHEST_IN_CELL]);
            // Meshes are covered by many solids, some of them thin.
            if most >= SHORTEST_SHAPE && (part.solids.len() == 1 || is_link(part)) {
                add(serious, key.clone(), what("shortest"), least, [THINNEST_SHAPE, FARTHEST_IN_CELL]);
            }
        }
        if part.carrier == Carrier::World && part.name != "base" {
            let range = |solid: &Solid| match solid {
                Solid::HalfSpace { .. } => [PLANE, FARTHEST_IN_CELL],
                _ => [NEAREST_TO_BASE, FARTHEST_IN_CELL],
            };
            for solid in part.solids.iter().take(1) {
                let what = format!("{}, by its middle from the base's origin,", part.name);
                add(Severity::Caution, key.clone(), what, distance(solid), range(solid));
            }
        }
    }
    let caution = Severity::Caution;
    for station in cell.scene.sight().iter().flat_map(|sight| &sight.stations) {
        let key = format!("tracker.station \"{}\"", station.name);
        let what = format!("The tracker station {} from the base's origin", station.name);
        add(caution, key, what, station.position.norm(), [NEAREST_TO_BASE, FARTHEST_IN_CELL]);
    }
    let rope = cell.scene.rope().and_then(|rope| rope.clearance);
    let sight = cell.scene.sight().map(|sight| sight.clearance);
    for (key, clearance) in [("shapes_mm", Some(cell.scene.clearance())), ("rope_mm", rope), ("sight_mm", sight)] {
        let clearance = clearance.unwrap_or(0.0);
        let what = "The clearance".to_string();
        add(caution, format!("clearance.{key}"), what, clearance, [CLEARANCE, FARTHEST_IN_CELL]);
    }
    for (key, height) in [("floor_mm", cell.limits.floor), ("wrist_height_mm", cell.limits.wrist_height)] {
        let what = "The height".to_string();
        let height = height.map_or(0.0, f64::abs);
        add(caution, format!("limits.{key}"), what, height, [HEIGHT, FARTHEST_IN_CELL]);
    }
    out
}

/// What of sizes, places and angles beside the arm can hardly be meant.
pub(super) fn check(cell: &Cell, findings: &mut Vec<Finding>) {
    let mut add = |severity, key: &str, sentence: String| {
        findings.push(Finding::new("suspicious-unit", severity, key, sentence));
    };
    for length in lengths(cell) {
        let [least, most] = length.range;
        let size = m_to_mm(length.metres);
        if length.metres > 0.0 && length.metres < least {
            let sentence = format!("{} is {size:.3} mm: is it in metres? The unit is mm.", length.what);
            add(length.severity, &length.key, sentence);
        } else if length.metres > most {
            let sentence = format!("{} is {:.0} m: is it in mm, with the point left out?", length.what, length.metres);
            add(length.severity, &length.key, sentence);
        }
    }
    let widest = cell.bounds.iter().flatten().map(|b| rad_to_deg(b.abs()));
    if widest.fold(0.0, f64::max) > WIDE_BOUNDS {
        for (key, what, q) in postures(cell) {
            if is_like_radians(q) {
                let sentence = format!(
                    "All angles of {what} lie within {:.0}° of zero, and the bounds do not: are they in radians? The \
                     unit is degrees.",
                    LIKE_RADIANS[1].ceil()
                );
                add(Severity::Caution, &key, sentence);
            }
        }
    }
    let tip = cell.work.tip.map(|tip| tip.rotation);
    let turns = [("work.workpiece_rpy_deg", Some(cell.work.workpiece.rotation)), ("work.tip_rpy_deg", tip)];
    for (key, rotation) in turns {
        if let Some(radians) = rotation.and_then(|rotation| turned_by_radians(&rotation)) {
            let sentence = format!(
                "An angle is {radians:.4}°, which is {:.0}° in radians: the unit is degrees.",
                rad_to_deg(radians)
            );
            add(Severity::Caution, key, sentence);
        }
    }
}

/// How far tools reach from the flange of this arm at most \[m\]: no farther than its longest link.
pub(super) fn longest_tool(robot: &Robot) -> f64 {
    let links = robot.joints().iter();
    let links = links.map(|joint| joint.placement.translation.vector.norm());
    links.fold(TOOL, f64::max)
}

/// The table of the cell file that a part is given in.
fn key_of(part: &Part) -> String {
    let table = match part.carrier {
        _ if is_link(part) => "robot.shape",
        Carrier::World => "obstacle",
        _ => "tool.shape",
    };
    format!("{table} \"{}\"", part.name)
}

fn is_link(part: &Part) -> bool {
    matches!(part.carrier, Carrier::Link(_)) || part.name == "base"
}

/// The smallest and the largest of its sides \[m\]; `None` for what fills half of space.
fn dimensions(solid: &Solid) -> Option<[f64; 2]> {
    let [a, b] = match solid {
        Solid::Capsule(capsule) => {
            let width = 2.0 * capsule.radius;
            // A sphere has no other size.
            return Some([capsule.radius, width + (capsule.b - capsule.a).norm()]);
        }
        Solid::Block { half, .. } => [2.0 * half.min(), 2.0 * half.max()],
        Solid::Cylinder { half_length, radius, .. } => {
            let (length, width) = (2.0 * half_length, 2.0 * radius);
            [radius.min(length), width.max(length)]
        }
        Solid::HalfSpace { .. } => return None,
    };
    Some([a, b])
}

/// Distance of its middle, or of its plane, from the origin \[m\].
fn distance(solid: &Solid) -> f64 {
    match solid {
        Solid::Capsule(capsule) => (0.5 * (capsule.a + capsule.b)).norm(),
        Solid::Block { pose, .. } | Solid::Cylinder { pose, .. } => pose.translation.vector.norm(),
        Solid::HalfSpace { point, normal } => point.dot(normal).abs(),
    }
}

/// The postures that the cell gives, each with its key and its name.
fn postures(cell: &Cell) -> Vec<(String, String, &[f64])> {
    let start = cell.route.start.iter();
    let start = start.map(|q| ("route.start_deg".into(), "the start".into(), q.as_slice()));
    let validation = cell.validation.iter().map(|posture| {
        let what = format!("validation posture {}", posture.name);
        ("validation.posture".into(), what, posture.q.as_slice())
    });
    let tasks = cell.tasks.iter().enumerate().map(|(t, task)| {
        let what = format!("task {}", task.name);
        (format!("task[{}].q_deg", t + 1), what, task.q.as_slice())
    });
    start.chain(validation).chain(tasks).collect()
}

/// Whether angles \[rad\] were typed as radians and taken for degrees: small, and no multiples of half a degree.
fn is_like_radians(q: &[f64]) -> bool {
    let degrees = || q.iter().map(|angle| rad_to_deg(angle.abs()));
    let largest = degrees().fold(0.0, f64::max);
    let is_typed = |degrees: f64| (degrees / STEP - (degrees / STEP).round()).abs() < 1e-6;
    let [least, most] = LIKE_RADIANS;
    (least..=most).contains(&largest) && !degrees().all(is_typed)
}

/// An angle of a rotation, in degrees, that is a multiple of 15° in radians; every other angle must be small, too.
fn turned_by_radians(rotation: &UnitQuaternion<f64>) -> Option<f64> {
    let (roll, pitch, yaw) = rotation.euler_angles();
    let angles = [roll, pitch, yaw].map(|angle| rad_to_deg(angle.abs()));
    if angles.iter().any(|angle| *angle > LIKE_RADIANS[1]) {
        return None;
    }
    let is_fraction = |angle: &f64| {
        let times = (angle / FRACTION).round();
        times > 0.0 && (angle - times * FRACTION).abs() < 1e-3
    };
    angles.into_iter().find(is_fraction)
}
