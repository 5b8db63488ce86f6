//! The posture that is proposed next brings what it promises, and no other brings more.

use crate::common::prelude::*;
use crate::common::readings::{reduced, states};
use proptest::prelude::*;
use stiffarm::estimate::next_posture::NextPosture;

/// Three unloaded rounds, two at half and at full load.
fn with_states(force: ForceRecord) -> Experiment {
    Experiment {
        states: states(&[("unloaded", 0.0, 3), ("half", 0.5, 2), ("full", 1.0, 2), ("half-2", 0.5, 1)]),
        force,
        tracker_noise: TrackerNoise::Isotropic,
        posture_common_std: 2e-5,
        ..Experiment::default()
    }
}

fn measured(cell: &Cell, q: Vec<Vec<f64>>, done: &Experiment, seed: u64) -> Measured {
    let postures = numbered(q);
    let truth = cell.prior.clone().unwrap();
    let table = experiment(cell, &postures, &truth, done, seed, 0).unwrap();
    prepare(cell, table, &ReduceOptions::default()).unwrap()
}

fn advice(fit: &Fit, count: u64) -> NextPosture {
    let search = rounds(count);
    next_posture(fit, &search, Control::default()).unwrap()
}

fn radians(advice: &NextPosture) -> Vec<f64> {
    advice.angles.clone()
}

/// Relative standard errors as the table of estimates has them.
fn standard_errors(fit: &Fit) -> Vec<f64> {
    let joints = fit.identification().unwrap().estimates.joints.iter();
    joints.map(|j| j.standard_error.unwrap() / j.stiffness.unwrap()).collect()
}

#[test]
fn now_is_what_the_table_of_estimates_says() {
    let cell = default_cell();
    for estimator in Estimator::ALL {
        let options = by(estimator);
        let measured = measured(&cell, group1(), &with_states(ForceRecord::Load), 4);
        let fit = Fit::new(&cell, measured, &options).unwrap();
        let advice = advice(&fit, 1);
        for (now, standard_error) in advice.before.iter().zip(standard_errors(&fit)) {
            let now = now.unwrap();
            assert!((now / standard_error - 1.0).abs() < 1e-9, "{estimator:?}: {now} {standard_error}");
        }
        assert_eq!(advice.displacements, 3 * cell.setup.tool.point_count());
    }
}

#[test]
fn with_it_is_what_a_fit_with_that_posture_has() {
    // The size of the noise is known, so that it is the same in both fits.
    let options = with(|o: &mut IdentifyOptions| {
        o.estimator = Estimator::Weighted;
        o.noise = NoiseSource::Known;
    });
    for (force, pushes) in [(ForceRecord::Load, false), (ForceRecord::Force, false), (ForceRecord::Force, true)] {
        let mut cell = default_cell();
        cell.noise.posture_common_std = 3e-5;
        if pushes {
            *rope_force(&mut cell) *= -1.0;
        }
        let done = with_states(force);
        let fit = Fit::new(&cell, measured(&cell, group1(), &done, 4), &options).unwrap();
        let advice = advice(&fit, 2);
        if let Some(assumed) = &advice.assumed_load {
            let anchor = Vector3::from(assumed.anchor_m.unwrap());
            assert!((anchor - *rope_anchor(&mut cell)).norm() < 1e-3);
            assert_eq!(assumed.pushes, pushes);
        }
        let mut q = group1();
        q.push(radians(&advice));
        let more = Fit::new(&cell, measured(&cell, q, &done, 4), &options).unwrap();
        let joints = fit.identification().unwrap().estimates.joints.iter();
        let then = more.identification().unwrap().estimates.joints.iter();
        for ((joint, then), with_it) in joints.zip(then).zip(&advice.after) {
            let error = then.compliance_standard_error.unwrap() * joint.stiffness.unwrap();
            let with_it = with_it.unwrap();
            assert!((with_it / error - 1.0).abs() < 1e-6, "{with_it} {error}");
        }
    }
}

#[test]
fn no_random_posture_measured_alike_is_better() {
    let cell = default_cell();
    let options = with(|o: &mut IdentifyOptions| {
        o.estimator = Estimator::Weighted;
        o.noise = NoiseSource::Known;
    });
    let done = with_states(ForceRecord::Load);
    let fit = Fit::new(&cell, measured(&cell, group1(), &done, 4), &options).unwrap();
    let best = advice(&fit, 3);
    let k: Vec<f64> = fit.identification().unwrap().estimates.stiffness().unwrap();
    for i in 0..20 {
        let mut q = group1();
        q.extend(random_group(&cell, StartKind::Uniform, 1, 8, i).unwrap());
        let more = Fit::new(&cell, measured(&cell, q, &done, 4), &options).unwrap();
        let joints = more.identification().unwrap().estimates.joints.iter();
        let squares = joints.zip(&k).map(|(j, k)| (j.compliance_standard_error.unwrap() * k).powi(2));
        let error = (squares.sum::<f64>() / 6.0).sqrt();
        assert!(best.expected_error <= error, "random posture {i}");
    }
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn one_more_posture_never_makes_an_error_larger(
        seed in 0u64..1000,
        count in 4usize..8,
        kind in 0usize..6,
        loads in 1usize..4,
        forces in any::<bool>(),
    ) {
        let cell = reference_cell();
        let q = random_group(&cell, StartKind::Uniform, count, seed, 0).unwrap();
        let force = if forces { ForceRecord::ForceAndMoment } else { ForceRecord::Load };
        let mut done = with_states(force);
        done.states.truncate(1 + loads);
        let options = with(|o: &mut IdentifyOptions| o.estimator = Estimator::ALL[kind]);
        let fit = Fit::new(&cell, measured(&cell, q, &done, seed), &options).unwrap();
        let advice = advice(&fit, 1);
        for (before, after) in advice.before.iter().zip(&advice.after) {
            let after = after.unwrap();
            prop_assert!(before.is_none_or(|b| after <= b * (1.0 + 1e-9)), "{advice:?}");
        }
    }
}

#[test]
fn displacements_alone_are_one_state_of_the_cells_load() {
    // Table 4 of the paper: one displacement per point, no readings behind it.
    let cell = reference_cell();
    let done = Experiment::default();
    let postures: Vec<Posture> = numbered(group1());
    let truth = cell.prior.clone().unwrap();
    let table = experiment(&cell, &postures, &truth, &done, 2, 0).unwrap();
    let plain = reduced(&cell, &table).measured;
    let fit = Fit::new(&cell, plain, &IdentifyOptions::default()).unwrap();
    let advice = advice(&fit, 1);
    assert_eq!(advice.displacements, cell.setup.tool.point_count());
    assert_eq!(advice.measured_as, postures[postures.len() / 2].name);
}
