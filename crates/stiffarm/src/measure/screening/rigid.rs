//! Rigid fits of points, and the other orders in which points can be labelled.

use crate::measure::registration::rigid_transform;
pub(super) use crate::measure::registration::{Pair, is_spread, misfit, moved};
use nalgebra::Isometry3;

/// Least-squares rigid transform, second from first, det = +1; directions that
/// the points leave open are taken as they come. `None` without two pairs.
pub(super) fn fit(pairs: &[Pair]) -> Option<Isometry3<f64>> {
    if pairs.len() < 2 {
        return None;
    }
    rigid_transform(pairs.iter().copied())
}

/// RMS of the distances that the best rigid transform leaves \[m\].
pub(super) fn best_rms(pairs: &[Pair]) -> f64 {
    match fit(pairs) {
        Some(transform) => (misfit(&transform, pairs) / pairs.len() as f64).sqrt(),
        None => 0.0,
    }
}
