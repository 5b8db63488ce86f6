//! Singular value decomposition of small matrices by one-sided Jacobi rotations
//! (Hestenes 1958; Demmel & Veselić 1992).
//!
//! nalgebra's own loses digits in about one of a thousand matrices, up to half
//! of them (<https://github.com/dimforge/nalgebra/issues/1172>); a condition
//! number would then depend on the order of the postures. Jacobi rotations
//! give small singular values to high relative accuracy, and our matrices have
//! few columns.

use nalgebra::{DMatrix, DVector};

/// Sweeps after which the decomposition counts as failed; six to ten do.
const MAX_SWEEPS: usize = 100;

/// A = U·diag(values)·Vᵀ with the values in descending order.
pub(crate) struct Svd {
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
pub(crate) fn tall_svd(a: DMatrix<f64>) -> Option<Svd> {
    let (rows, n) = a.shape();
    if rows < TALL.max(2 * n) || a.iter().any(|v| !v.is_finite()) {
        return svd(a);
    }
    let qr = a.qr();
    let parts = svd(qr.r())?;
    Some(Svd {
        u: qr.q() * parts.u,
        ..parts
    })
}

/// Decomposes a matrix with at least as many rows as columns; `None` when an
/// entry is not finite or the rotations do not converge.
pub(crate) fn svd(mut a: DMatrix<f64>) -> Option<Svd> {
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
                if left.min(right) <= negligible
                    || product.abs() <= tolerance * (left * right).sqrt()
                {
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
        if square <= negligible {
            0.0
        } else {
            square.sqrt()
        }
    };
    let norms: Vec<f64> = a.column_iter().map(|c| length(c.norm_squared())).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| norms[*b].total_cmp(&norms[*a]));
    for (mut column, norm) in a.column_iter_mut().zip(&norms) {
        match *norm > 0.0 {
            true => column.unscale_mut(*norm),
            false => column.fill(0.0),
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Largest error of A = UΣVᵀ relative to ‖A‖, and of the orthogonality of U and V.
    fn errors(a: &DMatrix<f64>, svd: &Svd) -> (f64, f64) {
        let back = &svd.u * DMatrix::from_diagonal(&svd.values) * svd.v.transpose();
        let n = a.ncols();
        let square = |m: &DMatrix<f64>| (m.tr_mul(m) - DMatrix::identity(n, n)).amax();
        (
            (back - a).norm() / a.norm(),
            square(&svd.u).max(square(&svd.v)),
        )
    }

    #[test]
    fn every_one_of_many_random_triangles_is_decomposed_to_working_precision() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for case in 0..20_000 {
            let a = DMatrix::from_fn(9, 6, |_, _| rng.random::<f64>() - 0.5)
                .qr()
                .r();
            let svd = svd(a.clone()).unwrap();
            let (residual, orthogonality) = errors(&a, &svd);
            assert!(
                residual < 1e-14 && orthogonality < 1e-13,
                "{case}: {residual:e} {orthogonality:e}"
            );
            assert!(svd.values.as_slice().is_sorted_by(|a, b| a >= b));
        }
    }

    #[test]
    fn a_matrix_that_nalgebra_gets_wrong() {
        // From the issue named above.
        let a = DMatrix::from_row_slice(
            3,
            3,
            &[
                0.247_779_766_566_469_27,
                0.549_620_789_778_049_4,
                -0.740_358_352_872_713_6,
                0.583_295_361_486_411_8,
                -0.380_156_958_264_198_54,
                -0.033_923_642_618_128_86,
                -0.373_811_062_290_105_1,
                0.359_160_059_894_174,
                -0.096_202_939_291_305_66,
            ],
        );
        let svd = svd(a.clone()).unwrap();
        let back = &svd.u * DMatrix::from_diagonal(&svd.values) * svd.v.transpose();
        assert!((back - a).amax() < 1e-15);
    }

    #[test]
    fn small_singular_values_of_graded_columns_keep_their_digits() {
        // Orthogonal columns of sizes 1 to 1e-12: the sizes are the singular values.
        let q = DMatrix::from_fn(7, 5, |i, j| ((3 * i + 7 * j + i * j) as f64).sin())
            .qr()
            .q();
        let sizes = DVector::from_fn(5, |j, _| 1e-3_f64.powi(j as i32));
        let svd = svd(q * DMatrix::from_diagonal(&sizes)).unwrap();
        assert!(
            svd.values
                .iter()
                .zip(sizes.iter())
                .all(|(a, b)| (a / b - 1.0).abs() < 1e-14)
        );
    }

    #[test]
    fn extreme_scales_zeros_and_nan() {
        for scale in [1e-200, 1e200] {
            let a = DMatrix::from_row_slice(2, 2, &[3.0, 0.0, 4.0, 5.0]) * scale;
            let svd = svd(a).unwrap();
            assert!((svd.values[0] / scale - 45f64.sqrt()).abs() < 1e-14);
            assert!((svd.values[1] / scale - 5f64.sqrt()).abs() < 1e-14);
        }
        // Rank one, with rounding errors in place of the rest.
        let column = DMatrix::from_fn(6, 1, |i, _| (i as f64 + 0.3).sin());
        let flat = &column * DMatrix::from_fn(1, 4, |_, j| (j as f64).exp()) / 3.0;
        let found = svd(flat.clone()).unwrap();
        assert!((found.values[0] / flat.norm() - 1.0).abs() < 1e-14);
        assert!(found.values.rows(1, 3).amax() < 1e-14 * flat.norm());
        assert_eq!(
            svd(DMatrix::zeros(3, 2)).unwrap().values.as_slice(),
            [0.0, 0.0]
        );
        assert!(svd(DMatrix::from_element(2, 2, f64::NAN)).is_none());
        assert!(svd(DMatrix::zeros(1, 2)).is_none());
        let row = svd(DMatrix::from_column_slice(2, 1, &[3.0, -4.0])).unwrap();
        assert_eq!(row.values.as_slice(), [5.0]);
    }
}
