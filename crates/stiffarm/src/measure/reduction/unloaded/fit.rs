//! Robust fit over postures, and how sure its turn is.

use super::UnloadedPosture;
use crate::error::Result;
use crate::measure::registration::{Agreement, Pair, PointPair, Registration, TurnSums, register, robust};
use nalgebra::Vector3;

/// A posture whose residual is so many times that of the others disagrees. With
/// joint offsets of 0.05° fewer than one posture in 500 does by chance.
const DISAGREES: f64 = 8.0;
/// … and so many times the noise of a reading.
pub(super) const ABOVE_NOISE: f64 = 10.0;
/// Rounding: no residual below it counts \[m\].
pub(super) const ROUNDING: f64 = 1e-9;
/// Postures of which none is left out: too few to tell which one is wrong.
const FEW: usize = 3;

/// A fit and the postures behind it.
pub(super) struct Fit {
    pub(super) registration: Registration,
    pub(super) used: Vec<bool>,
}

/// The pairs of the postures that are `used`.
fn pairs(seen: &[UnloadedPosture<'_>], used: &[bool]) -> Vec<PointPair> {
    let chosen = seen.iter().zip(used).filter(|(_, used)| **used);
    chosen.flat_map(|(s, _)| s.pairs.iter().cloned()).collect()
}

/// Fits the postures that agree with each other.
pub(super) fn robust_fit(seen: &[UnloadedPosture<'_>], reading_std: f64) -> Result<Fit> {
    let floor = (ABOVE_NOISE * reading_std).max(ROUNDING);
    let agreement = Agreement {
        factor: DISAGREES,
        floor,
        floor_few: floor,
        many: 0,
        most: |count| (2 * count).div_ceil(3),
        least: if seen.iter().all(|s| s.pairs.len() > 1) { 3 } else { 4 },
    };
    let groups: Vec<Vec<Pair>> = seen.iter().map(|s| s.positions().collect()).collect();
    let fit = if seen.len() > FEW { robust(&groups, agreement) } else { None };
    let used = fit.map_or_else(|| vec![true; seen.len()], |fit| fit.bad.iter().map(|bad| !bad).collect());
    let registration = register(&pairs(seen, &used))?;
    Ok(Fit { registration, used })
}

/// Jackknife standard error of the turn, base axes.
pub(super) fn jackknife(seen: &[UnloadedPosture<'_>], full: &Fit) -> Option<[f64; 3]> {
    let chosen = seen.iter().zip(&full.used).filter(|(_, used)| **used);
    let used: Vec<&UnloadedPosture<'_>> = chosen.map(|(s, _)| s).collect();
    if used.len() < 3 {
        return None;
    }
    let base = full.registration.centroid;
    let to_tracker = full.registration.base_from_tracker.inverse();
    let origins = (to_tracker.rotation * base + to_tracker.translation.vector, base);
    let sums = |seen: &UnloadedPosture<'_>| TurnSums::of(seen.positions(), &origins);
    let all = TurnSums::of(used.iter().flat_map(|s| s.positions()), &origins);
    let inverse = full.registration.base_from_tracker.rotation.inverse();
    let turns = used.iter().map(|left_out| {
        let other = all.without(&sums(left_out))?;
        Some((other * inverse).scaled_axis())
    });
    let turns = turns.collect::<Option<Vec<Vector3<f64>>>>()?;
    let count = turns.len() as f64;
    let mean = turns.iter().sum::<Vector3<f64>>() / count;
    let squares = turns.iter().map(|t| (t - mean).component_mul(&(t - mean)));
    let variance = squares.sum::<Vector3<f64>>() * ((count - 1.0) / count);
    Some(variance.map(f64::sqrt).into())
}
