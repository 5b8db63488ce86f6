//! Postures that cover the joint space evenly, without any index.
//!
//! The way of earlier stiffness identifications: Cen and Melkote (*CCT-based
//! mode coupling chatter avoidance in robotic milling*, J. Manuf. Processes 29,
//! 2017, 50–61) measured 15 postures that cover the joint space, Alici and
//! Shirinzadeh (*Enhanced stiffness modeling, identification and
//! characterization for robot manipulators*, IEEE Trans. Robot. 21(4), 2005,
//! 554–564) 20 in the workspace. Neither says how theirs were found; here the
//! smallest distance between two postures is made large, the maximin design of
//! Johnson, Moore and Ylvisaker (*Minimax and maximin distance designs*, J.
//! Stat. Plan. Inference 26, 1990, 131–148).
//!
//! Limits of the method: the postures come from a finite set of random
//! feasible ones, and a maximin design of few postures in many joints lies
//! mostly near the borders of what is feasible. It knows nothing of the load:
//! whether it determines all joints well is for [`evaluate`](crate::plan::index::evaluate) to say.

use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::observation::PostureTerms;
use crate::numerics::streams::group_rng;
use nalgebra::Vector3;
use rand::RngExt;
use std::f64::consts::TAU;

/// Stream of the candidates; no other group of a seed is drawn from it.
const STREAM: u64 = 1 << 62;
/// Feasible candidates per posture wanted, and their least and largest number.
const CANDIDATES_EACH: usize = 200;
const CANDIDATES: [usize; 2] = [4_000, 20_000];
/// Postures drawn in search of feasible ones.
const MAX_DRAWS: usize = 500_000;
/// Largest number of postures.
const MOST: usize = 5_000;
/// Exchanges per posture after which the search ends; it mostly ends before.
const EXCHANGES_EACH: usize = 20;

/// Chooses `count` postures (controller angles, rad) inside the bounds and the
/// limits of the cell that cover the feasible joint space evenly: the smallest
/// [`joint_distance`] between two of them is made large, first greedily (each
/// next posture is the candidate farthest from those chosen), then by
/// exchanging one of the closest two for a candidate that is farther from all
/// others. The same seed gives the same postures.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// # #[cfg(feature = "files")] {
/// use stiffarm::files::builtin;
/// use stiffarm::plan::select::{smallest_distance, space_filling};
///
/// let cell = builtin::cell("comau")?;
/// let group = space_filling(&cell, 4, 1)?;
/// assert!(smallest_distance(&cell.bounds, &group) > Some(0.5));
/// # }
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// No posture or more than 5,000 wanted; bounds that are reversed or not
/// finite; fewer feasible postures than wanted among half a million random ones,
/// or all in one place.
pub fn space_filling(cell: &Cell, count: usize, seed: u64) -> Result<Vec<Vec<f64>>> {
    if count == 0 || count > MOST {
        return Err(Error::new(
            Code::InvalidValue,
            format!("A space-filling group has 1 to {MOST} postures, not {count}."),
        ));
    }
    let candidates = candidates(cell, count, seed)?;
    let mut chosen = farthest_first(&cell.bounds, &candidates, count);
    exchange(&cell.bounds, &candidates, &mut chosen);
    let group: Vec<Vec<f64>> = chosen.iter().map(|c| candidates[*c].clone()).collect();
    if smallest_distance(&cell.bounds, &group) == Some(0.0) {
        return Err(Error::new(
            Code::InvalidValue,
            "The bounds leave room for fewer different postures than wanted.",
        )
        .key("bounds.q_deg"));
    }
    Ok(group)
}

/// Distance of two postures (controller angles, rad) relative to the bounds
/// \[rad\]: root of the sum over the joints of squared angle differences, each
/// divided by the joint's range. Angles a full turn apart are the same posture,
/// so differences count modulo 2π and a range counts as 2π at most. Joints
/// without a range do not count. 0 to √n.
pub fn joint_distance(bounds: &[[f64; 2]], a: &[f64], b: &[f64]) -> f64 {
    squared_distance(bounds, a, b).sqrt()
}

/// Smallest [`joint_distance`] between two postures of a group; `None` for
/// fewer than two.
pub fn smallest_distance<Q: AsRef<[f64]>>(bounds: &[[f64; 2]], group: &[Q]) -> Option<f64> {
    pairs(group.len())
        .map(|(i, j)| joint_distance(bounds, group[i].as_ref(), group[j].as_ref()))
        .reduce(f64::min)
}

fn squared_distance(bounds: &[[f64; 2]], a: &[f64], b: &[f64]) -> f64 {
    let mut sum = 0.0;
    for ((bound, a), b) in bounds.iter().zip(a).zip(b) {
        let range = (bound[1] - bound[0]).min(TAU);
        if range > 0.0 {
            let turn = (a - b).rem_euclid(TAU);
            sum += (turn.min(TAU - turn) / range).powi(2);
        }
    }
    sum
}

/// All pairs i < j below `count`.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |i| (i + 1..count).map(move |j| (i, j)))
}

/// Random postures inside the bounds and limits, at least `count`.
fn candidates(cell: &Cell, count: usize, seed: u64) -> Result<Vec<Vec<f64>>> {
    let setup = &cell.setup;
    let usable = |b: &[f64; 2]| b[0].is_finite() && b[1].is_finite() && b[0] <= b[1];
    if let Some(j) = cell.bounds.iter().position(|b| !usable(b)) {
        let message = format!(
            "The bounds of {} are reversed or not finite.",
            setup.robot.joints()[j].name
        );
        return Err(Error::new(Code::InvalidValue, message).key("bounds.q_deg"));
    }
    let wanted = (CANDIDATES_EACH * count).clamp(CANDIDATES[0], CANDIDATES[1]);
    // The limits ask where points are; a load that only a measurement gives is no obstacle.
    let unloaded = Wrench::force(Vector3::zeros());
    let mut margins = vec![0.0; cell.limits.count(setup)];
    let mut rng = group_rng(seed, STREAM);
    let mut found = Vec::with_capacity(wanted);
    let middle: Vec<f64> = cell.bounds.iter().map(|b| 0.5 * (b[0] + b[1])).collect();
    let mut terms = PostureTerms::new(setup, &middle, Some(&unloaded))?;
    let mut draws = 0;
    while found.len() < wanted && draws < MAX_DRAWS {
        draws += 1;
        let range = cell.bounds.iter();
        let q: Vec<f64> = range
            .map(|b| b[0] + (b[1] - b[0]) * rng.random::<f64>())
            .collect();
        terms.frames.update(&setup.robot, &q);
        terms.fill(setup, Some(&unloaded))?;
        cell.limits.evaluate(setup, &terms, &mut margins, None);
        if margins.iter().all(|m| *m >= 0.0) {
            found.push(q);
        }
    }
    if found.len() >= count {
        return Ok(found);
    }
    let message = format!(
        "Only {} of {MAX_DRAWS} random postures within the bounds meet the cell's limits, and {count} are wanted.",
        found.len()
    );
    Err(Error::new(Code::InvalidValue, message)
        .key("limits")
        .hint("ask for fewer postures, or check the limits' frame (robot base) and unit (mm)"))
}

/// Indices of `count` candidates, each the farthest from those before it.
fn farthest_first(bounds: &[[f64; 2]], candidates: &[Vec<f64>], count: usize) -> Vec<usize> {
    // Something at the border to begin with: what is farthest from any one candidate.
    let from_first = candidates
        .iter()
        .map(|c| squared_distance(bounds, c, &candidates[0]));
    let mut chosen = vec![largest(from_first)];
    let mut nearest = vec![f64::INFINITY; candidates.len()];
    while chosen.len() < count {
        let last = &candidates[chosen[chosen.len() - 1]];
        for (distance, candidate) in nearest.iter_mut().zip(candidates) {
            *distance = distance.min(squared_distance(bounds, candidate, last));
        }
        chosen.push(largest(nearest.iter().copied()));
    }
    chosen
}

/// Position of the largest value, the first of equals.
fn largest(values: impl Iterator<Item = f64>) -> usize {
    let mut best = (0, f64::NEG_INFINITY);
    for (i, value) in values.enumerate() {
        if value > best.1 {
            best = (i, value);
        }
    }
    best.0
}

/// Exchanges one of the closest two postures for a candidate that is farther
/// from all others than they are from each other, while there is one. Each
/// exchange removes a closest pair and makes none, so this ends.
fn exchange(bounds: &[[f64; 2]], candidates: &[Vec<f64>], chosen: &mut [usize]) {
    for _ in 0..EXCHANGES_EACH * chosen.len() {
        let distance =
            |i: usize, j: usize| squared_distance(bounds, &candidates[i], &candidates[j]);
        let closest = pairs(chosen.len())
            .map(|(a, b)| (distance(chosen[a], chosen[b]), a, b))
            .min_by(|x, y| x.0.total_cmp(&y.0));
        let Some((smallest, a, b)) = closest else {
            return;
        };
        let mut best = (smallest, None);
        for leaving in [a, b] {
            for candidate in 0..candidates.len() {
                let mut nearest = f64::INFINITY;
                for (at, other) in chosen.iter().enumerate() {
                    if at != leaving && nearest > best.0 {
                        nearest = nearest.min(distance(candidate, *other));
                    }
                }
                if nearest > best.0 {
                    best = (nearest, Some((leaving, candidate)));
                }
            }
        }
        let (_, Some((leaving, candidate))) = best else {
            return;
        };
        chosen[leaving] = candidate;
    }
}
