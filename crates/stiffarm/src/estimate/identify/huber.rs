//! Huber's estimator on whole displacements.

use crate::error::Result;
use crate::numerics::information::Factor;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Residuals beyond this many σ count less: 95 % efficiency for normal errors
/// in 1, 2, … dimensions (a displacement has three, a clamped posture up to six).
const THRESHOLDS: [f64; 6] = [1.345, 1.501, 1.628, 1.731, 1.812, 1.869];
/// Median of the norm of 1, 2, … standard normal components.
const MEDIAN_NORMS: [f64; 6] = [0.674_489_8, 1.177_410_0, 1.538_172_3, 1.832_128_3, 2.086_015_4, 2.312_600_4];
/// Reweightings after which the values are taken as they are.
const ITERATIONS: usize = 200;
/// Relative change of the fit that ends the iteration.
const TOLERANCE: f64 = 1e-12;

/// What Huber's estimator finds.
pub(super) struct Huber {
    pub values: DVector<f64>,
    /// Weight of each group of rows, 1 where it fits.
    pub weights: Vec<f64>,
    pub covariance: Option<DMatrix<f64>>,
    /// Scale of a component \[m\].
    pub sigma: f64,
}

/// Constant of a group with this many rows.
fn of(table: &[f64; 6], rows: usize) -> f64 {
    table[rows.clamp(1, table.len()) - 1]
}

/// Reweighted least squares: a group of rows with residual norm r counts with
/// weight min(1, c·s/r), where the scale s comes from the median of the norms.
pub(super) fn huber(
    psi: &DMatrix<f64>,
    factor: &Factor,
    delta: &DVector<f64>,
    groups: &[Range<usize>],
) -> Result<Huber> {
    let rows = psi.nrows();
    let rank = factor.rank();
    let mut values = factor.solve(delta);
    let mut weights = vec![1.0; groups.len()];
    let mut sigma = 0.0;
    let norms = |values: &DVector<f64>| -> Vec<f64> {
        let residual = delta - psi * values;
        groups.iter().map(|g| residual.rows(g.start, g.len()).norm()).collect()
    };
    let size = delta.norm();
    for _ in 0..ITERATIONS {
        let now = norms(&values);
        // Fitted residuals are smaller than errors by the square root of this.
        let free = (rows - rank.min(rows)) as f64 / rows as f64;
        if free <= 0.0 {
            break;
        }
        let scaled: Vec<f64> = now.iter().zip(groups).map(|(norm, g)| norm / of(&MEDIAN_NORMS, g.len())).collect();
        sigma = crate::numerics::sample::median(&scaled) / free.sqrt();
        if sigma <= 64.0 * f64::EPSILON * size {
            break;
        }
        let mut weighted = psi.clone();
        let mut right = delta.clone();
        for ((weight, norm), g) in weights.iter_mut().zip(&now).zip(groups) {
            *weight = (of(&THRESHOLDS, g.len()) * sigma / norm).min(1.0);
            weighted.rows_mut(g.start, g.len()).scale_mut(weight.sqrt());
            right.rows_mut(g.start, g.len()).scale_mut(weight.sqrt());
        }
        let next = Factor::new(&weighted)?.solve(&right);
        let change = (psi * (&next - &values)).norm();
        values = next;
        if change <= TOLERANCE * size {
            break;
        }
    }
    Ok(Huber { covariance: covariance(factor, &norms(&values), groups, sigma), values, weights, sigma })
}

/// Huber's asymptotic covariance with his correction for few rows (Huber &
/// Ronchetti, Robust Statistics, 2009, section 7.6), for spherical errors:
/// K² Σψ²/(rows − n) / mean(a)² (ΨᵀΨ)⁻¹, a the mean derivative of ψ.
fn covariance(factor: &Factor, norms: &[f64], groups: &[Range<usize>], sigma: f64) -> Option<DMatrix<f64>> {
    let rows: usize = groups.iter().map(Range::len).sum();
    let rank = factor.rank();
    if rows <= rank {
        return None;
    }
    if sigma <= 0.0 {
        return Some(factor.inverse_information() * 0.0);
    }
    let limit = |g: &Range<usize>| of(&THRESHOLDS, g.len()) * sigma;
    let squares: f64 = norms.iter().zip(groups).map(|(r, g)| r.min(limit(g)).powi(2)).sum();
    // Of d directions one is cut to zero slope, the others keep limit/r.
    let slope = |r: f64, g: &Range<usize>| {
        if r <= limit(g) { 1.0 } else { (g.len() as f64 - 1.0) / g.len() as f64 * limit(g) / r }
    };
    let share = |g: &Range<usize>| g.len() as f64 / rows as f64;
    let pairs = || norms.iter().zip(groups);
    let mean: f64 = pairs().map(|(r, g)| share(g) * slope(*r, g)).sum();
    let spread: f64 = pairs().map(|(r, g)| share(g) * (slope(*r, g) - mean).powi(2)).sum();
    if mean <= 0.0 {
        return None;
    }
    let correction = 1.0 + rank as f64 / rows as f64 * spread / (mean * mean);
    let scale = correction * correction * squares / (rows - rank) as f64 / (mean * mean);
    Some(factor.inverse_information() * scale)
}
