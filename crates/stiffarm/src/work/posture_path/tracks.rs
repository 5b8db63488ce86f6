//! Paths whose poses are given: each branch of the first pose followed along.

use super::{Search, change};
use crate::error::{Code, Error, Result};
use crate::estimate::identify::rms;
use crate::model::inverse::Method;
use crate::numerics::control::Control;
use crate::numerics::jobs::each_in_order;
use crate::units::rad_to_deg;
use nalgebra::Isometry3;
use std::f64::consts::FRAC_PI_2;

/// Where and why a branch could not be followed.
struct BrokenBranch {
    /// Points that it came along.
    length: usize,
    why: Error,
}

/// A branch that was followed to the end.
struct Track {
    q: Vec<Vec<f64>>,
    /// What bounds, limits and shapes lack along it, then its RMS deflection \[m\].
    rank: (f64, f64),
}

/// All branches of many poses, without a vector for each: a path may have
/// millions of points.
struct Layers {
    joints: usize,
    angles: Vec<f64>,
    /// Where the branches of each pose end in `angles`.
    ends: Vec<usize>,
}

impl Layers {
    fn new(joints: usize) -> Self {
        Layers { joints, angles: Vec::new(), ends: Vec::new() }
    }

    fn push(&mut self, branches: &[Vec<f64>]) {
        branches.iter().for_each(|q| self.angles.extend(q));
        self.ends.push(self.angles.len());
    }

    /// The branches of pose `i`.
    fn of(&self, i: usize) -> impl Iterator<Item = &[f64]> {
        let start = i.checked_sub(1).map_or(0, |before| self.ends[before]);
        self.angles[start..self.ends[i]].chunks(self.joints)
    }
}

/// Postures with the tip at `poses`.
pub(super) fn postures(search: &Search<'_>, poses: &[Isometry3<f64>], control: Control<'_>) -> Result<Vec<Vec<f64>>> {
    let closed = search.inverse.method() == Method::ClosedForm;
    // All branches of all poses, or of the first one.
    let solved = if closed { poses } else { &poses[..1] };
    let mut layers = Layers::new(search.arm.robot().joint_count());
    let solve = |(i, pose): (usize, &Isometry3<f64>)| {
        let mut branches = search.branches(i, pose)?;
        if i > 0 {
            // What no turns bring within the limits is never followed.
            branches.retain(|q| search.inverse.turns_near(q, q).is_some());
        }
        Ok(branches)
    };
    each_in_order(solved, "inverse kinematics", control, solve, |branches| {
        layers.push(&branches);
    })?;
    let mut starts: Vec<Vec<Vec<f64>>> =
        layers.of(0).map(|q| search.inverse.turns_within_limits(q)).filter(|turns| !turns.is_empty()).collect();
    if starts.is_empty() {
        let error = search
            .inverse
            .nearest(&search.flange(&poses[0]), layers.of(0).next().unwrap_or(&[]))
            .err()
            .unwrap_or_else(|| Error::new(Code::OutsideLimits, "No posture is within the limits."));
        return Err(search.named(0, &error));
    }
    // Full turns in the middle of the limits leave most room to wind on.
    for turns in &mut starts {
        turns.sort_by(|a, b| search.off_centre(a).total_cmp(&search.off_centre(b)));
    }
    let mut near_enough = f64::INFINITY;
    if let Some(near) = &search.options.start {
        // Nearest branch first, of each the nearest turns first.
        let far = |q: &Vec<f64>| change(near, q).1;
        for turns in &mut starts {
            turns.sort_by(|a, b| far(a).total_cmp(&far(b)));
        }
        starts.sort_by(|a, b| far(&a[0]).total_cmp(&far(&b[0])));
        near_enough = far(&starts[0][0]).max(FRAC_PI_2);
    }
    let wrenches = search.wrenches(poses)?;
    let mut broken: Option<BrokenBranch> = None;
    let mut best: Option<Track> = None;
    for turns in &starts {
        // Full turns leave every link where it is.
        let mut room: Option<f64> = None;
        for start in turns {
            let near = search.options.start.as_ref();
            if near.is_some_and(|near| change(near, start).1 > near_enough) && best.is_some() {
                continue;
            }
            if control.stopped() {
                return Err(Error::new(Code::Interrupted, "Interrupted."));
            }
            match follow(search, poses, closed.then_some(&layers), start) {
                Ok(track) => {
                    let lacking = match room {
                        Some(lacking) => lacking,
                        None => search.lacks_room_along(&track)?,
                    };
                    room = Some(lacking);
                    let beyond = search.beyond_bounds_along(&track);
                    let missing = lacking + beyond;
                    if search.options.start.is_some() && missing == 0.0 {
                        return Ok(track);
                    }
                    let cost = rms(&search.deflections(&track, &wrenches)?);
                    // Flipped wrists bend alike: rounding does not choose between them.
                    let is_better = |than: &Track| (missing, cost) < (than.rank.0, than.rank.1 * (1.0 - 1e-9));
                    if best.as_ref().is_none_or(is_better) {
                        best = Some(Track { q: track, rank: (missing, cost) });
                    }
                    // Other turns of the same branch bend alike.
                    if beyond == 0.0 {
                        break;
                    }
                }
                Err(other) => {
                    if broken.as_ref().is_none_or(|b| other.length > b.length) {
                        broken = Some(other);
                    }
                }
            }
        }
    }
    match (best, broken) {
        (Some(track), _) => Ok(track.q),
        (None, Some(broken)) => Err(broken.why),
        (None, None) => Err(Error::new(Code::Internal, "There was no branch to follow.")),
    }
}

/// Follows the branch that begins at `start`.
fn follow(
    search: &Search<'_>,
    poses: &[Isometry3<f64>],
    layers: Option<&Layers>,
    start: &[f64],
) -> Result<Vec<Vec<f64>>, BrokenBranch> {
    let mut track = Vec::with_capacity(poses.len());
    track.push(start.to_vec());
    for (i, pose) in poses.iter().enumerate().skip(1) {
        let last = &track[i - 1];
        let next = match layers {
            Some(layers) => nearest(search, layers.of(i), last),
            None => iterated(search, pose, last),
        };
        let stuck = |why: Error| BrokenBranch { length: i, why };
        let Some(next) = next else {
            let error = Error::new(
                Code::OutsideLimits,
                "the branch that was followed to here ends at a limit of the machine, or at the edge of its reach.",
            )
            .hint("start with another posture, or leave the turn about the tool axis free");
            return Err(stuck(search.named(i, &error)));
        };
        let (j, step) = change(last, &next);
        if step > search.largest_step(i - 1, i) {
            return Err(stuck(jump(search, i, j, step)));
        }
        track.push(next);
    }
    Ok(track)
}

/// The posture among `branches`, with turns within the limits, nearest to `last`.
fn nearest<'b>(search: &Search<'_>, branches: impl Iterator<Item = &'b [f64]>, last: &[f64]) -> Option<Vec<f64>> {
    let near = branches.filter_map(|q| search.inverse.turns_near(q, last));
    near.min_by(|a, b| change(last, a).1.total_cmp(&change(last, b).1))
}

/// The posture that iterations from `last` lead to, if it is within the limits.
fn iterated(search: &Search<'_>, pose: &Isometry3<f64>, last: &[f64]) -> Option<Vec<f64>> {
    let q = search.inverse.follow(&search.flange(pose), last).ok()?;
    search.arm.robot().outside_limits(&q).is_none().then_some(q)
}

/// A joint jumps on the way to point `i`.
fn jump(search: &Search<'_>, i: usize, j: usize, step: f64) -> Error {
    let joint = &search.arm.robot().joints()[j].name;
    let message = format!(
        "From point {} to {} {joint} would jump by {:.1}°: the points are far apart, or the path passes a singular \
         posture.",
        search.points[i - 1].name,
        search.points[i].name,
        rad_to_deg(step)
    );
    let error = Error::invalid(message)
        .hint("give more points between these two, leave the turn about the tool axis free, or allow larger steps");
    search.at(i, error)
}
