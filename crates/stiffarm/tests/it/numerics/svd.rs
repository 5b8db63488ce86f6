//! The singular value decomposition of small matrices is accurate to rounding, at every scale.

use crate::common::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stiffarm::internals::information::svd::{Svd, svd};

/// Largest error of A = UΣVᵀ relative to ‖A‖, and of the orthogonality of U and V.
fn errors(a: &DMatrix<f64>, svd: &Svd) -> (f64, f64) {
    let back = &svd.u * DMatrix::from_diagonal(&svd.values) * svd.v.transpose();
    let n = a.ncols();
    let square = |m: &DMatrix<f64>| (m.tr_mul(m) - DMatrix::identity(n, n)).amax();
    ((back - a).norm() / a.norm(), square(&svd.u).max(square(&svd.v)))
}

#[test]
fn every_one_of_many_random_triangles_is_decomposed_to_working_precision() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for case in 0..20_000 {
        let a = DMatrix::from_fn(9, 6, |_, _| rng.random::<f64>() - 0.5).qr().r();
        let svd = svd(a.clone()).unwrap();
        let (residual, orthogonality) = errors(&a, &svd);
        assert!(residual < 1e-14 && orthogonality < 1e-13, "{case}: {residual:e} {orthogonality:e}");
        assert!(svd.values.as_slice().is_sorted_by(|a, b| a >= b));
    }
}

#[test]
fn a_matrix_that_nalgebra_gets_wrong() {
    // From issue 1172 of nalgebra.
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
    let q = DMatrix::from_fn(7, 5, |i, j| ((3 * i + 7 * j + i * j) as f64).sin()).qr().q();
    let sizes = DVector::from_fn(5, |j, _| 1e-3_f64.powi(j as i32));
    let svd = svd(q * DMatrix::from_diagonal(&sizes)).unwrap();
    assert!(svd.values.iter().zip(sizes.iter()).all(|(a, b)| (a / b - 1.0).abs() < 1e-14));
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
    let factors = svd(flat.clone()).unwrap();
    assert!((factors.values[0] / flat.norm() - 1.0).abs() < 1e-14);
    assert!(factors.values.rows(1, 3).amax() < 1e-14 * flat.norm());
    assert_eq!(svd(DMatrix::zeros(3, 2)).unwrap().values.as_slice(), [0.0, 0.0]);
    assert!(svd(DMatrix::from_element(2, 2, f64::NAN)).is_none());
    assert!(svd(DMatrix::zeros(1, 2)).is_none());
    let row = svd(DMatrix::from_column_slice(2, 1, &[3.0, -4.0])).unwrap();
    assert_eq!(row.values.as_slice(), [5.0]);
}
