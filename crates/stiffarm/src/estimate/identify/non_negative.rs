//! Least squares with compliances at or above zero: the active-set method of
//! Lawson & Hanson (Solving Least Squares Problems, 1974, chapter 23), each
//! subproblem by QR and SVD.

use crate::error::{Code, Error, Result};
use crate::numerics::information::{Factor, ZERO_COLUMN};
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
    // Rounding errors in place of a column would be released by chance.
    let empty = ZERO_COLUMN * norms.iter().fold(0.0_f64, |m, norm| m.max(*norm));
    let mut candidates: Vec<usize> = (0..bounded).filter(|j| norms[*j] > empty).collect();
    let tolerance = 1e-10 * delta.norm();
    let mut values = solve(&free)?;
    for _ in 0..20 * (n + 1) {
        let gradient = psi.tr_mul(&(delta - psi * &values));
        // The bounded unknown whose release helps most, per unit of its column.
        let next = candidates
            .iter()
            .filter(|j| !free.contains(j))
            .map(|&j| (j, gradient[j] / norms[j]))
            .filter(|(_, g)| *g > tolerance)
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((released, _)) = next else {
            return Ok((values, free));
        };
        free.push(released);
        free.sort_unstable();
        let mut first = true;
        loop {
            let candidate = solve(&free)?;
            let blocking = free
                .iter()
                .filter(|j| **j < bounded && candidate[**j] <= 0.0)
                .map(|&j| if values[j] > 0.0 { (j, values[j] / (values[j] - candidate[j])) } else { (j, 0.0) })
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let Some((blocked, step)) = blocking else {
                values = candidate;
                break;
            };
            values += (candidate - &values) * step;
            let dust = |j: usize| 1e-14 * delta.norm() / norms[j];
            free.retain(|&j| j >= bounded || (j != blocked && values[j] > dust(j)));
            for j in 0..bounded {
                if !free.contains(&j) {
                    values[j] = 0.0;
                }
            }
            if first && !free.contains(&released) {
                // Rounding released what the data push back: leave it.
                candidates.retain(|j| *j != released);
            }
            first = false;
        }
    }
    Err(Error::new(Code::Numerical, "The non-negative least squares did not converge."))
}
