//! Values and closed-form gradients of every index against a second, plain
//! implementation of the whole chain from angles to index over dual numbers.

use crate::common::groups::ln_index;
use crate::common::model::{
    Model, condition_number, duals, has_sound_svd, inverse_gram_diagonal, inverse_r, singular_values,
};
use crate::common::prelude::*;
use num_dual::{Dual64, DualNum};

/// Largest condition number of a random group's Ψ, plain, in units of the prior
/// or with scaled columns: the library's gradients come from ΨᵀΨ, which squares it.
const LARGEST_CONDITION: f64 = 1e3;
/// Agreement asked for, relative to the largest entry of a gradient.
const TOLERANCE: f64 = 1e-10;
const POSTURES: usize = 4;

/// The reference: everything an index needs, with derivatives in one direction.
struct Reference<'a> {
    model: &'a Model,
    /// Ψ, posture by posture.
    blocks: Vec<DMatrix<Dual64>>,
    /// ln k(J_N) of each posture, for n ≥ 6.
    dexterity: Vec<Dual64>,
}

impl<'a> Reference<'a> {
    fn new(model: &'a Model, postures: &[Vec<Dual64>]) -> Self {
        let dexterous = model.joint_count() >= 6;
        Reference {
            model,
            blocks: postures.iter().map(|q| model.psi(q)).collect(),
            dexterity: postures
                .iter()
                .filter(|_| dexterous)
                .map(|q| condition_number(&model.normalised_jacobian(q)).ln())
                .collect(),
        }
    }

    /// Ψ·diag(1/k) of all postures but one, whitened by the Cholesky factor of
    /// the posture's covariance where `whiten`.
    fn stacked(&self, prior: bool, whiten: bool, without: Option<usize>) -> DMatrix<Dual64> {
        let rows = self.blocks[0].nrows();
        let covariance = self.model.posture_covariance() / self.model.sigma.powi(2);
        let inverse = covariance.cholesky().unwrap().l().try_inverse().unwrap();
        let rest: Vec<DMatrix<Dual64>> = self
            .blocks
            .iter()
            .enumerate()
            .filter(|(p, _)| Some(*p) != without)
            .map(|(_, block)| {
                DMatrix::from_fn(rows, block.ncols(), |i, j| {
                    let value = if whiten {
                        (0..=i).fold(Dual64::from(0.0), |s, l| s + block[(l, j)] * inverse[(i, l)])
                    } else {
                        block[(i, j)]
                    };
                    if prior { value / self.model.prior[j] } else { value }
                })
            })
            .collect();
        DMatrix::from_fn(rows * rest.len(), self.model.joint_count(), |i, j| rest[i / rows][(i % rows, j)])
    }

    /// ln of the RMS relative standard error without a posture.
    fn ln_rms(&self, without: Option<usize>) -> Dual64 {
        let diagonal = inverse_gram_diagonal(&self.stacked(true, true, without));
        let mean = diagonal.iter().fold(Dual64::from(0.0), |s, v| s + *v) / diagonal.len() as f64;
        mean.ln() * 0.5
    }

    /// ln of an index (of its reciprocal for O1 to O5): smooth part, components.
    fn ln_index(&self, index: Index, sharpness: Option<f64>) -> (Dual64, Vec<Dual64>) {
        let zero = Dual64::from(0.0);
        let ln_sigma = Dual64::from(self.model.sigma.ln());
        let dexterity = if index.uses_dexterity() { self.dexterity.clone() } else { Vec::new() };
        let n = self.model.joint_count() as f64;
        // Smoothed largest (p > 0) or smallest (p < 0) singular value: λ = σ².
        let extreme = |values: &[Dual64], sign: f64| match sharpness {
            None => {
                if sign > 0.0 {
                    values[0].ln()
                } else {
                    values[values.len() - 1].ln()
                }
            }
            Some(p) => {
                // Relative to the extreme one, or the powers overflow.
                let unit = if sign > 0.0 { values[0].re } else { values[values.len() - 1].re };
                let sum = values.iter().fold(zero, |s, v| s + (*v / unit).powf(2.0 * sign * p));
                sum.ln() * (sign / (2.0 * p)) + unit.ln()
            }
        };
        let condition = |prior: bool, most: f64, least: f64| {
            let values = singular_values(&self.stacked(prior, false, None));
            extreme(&values, 1.0) * most + extreme(&values, -1.0) * least
        };
        match index {
            Index::Classical => (zero, dexterity),
            Index::Condition | Index::Novel | Index::O2 => (condition(false, 1.0, -1.0), dexterity),
            Index::ScaledCondition | Index::Scaled => (condition(true, 1.0, -1.0), dexterity),
            Index::O3 => (condition(false, 0.0, -1.0), dexterity),
            Index::O4 => (condition(false, 1.0, -2.0), dexterity),
            Index::O5 => {
                let values = singular_values(&self.stacked(false, false, None));
                (values.iter().fold(zero, |s, v| s + v.recip()).ln(), dexterity)
            }
            Index::ExpectedError => (ln_sigma + self.ln_rms(None), dexterity),
            Index::DropOne => (ln_sigma, (0..self.blocks.len()).map(|p| self.ln_rms(Some(p))).collect()),
            Index::WorstJoint => {
                let diagonal = inverse_gram_diagonal(&self.stacked(true, true, None));
                (ln_sigma, diagonal.iter().map(|v| v.ln() * 0.5).collect())
            }
            // tr(T (ΨᵀPΨ)⁻¹) is the squared norm of the tasks' rows times R⁻¹.
            Index::Task => {
                let inverse = inverse_r(&self.stacked(false, true, None));
                let rows = self.model.task_rows();
                let mut trace = zero;
                for i in 0..rows.nrows() {
                    for j in 0..inverse.ncols() {
                        let entry = (0..inverse.nrows()).fold(zero, |s, k| s + inverse[(k, j)] * rows[(i, k)]);
                        trace += entry * entry;
                    }
                }
                (ln_sigma + trace.ln() * 0.5, dexterity)
            }
            // Held against dual numbers by a test of its own.
            Index::Prediction => unreachable!(),
            // √det(ΨᵀΨ) is the product of R's diagonal.
            Index::D | Index::O1 => {
                let is_d = index == Index::D;
                let inverse = inverse_r(&self.stacked(is_d, is_d, None));
                let mean = (0..inverse.nrows()).fold(zero, |s, j| s + inverse[(j, j)].ln()) / n;
                let unit = if is_d { ln_sigma } else { Dual64::from(0.5 * (self.blocks.len() as f64).ln()) };
                (mean + unit, dexterity)
            }
        }
    }
}

/// Largest condition of Ψ in the three scalings, and the smallest relative gap between its
/// extreme singular values and their neighbours, for both scalings.
fn difficulty(model: &Model, postures: &[Vec<f64>]) -> (f64, f64) {
    let (mut condition, mut gap) = (0.0_f64, f64::INFINITY);
    let psi = model.stacked(postures);
    let mut unit = psi.clone();
    for mut column in unit.column_iter_mut() {
        column.normalize_mut();
    }
    let scaled =
        &psi * DMatrix::from_diagonal(&DVector::from_iterator(model.prior.len(), model.prior.iter().map(|k| 1.0 / k)));
    for matrix in [psi, scaled] {
        if !has_sound_svd(&matrix) {
            return (f64::INFINITY, 0.0);
        }
        let s = matrix.singular_values();
        let n = s.len();
        condition = condition.max(s[0] / s[n - 1]);
        gap = gap.min(1.0 - s[1] / s[0]).min(s[n - 2] / s[n - 1] - 1.0);
    }
    // What a lost posture leaves must be determined too.
    let rows = unit.nrows() / POSTURES;
    let without = (0..POSTURES)
        .map(|p| {
            let s = unit.clone().remove_rows(rows * p, rows).singular_values();
            s.max() / s.min()
        })
        .fold(0.0, f64::max);
    (condition.max(without), gap)
}

/// A random cell and group that floating point can tell something about.
fn random_case(dice: &mut Dice, n: usize, kind: usize, elastic: bool, common: bool) -> (Model, Vec<Vec<f64>>) {
    for _ in 0..2000 {
        let model = dice.model(n, kind, elastic, common);
        let postures = dice.postures(n, POSTURES);
        let (condition, gap) = difficulty(&model, &postures);
        if condition < LARGEST_CONDITION && gap > 0.05 {
            return (model, postures);
        }
    }
    panic!("no well-conditioned random case with n = {n}, load {kind}");
}

fn compare(n: usize) {
    let mut dice = Dice::new(40 + n as u64);
    let (mut worst, mut worst_value, mut compared) = (0.0_f64, 0.0_f64, 0);
    for case in 0..18 {
        // The last two: a cylinder that pushes.
        let kind = if case < 16 { case % 4 } else { 4 };
        let elastic = (case / 4) % 2 == 1 || case == 17;
        let common = case % 16 / 8 == 1;
        let (model, postures) = random_case(&mut dice, n, kind, elastic, common);
        let cell = model.cell();
        let flat: Vec<f64> = postures.concat();
        let references: Vec<Reference<'_>> =
            (0..flat.len()).map(|k| Reference::new(&model, &duals(&flat, n, k))).collect();
        for index in Index::ALL {
            if index == Index::Prediction {
                continue;
            }
            if index.uses_dexterity() && n < 6 {
                assert!(IndexFunction::new(&cell, index, POSTURES).is_err());
                continue;
            }
            for sharpness in [None, Some(30.0)] {
                let mut function = IndexFunction::new(&cell, index, POSTURES).unwrap();
                function.set_sharpness(sharpness);
                let ours = function.evaluate(&flat);
                let golden: Vec<_> = references.iter().map(|r| r.ln_index(index, sharpness)).collect();
                let what = format!("n {n} case {case} {index:?} {sharpness:?}");
                assert_eq!(ours.components.len(), golden[0].1.len(), "{what}");
                assert_eq!(function.component_count(), ours.components.len(), "{what}");

                let mut values = vec![(ours.smooth, golden[0].0.re)];
                values.extend(ours.components.iter().zip(&golden[0].1).map(|(a, b)| (*a, b.re)));
                for (ours, golden) in values {
                    let error = (ours - golden).abs() / golden.abs().max(1.0);
                    assert!(error < 1e-9, "{what}: value {ours} against {golden}");
                    worst_value = worst_value.max(error);
                }
                // The exact value is that of the evaluation by QR and SVD.
                let exact = ln_index(&cell, index, &postures);
                assert!((ours.value() - exact).abs() < 1e-8 * exact.abs().max(1.0), "{what}: exact value");

                let mut rows = vec![(&ours.smooth_gradient[..], golden.iter().map(|g| g.0.eps).collect())];
                for c in 0..ours.components.len() {
                    let row = &ours.component_gradients[c * flat.len()..(c + 1) * flat.len()];
                    rows.push((row, golden.iter().map(|g| g.1[c].eps).collect::<Vec<f64>>()));
                }
                for (r, (ours, golden)) in rows.iter().enumerate() {
                    let scale = golden.iter().fold(1e-3_f64, |m, g| m.max(g.abs()));
                    for (k, (a, b)) in ours.iter().zip(golden).enumerate() {
                        let error = (a - b).abs() / scale;
                        assert!(error < TOLERANCE, "{what} row {r} angle {k}: {a} against {b}, scale {scale}");
                        worst = worst.max(error);
                    }
                    compared += 1;
                }
            }
        }
    }
    println!("n = {n}: {compared} gradients, worst {worst:.1e}; values, worst {worst_value:.1e}");
}

#[test]
fn five_joints() {
    compare(5);
}

#[test]
fn six_joints() {
    compare(6);
}

#[test]
fn seven_joints() {
    compare(7);
}

/// [`IndexFunction::smoothed`] is the log-sum-exp of what `evaluate` gives,
/// whose parts the tests above hold against dual numbers.
#[test]
fn the_smoothed_index_is_the_log_sum_exp_of_its_parts() {
    let mut dice = Dice::new(91);
    for n in [5, 6, 7] {
        for (case, index) in Index::ALL.into_iter().enumerate() {
            if index.uses_dexterity() && n < 6 {
                continue;
            }
            let (model, postures) = random_case(&mut dice, n, case % 4, case % 3 == 1, case % 2 == 1);
            let cell = model.cell();
            // The first posture is given, the others are free.
            let (measured, free) = postures.split_at(1);
            let flat = free.concat();
            let p = 25.0;
            let mut function = IndexFunction::with_given(&cell, index, POSTURES - 1, measured).unwrap();
            let mut gradient = vec![0.0; flat.len()];
            let smoothed = function.smoothed(&flat, p, &mut gradient);
            function.set_sharpness(Some(p));
            let parts = function.evaluate(&flat);
            let weights: Vec<f64> = parts.components.iter().map(|c| (p * c).exp()).collect();
            let sum: f64 = weights.iter().sum();
            let mut expected = parts.smooth_gradient.clone();
            let mut value = parts.smooth;
            if !weights.is_empty() {
                value += sum.ln() / p;
                let rows = parts.component_gradients.chunks_exact(flat.len());
                for (row, weight) in rows.zip(&weights) {
                    for (e, g) in expected.iter_mut().zip(row) {
                        *e += weight / sum * g;
                    }
                }
            }
            assert!((smoothed.objective - value).abs() < 1e-10 * value.abs().max(1.0));
            let scale = expected.iter().fold(1e-3_f64, |m, g| m.max(g.abs()));
            for (ours, expected) in gradient.iter().zip(&expected) {
                assert!((ours - expected).abs() < TOLERANCE * scale, "{index:?}, n {n}");
            }
            // The value counts given and free postures alike.
            let exact = ln_index(&cell, index, &postures);
            assert!((smoothed.exact - exact).abs() < 1e-8 * exact.abs().max(1.0));
            assert!((function.value(&flat) - exact).abs() < 1e-8 * exact.abs().max(1.0));
        }
    }
}

#[test]
fn smoothing_is_off_by_at_most_ln_n_over_p_and_does_not_touch_the_exact_value() {
    let mut dice = Dice::new(9);
    for p in [1.0, 30.0, 6e4] {
        let (model, postures) = random_case(&mut dice, 6, 0, false, false);
        let cell = model.cell();
        let flat = postures.concat();
        for index in [Index::Condition, Index::Scaled, Index::O2, Index::O3, Index::O4] {
            let mut function = IndexFunction::new(&cell, index, POSTURES).unwrap();
            assert!(function.has_extreme_singular_values());
            let exact = function.evaluate(&flat);
            assert_eq!(exact.smooth, exact.exact);
            function.set_sharpness(Some(p));
            let smooth = function.evaluate(&flat);
            assert_eq!(smooth.exact, exact.exact);
            let off = smooth.smooth - exact.smooth;
            // Half a power of each of λ_max and 1/λ_min; O4 has 1/λ_min whole.
            let most = match index {
                Index::O3 => 0.5,
                Index::O4 => 1.5,
                _ => 1.0,
            } * 6f64.ln()
                / p;
            assert!((-1e-12..=most * (1.0 + 1e-12)).contains(&off), "{index:?}, p = {p}: {off} of {most}");
        }
    }
}
