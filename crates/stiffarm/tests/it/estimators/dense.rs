//! Every estimator gives what dense matrices give.

use super::*;

/// −2 ln of the restricted likelihood with σ² profiled out, up to a constant.
fn dense_restricted(system: &MeasuredSystem, gamma: f64) -> f64 {
    let v = dense_covariance(system, gamma);
    let (_, covariance, rest) = dense_gls(system, &v);
    let free = (system.psi.nrows() - system.psi.ncols()) as f64;
    free * rest.ln() + v.determinant().ln() - covariance.determinant().ln()
}

/// Largest difference of the values, in standard errors.
fn distance(ours: &DVector<f64>, theirs: &DVector<f64>, covariance: &DMatrix<f64>) -> f64 {
    (0..ours.len()).map(|j| (ours[j] - theirs[j]).abs() / covariance[(j, j)].sqrt()).fold(0.0, f64::max)
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
        let norms: Vec<f64> = (0..rows / 3).map(|d| residual.fixed_rows::<3>(3 * d).norm()).collect();
        let mut sorted = norms.clone();
        sorted.sort_by(f64::total_cmp);
        let middle = 0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2]);
        // √2.3659739, the median of χ² with three degrees of freedom.
        sigma = middle / 2.365_973_884_f64.sqrt() / ((rows - n) as f64 / rows as f64).sqrt();
        weights = norms.iter().map(|r| (1.628 * sigma / r).min(1.0)).collect();
    }
    (values, weights, sigma)
}

/// The system without the postures of one fold.
fn without(system: &MeasuredSystem, left_out: &[usize]) -> MeasuredSystem {
    let mut rows = Vec::new();
    let mut out = system.clone();
    (out.blocks, out.labels) = (Vec::new(), Vec::new());
    for (b, block) in system.blocks.iter().enumerate() {
        if left_out.contains(&b) {
            continue;
        }
        let from = rows.len();
        rows.extend(block.rows.clone());
        let mut rest = block.clone();
        rest.rows = from..rows.len();
        out.blocks.push(rest);
        for label in system.labels_of(block) {
            let mut label = label.clone();
            let start = from + label.rows.start - block.rows.start;
            label.rows = start..start + 3;
            out.labels.push(label);
        }
    }
    out.psi = system.psi.select_rows(&rows);
    out.delta = system.delta.select_rows(&rows);
    out
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn a_fit_that_loses_postures_is_the_fit_of_the_others(
        seed in any::<u64>(), postures in 4..9_usize, unknowns in 1..5_usize, correlated in any::<bool>(),
        folds in 2..9_usize, blind in any::<bool>(), wild in any::<bool>(),
    ) {
        let mut dice = Dice::new(seed);
        let mut system = random_system(&mut dice, postures, unknowns, correlated);
        for block in &system.blocks {
            let shift = DVector::from_fn(3, |_, _| dice.between(-2.0, 2.0));
            let mut rows = system.delta.rows_mut(block.rows.start, block.rows.len());
            rows += &block.shared * shift;
        }
        if blind {
            // One posture alone sees the last unknown.
            let rows = system.blocks[1].rows.clone();
            let column = system.psi.view((rows.start, unknowns - 1), (rows.len(), 1)).into_owned();
            system.psi.column_mut(unknowns - 1).fill(0.0);
            system.psi.view_mut((rows.start, unknowns - 1), (rows.len(), 1)).copy_from(&column);
        }
        if wild {
            let mut rows = system.delta.rows_mut(0, system.blocks[0].rows.len());
            rows *= 1e3;
        }
        let folds = folds.min(postures);
        let known_scale = Scale::Known { sigma: 0.7, gamma: 2.0 };
        for (estimator, scale) in [
            (Estimator::TwoVariance, Scale::Estimated),
            (Estimator::TwoVariance, known_scale),
            (Estimator::Ordinary, Scale::Estimated),
            (Estimator::Weighted, Scale::Repeats { sigma: 0.5, degrees_of_freedom: 9 }),
            (Estimator::NonNegative, Scale::Estimated),
            (Estimator::Prior, Scale::Estimated),
            (Estimator::Huber, Scale::Estimated),
        ] {
            let mut assumed = assume(estimator, scale);
            if estimator == Estimator::Prior {
                assumed.prior = Some(PriorKnowledge { compliance: vec![0.3; unknowns], relative_std: 0.5 });
            }
            let prepared = Prepared::new(&system, estimator).unwrap();
            let ours = solutions_without(&prepared, &system.delta, &assumed, folds).unwrap();
            prop_assert_eq!(ours.len(), folds);
            for (f, ours) in ours.iter().enumerate() {
                let left_out: Vec<usize> = (f..postures).step_by(folds).collect();
                let rest = without(&system, &left_out);
                let theirs = solve(&rest, &assumed);
                prop_assert_eq!(&ours.undetermined, &theirs.undetermined);
                prop_assert_eq!(&ours.at_bound, &theirs.at_bound);
                prop_assert_eq!(ours.degrees_of_freedom, theirs.degrees_of_freedom);
                prop_assert_eq!(ours.t_degrees_of_freedom, theirs.t_degrees_of_freedom);
                prop_assert_eq!(ours.independent_rows, theirs.independent_rows);
                // The minimum is flat: γ is known to the root of the rounding.
                let estimated = estimator.as_str() != "ordinary" && scale == Scale::Estimated;
                let limit = if estimated { 1e-4 } else { 1e-8 };
                let near = |a: f64, b: f64| (a - b).abs() <= limit * (a.abs() + b.abs()) + 1e-9;
                let flat = (ours.gamma - theirs.gamma).abs() <= limit * (1.0 + theirs.gamma);
                prop_assert!(flat, "{:?}: {} {}", estimator, ours.gamma, theirs.gamma);
                prop_assert!(near(ours.sigma.unwrap(), theirs.sigma.unwrap()));
                let covariance = theirs.covariance.as_ref().unwrap();
                for j in (0..unknowns).filter(|j| !theirs.undetermined.contains(j)) {
                    let error = covariance[(j, j)].sqrt();
                    let difference = (ours.values[j] - theirs.values[j]).abs();
                    prop_assert!(difference <= limit * error + 1e-9 * theirs.values[j].abs(), "{:?}", estimator);
                    let ours = ours.covariance.as_ref().unwrap()[(j, j)].sqrt();
                    prop_assert!(near(ours, error), "{:?}: {} {}", estimator, ours, error);
                }
            }
        }
    }
}
