//! Cholesky factors invert and eigenvectors rebuild the small matrices that they are of.

use crate::common::prelude::*;
use stiffarm::internals::information::small::{
    cholesky, eigen, inverse_from_lower, invert_lower, packed, symmetric_product,
};

fn sample(n: usize, seed: u64, grade: f64) -> DMatrix<f64> {
    let b = DMatrix::from_fn(n + 3, n, |i, j| {
        let x = 12.9898 * i as f64 + 78.233 * j as f64 + 37.719 * seed as f64;
        ((x.sin() * 43758.5453).fract() - 0.2) * grade.powi(j as i32)
    });
    b.tr_mul(&b)
}

fn pack(m: &DMatrix<f64>) -> Vec<f64> {
    (0..m.nrows()).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|at| m[at]).collect()
}

#[test]
fn inverse_times_matrix_is_the_identity() {
    for n in 1..9 {
        for seed in 0..20 {
            let m = sample(n, seed, 0.7);
            let size = packed(n, 0);
            let (mut l, mut il) = (vec![0.0; size], vec![0.0; size]);
            assert!(cholesky(n, &pack(&m), &mut l));
            invert_lower(n, &l, &mut il);
            let mut inverse = vec![0.0; n * n];
            inverse_from_lower(n, &il, &mut inverse);
            let inverse = DMatrix::from_row_slice(n, n, &inverse);
            let error = (&inverse * &m - DMatrix::identity(n, n)).amax();
            assert!(error < 1e-9, "n {n} seed {seed}: {error:e}");
            let mut squared = vec![0.0; n * n];
            symmetric_product(n, inverse.as_slice(), inverse.as_slice(), &mut squared);
            let direct = &inverse * &inverse;
            let error = (DMatrix::from_row_slice(n, n, &squared) - &direct).amax();
            assert!(error < 1e-12 * direct.amax());
        }
    }
}

#[test]
fn what_is_not_positive_definite_is_refused() {
    let mut l = [0.0; 3];
    assert!(!cholesky(2, &[1.0, 1.0, 1.0], &mut l));
    assert!(!cholesky(2, &[1.0, f64::NAN, 1.0], &mut l));
    assert!(!cholesky(2, &[0.0, 0.0, 1.0], &mut l));
    assert!(cholesky(2, &[1.0, 0.5, 1.0], &mut l));
}

#[test]
fn eigenvectors_rebuild_the_matrix() {
    for n in 1..9 {
        for seed in 0..40 {
            for m in [
                sample(n, seed, 0.4),
                sample(n, seed, 1.0),
                DMatrix::identity(n, n) * 3.0,
                DMatrix::from_element(n, n, 2.0),
                DMatrix::zeros(n, n),
            ] {
                let mut vectors = m.as_slice().to_vec();
                let (mut values, mut off) = (vec![0.0; n], vec![0.0; n]);
                assert!(eigen(n, &mut vectors, &mut values, &mut off));
                let v = DMatrix::from_row_slice(n, n, &vectors);
                let d = DMatrix::from_diagonal(&DVector::from_vec(values));
                let error = (v.transpose() * d * &v - &m).amax();
                assert!(error <= 1e-13 * m.amax(), "n {n} seed {seed}: {error:e}");
                let error = (&v * v.transpose() - DMatrix::identity(n, n)).amax();
                assert!(error < 1e-13);
            }
        }
    }
}

#[test]
fn nan_ends_the_iteration() {
    let mut vectors = vec![f64::NAN; 9];
    assert!(!eigen(3, &mut vectors, &mut [0.0; 3], &mut [0.0; 3]));
}
