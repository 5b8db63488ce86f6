//! Registration of the unloaded readings to the kinematic model that a few bad
//! postures do not spoil.

use super::rigid::{Pair, fit, is_spread, misfit};
use super::{Work, predicted};
use crate::model::observation::Setup;
use nalgebra::{Isometry3, Vector3};

/// Subsets of the postures that are tried as a start.
const STARTS: usize = 120;
/// Rounds of sorting out bad postures.
const ROUNDS: usize = 20;
/// A posture disagrees where its misfit is above this many times the others'…
const FACTOR: f64 = 10.0;
/// … and above this \[m\]: what is below does not matter to Ψ.
const FLOOR: f64 = 5e-4;
/// The same where few postures agree with each other: three or four may do so
/// by chance on a robot that is a few mm off.
const FLOOR_FEW: f64 = 5e-3;
/// Postures that are more than a few.
const MANY: usize = 5;
/// Share of the worst postures that the trimmed misfit leaves out.
const TRIMMED: f64 = 0.25;

/// A registration, with the postures that disagree.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    pub base_from_tracker: Isometry3<f64>,
    /// By item: RMS distance of its points \[m\].
    pub rms: Vec<f64>,
    /// By item: it disagrees with the others.
    pub bad: Vec<bool>,
    /// RMS distance over the items that agree \[m\].
    pub level: f64,
    /// RMS distance over the best three quarters of the items \[m\].
    pub trimmed: f64,
}

impl Frame {
    /// Misfit above which a posture disagrees \[m\].
    pub fn limit(&self) -> f64 {
        limit(self.level, self.bad.iter().filter(|b| !**b).count())
    }

    /// Number of items that disagree.
    pub fn bad_count(&self) -> usize {
        self.bad.iter().filter(|b| **b).count()
    }
}

fn limit(level: f64, agreeing: usize) -> f64 {
    let floor = if agreeing < MANY { FLOOR_FEW } else { FLOOR };
    (FACTOR * level).max(floor)
}

/// States without load, in the order of the items of a [`Frame`]: those with a
/// doubtful reading only where a posture has no other.
pub(super) fn items(work: &Work) -> Vec<(usize, usize)> {
    let mut out = Vec::new();
    for (p, posture) in work.sheet.postures.iter().enumerate() {
        let seen = |s: &usize| !posture.states[*s].seen().is_empty();
        let all: Vec<usize> = posture.references().into_iter().filter(seen).collect();
        let sure: Vec<usize> = all
            .iter()
            .copied()
            .filter(|s| posture.states[*s].doubtful.is_empty())
            .collect();
        let kept = if sure.is_empty() { all } else { sure };
        out.extend(kept.into_iter().map(|s| (p, s)));
    }
    out
}

/// Pairs tracker–base of the items by the model `setup`.
pub(super) fn item_pairs(work: &Work, setup: &Setup, items: &[(usize, usize)]) -> Vec<Vec<Pair>> {
    items
        .iter()
        .map(|at| {
            let state = work.sheet.at(*at);
            state_pairs(&state.points, &predicted(setup, &state.q))
        })
        .collect()
}

/// Pairs tracker–base of one state.
pub(super) fn state_pairs(
    points: &[Option<super::sheet::Mean>],
    predicted: &[Vector3<f64>],
) -> Vec<Pair> {
    points
        .iter()
        .zip(predicted)
        .filter_map(|(mean, at)| mean.map(|m| (m.position, *at)))
        .collect()
}

/// RMS distance that `transform` leaves between pairs \[m\].
pub(super) fn rms(transform: &Isometry3<f64>, pairs: &[Pair]) -> f64 {
    (misfit(transform, pairs) / pairs.len().max(1) as f64).sqrt()
}

/// Registers items: from many small subsets the one that at least half of the
/// items agree with best, then all items that agree. `None` where the points do
/// not determine a transform.
pub(super) fn register(items: &[Vec<Pair>]) -> Option<Frame> {
    let all: Vec<Vector3<f64>> = items.iter().flatten().map(|p| p.1).collect();
    if !is_spread(&all) {
        return None;
    }
    let half = items.len() / 2;
    let mut best: Option<(f64, Isometry3<f64>)> = None;
    for subset in subsets(items) {
        let chosen: Vec<Pair> = subset.iter().flat_map(|i| items[*i].clone()).collect();
        let Some(transform) = fit(&chosen) else {
            continue;
        };
        let mut each: Vec<f64> = items.iter().map(|i| rms(&transform, i)).collect();
        each.sort_by(f64::total_cmp);
        if best.as_ref().is_none_or(|(score, _)| each[half] < *score) {
            best = Some((each[half], transform));
        }
    }
    let (_, mut transform) = best?;
    let mut bad = keep_half(items, &transform);
    let mut level = 0.0;
    for _ in 0..ROUNDS {
        let good: Vec<Pair> = chosen(items, &bad);
        transform = fit(&good)?;
        let freedom = (3 * good.len()).saturating_sub(6).max(1) as f64;
        level = (3.0 * misfit(&transform, &good) / freedom).sqrt();
        let agreeing = bad.iter().filter(|b| !**b).count();
        let allowed = limit(level, agreeing);
        let next: Vec<bool> = items.iter().map(|i| rms(&transform, i) > allowed).collect();
        if next == bad || next.iter().all(|b| *b) {
            break;
        }
        bad = next;
    }
    Some(with_transform(items, transform, bad, level))
}

/// Judges a transform that is given.
pub(super) fn judge(items: &[Vec<Pair>], transform: &Isometry3<f64>) -> Frame {
    let bad = keep_half(items, transform);
    let good = chosen(items, &bad);
    let level = rms(transform, &good);
    let allowed = limit(level, items.len());
    let bad = items.iter().map(|i| rms(transform, i) > allowed).collect();
    with_transform(items, *transform, bad, level)
}

fn with_transform(
    items: &[Vec<Pair>],
    base_from_tracker: Isometry3<f64>,
    bad: Vec<bool>,
    level: f64,
) -> Frame {
    let rms: Vec<f64> = items.iter().map(|i| rms(&base_from_tracker, i)).collect();
    let mut sorted = rms.clone();
    sorted.sort_by(f64::total_cmp);
    let left_out = match sorted.len() {
        0..4 => 0,
        n => ((n as f64 * TRIMMED) as usize).max(1),
    };
    sorted.truncate(sorted.len() - left_out);
    let squares: f64 = sorted.iter().map(|r| r * r).sum();
    Frame {
        trimmed: (squares / sorted.len().max(1) as f64).sqrt(),
        base_from_tracker,
        rms,
        bad,
        level,
    }
}

fn chosen(items: &[Vec<Pair>], bad: &[bool]) -> Vec<Pair> {
    let good = items.iter().zip(bad).filter(|(_, bad)| !**bad);
    good.flat_map(|(item, _)| item.clone()).collect()
}

/// All but the better half of the items counted as bad.
fn keep_half(items: &[Vec<Pair>], transform: &Isometry3<f64>) -> Vec<bool> {
    let each: Vec<f64> = items.iter().map(|i| rms(transform, i)).collect();
    let mut sorted = each.clone();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.get(items.len() / 2).copied().unwrap_or(0.0);
    each.iter().map(|r| *r > middle).collect()
}

/// Small sets of items to start from: single ones with three points or more and
/// pairs, or triples where single points are read.
fn subsets(items: &[Vec<Pair>]) -> Vec<Vec<usize>> {
    let count = items.len();
    let mut out: Vec<Vec<usize>> = vec![(0..count).collect()];
    let whole = |i: &usize| {
        let points: Vec<Vector3<f64>> = items[*i].iter().map(|p| p.1).collect();
        is_spread(&points)
    };
    out.extend((0..count).filter(whole).map(|i| vec![i]));
    let mut larger = Vec::new();
    let triples = out.len() < 2;
    for c in 0..count {
        for b in 0..c {
            if triples {
                larger.extend((0..b).map(|a| vec![a, b, c]));
            } else {
                larger.push(vec![b, c]);
            }
        }
    }
    let step = larger.len().div_ceil(STARTS).max(1);
    out.extend(larger.into_iter().step_by(step));
    out
}
