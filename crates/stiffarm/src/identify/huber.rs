//! Huber's estimator on whole displacements.

use crate::error::Result;
use crate::information::Factor;
use nalgebra::{DMatrix, DVector};

/// Residuals of a displacement beyond this many σ count less: 95 % efficiency
/// for normal errors in three dimensions (in one dimension it is 1.345).
const THRESHOLD: f64 = 1.628;
/// Median of the norm of three standard normal components.
const MEDIAN_NORM: f64 = 1.538_172_3;
/// Reweightings after which the values are taken as they are.
const ITERATIONS: usize = 200;
/// Relative change of the fit that ends the iteration.
const TOLERANCE: f64 = 1e-12;

/// What Huber's estimator finds.
pub(super) struct Huber {
    pub values: DVector<f64>,
    /// Weight of each displacement (three rows), 1 where it fits.
    pub weights: Vec<f64>,
    pub covariance: Option<DMatrix<f64>>,
    /// Scale of a component \[m\].
    pub sigma: f64,
}

/// Reweighted least squares: a displacement with residual norm r counts with
/// weight min(1, c·s/r), where the scale s comes from the median of the norms.
pub(super) fn huber(psi: &DMatrix<f64>, factor: &Factor, delta: &DVector<f64>) -> Result<Huber> {
    let (rows, count) = (psi.nrows(), psi.nrows() / 3);
    let rank = factor.rank();
    let mut values = factor.solve(delta);
    let mut weights = vec![1.0; count];
    let mut sigma = 0.0;
    let norms = |values: &DVector<f64>| -> Vec<f64> {
        let residual = delta - psi * values;
        (0..count)
            .map(|d| residual.fixed_rows::<3>(3 * d).norm())
            .collect()
    };
    let size = delta.norm();
    for _ in 0..ITERATIONS {
        let now = norms(&values);
        // Fitted residuals are smaller than errors by the square root of this.
        let free = (rows - rank.min(rows)) as f64 / rows as f64;
        if free <= 0.0 {
            break;
        }
        sigma = crate::simulate::median(&now) / (MEDIAN_NORM * free.sqrt());
        if sigma <= 64.0 * f64::EPSILON * size {
            break;
        }
        for (weight, norm) in weights.iter_mut().zip(&now) {
            *weight = (THRESHOLD * sigma / norm).min(1.0);
        }
        let mut weighted = psi.clone();
        let mut right = delta.clone();
        for (d, weight) in weights.iter().enumerate() {
            weighted.rows_mut(3 * d, 3).scale_mut(weight.sqrt());
            right.rows_mut(3 * d, 3).scale_mut(weight.sqrt());
        }
        let next = Factor::new(&weighted)?.solve(&right);
        let change = (psi * (&next - &values)).norm();
        values = next;
        if change <= TOLERANCE * size {
            break;
        }
    }
    Ok(Huber {
        covariance: covariance(factor, &norms(&values), sigma, rank),
        values,
        weights,
        sigma,
    })
}

/// Huber's asymptotic covariance with his correction for few rows (Huber &
/// Ronchetti, Robust Statistics, 2009, section 7.6), for spherical errors:
/// K² Σψ²/(rows − n) / mean(a)² (ΨᵀΨ)⁻¹, a the mean derivative of ψ.
fn covariance(factor: &Factor, norms: &[f64], sigma: f64, rank: usize) -> Option<DMatrix<f64>> {
    let rows = 3 * norms.len();
    if rows <= rank {
        return None;
    }
    if sigma <= 0.0 {
        return Some(factor.inverse_information() * 0.0);
    }
    let limit = THRESHOLD * sigma;
    let squares: f64 = norms.iter().map(|r| r.min(limit).powi(2)).sum();
    let slope = |r: &f64| {
        if *r <= limit {
            1.0
        } else {
            2.0 / 3.0 * limit / r
        }
    };
    let count = norms.len() as f64;
    let mean = norms.iter().map(slope).sum::<f64>() / count;
    let spread = norms.iter().map(|r| (slope(r) - mean).powi(2)).sum::<f64>() / count;
    let correction = 1.0 + rank as f64 / rows as f64 * spread / (mean * mean);
    let scale = correction * correction * squares / (rows - rank) as f64 / (mean * mean);
    Some(factor.inverse_information() * scale)
}
