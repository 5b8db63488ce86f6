//! Singular value decomposition of small matrices by one-sided Jacobi rotations
//! (Hestenes 1958; Demmel & Veselić 1992).
//!
//! nalgebra's own loses digits in about one of a thousand matrices, up to half
//! of them (<https://github.com/dimforge/nalgebra/issues/1172>); a condition
//! number would then depend on the order of the postures. Jacobi rotations
//! give small singular values to high relative accuracy, and our matrices have
//! few columns.

use crate::numerics::order::order_by_number;
use nalgebra::{DMatrix, DVector};

/// Sweeps after which the decomposition counts as failed; six to ten do.
const MAX_SWEEPS: usize = 100;

/// A = U·diag(values)·Vᵀ with the values in descending order.
pub struct Svd {
    /// Left singular vectors, as many as columns of A; zero where the value is.
    pub u: DMatrix<f64>,
    /// Singular values, descending; zero where below ε‖A‖, which is rounding.
    pub values: DVector<f64>,
    /// Right singular vectors.
    pub v: DMatrix<f64>,
}

/// Rows from which on a matrix is first reduced to a square one.
const TALL: usize = 64;

/// [`svd`] of a matrix that may have very many rows: by QR first, so that the
/// rotations do not go over all of them again and again.
pub fn tall_svd(a: DMatrix<f64>) -> Option<Svd> {
    let (rows, n) = a.shape();
    if rows < TALL.max(2 * n) || a.iter().any(|v| !v.is_finite()) {
        return svd(a);
    }
    let qr = a.qr();
    let parts = svd(qr.r())?;
    Some(Svd { u: qr.q() * parts.u, ..parts })
}

/// Decomposes a matrix with at least as many rows as columns; `None` when an
/// entry is not finite or the rotations do not converge.
pub fn svd(mut a: DMatrix<f64>) -> Option<Svd> {
    let (rows, n) = a.shape();
    let largest = a.amax();
    if rows < n || a.iter().any(|v| !v.is_finite()) {
        return None;
    }
    // Squares of entries must neither overflow nor vanish.
    let unit = if largest > 0.0 { largest } else { 1.0 };
    a.unscale_mut(unit);
    let mut v = DMatrix::identity(n, n);
    let tolerance = f64::EPSILON * rows as f64;
    // Columns of rounding errors would never settle.
    let negligible = (f64::EPSILON * a.norm()).powi(2);
    let mut settled = n < 2;
    for _ in 0..MAX_SWEEPS {
        if settled {
            break;
        }
        settled = true;
        for p in 0..n {
            for q in p + 1..n {
                let (left, right) = (a.column(p).norm_squared(), a.column(q).norm_squared());
                let product = a.column(p).dot(&a.column(q));
                if left.min(right) <= negligible || product.abs() <= tolerance * (left * right).sqrt() {
                    continue;
                }
                settled = false;
                let half = (right - left) / (2.0 * product);
                let tangent = half.signum() / (half.abs() + half.hypot(1.0));
                let cosine = 1.0 / tangent.hypot(1.0);
                let sine = cosine * tangent;
                rotate(&mut a, p, q, cosine, sine);
                rotate(&mut v, p, q, cosine, sine);
            }
        }
    }
    if !settled {
        return None;
    }
    let length = |square: f64| {
        if square <= negligible { 0.0 } else { square.sqrt() }
    };
    let norms: Vec<f64> = a.column_iter().map(|c| length(c.norm_squared())).collect();
    let order = order_by_number(n, |i| -norms[i]);
    for (mut column, norm) in a.column_iter_mut().zip(&norms) {
        if *norm > 0.0 { column.unscale_mut(*norm) } else { column.fill(0.0) }
    }
    Some(Svd {
        u: a.select_columns(&order),
        values: DVector::from_iterator(n, order.iter().map(|i| norms[*i] * unit)),
        v: v.select_columns(&order),
    })
}

/// Turns columns p < q of `m` by the angle of this cosine and sine.
fn rotate(m: &mut DMatrix<f64>, p: usize, q: usize, cosine: f64, sine: f64) {
    let rows = m.nrows();
    let (left, right) = m.as_mut_slice().split_at_mut(q * rows);
    let column = &mut left[p * rows..(p + 1) * rows];
    for (left, right) in column.iter_mut().zip(right) {
        let (a, b) = (*left, *right);
        *left = cosine * a - sine * b;
        *right = sine * a + cosine * b;
    }
}
