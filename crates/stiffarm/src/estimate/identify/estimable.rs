//! What data that cannot separate the joints do determine: combinations of
//! compliances, and which unknowns they cannot separate.

use super::solve::Solution;
use super::system::MeasuredSystem;
use crate::numerics::information::{Svd, scale_columns, svd};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// A direction whose relative standard error is above this is not determined.
const WEAK: f64 = 0.5;
/// Coefficients below this, in relative compliances, are left out of a sum.
const NEGLIGIBLE: f64 = 1e-3;
/// A sum without a second coefficient above this stands for its first unknown.
const COMBINED: f64 = 0.1;

/// A sum of compliances that the data determine although they cannot tell its
/// parts from each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EstimableCombination {
    /// Names of the unknowns.
    pub unknowns: Vec<String>,
    /// Their coefficients; the first is 1.
    pub coefficients: Vec<f64>,
    /// Value of the sum: Σ coefficient · compliance \[rad/(N·m)\].
    pub compliance: f64,
    /// Its standard error, where the size of the noise is known.
    pub standard_error: Option<f64>,
}

/// Share of its variance that an unknown has from what is not determined, and
/// correlation by it, from which on unknowns belong together.
const TOGETHER: f64 = 0.5;

/// Unknowns whose columns of Ψ are collinear as far as the noise lets tell: the
/// data determine only some combinations of them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CollinearSet {
    /// Names of the unknowns.
    pub unknowns: Vec<String>,
    /// How many combinations of them the data determine.
    pub determined: usize,
}

/// The directions of the relative unknowns (columns) with their singular
/// values per unit of σ, the best first, and how many of them are determined.
fn directions(solution: &Solution, reference: &[f64]) -> Option<(Svd, usize)> {
    let seen = solution.factor.seen();
    let sigma = solution.sigma.unwrap_or(0.0);
    let mut relative = seen.resize_vertically(reference.len(), 0.0);
    scale_columns(&mut relative, reference.iter().copied());
    let decomposition = svd(relative)?;
    let good = (0..solution.factor.rank())
        .filter(|&i| decomposition.values[i] > 0.0 && sigma <= WEAK * decomposition.values[i])
        .count();
    Some((decomposition, good))
}

/// Sets of unknowns that `solution` determines only together, although each has
/// a column of its own; `reference` as in [`estimable_combinations`].
pub(super) fn collinear_sets(system: &MeasuredSystem, solution: &Solution, reference: &[f64]) -> Vec<CollinearSet> {
    let n = system.unknowns.len();
    let Some((Svd { values, v, .. }, good)) = directions(solution, reference) else {
        return Vec::new();
    };
    // Covariance of the relative unknowns per σ²: of the directions that are not
    // determined, and whole. What is lost exactly is named as undetermined.
    let covariance = |range: std::ops::Range<usize>, j: usize, k: usize| -> f64 {
        let parts = range.filter(|i| values[*i] > 0.0);
        parts.map(|i| v[(j, i)] * v[(k, i)] / values[i].powi(2)).sum()
    };
    let rank = solution.factor.rank();
    let whole: Vec<f64> = (0..n).map(|j| covariance(0..rank, j, j)).collect();
    let sigma = solution.sigma.unwrap_or(0.0);
    let mut left: Vec<usize> = (0..n)
        .filter(|j| !solution.undetermined.contains(j) && sigma * whole[*j].sqrt() > WEAK)
        .filter(|j| covariance(good..rank, *j, *j) > TOGETHER * whole[*j])
        .collect();
    let mut out = Vec::new();
    while let Some(first) = left.first().copied() {
        // All that hang together with the first, directly or by others.
        let mut set = vec![first];
        let mut at = 0;
        while let Some(&j) = set.get(at) {
            let joined = |k: &usize| {
                let limit = TOGETHER * (whole[j] * whole[*k]).sqrt();
                !set.contains(k) && covariance(good..rank, j, *k).abs() > limit
            };
            let more: Vec<usize> = left.iter().copied().filter(joined).collect();
            set.extend(more);
            at += 1;
        }
        left.retain(|j| !set.contains(j));
        set.sort_unstable();
        // Where each is lost by itself there is no set.
        let lost = (good..rank).filter(|i| set.contains(&v.column(*i).iamax()));
        let determined = set.len().saturating_sub(lost.count());
        if determined > 0 && set.len() > 1 {
            out.push(CollinearSet { unknowns: set.iter().map(|j| system.unknowns[*j].clone()).collect(), determined });
        }
    }
    out
}

/// The combinations that `solution` determines, if it cannot separate all
/// unknowns; empty where each stands for itself. `reference` is the size of
/// each unknown against which an error counts as large.
pub(super) fn estimable_combinations(
    system: &MeasuredSystem,
    solution: &Solution,
    reference: &[f64],
) -> Vec<EstimableCombination> {
    let n = system.unknowns.len();
    let Some((Svd { v, .. }, good)) = directions(solution, reference) else {
        return Vec::new();
    };
    if good == n || good == 0 {
        return Vec::new();
    }
    let mut rows = v.columns(0, good).transpose();
    let pivots = reduce(&mut rows);
    let mut out = Vec::new();
    for (i, pivot) in pivots.into_iter().enumerate() {
        let others = (0..n).filter(|j| *j != pivot && rows[(i, *j)].abs() > NEGLIGIBLE);
        let parts: Vec<usize> = std::iter::once(pivot).chain(others).collect();
        if parts[1..].iter().all(|j| rows[(i, *j)].abs() < COMBINED) {
            continue;
        }
        let mut coefficients = DVector::zeros(n);
        for &j in &parts {
            coefficients[j] = rows[(i, j)] * reference[pivot] / reference[j];
        }
        let variance = solution.covariance.as_ref().map(|c| coefficients.dot(&(c * &coefficients)));
        out.push(EstimableCombination {
            unknowns: parts.iter().map(|j| system.unknowns[*j].clone()).collect(),
            coefficients: parts.iter().map(|j| coefficients[*j]).collect(),
            compliance: coefficients.dot(&solution.values),
            standard_error: variance.map(|v| v.max(0.0).sqrt()),
        });
    }
    out
}

/// Reduced row echelon form with the largest pivots first; the pivot columns.
fn reduce(rows: &mut DMatrix<f64>) -> Vec<usize> {
    let (count, n) = rows.shape();
    let mut pivots = Vec::with_capacity(count);
    for i in 0..count {
        let mut best = (i, 0, 0.0);
        for r in i..count {
            for j in (0..n).filter(|j| !pivots.contains(j)) {
                if rows[(r, j)].abs() > best.2 {
                    best = (r, j, rows[(r, j)].abs());
                }
            }
        }
        let (r, j, _) = best;
        rows.swap_rows(i, r);
        let scale = 1.0 / rows[(i, j)];
        rows.row_mut(i).scale_mut(scale);
        for other in (0..count).filter(|o| *o != i) {
            let factor = rows[(other, j)];
            let pivot_row = rows.row(i) * factor;
            let mut row = rows.row_mut(other);
            row -= pivot_row;
        }
        pivots.push(j);
    }
    pivots
}
