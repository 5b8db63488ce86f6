//! Estimators on measured displacements weigh what is correlated, name gross errors, and answer nothing that the data
//! leave open.

use super::*;
use crate::common::cases::refusals;
use stiffarm::estimate::identify::Identification;

/// Exact displacements of the reference cell under fractions of its load, plus
/// errors of size `sigma`, all against one unloaded reading.
fn measured(cell: &Cell, loads: &[f64], sigma: f64, dice: &mut Dice) -> Vec<MeasuredPosture> {
    let prior = cell.require_prior().unwrap();
    let compliance = compliance_of(prior);
    let mut out = Vec::new();
    for posture in numbered(random_group()) {
        let force = PostureTerms::new(&cell.setup, &posture.q, None).unwrap();
        for load in loads {
            let wrench = Wrench::force(force.wrench().force * *load);
            let terms = PostureTerms::new(&cell.setup, &posture.q, Some(&wrench)).unwrap();
            let exact = terms.block(&cell.setup.robot) * &compliance;
            let points = 0..cell.setup.tool.point_count();
            let displacements = points.map(|a| {
                let error = dice.vector(sigma * 3f64.sqrt());
                Displacement::new(a, exact.fixed_rows::<3>(3 * a) + error)
            });
            out.push(MeasuredPosture {
                state: format!("load {load}"),
                wrench: Some(wrench),
                ..MeasuredPosture::new(posture.clone(), displacements.collect())
            });
        }
    }
    out
}

#[test]
fn displacements_against_one_reading_correlate_by_a_half() {
    let cell = honest_cell();
    let mut measured = measured(&cell, &[0.5, 1.0], 1e-5, &mut Dice::new(1));
    let system =
        |measured: &[MeasuredPosture], cell: &Cell| measured_system(cell, measured, &[], Weights::Readings).unwrap();
    let shared = system(&measured, &cell);
    assert_eq!(shared.blocks.len(), 6);
    for block in &shared.blocks {
        let covariance = block.covariance.to_matrix(24);
        let expected = DMatrix::from_fn(24, 24, |i, j| match (i == j, i % 12 == j % 12) {
            (true, _) => 1.0,
            (false, true) => 0.5,
            _ => 0.0,
        });
        assert_eq!(covariance, expected);
    }
    // As the paper counts, the reference has no error of its own.
    assert!(system(&measured, &reference_cell()).blocks.iter().all(|b| b.covariance.is_identity()));
    // Each state against its own unloaded reading.
    for posture in measured.iter_mut().filter(|m| m.state == "load 1") {
        for displacement in &mut posture.displacements {
            displacement.reference = vec![ReferencePart::reading(1)];
        }
    }
    assert!(system(&measured, &cell).blocks.iter().all(|b| b.covariance.is_identity()));
    // Four loaded readings against two unloaded ones.
    let few = &mut measured[0].displacements[0];
    (few.readings, few.reference[0].readings) = (4, 2);
    let few = system(&measured, &cell);
    let covariance = few.blocks[0].covariance.to_matrix(24);
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
    let options = with(|o: &mut IdentifyOptions| {
        o.estimator = Estimator::Weighted;
        o.weights = Weights::Tracker;
    });
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
    for (j, joint) in ours.estimates.joints.iter().enumerate() {
        let error = (covariance[(j, j)] * s2).sqrt();
        assert!((joint.compliance.unwrap() - values[j]).abs() < 1e-8 * error);
        assert!((joint.compliance_standard_error.unwrap() / error - 1.0).abs() < 1e-9);
    }
    // Without the tracker's covariance there is nothing to weigh by.
    measured[0].displacements[0].covariance = None;
    let error = identify(&cell, &measured, &options).unwrap_err();
    assert_eq!(error.code(), Code::MissingKey);
}

#[test]
fn the_robust_fit_ignores_a_gross_error_and_names_it() {
    let cell = reference_cell();
    let clean = measured(&cell, &[1.0], 1e-5, &mut Dice::new(3));
    let mut spoiled = clean.clone();
    spoiled[2].displacements[1].value += Vector3::new(0.3, -0.2, 1.0);
    let with = |measured: &[MeasuredPosture], estimator| {
        let options = by(estimator);
        identify(&cell, measured, &options).unwrap()
    };
    let reference = with(&clean, Estimator::Huber);
    let robust = with(&spoiled, Estimator::Huber);
    let plain = with(&spoiled, Estimator::Ordinary);
    for j in 0..6 {
        let shift = |identification: &Identification| {
            let [ours, other] = [identification, &reference].map(|f| &f.estimates.joints[j]);
            let moved = ours.compliance.unwrap() - other.compliance.unwrap();
            moved.abs() / other.compliance_standard_error.unwrap()
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
    let options = by(Estimator::NonNegative);
    let identification = identify(&cell, &measured, &options).unwrap();
    assert_eq!(identification.estimates.undetermined_joints, ["joint 6"]);
    let blind = &identification.estimates.joints[5];
    assert_eq!(blind.verdict, Verdict::Undetermined);
    assert_eq!(blind.interval, [None, None]);
    assert!(!blind.determined && blind.compliance.is_none());
    assert!(identification.estimates.joints[..5].iter().all(|j| j.determined));
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
            system.delta =
                &system.psi * &truth + DVector::from_fn(system.delta.len(), |_, _| noise * dice.between(-1.0, 1.0));
            let solution = solve(&system, &assume(Estimator::Ordinary, Scale::Estimated));
            let covariance = solution.covariance.as_ref().unwrap();
            // The columns without a twin are known either way.
            for j in [1, 2] {
                assert!(!solution.undetermined.contains(&j));
                let error = covariance[(j, j)].sqrt();
                assert!((solution.values[j] - truth[j]).abs() < 6.0 * error, "1e-{exponent}");
                assert!(error < 0.1 * truth[j]);
            }
            if solution.undetermined.is_empty() {
                answered += 1;
                for j in [0, 3] {
                    let error = covariance[(j, j)].sqrt();
                    assert!(
                        (solution.values[j] - truth[j]).abs() < 6.0 * error,
                        "1e-{exponent}: {} instead of {} ± {error}",
                        solution.values[j],
                        truth[j]
                    );
                    // What the data can say falls with the distance of the columns.
                    assert!(error > 0.5 * noise / apart * truth[j], "1e-{exponent}: {error}");
                }
            } else {
                named += 1;
                assert_eq!(solution.undetermined, [0, 3], "1e-{exponent}");
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
    let options = by(Estimator::Ordinary);
    let fit = Fit::new(&cell, &many, &options).unwrap();
    let resampled = bootstrap(&fit, 800, 1, 0.95).unwrap();
    let formula = identify(&cell, &many, &options).unwrap();
    assert_eq!((resampled.postures, resampled.skipped), (72, 0));
    assert_eq!(resampled.degrees_of_freedom, 3 * 72 - 6);
    for (a, b) in resampled.joints.iter().zip(&formula.estimates.joints) {
        assert_eq!(a.compliance, b.compliance);
        let ratio = a.compliance_standard_error.unwrap() / b.compliance_standard_error.unwrap();
        assert!((0.7..1.4).contains(&ratio), "{}: {ratio}", a.name);
        let [low, high] = a.interval.map(Option::unwrap);
        assert!(low < a.stiffness.unwrap() && a.stiffness.unwrap() < high);
    }
    // The same seed, the same numbers; another, others.
    assert_eq!(resampled, bootstrap(&fit, 800, 1, 0.95).unwrap());
    let other = bootstrap(&fit, 800, 2, 0.95).unwrap();
    assert_ne!(resampled.joints, other.joints);
}

#[test]
fn a_bootstrap_skips_resamples_that_lose_a_joint() {
    // One point: a resample of three postures needs all of them or nearly so.
    let mut cell = honest_cell();
    cell.setup.tool.measuring_points.truncate(1);
    let measured = measured(&cell, &[1.0], 1e-6, &mut Dice::new(4));
    let options = with(|o: &mut IdentifyOptions| {
        o.estimator = Estimator::Ordinary;
        o.noise = NoiseSource::Known;
    });
    // A resample with one posture only, 1 in 1296 of six … and 1 in 3 of two.
    let two = Fit::new(&cell, &measured[..2], &options).unwrap();
    let resampled = bootstrap(&two, 600, 1, 0.95).unwrap();
    let share = resampled.skipped as f64 / 600.0;
    assert!((share - 0.5).abs() < 0.1, "{share}");
    let of = |measured: &[MeasuredPosture], resamples, confidence| {
        let fit = Fit::new(&cell, measured, &options).unwrap();
        bootstrap(&fit, resamples, 1, confidence)
    };
    let rows = [
        ("one posture", Code::TooFewData, of(&measured[..1], 600, 0.95)),
        ("no confidence", Code::InvalidValue, of(&measured, 600, 0.0)),
        ("certainty", Code::InvalidValue, of(&measured, 600, 1.0)),
        ("a confidence that is no number", Code::InvalidValue, of(&measured, 600, f64::NAN)),
        ("too few resamples", Code::InvalidValue, of(&measured, 199, 0.95)),
    ];
    insta::assert_snapshot!(refusals(rows), @"
    » one posture
    [too-few-data] Postures can only be resampled where there are at least two.

    » no confidence
    [invalid-value] The confidence must lie between 0.01 and 0.999999.

    » certainty
    [invalid-value] The confidence must lie between 0.01 and 0.999999.

    » a confidence that is no number
    [invalid-value] The confidence must lie between 0.01 and 0.999999.

    » too few resamples
    [invalid-value] Intervals of 95 % need from 200 to 1000000 resamples, not 199.
    ");
}
