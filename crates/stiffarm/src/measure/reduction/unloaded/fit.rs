//! Robust fit over postures.
//!
//! The start is a least quantile of squares (Rousseeuw, J. Am. Stat. Assoc. 79,
//! 1984, 871–880, doi:10.1080/01621459.1984.10477105): of the rigid fits to small
//! subsets of postures, the one with the smallest quantile of the postures'
//! residuals. Least squares over the postures that agree with it finish it.

use super::Seen;
use crate::error::Result;
use crate::measure::registration::{PointPair, Registration, register, rigid_transform};
use nalgebra::{Isometry3, Vector3};

/// A posture whose residual is so many times that of the others disagrees. With
/// joint offsets of 0.05° fewer than one posture in 500 does by chance.
const DISAGREES: f64 = 8.0;
/// … and so many times the noise of a reading.
pub(super) const ABOVE_NOISE: f64 = 10.0;
/// Rounding: no residual below it counts \[m\].
pub(super) const ROUNDING: f64 = 1e-9;
/// Subsets of postures tried for the start.
const SUBSETS: usize = 2000;
/// Rounds of fit and choice of postures.
const ROUNDS: usize = 20;

/// A fit and the postures behind it.
pub(super) struct Fit {
    pub(super) registration: Registration,
    pub(super) used: Vec<bool>,
}

/// The pairs of the postures that are `used`.
fn pairs(seen: &[Seen<'_>], used: &[bool]) -> Vec<PointPair> {
    let chosen = seen.iter().zip(used).filter(|(_, used)| **used);
    chosen.flat_map(|(s, _)| s.pairs.iter().cloned()).collect()
}

/// The rigid transform of the postures that are `used`.
fn transform_of(seen: &[Seen<'_>], used: &[bool]) -> Option<Isometry3<f64>> {
    let chosen = seen.iter().zip(used).filter(|(_, used)| **used);
    rigid_transform(chosen.flat_map(|(s, _)| s.pairs.iter().map(|p| (p.tracker, p.base))))
}

/// Fits the postures that agree with each other; see the module.
pub(super) fn robust_fit(seen: &[Seen<'_>], reading_std: f64) -> Result<Fit> {
    let count = seen.len();
    let size: usize = match seen.iter().all(|s| s.pairs.len() > 1) {
        true => 2,
        false => 3,
    };
    // So many postures have to agree: two thirds, and one more than fit themselves.
    let agreeing = (2 * count).div_ceil(3).max(size + 1);
    let all = vec![true; count];
    let finish = |used: Vec<bool>| {
        let registration = register(&pairs(seen, &used))?;
        Ok(Fit { registration, used })
    };
    if agreeing >= count {
        return finish(all);
    }
    let mut start: Option<(f64, Isometry3<f64>)> = None;
    for subset in subsets(count, size) {
        let mut used = vec![false; count];
        subset.iter().for_each(|i| used[*i] = true);
        // A subset on a line fits anyhow: its turn, and so its score, is bad.
        let Some(candidate) = transform_of(seen, &used) else {
            continue;
        };
        let score = quantile(seen, &candidate, agreeing);
        if start.is_none_or(|(best, _)| score < best) {
            start = Some((score, candidate));
        }
    }
    let Some((_, mut transform)) = start else {
        return finish(all);
    };
    let mut used = vec![false; count];
    for _ in 0..ROUNDS {
        let typical = quantile(seen, &transform, agreeing).sqrt();
        let limit = (DISAGREES * typical)
            .max(ABOVE_NOISE * reading_std)
            .max(ROUNDING);
        let agree = seen
            .iter()
            .map(|s| s.mean_square(&transform).sqrt() <= limit);
        let agree: Vec<bool> = agree.collect();
        if agree == used {
            break;
        }
        used = agree;
        match transform_of(seen, &used) {
            Some(next) => transform = next,
            None => return finish(all),
        }
    }
    finish(used)
}

/// The `rank`-th smallest mean square residual of a posture.
fn quantile(seen: &[Seen<'_>], transform: &Isometry3<f64>, rank: usize) -> f64 {
    let mut squares: Vec<f64> = seen.iter().map(|s| s.mean_square(transform)).collect();
    squares.sort_by(f64::total_cmp);
    squares[rank.clamp(1, squares.len()) - 1]
}

/// Subsets of two or three of `count`, evenly thinned where there are too many.
fn subsets(count: usize, size: usize) -> Vec<Vec<usize>> {
    let mut all = Vec::new();
    for i in 0..count {
        for j in i + 1..count {
            match size {
                2 => all.push(vec![i, j]),
                _ => all.extend((j + 1..count).map(|k| vec![i, j, k])),
            }
        }
    }
    let step = all.len().div_ceil(SUBSETS).max(1);
    all.into_iter().step_by(step).collect()
}

/// Jackknife standard error of the turn, base axes.
pub(super) fn jackknife(seen: &[Seen<'_>], full: &Fit) -> Option<[f64; 3]> {
    let used: Vec<usize> = (0..seen.len()).filter(|i| full.used[*i]).collect();
    if used.len() < 3 {
        return None;
    }
    let inverse = full.registration.base_from_tracker.rotation.inverse();
    let turns = used.iter().map(|left_out| {
        let mut without = full.used.clone();
        without[*left_out] = false;
        let other = transform_of(seen, &without)?;
        Some((other.rotation * inverse).scaled_axis())
    });
    let turns = turns.collect::<Option<Vec<Vector3<f64>>>>()?;
    let count = turns.len() as f64;
    let mean = turns.iter().sum::<Vector3<f64>>() / count;
    let squares = turns.iter().map(|t| (t - mean).component_mul(&(t - mean)));
    let variance = squares.sum::<Vector3<f64>>() * ((count - 1.0) / count);
    Some(variance.map(f64::sqrt).into())
}
