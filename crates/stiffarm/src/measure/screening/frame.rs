//! Registration of the unloaded readings to the kinematic model that a few bad
//! postures do not spoil.

use super::{Work, predicted};
pub(super) use crate::measure::registration::rms;
use crate::measure::registration::{Agreement, Pair, agreeing, all_but_the_nearest, robust};
use crate::model::observation::Setup;
use nalgebra::{Isometry3, Vector3};

/// What is below 0.5 mm does not matter to Ψ; three or four postures may agree
/// with each other by chance on a robot that is a few mm off.
const AGREEMENT: Agreement =
    Agreement { factor: 10.0, floor: 5e-4, floor_few: 5e-3, many: 5, most: |count| count / 2 + 1, least: 1 };
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
        AGREEMENT.limit(self.level, self.bad.iter().filter(|b| !**b).count())
    }

    /// Number of items that disagree.
    pub fn bad_count(&self) -> usize {
        self.bad.iter().filter(|b| **b).count()
    }
}

/// States without load, in the order of the items of a [`Frame`]: those with a
/// doubtful reading only where a posture has no other.
pub(super) fn items(work: &Work) -> Vec<(usize, usize)> {
    let mut out = Vec::new();
    for (p, posture) in work.sheet.postures.iter().enumerate() {
        let seen = |s: &usize| !posture.states[*s].seen().is_empty();
        let all: Vec<usize> = posture.references().into_iter().filter(seen).collect();
        let sure: Vec<usize> = all.iter().copied().filter(|s| posture.states[*s].doubtful.is_empty()).collect();
        let trusted = if sure.is_empty() { all } else { sure };
        out.extend(trusted.into_iter().map(|s| (p, s)));
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
pub(super) fn state_pairs(points: &[Option<super::sheet::Mean>], predicted: &[Vector3<f64>]) -> Vec<Pair> {
    points.iter().zip(predicted).filter_map(|(mean, at)| mean.map(|m| (m.position, *at))).collect()
}

/// Registers items: those that agree with each other. `None` where the points do
/// not determine a transform.
pub(super) fn register(items: &[Vec<Pair>]) -> Option<Frame> {
    let fit = robust(items, AGREEMENT)?;
    Some(with_transform(items, fit.base_from_tracker, fit.bad, fit.level))
}

/// Judges a transform that is given.
pub(super) fn judge(items: &[Vec<Pair>], transform: &Isometry3<f64>) -> Frame {
    let bad = all_but_the_nearest(items, transform, items.len() / 2 + 1);
    let good: Vec<Pair> = agreeing(items, &bad).collect();
    let level = rms(transform, &good);
    let allowed = AGREEMENT.limit(level, items.len());
    let bad = items.iter().map(|i| rms(transform, i) > allowed).collect();
    with_transform(items, *transform, bad, level)
}

fn with_transform(items: &[Vec<Pair>], base_from_tracker: Isometry3<f64>, bad: Vec<bool>, level: f64) -> Frame {
    let rms: Vec<f64> = items.iter().map(|i| rms(&base_from_tracker, i)).collect();
    let mut sorted = rms.clone();
    sorted.sort_by(f64::total_cmp);
    let left_out = match sorted.len() {
        0..4 => 0,
        n => ((n as f64 * TRIMMED) as usize).max(1),
    };
    sorted.truncate(sorted.len() - left_out);
    let squares: f64 = sorted.iter().map(|r| r * r).sum();
    Frame { trimmed: (squares / sorted.len().max(1) as f64).sqrt(), base_from_tracker, rms, bad, level }
}

/// Misfit above which a cause counts as undone \[m\]: an uncalibrated robot has a few mm.
pub(super) const PLAUSIBLE: f64 = 8e-3;

/// Registration by the readings themselves, or the given transform where they
/// do not determine one.
pub(super) fn fitted(work: &Work, stated_transform: Option<&Isometry3<f64>>) -> Option<Frame> {
    let at = items(work);
    let pairs = item_pairs(work, work.setup(), &at);
    match register(&pairs) {
        Some(frame) => Some(frame),
        None => stated_transform.filter(|_| !pairs.is_empty()).map(|transform| judge(&pairs, transform)),
    }
}
