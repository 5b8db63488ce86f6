//! Least squares with compliances at or above zero: the active-set method of
//! Lawson & Hanson (Solving Least Squares Problems, 1974, chapter 23), each
//! subproblem by QR and SVD.

use crate::error::{Code, Error, Result};
use crate::information::Factor;
use nalgebra::{DMatrix, DVector};

/// Minimises ‖Ψx − Δ‖ with x_j ≥ 0 for j < `bounded`: the values, and which
/// unknowns are free, ascending.
///
/// # Errors
/// A decomposition that fails, or no end of the exchange of active unknowns.
pub(super) fn non_negative(
    psi: &DMatrix<f64>,
    delta: &DVector<f64>,
    bounded: usize,
) -> Result<(DVector<f64>, Vec<usize>)> {
    let n = psi.ncols();
    let mut free: Vec<usize> = (bounded..n).collect();
    let solve = |free: &[usize]| -> Result<DVector<f64>> {
        let mut all = DVector::zeros(n);
        if free.is_empty() {
            return Ok(all);
        }
        let part = Factor::new(&psi.select_columns(free))?.solve(delta);
        for (value, j) in part.iter().zip(free) {
            all[*j] = *value;
        }
        Ok(all)
    };
    let norms: Vec<f64> = psi.column_iter().map(|c| c.norm()).collect();
    let tolerance = 1e-10 * delta.norm();
    let mut values = solve(&free)?;
    for _ in 0..20 * (n + 1) {
        let gradient = psi.tr_mul(&(delta - psi * &values));
        // The bounded unknown whose release helps most, per unit of its column.
        let next = (0..bounded)
            .filter(|j| !free.contains(j) && norms[*j] > 0.0)
            .map(|j| (j, gradient[j] / norms[j]))
            .filter(|(_, g)| *g > tolerance)
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((released, _)) = next else {
            return Ok((values, free));
        };
        free.push(released);
        free.sort_unstable();
        loop {
            let candidate = solve(&free)?;
            let blocked = |j: &&usize| **j < bounded && candidate[**j] <= 0.0;
            let step = free
                .iter()
                .filter(blocked)
                .map(|&j| values[j] / (values[j] - candidate[j]))
                .fold(f64::INFINITY, f64::min);
            if step.is_infinite() {
                values = candidate;
                break;
            }
            values += (candidate - &values) * step.clamp(0.0, 1.0);
            let dust: Vec<f64> = norms
                .iter()
                .map(|norm| 1e-14 * delta.norm() / norm)
                .collect();
            free.retain(|&j| j >= bounded || values[j] > dust[j]);
            for j in 0..bounded {
                if !free.contains(&j) {
                    values[j] = 0.0;
                }
            }
            if !free.contains(&released) {
                // Rounding released what the data push back: leave it.
                return Ok((solve(&free)?, free));
            }
        }
    }
    Err(Error::new(
        Code::Numerical,
        "The non-negative least squares did not end.",
    ))
}
