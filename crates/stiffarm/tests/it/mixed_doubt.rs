//! How well the sizes of the mixed model are known, and what that does to its covariance and degrees of freedom, is
//! what dense matrices and a published example say.

use crate::common::prelude::*;
use crate::estimators::dense_covariance;
use crate::mixed::{any_readings, dense, rails, random_model};

use proptest::prelude::*;
use std::ops::Range;
use stiffarm::estimate::freedom::SizeDoubt;
use stiffarm::internals::MeasuredSystem;

/// h and u as linear functions of the displacements.
fn solution(
    system: &MeasuredSystem,
    random: &DMatrix<f64>,
    classes: &[Range<usize>],
    gamma: f64,
    ratios: &[f64],
) -> DMatrix<f64> {
    let inverse = dense(system, gamma, random, classes, ratios).try_inverse().unwrap();
    let psi = &system.psi;
    let information = psi.transpose() * &inverse * psi;
    let h = information.try_inverse().unwrap() * psi.transpose() * &inverse;
    let left = DMatrix::identity(psi.nrows(), psi.nrows()) - psi * &h;
    let mut u = random.transpose() * inverse * left;
    for (class, ratio) in classes.iter().zip(ratios) {
        u.rows_mut(class.start, class.len()).scale_mut(*ratio);
    }
    let mut out = h.clone().resize_vertically(h.nrows() + u.nrows(), 0.0);
    out.rows_mut(h.nrows(), u.nrows()).copy_from(&u);
    out
}

/// The information about the logarithms, with what it lacks for no combination of the
/// classes' to be doubted by more than a factor of e.
fn bounded(information: &DMatrix<f64>, others: usize) -> DMatrix<f64> {
    let n = information.nrows() - others;
    let inverse = information.view((0, 0), (others, others)).into_owned().try_inverse().unwrap();
    let cross = information.view((0, others), (others, n));
    let schur = information.view((others, others), (n, n)) - cross.transpose() * inverse * cross;
    let eigen = schur.symmetric_eigen();
    let lacks = eigen.eigenvalues.map(|v| (1.0 - v).max(0.0));
    let more = &eigen.eigenvectors * DMatrix::from_diagonal(&lacks) * eigen.eigenvectors.transpose();
    let mut out = information.clone();
    let mut block = out.view_mut((others, others), (n, n));
    block += more;
    out
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn covariance_and_doubt_are_those_of_dense_matrices(
        seed in any::<u64>(), postures in 4..8_usize, unknowns in 1..4_usize, readings in any_readings(),
    ) {
        let (system, random, classes, model) = random_model(seed, postures, unknowns, readings);
        prop_assume!(model.has_shifts());
        for (gamma, ratios) in [(0.3, [0.5, 0.01]), (1e-2, [2.0, 30.0]), (20.0, [1e-4, 0.2])] {
            let v = dense(&system, gamma, &random, &classes, &ratios);
            let inverse = v.clone().try_inverse().unwrap();
            let psi = &system.psi;
            let information = psi.transpose() * &inverse * psi;
            let projector = &inverse
                - &inverse * psi * information.try_inverse().unwrap() * psi.transpose() * &inverse;
            let shifts = dense_covariance(&system, gamma) - dense_covariance(&system, 0.0);
            let mut parts = vec![v.clone(), shifts];
            for (class, ratio) in classes.iter().zip(&ratios) {
                let columns = random.columns(class.start, class.len());
                parts.push(columns * columns.transpose() * *ratio);
            }
            let seen: Vec<DMatrix<f64>> = parts.iter().map(|part| &projector * part).collect();
            let information = DMatrix::from_fn(4, 4, |k, l| 0.5 * (&seen[k] * &seen[l]).trace());
            let of_sizes = bounded(&information, 2).try_inverse().unwrap();
            let (covariance, ours) = model.doubt(gamma, &ratios).unwrap();
            let expected = of_sizes.clone().remove_row(1).remove_column(1);
            prop_assert!((&ours - &expected).amax() < 1e-6 * expected.amax(), "{ours} {expected}");

            // E[∂m ∂mᵀ] by differences of the solution as a function of the displacements.
            let at = |k: usize, h: f64| {
                let mut ratios = ratios;
                let gamma = if k == 0 { gamma * h.exp() } else { gamma };
                if k > 0 {
                    ratios[k - 1] *= h.exp();
                }
                solution(&system, &random, &classes, gamma, &ratios)
            };
            let h = 1e-4;
            let moved: Vec<DMatrix<f64>> =
                (0..3).map(|k| (at(k, h) - at(k, -h)) / (2.0 * h)).collect();
            let (_, plain, variance) = model.solve(gamma, &ratios, &[]).unwrap();
            let mut more = DMatrix::zeros(plain.nrows(), plain.ncols());
            for k in 0..3 {
                for l in 0..3 {
                    let both = &moved[k] * &v * moved[l].transpose();
                    more += both * (variance * of_sizes[(k + 1, l + 1)]);
                }
            }
            let scale = DVector::from_fn(plain.nrows(), |i, _| plain[(i, i)].sqrt());
            let off = DMatrix::from_fn(plain.nrows(), plain.ncols(), |i, j| {
                (covariance[(i, j)] - plain[(i, j)] - more[(i, j)]) / (scale[i] * scale[j])
            });
            prop_assert!(off.amax() < 1e-5, "{}", off.amax());
        }
    }
}

/// The mean of the six rails has five degrees of freedom, as any balanced design's, and
/// its standard error 10.17 has no doubt about the sizes in it.
#[test]
fn the_mean_of_the_rails_has_five_degrees_of_freedom() {
    let model = rails();
    let (gamma, ratios, _) = model.best().unwrap();
    let (covariance, of_sizes) = model.doubt(gamma, &ratios).unwrap();
    let (_, _, variance) = model.solve(gamma, &ratios, &[]).unwrap();
    let error = covariance[(0, 0)].sqrt();
    assert!((error - 10.17104).abs() < 1e-4, "{error}");
    let doubt = SizeDoubt {
        classes: std::iter::once(1..7).collect(),
        means: std::iter::once(1..1).collect(),
        prior: DVector::from_fn(7, |i, _| if i == 0 { 0.0 } else { ratios[0] * variance }),
        covariance: of_sizes,
    };
    let with = covariance.column(0).into_owned();
    let n = doubt.degrees_of_freedom(&with, with[0], 0.0);
    assert!((n - 5.0).abs() < 1e-3, "{n}");
}
