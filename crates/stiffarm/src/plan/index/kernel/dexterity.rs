//! ln k(J_N), Eqs. (20)–(21), by an orthogonal factorisation of J_Nᵀ = Q R,
//! which does not square the condition number: tr(A⁻¹) = ‖R⁻¹‖² for A = J_N J_Nᵀ.

use super::batch::Batch;
use super::lanes::{Lanes, Vec3, Vec6, ZERO, ZERO6, cross, six, sub, three};

/// Relative size of a pivot below which J_N counts as singular.
const SINGULAR: f64 = 1e-15;

/// tr A, tr A⁻¹ and the factors of every lane.
#[inline(always)]
pub(super) fn forward(batch: &mut Batch, n: usize, inverse_length: f64) {
    let (axes, origins) = (&batch.axes[..n], &batch.origins[..n]);
    let tcp = &mut batch.tcp_columns[..n];
    let q = &mut batch.orthogonal[..n];
    let mut trace = ZERO;
    for i in 0..n {
        let column: Vec3 = cross(&axes[i], &sub(batch.tcp, origins[i]));
        tcp[i] = column;
        // Column i of J_N, Eq. (20): row i of J_Nᵀ.
        q[i] = [
            column[0] * inverse_length,
            column[1] * inverse_length,
            column[2] * inverse_length,
            axes[i][0],
            axes[i][1],
            axes[i][2],
        ];
        batch.normalised[i] = q[i];
        for r in 0..6 {
            trace += q[i][r] * q[i][r];
        }
    }
    // Modified Gram–Schmidt on the six columns of J_Nᵀ; R upper triangular.
    let mut upper = [ZERO6; 6];
    let mut inverse_pivots = ZERO6;
    let floor = (trace * (SINGULAR * SINGULAR)).max(Lanes::splat(f64::MIN_POSITIVE));
    for c in 0..6 {
        let mut square = ZERO;
        for row in q.iter() {
            square += row[c] * row[c];
        }
        // A pivot that rounding made stands for a singular posture: huge k(J_N).
        let pivot = square.max(floor).sqrt();
        let inverse = Lanes::splat(1.0) / pivot;
        inverse_pivots[c] = inverse;
        let mut products = ZERO6;
        for row in q.iter_mut() {
            row[c] = row[c] * inverse;
            for later in c + 1..6 {
                products[later] += row[c] * row[later];
            }
        }
        for row in q.iter_mut() {
            for later in c + 1..6 {
                row[later] -= row[c] * products[later];
            }
        }
        upper[c] = products;
    }
    // T = R⁻¹, upper triangular, row by row from below.
    let mut inverse = [ZERO6; 6];
    let mut inverse_trace = ZERO;
    for r in (0..6).rev() {
        inverse[r][r] = inverse_pivots[r];
        inverse_trace += inverse_pivots[r] * inverse_pivots[r];
        for c in r + 1..6 {
            let mut sum = ZERO;
            for k in r + 1..=c {
                sum += upper[r][k] * inverse[k][c];
            }
            let entry = -(inverse_pivots[r] * sum);
            inverse[r][c] = entry;
            inverse_trace += entry * entry;
        }
    }
    batch.inverse = inverse;
    batch.trace = trace;
    batch.inverse_trace = inverse_trace;
}

/// Derivative of ln k(J_N) with respect to J_N, times `weight`, as a linear
/// part (with respect to the columns at the tool centre point) and an angular
/// part per joint.
///
/// d ln k = ⟨J_N/tr A − A⁻² J_N/tr A⁻¹, dJ_N⟩ with A⁻² J_N = T Tᵀ T Qᵀ.
#[inline(always)]
pub(super) fn adjoint(batch: &mut Batch, n: usize, inverse_length: f64, weight: Lanes) {
    let t = &batch.inverse;
    // TᵀT, then Y = T (TᵀT).
    let mut square = [ZERO6; 6];
    for r in 0..6 {
        for c in r..6 {
            let mut sum = ZERO;
            for k in 0..=r {
                sum += t[k][r] * t[k][c];
            }
            square[r][c] = sum;
            square[c][r] = sum;
        }
    }
    let by_inverse = weight / batch.inverse_trace;
    let y: [Vec6; 6] = six!(|r| {
        let mut row = ZERO6;
        for k in r..6 {
            row = six!(|c| row[c] + t[r][k] * square[k][c]);
        }
        six!(|c| row[c] * by_inverse)
    });
    let by_trace = weight / batch.trace;
    for i in 0..n {
        let (j, q) = (&batch.normalised[i], &batch.orthogonal[i]);
        let mut out = ZERO6;
        for r in 0..6 {
            let mut sum = y[r][0] * q[0];
            for s in 1..6 {
                sum += y[r][s] * q[s];
            }
            out[r] = j[r] * by_trace - sum;
        }
        batch.tcp_adjoint[i] = three!(|r| out[r] * inverse_length);
        batch.axis_adjoint[i] = [out[3], out[4], out[5]];
    }
}
