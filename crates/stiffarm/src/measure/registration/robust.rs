//! Registration over groups of pairs, a few of which disagree with the rest:
//! the points of a posture are right or wrong together.
//!
//! The start is a least quantile of squares (Rousseeuw, J. Am. Stat. Assoc. 79, 1984,
//! 871–880, doi:10.1080/01621459.1984.10477105): of the rigid fits to single
//! groups and small sets of them the one that most groups lie nearest to. Least
//! squares over the groups that agree finish it, until they stay the same.

use super::fit::{frame, is_spread};
use super::rigid_transform;
use crate::numerics::arrangements::{choose, set};
use crate::numerics::information::svd;
use nalgebra::{DMatrix, Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Two positions of one point: where it is seen, where it should be \[m\].
pub(in crate::measure) type Pair = (Vector3<f64>, Vector3<f64>);

/// Sets of groups that are tried as a start, beside as many single groups.
const STARTS: usize = 200;
/// Rounds of fit and choice of groups.
const ROUNDS: usize = 20;

/// When a group disagrees with the others.
#[derive(Debug, Clone, Copy)]
pub(in crate::measure) struct Agreement {
    /// Its RMS residual is above this many times that of the others …
    pub factor: f64,
    /// … and above this \[m\].
    pub floor: f64,
    /// The same where fewer than `many` groups agree with each other, which a
    /// few may do by chance \[m\].
    pub floor_few: f64,
    /// Groups that are more than a few.
    pub many: usize,
    /// Of so many groups so many have to agree to begin with, and at least
    /// `least`.
    pub most: fn(usize) -> usize,
    pub least: usize,
}

impl Agreement {
    /// Groups of `count` that have to agree to begin with.
    fn start(&self, count: usize) -> usize {
        (self.most)(count).max(self.least).clamp(1, count.max(1))
    }

    /// RMS residual above which a group disagrees with `agreeing` others, whose
    /// own is `level` \[m\].
    pub(in crate::measure) fn limit(&self, level: f64, agreeing: usize) -> f64 {
        let floor = if agreeing < self.many { self.floor_few } else { self.floor };
        (self.factor * level).max(floor)
    }
}

/// A registration with the groups that disagree.
#[derive(Debug, Clone)]
pub(in crate::measure) struct Robust {
    pub base_from_tracker: Isometry3<f64>,
    /// By group: it disagrees with the others.
    pub bad: Vec<bool>,
    /// RMS distance over the groups that agree, the six unknowns counted \[m\].
    pub level: f64,
}

/// `transform` applied to a point.
pub(in crate::measure) fn moved(transform: &Isometry3<f64>, point: &Vector3<f64>) -> Vector3<f64> {
    transform.rotation * point + transform.translation.vector
}

/// Sum of the squared distances that `transform` leaves \[m²\].
pub(in crate::measure) fn misfit(transform: &Isometry3<f64>, pairs: &[Pair]) -> f64 {
    pairs.iter().map(|(a, b)| (moved(transform, a) - b).norm_squared()).sum()
}

/// RMS distance that `transform` leaves between pairs \[m\].
pub(in crate::measure) fn rms(transform: &Isometry3<f64>, pairs: &[Pair]) -> f64 {
    (misfit(transform, pairs) / pairs.len().max(1) as f64).sqrt()
}

/// Registers groups; `None` where the points do not determine a transform.
pub(in crate::measure) fn robust(groups: &[Vec<Pair>], agreement: Agreement) -> Option<Robust> {
    let all: Vec<Vector3<f64>> = groups.iter().flatten().map(|p| p.1).collect();
    if !is_spread(&all) {
        return None;
    }
    let start = agreement.start(groups.len());
    let mut best: Option<(f64, Isometry3<f64>)> = None;
    for set in starts(groups) {
        let chosen = set.iter().flat_map(|i| groups[*i].iter().copied());
        // A set on a line fits anyhow: its turn, and so its score, is bad.
        let Some(transform) = rigid_transform(chosen) else {
            continue;
        };
        let mut each: Vec<f64> = groups.iter().map(|g| misfit_mean(&transform, g)).collect();
        let (_, last, _) = each.select_nth_unstable_by(start - 1, f64::total_cmp);
        if best.as_ref().is_none_or(|(score, _)| *last < *score) {
            best = Some((*last, transform));
        }
    }
    let (_, mut transform) = best?;
    let mut bad = all_but_the_nearest(groups, &transform, start);
    let mut level = 0.0;
    for _ in 0..ROUNDS {
        let good: Vec<Pair> = agreeing(groups, &bad).collect();
        transform = rigid_transform(good.iter().copied())?;
        let freedom = (3 * good.len()).saturating_sub(6).max(1) as f64;
        level = (3.0 * misfit(&transform, &good) / freedom).sqrt();
        let allowed = agreement.limit(level, bad.iter().filter(|b| !**b).count());
        let next: Vec<bool> = groups.iter().map(|g| rms(&transform, g) > allowed).collect();
        if next == bad || next.iter().all(|b| *b) {
            break;
        }
        bad = next;
    }
    Some(Robust { base_from_tracker: transform, bad, level })
}

fn misfit_mean(transform: &Isometry3<f64>, pairs: &[Pair]) -> f64 {
    misfit(transform, pairs) / pairs.len().max(1) as f64
}

/// The pairs of the groups that are not `bad`.
pub(in crate::measure) fn agreeing<'a>(groups: &'a [Vec<Pair>], bad: &'a [bool]) -> impl Iterator<Item = Pair> + 'a {
    let good = groups.iter().zip(bad).filter(|(_, bad)| !**bad);
    good.flat_map(|(group, _)| group.iter().copied())
}

/// All but the `count` nearest groups counted as bad.
pub(in crate::measure) fn all_but_the_nearest(
    groups: &[Vec<Pair>],
    transform: &Isometry3<f64>,
    count: usize,
) -> Vec<bool> {
    let each: Vec<f64> = groups.iter().map(|g| rms(transform, g)).collect();
    let mut sorted = each.clone();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.get(count - 1).copied().unwrap_or(0.0);
    each.iter().map(|r| *r > last).collect()
}

/// Small sets of groups to start from: all of them, single ones with three
/// points or more, and pairs, or triples where single points are read; evenly
/// thinned where there are many.
fn starts(groups: &[Vec<Pair>]) -> Vec<Vec<usize>> {
    let count = groups.len();
    let whole = |i: &usize| {
        let points: Vec<Vector3<f64>> = groups[*i].iter().map(|p| p.1).collect();
        is_spread(&points)
    };
    let single: Vec<usize> = (0..count).step_by(count.div_ceil(STARTS).max(1)).collect();
    let mut out: Vec<Vec<usize>> = vec![(0..count).collect()];
    out.extend(single.into_iter().filter(whole).map(|i| vec![i]));
    let size = if out.len() < 2 { 3 } else { 2 };
    let sets = choose(count as u64, size);
    let step = sets.div_ceil(STARTS as u64).max(1);
    out.extend((0..sets).step_by(step as usize).map(|i| set(i, size)));
    out
}

/// Sums of pairs about two origins from which the best turn follows: those of
/// some pairs can be taken away from those of all.
#[derive(Debug, Clone, Copy)]
pub(in crate::measure) struct TurnSums {
    count: f64,
    tracker: Vector3<f64>,
    base: Vector3<f64>,
    cross: Matrix3<f64>,
}

impl TurnSums {
    /// Of `pairs`, their positions taken from `origins`.
    pub(in crate::measure) fn of(pairs: impl Iterator<Item = Pair>, origins: &Pair) -> Self {
        let mut out =
            TurnSums { count: 0.0, tracker: Vector3::zeros(), base: Vector3::zeros(), cross: Matrix3::zeros() };
        for (tracker, base) in pairs {
            let (tracker, base) = (tracker - origins.0, base - origins.1);
            out.count += 1.0;
            out.tracker += tracker;
            out.base += base;
            out.cross += base * tracker.transpose();
        }
        out
    }

    /// The turn, base from tracker, of these pairs but for `others`.
    pub(in crate::measure) fn without(&self, others: &TurnSums) -> Option<UnitQuaternion<f64>> {
        let count = self.count - others.count;
        let (tracker, base) = (self.tracker - others.tracker, self.base - others.base);
        let cross = self.cross - others.cross - base * tracker.transpose() / count;
        let parts = svd(DMatrix::from_iterator(3, 3, cross.iter().copied()))?;
        let turn = frame(&parts.u) * frame(&parts.v).transpose();
        let rotation = Rotation3::from_matrix_unchecked(turn);
        Some(UnitQuaternion::from_rotation_matrix(&rotation))
    }
}
