//! The estimators against dense textbook formulas: covariance matrices written
//! out in full and inverted, which the library never does.

use crate::common;

use common::random::Dice;
use common::{cases, random_group, reference_cell};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use proptest::prelude::*;
use stiffarm::estimate::identify::{
    Estimator, Fit, IdentifyOptions, NoiseSource, Verdict, Weights, bootstrap, identify,
};
use stiffarm::internals::{
    Assumptions, Block, MeasuredSystem, Prepared, PriorKnowledge, RowLabel, Scale, Solution,
    Whitened, measured_system,
};
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Wrench;
use stiffarm::model::measurement::{Displacement, MeasuredPosture};
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::posture::{Posture, PostureGroup};

/// A random system of `postures` blocks with up to four displacements each,
/// `states` of which share shifts in proportion to a load, and covariances
/// where asked.
fn random_system(
    dice: &mut Dice,
    postures: usize,
    unknowns: usize,
    correlated: bool,
) -> MeasuredSystem {
    let mut blocks = Vec::new();
    let mut labels = Vec::new();
    let mut at = 0;
    for p in 0..postures {
        let count = 2 + dice.below(3);
        let mut shared = DMatrix::zeros(3 * count, 3);
        for d in 0..count {
            let load = if d % 2 == 0 {
                1.0
            } else {
                dice.signed(0.3, 1.0)
            };
            for axis in 0..3 {
                shared[(3 * d + axis, axis)] = load;
            }
            labels.push(RowLabel {
                measured: p,
                displacement: d,
                rows: at + 3 * d..at + 3 * d + 3,
            });
        }
        let rows = 3 * count;
        let covariance = correlated.then(|| {
            let root = DMatrix::from_fn(rows, rows, |_, _| dice.between(-0.4, 0.4));
            &root * root.transpose() + DMatrix::identity(rows, rows)
        });
        blocks.push(Block {
            posture: format!("p{p}"),
            rows: at..at + rows,
            covariance,
            shared,
        });
        at += rows;
    }
    MeasuredSystem {
        psi: DMatrix::from_fn(at, unknowns, |_, j| {
            dice.between(-1.0, 1.0) * 10f64.powi(j as i32 - 2)
        }),
        delta: DVector::from_fn(at, |_, _| dice.between(-1.0, 1.0)),
        unknowns: (0..unknowns).map(|j| format!("u{j}")).collect(),
        springs: unknowns,
        extra: Vec::new(),
        blocks,
        labels,
    }
}

/// C + γ Z Zᵀ of the whole system, in units of σ².
fn dense_covariance(system: &MeasuredSystem, gamma: f64) -> DMatrix<f64> {
    let rows = system.psi.nrows();
    let mut out = DMatrix::identity(rows, rows);
    for block in &system.blocks {
        let (from, count) = (block.rows.start, block.rows.len());
        let own = block
            .covariance
            .clone()
            .unwrap_or_else(|| DMatrix::identity(count, count));
        let shift = &block.shared * block.shared.transpose() * gamma;
        out.view_mut((from, from), (count, count))
            .copy_from(&(own + shift));
    }
    out
}

/// Generalised least squares: values, (ΨᵀV⁻¹Ψ)⁻¹, eᵀV⁻¹e.
fn dense_gls(system: &MeasuredSystem, v: &DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>, f64) {
    let inverse = v.clone().try_inverse().unwrap();
    let information = system.psi.transpose() * &inverse * &system.psi;
    let covariance = information.try_inverse().unwrap();
    let values = &covariance * system.psi.transpose() * &inverse * &system.delta;
    let residual = &system.delta - &system.psi * &values;
    let rest = residual.dot(&(inverse * &residual));
    (values, covariance, rest)
}

/// −2 ln of the restricted likelihood with σ² profiled out, up to a constant.
fn dense_restricted(system: &MeasuredSystem, gamma: f64) -> f64 {
    let v = dense_covariance(system, gamma);
    let (_, covariance, rest) = dense_gls(system, &v);
    let free = (system.psi.nrows() - system.psi.ncols()) as f64;
    free * rest.ln() + v.determinant().ln() - covariance.determinant().ln()
}

fn assume(estimator: Estimator, scale: Scale) -> Assumptions {
    Assumptions {
        estimator,
        scale,
        declared_ratio: 0.0,
        prior: None,
    }
}

fn solve(system: &MeasuredSystem, assumed: &Assumptions) -> Solution {
    Prepared::new(system, assumed.estimator)
        .unwrap()
        .solve(&system.delta, assumed)
        .unwrap()
}

/// Largest difference of the values, in standard errors.
fn distance(ours: &DVector<f64>, theirs: &DVector<f64>, covariance: &DMatrix<f64>) -> f64 {
    (0..ours.len())
        .map(|j| (ours[j] - theirs[j]).abs() / covariance[(j, j)].sqrt())
        .fold(0.0, f64::max)
}

fn same_matrix(ours: &DMatrix<f64>, theirs: &DMatrix<f64>) -> f64 {
    let n = ours.nrows();
    let mut worst = 0.0_f64;
    for i in 0..n {
        for j in 0..n {
            let size = (theirs[(i, i)] * theirs[(j, j)]).sqrt();
            worst = worst.max((ours[(i, j)] - theirs[(i, j)]).abs() / size);
        }
    }
    worst
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn the_restricted_likelihood_is_that_of_dense_matrices(
        seed in any::<u64>(), postures in 3..7_usize, unknowns in 1..5_usize, correlated in any::<bool>(),
    ) {
        let system = random_system(&mut Dice::new(seed), postures, unknowns, correlated);
        let whitened = Whitened::new(&system).unwrap();
        let white = whitened.whiten(&system.delta);
        let ours = whitened.restricted(&white).unwrap();
        let constant = ours.value(0.0) - dense_restricted(&system, 0.0);
        for gamma in [1e-4, 0.03, 0.5, 1.0, 7.0, 300.0] {
            let difference = ours.value(gamma) - dense_restricted(&system, gamma) - constant;
            prop_assert!(difference.abs() < 1e-8, "γ = {}: {}", gamma, difference);
        }
        // The ratio found is a minimum over all sizes.
        let best = whitened.variance_ratio(&white);
        let least = ours.value(best);
        prop_assert!(least <= ours.value(0.0));
        for i in 0..400 {
            let gamma = (-12.0 + 0.06 * i as f64).exp();
            prop_assert!(least <= ours.value(gamma) + 1e-9, "γ = {} is better than {}", gamma, best);
        }
    }

    #[test]
    fn the_two_variance_fit_is_least_squares_with_the_covariance_found(
        seed in any::<u64>(), postures in 3..7_usize, unknowns in 1..5_usize, correlated in any::<bool>(),
    ) {
        let mut dice = Dice::new(seed);
        let mut system = random_system(&mut dice, postures, unknowns, correlated);
        // Shifts large enough to be found more often than not.
        for block in &system.blocks {
            let shift = DVector::from_fn(3, |_, _| dice.between(-2.0, 2.0));
            let mut rows = system.delta.rows_mut(block.rows.start, block.rows.len());
            rows += &block.shared * shift;
        }
        let ours = solve(&system, &assume(Estimator::TwoVariance, Scale::Estimated));
        let (values, covariance, rest) = dense_gls(&system, &dense_covariance(&system, ours.gamma));
        let free = system.psi.nrows() - unknowns;
        let s2 = rest / free as f64;
        prop_assert!((ours.sigma.unwrap().powi(2) / s2 - 1.0).abs() < 1e-9);
        prop_assert!(distance(&ours.values, &values, &(&covariance * s2)) < 1e-8);
        prop_assert!(same_matrix(&ours.covariance.unwrap(), &(covariance * s2)) < 1e-9);
        prop_assert_eq!(ours.degrees_of_freedom, free);
        let between = 3 * postures - unknowns;
        prop_assert_eq!(ours.t_degrees_of_freedom, Some(between.min(free)));
    }

    #[test]
    fn weighted_least_squares_use_what_is_declared(
        seed in any::<u64>(), ratio in 0.0..5.0_f64, correlated in any::<bool>(),
    ) {
        let system = random_system(&mut Dice::new(seed), 5, 3, correlated);
        let mut assumed = assume(Estimator::Weighted, Scale::Estimated);
        assumed.declared_ratio = ratio;
        let ours = solve(&system, &assumed);
        let (values, covariance, rest) = dense_gls(&system, &dense_covariance(&system, ratio));
        let s2 = rest / (system.psi.nrows() - 3) as f64;
        prop_assert!(distance(&ours.values, &values, &(&covariance * s2)) < 1e-8);
        prop_assert!(same_matrix(&ours.covariance.unwrap(), &(covariance * s2)) < 1e-9);
        // Ordinary least squares know of neither.
        let plain = solve(&system, &assume(Estimator::Ordinary, Scale::Estimated));
        let (values, covariance, _) = dense_gls(&system, &DMatrix::identity(system.psi.nrows(), system.psi.nrows()));
        prop_assert!(distance(&plain.values, &values, &covariance) < 1e-8);
    }

    #[test]
    fn the_prior_estimate_is_bayes_rule(
        seed in any::<u64>(), gamma in 0.0..4.0_f64, spread in 0.05..2.0_f64, sigma in 0.01..3.0_f64,
    ) {
        let mut dice = Dice::new(seed);
        let system = random_system(&mut dice, 4, 3, true);
        let prior: Vec<f64> = (0..3).map(|j| dice.between(0.2, 2.0) * 10f64.powi(2 - j)).collect();
        let mut assumed = assume(Estimator::Prior, Scale::Known { sigma, gamma });
        assumed.prior = Some(PriorKnowledge { compliance: prior.clone(), relative_std: spread });
        let ours = solve(&system, &assumed);
        let precision = dense_covariance(&system, gamma).try_inverse().unwrap() / (sigma * sigma);
        let mut information = system.psi.transpose() * &precision * &system.psi;
        let mut right = system.psi.transpose() * &precision * &system.delta;
        for (j, h) in prior.iter().enumerate() {
            let weight = (spread * h).powi(-2);
            information[(j, j)] += weight;
            right[j] += weight * h;
        }
        let covariance = information.try_inverse().unwrap();
        prop_assert!(distance(&ours.values, &(&covariance * right), &covariance) < 1e-8);
        prop_assert!(same_matrix(&ours.covariance.unwrap(), &covariance) < 1e-9);
        prop_assert_eq!(ours.t_degrees_of_freedom, None);
    }

    #[test]
    fn the_non_negative_fit_meets_its_optimality_conditions(
        seed in any::<u64>(), gamma in prop_oneof![Just(0.0), 0.1..4.0_f64], unknowns in 1..7_usize,
        blind in 0..3_usize,
    ) {
        let mut dice = Dice::new(seed);
        let mut system = random_system(&mut dice, 6, unknowns, true);
        let last = unknowns - 1;
        if blind == 1 {
            // A joint that the load passes by: rounding errors in place of a column.
            system.psi.column_mut(last).iter_mut().for_each(|v| *v *= 1e-17);
        } else if blind == 2 && unknowns > 1 {
            // Two joints that cannot be told apart.
            let twin = system.psi.column(0) * dice.between(1.0, 3.0);
            system.psi.set_column(last, &twin);
        }
        let scale = Scale::Known { sigma: 1.0, gamma };
        let ours = solve(&system, &assume(Estimator::NonNegative, scale));
        let free = solve(&system, &assume(Estimator::TwoVariance, scale));
        let precision = dense_covariance(&system, gamma).try_inverse().unwrap();
        let residual = &system.delta - &system.psi * &ours.values;
        let gradient = system.psi.transpose() * &precision * residual;
        let size = (system.delta.dot(&(&precision * &system.delta))).sqrt();
        let length = |j: usize| {
            let column = system.psi.column(j);
            column.dot(&(&precision * column)).sqrt()
        };
        let longest = (0..unknowns).map(length).fold(0.0, f64::max);
        for j in 0..unknowns {
            let unit = length(j).max(1e-6 * longest) * size;
            let held = ours.values[j] == 0.0;
            let unknown = ours.undetermined.contains(&j);
            prop_assert_eq!(ours.at_bound.contains(&j), held && !unknown);
            prop_assert!(ours.values[j] >= 0.0, "{}: {}", j, ours.values[j]);
            if held {
                prop_assert!(gradient[j] <= 1e-9 * unit, "{} wants to rise: {}", j, gradient[j] / unit);
            } else {
                prop_assert!(gradient[j].abs() <= 1e-9 * unit, "{} is not stationary: {}", j, gradient[j] / unit);
            }
        }
        if free.undetermined.is_empty() && free.values.iter().all(|v| *v > 0.0) {
            prop_assert!(distance(&ours.values, &free.values, free.covariance.as_ref().unwrap()) < 1e-9);
            prop_assert!(ours.at_bound.is_empty());
        }
    }

    #[test]
    fn the_robust_fit_is_textbook_reweighting(seed in any::<u64>(), unknowns in 1..5_usize) {
        let mut dice = Dice::new(seed);
        let mut system = random_system(&mut dice, 6, unknowns, false);
        let truth = DVector::from_fn(unknowns, |j, _| 10f64.powi(3 - j as i32));
        system.delta = &system.psi * truth + &system.delta * 0.1;
        let ours = solve(&system, &assume(Estimator::Huber, Scale::Estimated));
        let (values, weights, sigma) = dense_huber(&system);
        // Against the errors themselves, which are of size 0.1.
        let fit = (&system.psi * (&ours.values - &values)).amax();
        prop_assert!(fit < 1e-7, "fits differ by {}", fit);
        prop_assert!((ours.sigma.unwrap() / sigma - 1.0).abs() < 1e-6);
        for (a, b) in ours.weights.unwrap().iter().zip(&weights) {
            prop_assert!((a - b).abs() < 1e-6);
        }
    }
}

/// Iteratively reweighted least squares by normal equations, scale from the
/// median norm of the residuals.
fn dense_huber(system: &MeasuredSystem) -> (DVector<f64>, Vec<f64>, f64) {
    let (rows, n) = system.psi.shape();
    let mut weights = vec![1.0; rows / 3];
    let mut sigma = 0.0;
    let mut values = DVector::zeros(n);
    for _ in 0..2000 {
        let diagonal = DVector::from_fn(rows, |i, _| weights[i / 3]);
        let weighted = DMatrix::from_diagonal(&diagonal) * &system.psi;
        let information = weighted.transpose() * &system.psi;
        values = information.try_inverse().unwrap() * weighted.transpose() * &system.delta;
        let residual = &system.delta - &system.psi * &values;
        let norms: Vec<f64> = (0..rows / 3)
            .map(|d| residual.fixed_rows::<3>(3 * d).norm())
            .collect();
        let mut sorted = norms.clone();
        sorted.sort_by(f64::total_cmp);
        let middle = 0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2]);
        // √2.3659739, the median of χ² with three degrees of freedom.
        sigma = middle / 2.365_973_884_f64.sqrt() / ((rows - n) as f64 / rows as f64).sqrt();
        weights = norms.iter().map(|r| (1.628 * sigma / r).min(1.0)).collect();
    }
    (values, weights, sigma)
}

fn named(postures: &[Vec<f64>]) -> Vec<Posture> {
    PostureGroup::from_angles("", postures.iter().cloned()).postures
}

/// Exact displacements of the reference cell under fractions of its load, plus
/// errors of size `sigma`, all against one unloaded reading.
fn measured(cell: &Cell, loads: &[f64], sigma: f64, dice: &mut Dice) -> Vec<MeasuredPosture> {
    let prior = cell.require_prior().unwrap();
    let compliance = DVector::from_iterator(prior.len(), prior.iter().map(|k| 1.0 / k));
    let mut out = Vec::new();
    for posture in named(&random_group()) {
        let force = PostureTerms::new(&cell.setup, &posture.q, None).unwrap();
        for load in loads {
            let wrench = Wrench::force(force.wrench().force * *load);
            let terms = PostureTerms::new(&cell.setup, &posture.q, Some(&wrench)).unwrap();
            let exact = terms.block(&cell.setup.robot) * &compliance;
            out.push(MeasuredPosture {
                posture: posture.clone(),
                state: format!("load {load}"),
                wrench: Some(wrench),
                common_readings: [0.0; 2],
                servo_deflection: None,
                displacements: (0..cell.setup.tool.point_count())
                    .map(|a| {
                        let error = dice.vector(sigma * 3f64.sqrt());
                        Displacement::new(a, exact.fixed_rows::<3>(3 * a) + error)
                    })
                    .collect(),
            });
        }
    }
    out
}

fn honest_cell() -> Cell {
    let mut cell = reference_cell();
    cell.noise.readings_per_displacement = 2;
    cell
}

#[test]
fn displacements_against_one_reading_correlate_by_a_half() {
    let cell = honest_cell();
    let mut measured = measured(&cell, &[0.5, 1.0], 1e-5, &mut Dice::new(1));
    let system = |measured: &[MeasuredPosture], cell: &Cell| {
        measured_system(cell, measured, &[], Weights::Readings).unwrap()
    };
    let found = system(&measured, &cell);
    assert_eq!(found.blocks.len(), 6);
    for block in &found.blocks {
        let covariance = block.covariance.as_ref().unwrap();
        let expected = DMatrix::from_fn(24, 24, |i, j| match (i == j, i % 12 == j % 12) {
            (true, _) => 1.0,
            (false, true) => 0.5,
            _ => 0.0,
        });
        assert_eq!(covariance, &expected);
    }
    // As the paper counts, the reference has no error of its own.
    assert!(
        system(&measured, &reference_cell())
            .blocks
            .iter()
            .all(|b| b.covariance.is_none())
    );
    // Each state against its own unloaded reading.
    for posture in measured.iter_mut().filter(|m| m.state == "load 1") {
        for displacement in &mut posture.displacements {
            displacement.reference = 1;
        }
    }
    assert!(
        system(&measured, &cell)
            .blocks
            .iter()
            .all(|b| b.covariance.is_none())
    );
    // Four loaded readings against two unloaded ones.
    measured[0].displacements[0].readings = [4, 2];
    let few = system(&measured, &cell);
    let covariance = few.blocks[0].covariance.as_ref().unwrap();
    assert_eq!(covariance[(0, 0)], 0.125 + 0.25);
    assert_eq!(covariance[(3, 3)], 1.0);
}

#[test]
fn tracker_weights_are_least_squares_with_the_trackers_covariance() {
    let cell = honest_cell();
    let mut dice = Dice::new(7);
    let mut measured = measured(&cell, &[1.0], 1e-5, &mut dice);
    let mut blocks = Vec::new();
    for posture in &mut measured {
        for displacement in &mut posture.displacements {
            let along = dice.direction();
            let projector = along * along.transpose();
            let covariance = projector * 4e-12 + (Matrix3::identity() - projector) * 4e-10;
            displacement.covariance = Some(covariance);
            blocks.push(covariance);
        }
    }
    let options = IdentifyOptions {
        estimator: Estimator::Weighted,
        weights: Weights::Tracker,
        ..IdentifyOptions::default()
    };
    let ours = identify(&cell, &measured, &options).unwrap();
    let system = measured_system(&cell, &measured, &[], Weights::Readings).unwrap();
    let mut v = DMatrix::zeros(72, 72);
    for (i, block) in blocks.iter().enumerate() {
        // Two readings, in units of σ² of a displacement by the cell.
        let share = block * 2.0 / cell.noise.displacement_variance();
        v.view_mut((3 * i, 3 * i), (3, 3)).copy_from(&share);
    }
    let (values, covariance, rest) = dense_gls(&system, &v);
    let s2 = rest / 66.0;
    for (j, joint) in ours.joints.iter().enumerate() {
        let error = (covariance[(j, j)] * s2).sqrt();
        assert!((joint.compliance.unwrap() - values[j]).abs() < 1e-8 * error);
        assert!((joint.compliance_standard_error.unwrap() / error - 1.0).abs() < 1e-9);
    }
    // Without the tracker's covariance there is nothing to weigh by.
    measured[0].displacements[0].covariance = None;
    let error = identify(&cell, &measured, &options).unwrap_err();
    assert_eq!(error.code(), stiffarm::Code::MissingKey);
}

#[test]
fn the_robust_fit_ignores_a_gross_error_and_names_it() {
    let cell = reference_cell();
    let clean = measured(&cell, &[1.0], 1e-5, &mut Dice::new(3));
    let mut spoiled = clean.clone();
    spoiled[2].displacements[1].value += Vector3::new(0.3, -0.2, 1.0);
    let with = |measured: &[MeasuredPosture], estimator| {
        let options = IdentifyOptions {
            estimator,
            ..IdentifyOptions::default()
        };
        identify(&cell, measured, &options).unwrap()
    };
    let reference = with(&clean, Estimator::Huber);
    let robust = with(&spoiled, Estimator::Huber);
    let plain = with(&spoiled, Estimator::Ordinary);
    for j in 0..6 {
        let shift = |found: &stiffarm::estimate::identify::Identification| {
            let error = reference.joints[j].compliance_standard_error.unwrap();
            (found.joints[j].compliance.unwrap() - reference.joints[j].compliance.unwrap()).abs()
                / error
        };
        assert!(shift(&robust) < 2.0, "joint {}: {}", j + 1, shift(&robust));
        assert!(shift(&plain) > 20.0 * shift(&robust));
    }
    let least = &robust.weights[0];
    assert_eq!((least.posture.as_str(), least.point.as_str()), ("3", "2"));
    assert!(least.weight < 1e-3 && robust.weights[1].weight > 0.2);
}

#[test]
fn the_non_negative_fit_says_nothing_about_a_joint_without_load() {
    // The load passes through the last axis.
    let mut cell = reference_cell();
    cell.setup.tool.loading_point = Vector3::new(0.0, 0.0, 0.25);
    let measured = measured(&cell, &[1.0], 1e-5, &mut Dice::new(5));
    let options = IdentifyOptions {
        estimator: Estimator::NonNegative,
        ..IdentifyOptions::default()
    };
    let found = identify(&cell, &measured, &options).unwrap();
    assert_eq!(found.undetermined_joints, ["joint 6"]);
    let blind = &found.joints[5];
    assert_eq!(blind.verdict, Verdict::Undetermined);
    assert_eq!(blind.interval, [None, None]);
    assert!(!blind.determined && blind.compliance.is_none());
    assert!(found.joints[..5].iter().all(|j| j.determined));
}

/// Two columns that differ by less and less: the values come with errors that
/// say so, or the unknowns are named; never a number that looks good.
#[test]
fn nearly_collinear_columns_are_never_answered_in_silence() {
    let mut named = 0;
    let mut answered = 0;
    for exponent in 5..=16 {
        for seed in 0..20 {
            let mut dice = Dice::new(1000 * exponent + seed);
            let mut system = random_system(&mut dice, 6, 4, false);
            let apart = 10f64.powi(-(exponent as i32));
            let twin = DVector::from_fn(system.psi.nrows(), |i, _| {
                system.psi[(i, 0)] * (1.0 + apart * dice.between(-1.0, 1.0))
            });
            // The same column again, in another unit.
            system.psi.set_column(3, &(twin * 1e3));
            let truth = DVector::from_column_slice(&[2.0, 0.3, 0.05, 4e-3]);
            let noise = 1e-3 * system.delta.norm() / (system.delta.len() as f64).sqrt();
            system.delta = &system.psi * &truth
                + DVector::from_fn(system.delta.len(), |_, _| noise * dice.between(-1.0, 1.0));
            let found = solve(&system, &assume(Estimator::Ordinary, Scale::Estimated));
            let covariance = found.covariance.as_ref().unwrap();
            // The columns without a twin are known either way.
            for j in [1, 2] {
                assert!(!found.undetermined.contains(&j));
                let error = covariance[(j, j)].sqrt();
                assert!(
                    (found.values[j] - truth[j]).abs() < 6.0 * error,
                    "1e-{exponent}"
                );
                assert!(error < 0.1 * truth[j]);
            }
            if found.undetermined.is_empty() {
                answered += 1;
                for j in [0, 3] {
                    let error = covariance[(j, j)].sqrt();
                    assert!(
                        (found.values[j] - truth[j]).abs() < 6.0 * error,
                        "1e-{exponent}: {} instead of {} ± {error}",
                        found.values[j],
                        truth[j]
                    );
                    // What the data can say falls with the distance of the columns.
                    assert!(
                        error > 0.5 * noise / apart * truth[j],
                        "1e-{exponent}: {error}"
                    );
                }
            } else {
                named += 1;
                assert_eq!(found.undetermined, [0, 3], "1e-{exponent}");
            }
        }
    }
    println!("{answered} answered with their errors, {named} named");
    assert!(answered >= 80 && named >= 80);
}

#[test]
fn a_bootstrap_agrees_with_the_formula_where_both_hold() {
    // Many alike postures: percentile and t intervals describe the same thing.
    let mut cell = honest_cell();
    cell.noise.reading_variance = 1e-10;
    let mut dice = Dice::new(9);
    let mut many = Vec::new();
    for round in 0..12 {
        for mut posture in measured(&cell, &[1.0], 1e-5, &mut dice) {
            posture.posture.name = format!("{}-{round}", posture.posture.name);
            many.push(posture);
        }
    }
    let options = IdentifyOptions {
        estimator: Estimator::Ordinary,
        ..IdentifyOptions::default()
    };
    let found = Fit::new(&cell, &many, &options)
        .and_then(|fit| bootstrap(&fit, 800, 1, 0.95))
        .unwrap();
    let formula = identify(&cell, &many, &options).unwrap();
    assert_eq!((found.postures, found.skipped), (72, 0));
    assert_eq!(found.degrees_of_freedom, 3 * 72 - 6);
    for (a, b) in found.joints.iter().zip(&formula.joints) {
        assert_eq!(a.compliance, b.compliance);
        let ratio = a.compliance_standard_error.unwrap() / b.compliance_standard_error.unwrap();
        assert!((0.7..1.4).contains(&ratio), "{}: {ratio}", a.name);
        let [low, high] = a.interval.map(Option::unwrap);
        assert!(low < a.stiffness.unwrap() && a.stiffness.unwrap() < high);
    }
    // The same seed, the same numbers; another, others.
    let again = Fit::new(&cell, &many, &options)
        .and_then(|fit| bootstrap(&fit, 800, 1, 0.95))
        .unwrap();
    assert_eq!(found, again);
    assert_ne!(
        found.joints,
        Fit::new(&cell, &many, &options)
            .and_then(|fit| bootstrap(&fit, 800, 2, 0.95))
            .unwrap()
            .joints
    );
}

#[test]
fn a_bootstrap_skips_resamples_that_lose_a_joint() {
    // One point: a resample of three postures needs all of them or nearly so.
    let mut cell = honest_cell();
    cell.setup.tool.measuring_points.truncate(1);
    let measured = measured(&cell, &[1.0], 1e-6, &mut Dice::new(4));
    let options = IdentifyOptions {
        estimator: Estimator::Ordinary,
        noise: NoiseSource::Known,
        ..IdentifyOptions::default()
    };
    // A resample with one posture only, 1 in 1296 of six … and 1 in 3 of two.
    let found = Fit::new(&cell, &measured[..2], &options)
        .and_then(|fit| bootstrap(&fit, 600, 1, 0.95))
        .unwrap();
    let share = found.skipped as f64 / 600.0;
    assert!((share - 0.5).abs() < 0.1, "{share}");
    let one = Fit::new(&cell, &measured[..1], &options)
        .and_then(|fit| bootstrap(&fit, 600, 1, 0.95))
        .unwrap_err();
    assert_eq!(one.code(), stiffarm::Code::TooFewData);
    for confidence in [0.0, 1.0, f64::NAN] {
        let error = Fit::new(&cell, &measured, &options)
            .and_then(|fit| bootstrap(&fit, 600, 1, confidence))
            .unwrap_err();
        assert_eq!(error.code(), stiffarm::Code::InvalidValue);
    }
    let few = Fit::new(&cell, &measured, &options)
        .and_then(|fit| bootstrap(&fit, 199, 1, 0.95))
        .unwrap_err();
    assert_eq!(few.code(), stiffarm::Code::InvalidValue);
}
