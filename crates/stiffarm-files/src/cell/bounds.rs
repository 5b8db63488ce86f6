//! Bounds to start from.

use super::example::comment;
use stiffarm::findings::list;
use stiffarm::model::robot::{CatalogueEntry, Joint, Robot};
use stiffarm::units::rad_to_shortest_deg;

/// Bounds to start from \[deg\]: the paper's Table 1 for its robot, else the
/// machine's limits less [`BOUNDS_MARGIN_DEG`] within a quarter turn of joint 1 to each side (the box lies
/// in front of the robot) and half a turn of the others.
pub(super) fn start_bounds(entry: &CatalogueEntry, robot: &Robot) -> Vec<[f64; 2]> {
    if entry.key == "comau-nj165-3.0" {
        let table_1 = [[-90, 90], [-60, 40], [-180, -40], [-180, 180], [-90, 90], [-180, 180]];
        return table_1.map(|range| range.map(f64::from)).to_vec();
    }
    narrowed(robot)
}

/// The machine's limits, as [`start_bounds`] says.
pub(super) fn narrowed(robot: &Robot) -> Vec<[f64; 2]> {
    let joints = robot.joints().iter().enumerate();
    joints
        .map(|(j, joint)| {
            let [low, high] = joint.limits.map(rad_to_shortest_deg);
            let turn: f64 = if j == 0 { 90.0 } else { 180.0 };
            let inside = [(low + BOUNDS_MARGIN_DEG).max(-turn), (high - BOUNDS_MARGIN_DEG).min(turn)];
            // A joint may have its range elsewhere.
            if inside[0] < inside[1] { inside } else { [low, high] }
        })
        .collect()
}

/// What bounds to start from keep off the machine's limits \[deg\]: a posture on a limit may not be reached.
pub const BOUNDS_MARGIN_DEG: f64 = 1.0;

/// The joints of which bounds \[deg\] end [`BOUNDS_MARGIN_DEG`] before the machine's limits.
pub fn joints_kept_inside(robot: &Robot, bounds: &[[f64; 2]]) -> Vec<String> {
    let ends = |(joint, b): (&Joint, &[f64; 2])| {
        let limits = joint.limits.map(rad_to_shortest_deg);
        let has_margin = |i: usize| ((limits[i] - b[i]).abs() - BOUNDS_MARGIN_DEG).abs() < 1e-6;
        (has_margin(0) || has_margin(1)).then(|| joint.name.clone())
    };
    robot.joints().iter().zip(bounds).filter_map(ends).collect()
}

/// That in a comment, where there are any.
pub(super) fn margin_comment(robot: &Robot, bounds: &[[f64; 2]]) -> String {
    match joints_kept_inside(robot, bounds).as_slice() {
        [] => String::new(),
        joints => comment(&format!("They end {BOUNDS_MARGIN_DEG}° before the machine's limits of {}.", list(joints))),
    }
}

/// Their middles, in whole degrees where these are inside.
pub(super) fn middle(bounds: &[[f64; 2]]) -> Vec<f64> {
    let middles = bounds.iter().map(|[low, high]| {
        let middle = (low + high) / 2.0;
        Some(middle.round()).filter(|m| (low..=high).contains(&m)).unwrap_or(middle)
    });
    middles.collect()
}
