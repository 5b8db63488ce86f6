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

use crate::error::{Error, Result};
use crate::model::cell::Cell;
use crate::numerics::control::{Control, Termination};
use crate::numerics::streams::{group_rng, uniform};
use crate::plan::feasibility::nothing_meets;
use std::f64::consts::TAU;

/// Stream of the candidates; no other group of a seed is drawn from it.
const STREAM: u64 = 1 << 62;
/// Feasible candidates per posture wanted, and their least and largest number.
const CANDIDATES_EACH: usize = 200;
const CANDIDATES: [usize; 2] = [4_000, 20_000];
/// Postures drawn in search of feasible ones.
const MAX_DRAWS: usize = 500_000;
/// Largest number of postures.
const MOST_SPACE_FILLING: usize = 5_000;
/// Exchanges per posture after which the search ends; it mostly ends before.
const EXCHANGES_EACH: usize = 20;
/// Draws and exchanges between two looks at progress and Ctrl-C.
const BETWEEN_LOOKS: usize = 64;

/// Postures that cover the joint space, and why the search for them ended.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceFilling {
    /// The postures, controller angles \[rad\].
    pub postures: Vec<Vec<f64>>,
    /// `Converged` where no exchange spreads them further.
    pub termination: Termination,
}

/// Chooses `count` postures (controller angles, rad) inside the bounds and the
/// limits of the cell that cover the feasible joint space evenly: the smallest
/// [`joint_distance`] between two of them is made large, first greedily (each
/// next posture is the candidate farthest from those chosen), then by
/// exchanging one of the closest two for a candidate that is farther from all
/// others. The same seed gives the same postures. Stopped, it gives the postures
/// with the exchanges made so far.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
/// use stiffarm::plan::select::{smallest_distance, space_filling};
///
/// let cell = builtin::cell("comau")?;
/// let group = space_filling(&cell, 4, 1, Control::default())?.postures;
/// assert!(smallest_distance(&cell.bounds, &group) > Some(0.5));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// No posture or more than 5,000 wanted; bounds that are reversed or not
/// finite; fewer feasible postures than wanted among half a million random ones,
/// or all in one place; stopped before there was a group.
pub fn space_filling(cell: &Cell, count: usize, seed: u64, control: Control<'_>) -> Result<SpaceFilling> {
    if count == 0 || count > MOST_SPACE_FILLING {
        return Err(Error::invalid(format!(
            "A space-filling group has 1 to {MOST_SPACE_FILLING} postures, not {count}."
        )));
    }
    let candidates = candidates(cell, count, seed, control)?;
    let chosen = farthest_first(&cell.bounds, &candidates, count, control)?;
    let mut spread = Exchange::new(&cell.bounds, &candidates, chosen);
    let termination = spread.run(control);
    let chosen = spread.chosen.iter();
    let postures: Vec<Vec<f64>> = chosen.map(|c| candidates[*c].clone()).collect();
    if smallest_distance(&cell.bounds, &postures) == Some(0.0) {
        return Err(
            Error::invalid("The bounds leave room for fewer different postures than wanted.").key("bounds.q_deg")
        );
    }
    Ok(SpaceFilling { postures, termination })
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
    pairs(group.len()).map(|(i, j)| joint_distance(bounds, group[i].as_ref(), group[j].as_ref())).reduce(f64::min)
}

fn squared_distance(bounds: &[[f64; 2]], a: &[f64], b: &[f64]) -> f64 {
    let mut sum = 0.0;
    for ((bound, a), b) in bounds.iter().zip(a).zip(b) {
        let range = (bound[1] - bound[0]).min(TAU);
        if range > 0.0 {
            // The remainder is slow, and mostly there is nothing to take off.
            let apart = (a - b).abs();
            let turn = if apart < TAU { apart } else { apart.rem_euclid(TAU) };
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
fn candidates(cell: &Cell, count: usize, seed: u64, control: Control<'_>) -> Result<Vec<Vec<f64>>> {
    let setup = &cell.setup;
    let usable = |b: &[f64; 2]| b[0].is_finite() && b[1].is_finite() && b[0] <= b[1];
    if let Some(j) = cell.bounds.iter().position(|b| !usable(b)) {
        let message = format!("The bounds of {} are reversed or not finite.", setup.robot.joints()[j].name);
        return Err(Error::invalid(message).key("bounds.q_deg"));
    }
    let wanted = (CANDIDATES_EACH * count).clamp(CANDIDATES[0], CANDIDATES[1]);
    let mut margins = cell.posture_margins()?;
    let mut rng = group_rng(seed, STREAM);
    let mut candidates = Vec::with_capacity(wanted);
    let mut draws = 0;
    while candidates.len() < wanted && draws < MAX_DRAWS {
        draws += 1;
        if draws.is_multiple_of(BETWEEN_LOOKS) {
            control.check()?;
        }
        let q = uniform(&cell.bounds, &mut rng);
        // A rope without a direction is no posture to measure.
        if margins.least(&q).is_ok_and(|margin| margin >= 0.0) {
            candidates.push(q);
        }
    }
    if candidates.len() >= count {
        return Ok(candidates);
    }
    if candidates.is_empty() {
        return Err(nothing_meets(cell, MAX_DRAWS));
    }
    let message = format!(
        "Only {} of {MAX_DRAWS} random postures within the bounds meet the cell's limits, and {count} are wanted.",
        candidates.len()
    );
    Err(Error::invalid(message)
        .key("limits")
        .hint("ask for fewer postures, or check the limits' frame (robot base) and unit (mm)"))
}

/// Indices of `count` candidates, each the farthest from those before it.
fn farthest_first(
    bounds: &[[f64; 2]],
    candidates: &[Vec<f64>],
    count: usize,
    control: Control<'_>,
) -> Result<Vec<usize>> {
    // Something at the border to begin with: what is farthest from any one candidate.
    let from_first = candidates.iter().map(|c| squared_distance(bounds, c, &candidates[0]));
    let mut chosen = vec![largest(from_first)];
    let mut nearest = vec![f64::INFINITY; candidates.len()];
    while chosen.len() < count {
        control.check()?;
        let last = &candidates[chosen[chosen.len() - 1]];
        for (distance, candidate) in nearest.iter_mut().zip(candidates) {
            *distance = distance.min(squared_distance(bounds, candidate, last));
        }
        chosen.push(largest(nearest.iter().copied()));
        control.report("spreading postures", chosen.len(), count);
    }
    Ok(chosen)
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

/// The two chosen postures nearest to a candidate: squared distance and place among
/// the chosen.
#[derive(Clone, Copy)]
struct Nearest {
    first: (f64, usize),
    second: f64,
    second_at: usize,
}

/// Chosen postures beside all candidates, with what makes an exchange cost one look
/// at each candidate, however many postures there are.
struct Exchange<'a> {
    bounds: &'a [[f64; 2]],
    candidates: &'a [Vec<f64>],
    chosen: Vec<usize>,
    /// For each candidate its nearest chosen postures.
    nearest: Vec<Nearest>,
    /// For each chosen posture the nearest of those after it; infinite for the last.
    after: Vec<(f64, usize)>,
}

impl<'a> Exchange<'a> {
    fn new(bounds: &'a [[f64; 2]], candidates: &'a [Vec<f64>], chosen: Vec<usize>) -> Self {
        let mut out =
            Exchange { bounds, candidates, chosen, nearest: Vec::with_capacity(candidates.len()), after: Vec::new() };
        out.nearest = (0..candidates.len()).map(|c| out.nearest_to(c)).collect();
        out.after = (0..out.chosen.len()).map(|place| out.nearest_after(place)).collect();
        out
    }

    fn distance(&self, candidate: usize, place: usize) -> f64 {
        let other = &self.candidates[self.chosen[place]];
        squared_distance(self.bounds, &self.candidates[candidate], other)
    }

    fn nearest_to(&self, candidate: usize) -> Nearest {
        let mut out = Nearest { first: (f64::INFINITY, 0), second: f64::INFINITY, second_at: 0 };
        for place in 0..self.chosen.len() {
            out.add(self.distance(candidate, place), place);
        }
        out
    }

    fn nearest_after(&self, place: usize) -> (f64, usize) {
        let mut out = (f64::INFINITY, place);
        for other in place + 1..self.chosen.len() {
            let distance = self.distance(self.chosen[place], other);
            if distance < out.0 {
                out = (distance, other);
            }
        }
        out
    }

    /// Exchanges one of the closest two postures for a candidate that is farther
    /// from all others than they are from each other, while there is one. Each
    /// exchange removes a closest pair and makes none, so this ends.
    fn run(&mut self, control: Control<'_>) -> Termination {
        let most = EXCHANGES_EACH * self.chosen.len();
        for done in 0..most {
            if control.stopped() {
                return Termination::Interrupted;
            }
            if done.is_multiple_of(BETWEEN_LOOKS) {
                control.report("exchanging postures", done, most);
            }
            let Some((leaving, candidate)) = self.best() else {
                return Termination::Converged;
            };
            self.exchange(leaving, candidate);
        }
        Termination::IterationLimit
    }

    /// The exchange after which the candidate that comes in is farthest from the
    /// others; `None` where none is farther than the closest two are.
    fn best(&self) -> Option<(usize, usize)> {
        let pairs = self.after.iter().enumerate();
        let (a, (smallest, b)) = pairs.min_by(|x, y| x.1.0.total_cmp(&y.1.0))?;
        let mut best = (*smallest, None);
        for leaving in [a, *b] {
            for (candidate, nearest) in self.nearest.iter().enumerate() {
                let distance = if nearest.first.1 == leaving { nearest.second } else { nearest.first.0 };
                if distance > best.0 {
                    best = (distance, Some((leaving, candidate)));
                }
            }
        }
        best.1
    }

    fn exchange(&mut self, leaving: usize, candidate: usize) {
        self.chosen[leaving] = candidate;
        for c in 0..self.candidates.len() {
            let near = self.nearest[c];
            self.nearest[c] = if near.first.1 == leaving || near.second_at == leaving {
                self.nearest_to(c)
            } else {
                let mut near = near;
                near.add(self.distance(c, leaving), leaving);
                near
            };
        }
        for place in 0..self.chosen.len() {
            let new = if place < leaving { self.distance(self.chosen[place], leaving) } else { f64::INFINITY };
            let before = self.after[place];
            if place == leaving || before.1 == leaving {
                self.after[place] = self.nearest_after(place);
            } else if new < before.0 || (new == before.0 && leaving < before.1) {
                self.after[place] = (new, leaving);
            }
        }
    }
}

impl Nearest {
    /// One more posture, of equal ones the earlier place first.
    fn add(&mut self, distance: f64, place: usize) {
        if distance < self.first.0 {
            (self.second, self.second_at) = self.first;
            self.first = (distance, place);
        } else if distance < self.second {
            (self.second, self.second_at) = (distance, place);
        }
    }
}
