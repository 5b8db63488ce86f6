//! A sound experiment raises a finding about as rarely as its level says.

use super::*;
use crate::common::cases::sentences;

/// Findings that say that something is wrong, in `seeds` clean experiments.
fn false_alarms(cell: &Cell, postures: &[Posture], estimator: Estimator, seeds: u64) -> BTreeMap<String, u64> {
    let faults = [
        "residuals-above-noise",
        "residuals-below-noise",
        "outlying-displacement",
        "outlying-posture",
        "outlying-point",
        "more-outliers",
        "further-term",
        "weak-joint",
        "correlated",
        "posture-needed",
    ];
    let mut counts = BTreeMap::new();
    for seed in 0..seeds {
        let truth = truth(cell);
        let measured = simulate_measurements(cell, postures, &truth, Model::Linear, seed, 0);
        let diagnosis = diagnose(&Fit::new(cell, measured.unwrap(), &by(estimator)).unwrap()).unwrap();
        for fault in faults.iter().filter(|f| codes(&diagnosis).contains(f)) {
            *counts.entry((*fault).to_string()).or_default() += 1;
        }
    }
    println!(
        "τ = {:.1} σ, {} postures, {}: {counts:?} of {seeds}",
        cell.noise.posture_common_std / cell.noise.displacement_std(),
        postures.len(),
        estimator.as_str()
    );
    counts
}

/// Measured with 200 seeds (experiments of 200 with the finding; none had any of
/// the others):
///
/// | τ/σ | postures | estimator | above noise | below noise | displacement | extra term |
/// |--:|--:|:--|--:|--:|--:|--:|
/// | 0 | 12 | ordinary | 0 | 1 | 1 | 0 |
/// | 0 | 12 | two-variance | 0 | 1 | 1 | 0 |
/// | 1 | 12 | two-variance | 0 | 0 | 0 | 1 |
/// | 3 | 12 | two-variance | 0 | 0 | 0 | 0 |
/// | 3 | 6 | two-variance | 1 | 1 | 0 | 0 |
#[test]
fn false_alarm_rates() {
    let seeds = runs(20);
    let all = postures();
    for (common_part, estimator, count) in [
        (0.0, Estimator::Ordinary, 12),
        (0.0, Estimator::TwoVariance, 12),
        (1.0, Estimator::TwoVariance, 12),
        (3.0, Estimator::TwoVariance, 12),
        (3.0, Estimator::TwoVariance, 6),
    ] {
        let counts = false_alarms(&noisy_cell(common_part), &all[12 - count..], estimator, seeds);
        for (fault, count) in counts {
            // 1 % expects 2 of 200; 9 or more have a probability of 2e-4.
            assert!(count <= most(0.01, seeds, u64::MAX), "{fault}: {count} of {seeds}");
        }
    }
}

/// The same for load states. Measured: up only, curvature 1 and offset 1 of 200;
/// both ways, scatter 2 of 200.
#[test]
fn clean_load_states_raise_few_findings() {
    let seeds = runs(20);
    let cell = noisy_cell(0.0);
    for states in [&UP[..], &BOTH[..]] {
        let mut counts: BTreeMap<String, u64> = BTreeMap::new();
        for seed in 0..seeds {
            let measured = in_states(&cell, states, seed, |_, _, _| Vector3::zeros());
            let options = by(Estimator::TwoVariance);
            let noise = noise_test(&Fit::new(&cell, &measured, &options).unwrap()).unwrap();
            let comparison = Fit::new(&cell, &measured, &options)
                .and_then(|fit| load_states(&fit, noise.as_ref()))
                .unwrap()
                .unwrap();
            assert_eq!(comparison.scatter_degrees_of_freedom.is_some(), states.len() == 5);
            assert_eq!(comparison.hysteresis.is_some(), states.len() == 5);
            for finding in comparison.findings() {
                *counts.entry(finding.code).or_default() += 1;
            }
        }
        println!("{} states: {counts:?} of {seeds}", states.len());
        for (code, count) in counts {
            let rare = count <= most(0.01, seeds, u64::MAX);
            assert!(code == "load-linear" || rare, "{code}: {count}");
        }
    }
}

#[test]
fn residuals_are_compared_with_the_noise_in_words() {
    let cell = noisy_cell(0.0);
    let measured = measure(&cell, 5);
    let test = |factor: f64| {
        let mut stated = cell.clone();
        stated.noise.reading_variance /= factor * factor;
        noise_test(&Fit::new(&stated, &measured, &by(Estimator::Ordinary)).unwrap()).unwrap().unwrap()
    };
    let honest = test(1.0);
    assert_eq!(honest.agreement, Agreement::Agrees);
    assert!((honest.p_larger + honest.p_smaller - 1.0).abs() < 1e-9);
    let understated = test(22.0);
    assert_eq!(understated.agreement, Agreement::Larger);
    assert!((understated.ratio / honest.ratio / 22.0 - 1.0).abs() < 1e-9);
    let overstated = test(0.5);
    assert_eq!(overstated.agreement, Agreement::Smaller);
    // The whitened residual with the declared common part is what it is.
    let cell = noisy_cell(3.0);
    let shared = Fit::new(&cell, measure(&cell, 5), &by(Estimator::TwoVariance)).and_then(|fit| noise_test(&fit));
    assert_eq!(shared.unwrap().unwrap().agreement, Agreement::Agrees);
    let mut undeclared = cell.clone();
    undeclared.noise.posture_common_std = 0.0;
    let alike = Fit::new(&undeclared, measure(&cell, 5), &by(Estimator::TwoVariance)).and_then(|fit| noise_test(&fit));
    let alike = alike.unwrap().unwrap();
    assert_eq!(alike.agreement, Agreement::Larger);
    assert!(alike.within_ratio.is_some_and(|r| r < 1.3), "{alike:?}");
    let findings = [understated, test(1.4), overstated].map(|noise| noise.finding(None));
    insta::assert_snapshot!(sentences(findings.iter().chain([&alike.finding(None)])), @"
    [residuals-above-noise] residuals: The residuals are 21 times the cell's noise (0.013 mm against 0.6 µm, p < 0.001): the model, not the tracker, limits the result.
    [residuals-above-noise] residuals: The residuals are 1.32 times the cell's noise (0.013 mm against 9.7 µm, p < 0.001): something beyond the stated noise is in the data, or the noise is stated too small.
    [residuals-below-noise] residuals: The residuals are 0.47 times the cell's noise (0.013 mm against 0.027 mm, p < 0.001): the noise is stated too large.
    [residuals-above-noise] residuals: The residuals are 2.7 times the cell's noise (0.037 mm against 0.014 mm, p < 0.001): the model, not the tracker, limits the result. What the points of a posture do not share is 1.0 times the noise: the rest moves all points alike (load, rope, drift, or the model of the arm).
    ");
    // As the result says it, where no common part is declared.
    let result = identify(&undeclared, measure(&cell, 5), &by(Estimator::TwoVariance));
    assert!((result.unwrap().total_std_m.unwrap() / alike.residual_std_m - 1.0).abs() < 1e-12);
}
