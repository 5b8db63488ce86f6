//! The best of many single postures within the cell's bounds and limits.

use crate::error::{Code, Error, Result};
use crate::model::cell::{Cell, PostureMargins};
use crate::numerics::control::Control;
use crate::numerics::jobs::in_order;
use crate::numerics::order::sort_by_number;
use crate::numerics::streams::chain_rng;
use crate::plan::select::{GlobalOptions, StartKind, random_group};
use rand::RngExt;
use std::time::Instant;

/// Rounds where the options name none.
const ROUNDS: u64 = 4;
/// Random postures of a round, and how many of the best are improved.
const CANDIDATES: usize = 256;
const IMPROVED: usize = 3;
/// First and last step of an improvement \[rad\].
const FIRST_STEP: f64 = 0.3;
const LAST_STEP: f64 = 2e-4;

/// A posture with its value.
struct Candidate {
    q: Vec<f64>,
    value: f64,
}

/// The controller angles \[rad\] at which `value` is smallest, as far as the
/// rounds of `options` find them; infinite values are never taken. `None` where
/// all are infinite.
///
/// # Errors
/// No posture within the limits, a `value` that fails, or stopped before the
/// first round was over.
pub(super) fn best_posture(
    cell: &Cell,
    options: &GlobalOptions,
    control: Control<'_>,
    value: &(impl Fn(&[f64]) -> Result<f64> + Sync),
) -> Result<Option<Vec<f64>>> {
    let begin = Instant::now();
    // Infinite outside the limits.
    let ready = cell.posture_margins()?;
    let at = |margins: &mut PostureMargins<'_>, q: &[f64]| -> Result<f64> {
        if margins.least(q)? < 0.0 { Ok(f64::INFINITY) } else { value(q) }
    };
    let mut best: Option<Candidate> = None;
    let rounds = options.rounds.unwrap_or(ROUNDS).max(1);
    for round in 0..rounds {
        let over = options.time_limit.is_some_and(|limit| begin.elapsed() >= limit);
        if round > 0 && (over || control.stopped()) {
            break;
        }
        let random = random_group(cell, StartKind::Uniform, CANDIDATES, options.seed, round)?;
        let mut candidates = in_order(&random, |(_, q)| {
            let value = at(&mut ready.clone(), q)?;
            Ok(Candidate { q: q.clone(), value })
        })?;
        candidates.retain(|c| c.value.is_finite());
        // A stable sort: equal values stay in the order they were drawn.
        sort_by_number(&mut candidates, |a| a.value);
        candidates.truncate(IMPROVED);
        let improved = in_order(&candidates, |(i, start)| {
            let mut margins = ready.clone();
            let at = |q: &[f64]| at(&mut margins, q);
            improve(cell, options.seed, (round, i), start, control, at)
        })?;
        if control.stopped() && best.is_none() {
            return Err(Error::new(Code::Interrupted, "The search was stopped."));
        }
        for one in improved {
            if best.as_ref().is_none_or(|b| one.value < b.value) {
                best = Some(one);
            }
        }
        control.report("next posture", round as usize + 1, rounds as usize);
    }
    Ok(best.map(|b| b.q))
}

/// Steps along the axes and along random directions, halved where none helps.
fn improve(
    cell: &Cell,
    seed: u64,
    (round, start): (u64, usize),
    from: &Candidate,
    control: Control<'_>,
    mut at: impl FnMut(&[f64]) -> Result<f64>,
) -> Result<Candidate> {
    let mut rng = chain_rng(seed, round, start);
    let n = from.q.len();
    let (mut q, mut value) = (from.q.clone(), from.value);
    let mut step = FIRST_STEP;
    while step > LAST_STEP && !control.stopped() {
        let mut moved = false;
        for direction in 0..2 * n {
            let along: Vec<f64> = if direction < n {
                (0..n).map(|j| f64::from(u8::from(j == direction))).collect()
            } else {
                (0..n).map(|_| 2.0 * rng.random::<f64>() - 1.0).collect()
            };
            for sign in [1.0, -1.0] {
                let next: Vec<f64> = q
                    .iter()
                    .zip(&along)
                    .zip(&cell.bounds)
                    .map(|((q, a), b)| (q + sign * step * a).clamp(b[0], b[1]))
                    .collect();
                let there = at(&next)?;
                if there < value {
                    (q, value, moved) = (next, there, true);
                    break;
                }
            }
        }
        if !moved {
            step *= 0.5;
        }
    }
    Ok(Candidate { q, value })
}
