//! Factorisations of one small symmetric matrix in place, or of several side by side, for loops that must
//! not allocate. Lower triangles are packed row by row; full matrices are n × n.

use super::GRAM_ROUNDING;
use std::ops::{AddAssign, Div, Mul, Neg, SubAssign};

/// Sweeps of the QL iteration per eigenvalue before it counts as failed.
const MAX_ITERATIONS: usize = 60;

/// An entry of a matrix, or the same entry of several matrices.
pub trait Entry: Copy + AddAssign + SubAssign + Neg<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// The same number for all matrices.
    fn splat(value: f64) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// True where it is above a limit in every matrix; not a number is above nothing.
    fn is_above(self, limit: Self) -> bool;
}

impl Entry for f64 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn is_above(self, limit: Self) -> bool {
        self > limit
    }
}

/// Position of (i, j), i ≥ j, in a packed lower triangle.
#[inline(always)]
pub fn packed(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

/// Cholesky factor L of M = L Lᵀ (both packed). False where M is not positive
/// definite beyond its rounding errors.
#[inline(always)]
pub fn cholesky<E: Entry>(n: usize, m: &[E], l: &mut [E]) -> bool {
    let size = packed(n, 0);
    let (m, l) = (&m[..size], &mut l[..size]);
    let rounding = E::splat(n as f64 * GRAM_ROUNDING);
    for j in 0..n {
        let row = packed(j, 0);
        let mut pivot = m[row + j];
        for k in 0..j {
            pivot -= l[row + k] * l[row + k];
        }
        if !(pivot.is_above(rounding * m[row + j]) && pivot.is_above(E::splat(0.0))) {
            return false;
        }
        let pivot = pivot.sqrt();
        l[row + j] = pivot;
        let inverse = E::splat(1.0) / pivot;
        for i in j + 1..n {
            let below = packed(i, 0);
            let mut sum = m[below + j];
            for k in 0..j {
                sum -= l[below + k] * l[row + k];
            }
            l[below + j] = sum * inverse;
        }
    }
    true
}

/// Inverse of a lower triangular matrix, packed.
#[inline(always)]
pub fn invert_lower<E: Entry>(n: usize, l: &[E], inverse: &mut [E]) {
    let size = packed(n, 0);
    let (l, inverse) = (&l[..size], &mut inverse[..size]);
    for i in 0..n {
        let row = packed(i, 0);
        let pivot = E::splat(1.0) / l[row + i];
        inverse[row + i] = pivot;
        for j in 0..i {
            let mut sum = E::splat(0.0);
            for k in j..i {
                sum += l[row + k] * inverse[packed(k, j)];
            }
            inverse[row + j] = -sum * pivot;
        }
    }
}

/// M⁻¹ = L⁻ᵀ L⁻¹, n × n, from the packed L⁻¹.
#[inline(always)]
pub fn inverse_from_lower<E: Entry>(n: usize, inverse_lower: &[E], out: &mut [E]) {
    let (lower, out) = (&inverse_lower[..packed(n, 0)], &mut out[..n * n]);
    for i in 0..n {
        for j in 0..=i {
            let mut sum = E::splat(0.0);
            for k in i..n {
                sum += lower[packed(k, i)] * lower[packed(k, j)];
            }
            out[i * n + j] = sum;
            out[j * n + i] = sum;
        }
    }
}

/// `out` = A·B for symmetric A and B whose product is symmetric too.
#[inline(always)]
pub fn symmetric_product<E: Entry>(n: usize, a: &[E], b: &[E], out: &mut [E]) {
    let (a, b, out) = (&a[..n * n], &b[..n * n], &mut out[..n * n]);
    for i in 0..n {
        for j in 0..=i {
            let (left, right) = (&a[i * n..][..n], &b[j * n..][..n]);
            let mut sum = E::splat(0.0);
            for k in 0..n {
                sum += left[k] * right[k];
            }
            out[i * n + j] = sum;
            out[j * n + i] = sum;
        }
    }
}

/// Eigenvalues (any order) and eigenvectors (rows of `vectors`) of the
/// symmetric matrix in `vectors`, n × n, which is replaced. `off` is scratch of
/// length n. False when the iteration does not converge.
///
/// Householder reduction to tridiagonal form and the implicit QL iteration
/// (Martin, Reinsch & Wilkinson 1968; Dubrulle, Martin & Wilkinson 1968).
#[inline(always)]
pub fn eigen(n: usize, vectors: &mut [f64], values: &mut [f64], off: &mut [f64]) -> bool {
    let (a, d, e) = (&mut vectors[..n * n], &mut values[..n], &mut off[..n]);
    tridiagonal(n, a, d, e);
    // The reflections stand in columns; rows are faster to rotate.
    for i in 0..n {
        for j in 0..i {
            a.swap(i * n + j, j * n + i);
        }
    }
    e.rotate_left(1);
    e[n - 1] = 0.0;
    for l in 0..n {
        for iteration in 0.. {
            let m = (l..n - 1).find(|&m| e[m].abs() <= f64::EPSILON * (d[m].abs() + d[m + 1].abs())).unwrap_or(n - 1);
            if m == l {
                break;
            }
            if iteration == MAX_ITERATIONS || !e[l].is_finite() {
                return false;
            }
            // Shift from the leading two by two block.
            let g = (d[l + 1] - d[l]) / (2.0 * e[l]);
            let root = (g * g + 1.0).sqrt();
            let mut g = d[m] - d[l] + e[l] / (g + root.copysign(g));
            let (mut sine, mut cosine, mut shift) = (1.0, 1.0, 0.0);
            let mut split = false;
            for i in (l..m).rev() {
                let f = sine * e[i];
                let b = cosine * e[i];
                let r = (f * f + g * g).sqrt();
                e[i + 1] = r;
                if r == 0.0 {
                    d[i + 1] -= shift;
                    e[m] = 0.0;
                    split = true;
                    break;
                }
                let inverse = 1.0 / r;
                sine = f * inverse;
                cosine = g * inverse;
                g = d[i + 1] - shift;
                let r = (d[i] - g) * sine + 2.0 * cosine * b;
                shift = sine * r;
                d[i + 1] = g + shift;
                g = cosine * r - b;
                let (upper, lower) = a.split_at_mut((i + 1) * n);
                let (upper, lower) = (&mut upper[i * n..], &mut lower[..n]);
                for (x, y) in upper.iter_mut().zip(lower) {
                    (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
                }
            }
            if !split {
                d[l] -= shift;
                e[l] = g;
                e[m] = 0.0;
            }
        }
    }
    true
}

/// Reduces the symmetric `a` to tridiagonal form: diagonal `d`, subdiagonal
/// `e[1..]`, and the orthogonal transformation in `a`.
#[inline(always)]
fn tridiagonal(n: usize, a: &mut [f64], d: &mut [f64], e: &mut [f64]) {
    for i in (1..n).rev() {
        let mut h = 0.0;
        for k in 0..i {
            h += a[i * n + k] * a[i * n + k];
        }
        let last = a[i * n + i - 1];
        if i == 1 || h == last * last {
            e[i] = last;
            d[i] = 0.0;
            continue;
        }
        let g = -h.sqrt().copysign(last);
        e[i] = g;
        h -= last * g;
        a[i * n + i - 1] = last - g;
        let inverse = 1.0 / h;
        let mut sum = 0.0;
        for j in 0..i {
            a[j * n + i] = a[i * n + j] * inverse;
            let mut g = 0.0;
            for k in 0..=j {
                g += a[j * n + k] * a[i * n + k];
            }
            for k in j + 1..i {
                g += a[k * n + j] * a[i * n + k];
            }
            e[j] = g * inverse;
            sum += e[j] * a[i * n + j];
        }
        let half = sum * 0.5 * inverse;
        for j in 0..i {
            let f = a[i * n + j];
            let g = e[j] - half * f;
            e[j] = g;
            for k in 0..=j {
                a[j * n + k] -= f * e[k] + g * a[i * n + k];
            }
        }
        d[i] = h;
    }
    d[0] = 0.0;
    e[0] = 0.0;
    for i in 0..n {
        if d[i] != 0.0 {
            for j in 0..i {
                let mut g = 0.0;
                for k in 0..i {
                    g += a[i * n + k] * a[k * n + j];
                }
                for k in 0..i {
                    a[k * n + j] -= g * a[k * n + i];
                }
            }
        }
        d[i] = a[i * n + i];
        a[i * n + i] = 1.0;
        for j in 0..i {
            a[i * n + j] = 0.0;
            a[j * n + i] = 0.0;
        }
    }
}
