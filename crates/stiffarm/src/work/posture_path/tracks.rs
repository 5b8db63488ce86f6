//! Paths whose poses are given: each branch of the first pose followed along.

use super::{Search, change};
use crate::error::{Code, Error, Result};
use crate::estimate::identify::rms;
use crate::model::inverse::{Method, largest_change};
use crate::model::load::Wrench;
use crate::model::observation::PostureTerms;
use crate::numerics::control::Control;
use crate::numerics::jobs::each_block;
use crate::units::rad_to_deg;
use nalgebra::Isometry3;
use std::f64::consts::FRAC_PI_2;

/// Points that are followed between two looks at whether to stop.
const BETWEEN_CHECKS: usize = 4096;

/// Where and why a branch could not be followed.
struct BrokenBranch {
    /// Points that it came along.
    length: usize,
    why: Error,
}

/// All branches of many poses that are within the limits, without a vector for each: a path may have millions of points.
pub(super) struct Layers {
    joints: usize,
    angles: Vec<f64>,
    /// Squared deflection of each branch \[m²\].
    squares: Vec<f64>,
    /// How many branches there are up to the end of each pose.
    ends: Vec<usize>,
}

impl Layers {
    fn new(joints: usize) -> Self {
        Layers { joints, angles: Vec::new(), squares: Vec::new(), ends: Vec::new() }
    }

    fn push(&mut self, q: &[f64], square: f64) {
        self.angles.extend(q);
        self.squares.push(square);
    }

    fn end_pose(&mut self) {
        self.ends.push(self.squares.len());
    }

    fn append(&mut self, other: &Layers) {
        let before = self.squares.len();
        self.angles.extend(&other.angles);
        self.squares.extend(&other.squares);
        self.ends.extend(other.ends.iter().map(|end| before + end));
    }

    /// The branches of pose `i` with their squared deflections.
    fn of(&self, i: usize) -> impl Iterator<Item = (&[f64], f64)> {
        let start = i.checked_sub(1).map_or(0, |before| self.ends[before]);
        let branches = start..self.ends[i];
        let angles = self.angles[start * self.joints..self.ends[i] * self.joints].chunks(self.joints);
        angles.zip(self.squares[branches].iter().copied())
    }
}

/// What the ways through given poses are chosen from.
pub(super) struct Branches {
    /// All branches of the first pose, inside and outside the limits.
    first: Vec<Vec<f64>>,
    /// All branches of the poses in closed form.
    layers: Option<Layers>,
    /// Loads at the poses; of the first one alone where the layers have the deflections.
    wrenches: Vec<Wrench>,
}

/// The branches of `poses`.
pub(super) fn branches(search: &Search<'_>, poses: &[Isometry3<f64>], control: Control<'_>) -> Result<Branches> {
    let first = search.branches(0, &poses[0])?;
    let mut wrenches = search.wrenches(poses)?;
    let layers = match search.inverse.method() {
        Method::ClosedForm => Some(layers(search, poses, &wrenches, control)?),
        Method::Numeric => None,
    };
    if layers.is_some() {
        wrenches = vec![wrenches[0]];
    }
    Ok(Branches { first, layers, wrenches })
}

fn layers(search: &Search<'_>, poses: &[Isometry3<f64>], wrenches: &[Wrench], control: Control<'_>) -> Result<Layers> {
    let joints = search.arm.robot().joint_count();
    let mut layers = Layers::new(joints);
    let solve = |start: usize, block: &[Isometry3<f64>]| {
        let mut part = Layers::new(joints);
        let mut terms = search.arm.memory();
        for (i, pose) in (start..).zip(block) {
            search.push_branches(i, pose, &wrenches[i], &mut terms, &mut part)?;
        }
        Ok(part)
    };
    each_block(poses, "inverse kinematics", control, solve, |part| layers.append(&part))?;
    Ok(layers)
}

impl Search<'_> {
    /// Adds the branches of point `i`, whose tip is at `pose` under `wrench`, to `layers`.
    fn push_branches(
        &self,
        i: usize,
        pose: &Isometry3<f64>,
        wrench: &Wrench,
        terms: &mut PostureTerms,
        layers: &mut Layers,
    ) -> Result<()> {
        let flange = self.flange(pose);
        let mut turned = vec![0.0; layers.joints];
        let mut is_reached = false;
        let mut postures = self.inverse.each_posture(&flange).map_err(|e| self.at(i, e))?;
        while let Some(q) = postures.as_mut().and_then(|postures| postures.next(&mut terms.frames)) {
            is_reached = true;
            // What no turns bring within the limits is never followed.
            if self.inverse.turned_near(&q, &q, f64::INFINITY, &mut turned).is_some() {
                self.arm.load(wrench, terms).map_err(|e| self.at(i, e))?;
                layers.push(&q, self.shift(terms).powi(2));
            }
        }
        layers.end_pose();
        // What is missing to a pose out of reach.
        if is_reached { Ok(()) } else { self.branches(i, pose).map(|_| ()) }
    }
}

/// Postures with the tip at `poses`.
pub(super) fn postures(
    search: &Search<'_>,
    poses: &[Isometry3<f64>],
    branches: &Branches,
    control: Control<'_>,
) -> Result<Vec<Vec<f64>>> {
    let first = branches.first.iter();
    let mut starts: Vec<Vec<Vec<f64>>> =
        first.map(|q| search.inverse.turns_within_limits(q)).filter(|turns| !turns.is_empty()).collect();
    if starts.is_empty() {
        let near = branches.first.first().map_or(&[][..], Vec::as_slice);
        let error = search
            .inverse
            .nearest(&search.flange(&poses[0]), near)
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
    let mut through = Through { search, poses, branches, near_enough, control, best: None, broken: None };
    for turns in &starts {
        through.follow_each(turns)?;
        let is_free = through.best.as_ref().is_some_and(|(_, (missing, _))| *missing == 0.0);
        if search.options.start.is_some() && is_free {
            break;
        }
    }
    match (through.best, through.broken) {
        (Some((q, _)), _) => Ok(search.each(&q)),
        (None, Some(broken)) => Err(broken.why),
        (None, None) => Err(Error::new(Code::Internal, "There was no branch to follow.")),
    }
}

/// What following one branch after the other leads to.
struct Through<'a> {
    search: &'a Search<'a>,
    poses: &'a [Isometry3<f64>],
    branches: &'a Branches,
    /// How far from the wanted start a way may begin, where there is another \[rad\].
    near_enough: f64,
    control: Control<'a>,
    /// Posture after posture of the best way; what bounds, limits and shapes lack along it, then its RMS deflection \[m\].
    best: Option<(Vec<f64>, (f64, f64))>,
    /// The branch that leads farthest of those that break off.
    broken: Option<BrokenBranch>,
}

impl Through<'_> {
    /// Follows a branch from its full `turns`; from those that are far from the wanted start only where there is no other
    /// way.
    fn follow_each(&mut self, turns: &[Vec<f64>]) -> Result<()> {
        let Through { search, poses, branches, near_enough, control, .. } = *self;
        // Full turns leave every link where it is: what a way lacks of room, and what it costs.
        let mut of_branch: Option<(f64, f64)> = None;
        for start in turns {
            let is_far = search.options.start.as_ref().is_some_and(|near| change(near, start).1 > near_enough);
            if is_far && self.best.is_some() {
                continue;
            }
            control.check()?;
            match follow(search, poses, branches, start, control) {
                Ok((q, squares)) => {
                    let (lacking, cost) = match of_branch {
                        Some(of_branch) => of_branch,
                        None => (search.lacks_room_along(&q)?, branches.cost(search, &q, squares, control)?),
                    };
                    of_branch = Some((lacking, cost));
                    let beyond = search.beyond_bounds_along(&q, control)?;
                    let missing = lacking + beyond;
                    // Flipped wrists bend alike: rounding does not choose between them.
                    let is_better = |than: (f64, f64)| (missing, cost) < (than.0, than.1 * (1.0 - 1e-9));
                    if self.best.as_ref().is_none_or(|(_, rank)| is_better(*rank)) {
                        self.best = Some((q, (missing, cost)));
                    }
                    // Other turns of the same branch bend alike.
                    if beyond == 0.0 {
                        break;
                    }
                }
                Err(broken) if broken.why.code() == Code::Interrupted => return Err(broken.why),
                Err(broken) => {
                    if self.broken.as_ref().is_none_or(|than| broken.length > than.length) {
                        self.broken = Some(broken);
                    }
                }
            }
        }
        Ok(())
    }
}

impl Branches {
    /// RMS deflection along `q` \[m\]; `squares` is the sum of the squares behind the first point in closed form.
    fn cost(&self, search: &Search<'_>, q: &[f64], squares: f64, control: Control<'_>) -> Result<f64> {
        if self.layers.is_none() {
            return Ok(rms(&search.deflections(&search.each(q), &self.wrenches, control)?));
        }
        let joints = search.arm.robot().joint_count();
        let first = search.deflection(&q[..joints], &self.wrenches[0])?;
        Ok(((first.powi(2) + squares) / (q.len() / joints) as f64).sqrt())
    }
}

/// Follows the branch that begins at `start`: posture after posture, and the sum of their squared deflections behind
/// the first one, where the branches have them.
fn follow(
    search: &Search<'_>,
    poses: &[Isometry3<f64>],
    branches: &Branches,
    start: &[f64],
    control: Control<'_>,
) -> Result<(Vec<f64>, f64), BrokenBranch> {
    let n = start.len();
    let mut q = Vec::with_capacity(n * poses.len());
    q.extend(start);
    let (mut next, mut turned) = (vec![0.0; n], vec![0.0; n]);
    let mut squares = 0.0;
    for (i, pose) in poses.iter().enumerate().skip(1) {
        let stuck = |why: Error| BrokenBranch { length: i, why };
        if i.is_multiple_of(BETWEEN_CHECKS) {
            control.check().map_err(stuck)?;
        }
        let last = &q[n * (i - 1)..];
        let square = match &branches.layers {
            Some(layers) => nearest(search, layers.of(i), last, &mut next, &mut turned),
            None => iterated(search, pose, last).map(|posture| {
                next = posture;
                0.0
            }),
        };
        let Some(square) = square else {
            let error = Error::new(
                Code::OutsideLimits,
                "the branch that was followed to here ends at a limit of the machine, or at the edge of its reach.",
            )
            .hint("start with another posture, or leave the turn about the tool axis free");
            return Err(stuck(search.named(i, &error)));
        };
        if largest_change(last, &next) > search.largest_step(i - 1, i) {
            let (j, step) = change(last, &next);
            return Err(stuck(jump(search, i, j, step)));
        }
        squares += square;
        q.extend(&next);
    }
    Ok((q, squares))
}

/// Writes the posture among `branches`, with turns within the limits, that is nearest to `last` to `next`; its squared
/// deflection.
fn nearest<'b>(
    search: &Search<'_>,
    branches: impl Iterator<Item = (&'b [f64], f64)>,
    last: &[f64],
    next: &mut [f64],
    turned: &mut [f64],
) -> Option<f64> {
    let (mut least, mut nearest) = (f64::INFINITY, None);
    for (q, square) in branches {
        if let Some(change) = search.inverse.turned_near(q, last, least, turned) {
            (least, nearest) = (change, Some(square));
            next.copy_from_slice(turned);
        }
    }
    nearest
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
