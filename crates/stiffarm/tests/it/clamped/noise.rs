//! Intervals of clamped data cover as often as they say, and gross errors in them are found.

use super::*;

#[test]
fn intervals_cover_as_often_as_they_say() {
    let runs = runs(300) as usize;
    let binomial = Binomial::new(0.95, runs as u64).unwrap();
    for (cell, what) in [(reference_cell(), "COMAU"), (panda(), "Panda")] {
        let truth = cell.require_prior().unwrap();
        let n = truth.len();
        let mut dice = Dice::new(4);
        let postures = postures(&cell, &mut dice, 3);
        let mut simulation = ClampedSimulation {
            moves: moves(&cell, &mut dice, 1, 300.0),
            angle_std: 0.0,
            ..ClampedSimulation::default()
        };
        let largest = simulation.moves[0].motor.iter().fold(0.0_f64, |m, q| m.max(q.abs()));
        simulation.angle_std = 0.01 * largest;
        for noise in [NoiseSource::Estimated, NoiseSource::Known] {
            let options = with(|o: &mut IdentifyOptions| o.noise = noise);
            let mut covered = vec![0; n];
            for run in 0..runs {
                let data = simulate_clamped(&cell, &postures, truth, &simulation, 9, run).unwrap();
                let result = identify_clamped(&cell, &data, Some(simulation.angle_std), &options).unwrap();
                assert!(result.estimates.independent_rows);
                for (j, joint) in result.estimates.joints.iter().enumerate() {
                    let [low, high] = joint.interval;
                    let above = low.is_some_and(|low| low <= truth[j]);
                    covered[j] += u64::from(above && high.is_none_or(|high| truth[j] <= high));
                }
            }
            println!("{what}, {noise:?}: {covered:?} of {runs}");
            let tail = 0.5 * FALSE_ALARM / (4 * n) as f64;
            let (least, most) = (binomial.inverse_cdf(tail), binomial.inverse_cdf(1.0 - tail));
            assert!(covered.iter().all(|c| (least..=most).contains(c)), "{what} {noise:?}: {covered:?}");
        }
    }
}

#[test]
fn noise_of_the_wrench_hardly_moves_the_estimates() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let mut dice = Dice::new(12);
    let postures = postures(&cell, &mut dice, 10);
    let simulation = ClampedSimulation {
        moves: moves(&cell, &mut dice, 2, 500.0),
        angle_std: 2e-6,
        force_std: 0.5,
        moment_std: 0.1,
        ..ClampedSimulation::default()
    };
    let data = simulate_clamped(&cell, &postures, truth, &simulation, 3, 0).unwrap();
    assert_close(&stiffness(&cell, &data), truth, 0.02, "with noise");
}

#[test]
fn states_against_one_reference_weigh_as_dense_least_squares() {
    let cell = reference_cell();
    let mut dice = Dice::new(71);
    let mut data = exact(&cell, 71, 3, 3);
    for c in &mut data {
        c.reference = Some(0);
        for q in &mut c.motor {
            *q += dice.between(-2e-5, 2e-5);
        }
    }
    let system = clamped_system(&cell, &data, &[]).unwrap();
    let rows = system.psi.nrows();
    let mut dense = DMatrix::identity(rows, rows);
    for a in 0..rows {
        for b in 0..rows {
            // Six rows per state, three states per posture.
            if a != b && a / 18 == b / 18 && a % 6 == b % 6 {
                dense[(a, b)] = 0.5;
            }
        }
    }
    let precision = dense.try_inverse().unwrap();
    let information = system.psi.transpose() * &precision * &system.psi;
    let expected = information.lu().solve(&(system.psi.transpose() * precision * &system.delta)).unwrap();
    let options = by(Estimator::Weighted);
    let result = identify_clamped(&cell, &data, None, &options).unwrap();
    for (joint, h) in result.estimates.joints.iter().zip(expected.iter()) {
        assert!((joint.compliance.unwrap() / h - 1.0).abs() < 1e-9);
    }
}

#[test]
fn huber_finds_a_state_that_does_not_fit() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let mut dice = Dice::new(81);
    let moves = moves(&cell, &mut dice, 3, 300.0);
    let postures = postures(&cell, &mut dice, 8);
    let mut data = simulated(&cell, &postures, moves, 2e-6, 2);
    for q in &mut data[4].motor {
        *q *= 3.0;
    }
    let error = |estimator| {
        let options = by(estimator);
        let result = identify_clamped(&cell, &data, None, &options).unwrap();
        let estimate = result.estimates.stiffness().unwrap();
        let worst = estimate.iter().zip(truth).map(|(k, t)| (k / t - 1.0).abs()).fold(0.0, f64::max);
        (worst, result)
    };
    let (ordinary, _) = error(Estimator::Ordinary);
    let (robust, result) = error(Estimator::Huber);
    assert!(robust < 0.2 * ordinary, "{robust} and {ordinary}");
    assert_eq!((result.weights[0].posture.as_str(), result.weights[0].state.as_str()), ("2", "loaded-2"));
    assert!(result.weights[0].weight < 0.05 && result.weights[1].weight > 0.2);
}
