//! Information matrices and their factors are those of the rows that went in.

use crate::common::prelude::*;
use stiffarm::internals::information::{posture_information, whiten_posture};

fn sample() -> DMatrix<f64> {
    DMatrix::from_fn(9, 3, |i, j| ((i * 7 + j * 13 + i * j * 5) % 11) as f64 - 4.0)
}

#[test]
fn solve_inverts_and_pseudo_inverse_agrees() {
    let psi = sample();
    let h = DVector::from_column_slice(&[1e-6, 3e-7, 5e-6]);
    let factor = Factor::new(&psi).unwrap();
    let delta = &psi * &h;
    assert!((factor.solve(&delta) - &h).amax() < 1e-18);
    assert!((factor.pseudo_inverse(9) * delta - h).amax() < 1e-18);
}

#[test]
fn inverse_information_is_the_inverse_of_the_gram_matrix() {
    let psi = sample();
    let inverse = psi.tr_mul(&psi).try_inverse().unwrap();
    let ours = Factor::new(&psi).unwrap().inverse_information();
    assert!((ours - &inverse).amax() < 1e-12 * inverse.amax());
}

#[test]
fn zero_and_dependent_columns_are_named() {
    let mut psi = sample();
    psi.column_mut(1).fill(0.0);
    assert_eq!(Factor::new(&psi).unwrap().undetermined(), [1]);
    let mut psi = sample();
    let twice = psi.column(0) * 2.0;
    psi.column_mut(2).copy_from(&twice);
    let factor = Factor::new(&psi).unwrap();
    assert_eq!(factor.undetermined(), [0, 2]);
    assert_eq!(factor.rank(), 2);
    assert!(factor.scaled_condition().is_none());
}

#[test]
fn fewer_rows_than_unknowns_leave_joints_undetermined() {
    let psi = sample().rows(0, 2).into_owned();
    let factor = Factor::new(&psi).unwrap();
    assert_eq!(factor.rank(), 2);
    assert!(!factor.undetermined().is_empty());
    assert_eq!(factor.pseudo_inverse(2).shape(), (3, 2));
}

#[test]
fn nan_is_stopped() {
    let mut psi = sample();
    psi[(2, 1)] = f64::NAN;
    assert_eq!(Factor::new(&psi).unwrap_err().code(), Code::NotFinite);
}

#[test]
fn whitened_rows_have_the_weighted_information() {
    let mut block = sample();
    let direct = posture_information(&block, 0.2);
    whiten_posture(&mut block, 0.2);
    assert!((block.tr_mul(&block) - direct).amax() < 1e-10);
}
