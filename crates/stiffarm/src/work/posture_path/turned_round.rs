//! Poses that nobody meant: a path that the arm cannot follow, and could with an axis the other way round.

use super::{Search, turned};
use crate::error::{Code, Error};
use crate::model::inverse::Outcome;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use std::f64::consts::{PI, TAU};

/// Points of the path that are looked at, spread over it.
const LOOKED_AT: usize = 40;
/// Turns about a free tool axis that are tried at each.
const TURNS: usize = 8;

/// What can be the other way round by half a turn about an axis of its frame.
struct HalfTurn {
    /// The tool, or else the workpiece.
    of_tool: bool,
    axis: fn() -> Vector3<f64>,
    hint: &'static str,
}

#[rustfmt::skip]
const HALF_TURNS: [HalfTurn; 4] = [
    HalfTurn { of_tool: true, axis: Vector3::x, hint: "with the tool axis of every pose the other way round it reaches \
        them: say which way z of the poses points, out of the tool or into it" },
    HalfTurn { of_tool: false, axis: Vector3::z, hint: "with the workpiece turned by 180° about its z it reaches them: \
        check the turn of the workpiece frame" },
    HalfTurn { of_tool: false, axis: Vector3::x, hint: "with the workpiece turned by 180° about its x it reaches them: \
        check which way z of the workpiece frame points" },
    HalfTurn { of_tool: false, axis: Vector3::y, hint: "with the workpiece turned by 180° about its y it reaches them: \
        check which way z of the workpiece frame points" },
];

/// `error` of a path through `poses`, whose turn about the tool axis is `free`, with what would make all of it
/// reachable.
pub(super) fn with_hint(search: &Search<'_>, poses: &[Isometry3<f64>], free: bool, error: Error) -> Error {
    if ![Code::Unreachable, Code::OutsideLimits].contains(&error.code()) {
        return error;
    }
    let workpiece = &search.options.workpiece;
    let is_placed = *workpiece != Isometry3::identity();
    let step = poses.len().div_ceil(LOOKED_AT).max(1);
    let looked_at = || poses.iter().step_by(step).chain(poses.last());
    // A point alone is a slip of that point.
    let missed = looked_at().filter(|pose| !is_reached(search, pose, free));
    if 2 * missed.count() < looked_at().count() {
        return error;
    }
    let reaches = |way: &&HalfTurn| {
        let half = UnitQuaternion::from_scaled_axis((way.axis)() * PI);
        let round = |pose: &Isometry3<f64>| match way.of_tool {
            true => pose * half,
            false => workpiece * half * workpiece.inverse() * pose,
        };
        (way.of_tool || is_placed) && looked_at().all(|pose| is_reached(search, &round(pose), free))
    };
    match HALF_TURNS.iter().find(reaches) {
        Some(way) => {
            let hint = error.hint_text().map(|hint| format!("{hint}; ")).unwrap_or_default();
            error.hint(format!("{hint}{}", way.hint))
        }
        None => error,
    }
}

/// Whether some posture within the limits has the tip there.
fn is_reached(search: &Search<'_>, tip: &Isometry3<f64>, free: bool) -> bool {
    let turns = if free { TURNS } else { 1 };
    (0..turns).any(|k| {
        let tip = turned(tip, TAU * k as f64 / TURNS as f64);
        match search.inverse.solve(&search.flange(&tip)) {
            Ok(Outcome::Reachable(branches)) => branches.iter().any(|branch| branch.within_limits),
            _ => false,
        }
    })
}
