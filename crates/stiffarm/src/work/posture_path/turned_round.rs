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

/// What can be the other way round: of the tool, or of the workpiece, by half a turn about this axis of its frame.
const WAYS: [(bool, fn() -> Vector3<f64>, &str); 4] = [
    (
        true,
        Vector3::x,
        "with the tool axis of every pose the other way round it reaches them: say which way z of the poses points, out \
         of the tool or into it",
    ),
    (
        false,
        Vector3::z,
        "with the workpiece turned by 180° about its z it reaches them: check the turn of the workpiece frame",
    ),
    (
        false,
        Vector3::x,
        "with the workpiece turned by 180° about its x it reaches them: check which way z of the workpiece frame points",
    ),
    (
        false,
        Vector3::y,
        "with the workpiece turned by 180° about its y it reaches them: check which way z of the workpiece frame points",
    ),
];

/// `error` of a path through `poses`, whose turn about the tool axis is `free`, with what would make all of it reachable.
pub(super) fn told(
    search: &Search<'_>,
    poses: &[Isometry3<f64>],
    free: bool,
    error: Error,
) -> Error {
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
    let reaches = |(of_tool, axis, _): &&(bool, fn() -> Vector3<f64>, &str)| {
        let half = UnitQuaternion::from_scaled_axis(axis() * PI);
        let round = |pose: &Isometry3<f64>| match of_tool {
            true => pose * half,
            false => workpiece * half * workpiece.inverse() * pose,
        };
        (*of_tool || is_placed) && looked_at().all(|pose| is_reached(search, &round(pose), free))
    };
    match WAYS.iter().find(reaches) {
        Some((_, _, hint)) => {
            let own = error
                .hint_text()
                .map(|own| format!("{own}; "))
                .unwrap_or_default();
            error.hint(format!("{own}{hint}"))
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
