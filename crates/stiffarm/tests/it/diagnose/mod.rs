//! Diagnostics: each finding appears where its cause was planted, and rarely
//! otherwise.

mod alarms;
mod fanuc;
mod outliers;

use crate::common::cases::sentences;
use crate::common::prelude::*;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::collections::BTreeMap;
use stiffarm::estimate::diagnose::{
    Agreement, Diagnosis, OutlierKind, joint_signals, load_states, noise_test, outliers, second_order_shares, try_terms,
};

/// Twelve postures: Group 1 and the random group.
fn postures() -> Vec<Posture> {
    let angles = group1().into_iter().chain(common::random_group());
    numbered(angles)
}

fn truth(cell: &Cell) -> Vec<f64> {
    cell.prior.clone().unwrap()
}

fn measure(cell: &Cell, seed: u64) -> Vec<MeasuredPosture> {
    simulate_measurements(cell, &postures(), &truth(cell), Model::Linear, seed, 0).unwrap()
}

fn codes(diagnosis: &Diagnosis) -> Vec<&str> {
    diagnosis.findings.iter().map(|f| f.code.as_str()).collect()
}

/// The cell with an honest difference of two readings and a common part.
fn noisy_cell(common_part: f64) -> Cell {
    {
        let mut cell = default_cell();
        cell.noise.readings_per_displacement = 2;
        cell.noise.posture_common_std = common_part * cell.noise.displacement_std();
        cell
    }
}

/// Measurements in several load states: name and force \[N\] of each; every
/// posture and point has one unloaded reading that its states share. `extra`
/// adds to the exact displacement, from posture, terms of the state, and state.
fn in_states(
    cell: &Cell,
    states: &[(&str, f64)],
    seed: u64,
    extra: impl Fn(&PostureTerms, usize, Displacement) -> Vector3<f64>,
) -> Vec<MeasuredPosture> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let sigma = cell.noise.reading_variance.sqrt();
    let points = cell.setup.tool.point_count();
    let mut out = Vec::new();
    for posture in postures() {
        let mut draw = || {
            Vector3::from_fn(|_, _| {
                let z: f64 = StandardNormal.sample(&mut rng);
                sigma * z
            })
        };
        let unloaded: Vec<Vector3<f64>> = (0..points).map(|_| draw()).collect();
        for (s, (state, newton)) in states.iter().enumerate() {
            let mut loaded = cell.clone();
            *rope_force(&mut loaded) = *newton;
            let terms = PostureTerms::new(&loaded.setup, &posture.q, None).unwrap();
            let mut measured = MeasuredPosture {
                state: (*state).to_string(),
                wrench: Some(*terms.wrench()),
                ..MeasuredPosture::new(posture.clone(), Vec::new())
            };
            let exact = calculated_displacements(&loaded, &measured, &truth(cell), Model::Linear);
            for (point, value) in exact.unwrap().into_iter().enumerate() {
                let more = extra(&terms, s, Displacement::new(point, value));
                let value = value + more + draw() - unloaded[point];
                measured.displacements.push(Displacement::new(point, value));
            }
            out.push(measured);
        }
    }
    out
}

const UP: [(&str, f64); 3] = [("up-150", 150.0), ("up-300", 300.0), ("up-500", 500.0)];
const BOTH: [(&str, f64); 5] =
    [("up-150", 150.0), ("up-300", 300.0), ("up-500", 500.0), ("down-300", 300.0), ("down-150", 150.0)];

#[test]
fn lost_motion_loops_and_curvature_are_told_apart() {
    let cell = noisy_cell(0.0);
    let options = by(Estimator::TwoVariance);
    let states = |measured: &[MeasuredPosture]| {
        let noise = noise_test(&Fit::new(&cell, measured, &options).unwrap()).unwrap();
        Fit::new(&cell, measured, &options).and_then(|fit| load_states(&fit, noise.as_ref())).unwrap().unwrap()
    };
    let said = |measured: &[MeasuredPosture]| -> Vec<String> {
        states(measured).findings().into_iter().map(|f| f.code).collect()
    };
    for seed in 0..10 {
        for levels in [&UP[..], &BOTH[..]] {
            // Joint 2 gives way by 10 arc-seconds before it is loaded.
            let lost = in_states(&cell, levels, seed, |terms, _, d| {
                let column = ExtraTerm::LostMotion(1).column(terms);
                column.fixed_rows::<3>(3 * d.point) * 4.8e-5
            });
            assert_eq!(said(&lost), ["load-offset"], "seed {seed}");
            let offset = states(&lost).offset.unwrap();
            assert!(offset.value > 10.0 * offset.standard_error);
            // The arm gives 5 % more at the largest load than in proportion.
            let soft = in_states(&cell, levels, seed, |_, s, d| {
                let load = levels[s].1 / 500.0;
                d.value * (0.05 * load)
            });
            assert_eq!(said(&soft), ["load-curvature"], "seed {seed}");
            let bend = states(&soft).curvature.unwrap();
            assert!((bend.value - 0.05 / 1.05).abs() < 5.0 * bend.standard_error);
        }
        // Friction holds 4 % of the largest displacement on the way back.
        let held = in_states(&cell, &BOTH, seed, |_, s, d| match s {
            3 => d.value * (0.04 * 500.0 / 300.0),
            4 => d.value * (0.04 * 500.0 / 150.0),
            _ => Vector3::zeros(),
        });
        assert_eq!(said(&held), ["hysteresis"], "seed {seed}");
        let held_states = states(&held);
        let width = held_states.hysteresis.unwrap();
        let top: Vec<f64> = held_states.postures.iter().map(|p| p.displacements_m[2]).collect();
        let smallest = top.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = top.iter().copied().fold(0.0, f64::max);
        assert!(width.value > 0.04 * smallest && width.value < 0.04 * largest);
    }
}

#[test]
fn the_tilt_that_is_there_is_found() {
    let cell = noisy_cell(0.0);
    let options = by(Estimator::TwoVariance);
    let mut report = String::new();
    for (term, size) in [(ExtraTerm::JointTilt(2), 2e-7), (ExtraTerm::BaseTilt, 1e-7), (ExtraTerm::LostMotion(0), 5e-5)]
    {
        let mut measured = measure(&cell, 9);
        move_points(&cell, &mut measured, |terms| term.column(terms) * size);
        let tried = try_terms(&Fit::new(&cell, &measured, &options).unwrap()).unwrap();
        // On this robot joint 1 tilts at the foot of the base.
        assert_eq!(tried.trials.len(), 12);
        assert_eq!(tried.trials.iter().filter(|t| !t.same_as.is_empty()).count(), 1);
        let best = &tried.trials[0];
        assert_eq!(best.term, term, "{tried:?}");
        let (value, error) = (best.value.unwrap(), best.standard_error.unwrap());
        assert!((value - size).abs() < 5.0 * error, "{value} ± {error}");
        report += &format!("{}: {}\n", best.name, tried.finding().unwrap().sentence);
        // With it in the model nothing more is asked for.
        let mut with = options.clone();
        with.extra.push(term);
        let tried = try_terms(&Fit::new(&cell, &measured, &with).unwrap()).unwrap();
        assert!(tried.trials.len() <= 11 && !tried.axis_only);
        assert_eq!(tried.finding(), None);
    }
    insta::assert_snapshot!(report, @"
    tilt of joint 3: The tilt of joint 3 lowers the leave-one-out RMS by 80.4 %, from 0.078 mm to 0.015 mm. So the axis-only model is rejected.
    tilt of the base: The tilt of the base (or the tilt of joint 1, which acts alike here) lowers the leave-one-out RMS by 66.6 %, from 0.045 mm to 0.015 mm. So the axis-only model is rejected.
    lost motion of joint 1: The lost motion of joint 1 lowers the leave-one-out RMS by 52.5 %, from 0.032 mm to 0.015 mm. So the axis-only model is rejected.
    ");
}

#[test]
fn the_linear_model_is_judged_posture_by_posture() {
    let cell = default_cell();
    let measured = measure(&cell, 1);
    let shares = second_order_shares(&cell, &measured, &truth(&cell)).unwrap();
    assert_eq!(shares.len(), 12);
    // Below 4 µm at 500 N in Group 1.
    assert!(shares[..6].iter().all(|s| s.correction_m < 4e-6 && s.linearisation_m < 4e-6));
    assert!(shares.iter().all(|s| s.correction_m > 1e-8 && s.correction_share < 0.05));
    let mut heavy = cell.clone();
    *rope_force(&mut heavy) = 30_000.0;
    let diagnoses = [(&cell, measured), (&heavy, measure(&heavy, 1))]
        .map(|(cell, measured)| diagnose(&Fit::new(cell, &measured, &by(Estimator::Ordinary)).unwrap()).unwrap());
    insta::assert_snapshot!(sentences(diagnoses.iter().map(|d| the(&d.findings, "second-order"))), @"
    [second-order] model: K_C changes a displacement by at most 3.5 µm (0.13 %, posture 6), and the exact equilibrium differs from the linear model by at most 2.9 µm (0.09 %, posture 4): the linear model is enough.
    [second-order] model: K_C changes a displacement by at most 13.7 mm (8.57 %, posture 6), and the exact equilibrium differs from the linear model by at most 10.6 mm (5.59 %, posture 4): predict with the equilibrium there.
    ");
}

#[test]
fn a_joint_with_little_leverage_is_named_and_pairs_are() {
    // The rope pulls 3 mm from axis 6: joint 6 is barely loaded.
    let mut cell = noisy_cell(0.0);
    let height = cell.setup.tool.loading_point.z;
    cell.setup.tool.loading_point = Vector3::new(3e-3, 0.0, height);
    let measured = measure(&cell, 3);
    let signals = Fit::new(&cell, &measured, &by(Estimator::TwoVariance)).map(|fit| joint_signals(&fit)).unwrap();
    assert!(signals[5].torque_rms_nm < 2.0 && signals[1].torque_rms_nm > 100.0);
    assert!(signals[5].to_residual.unwrap() < 1.0 && signals[1].to_residual.unwrap() > 10.0);
    let diagnosis = diagnose(&Fit::new(&cell, &measured, &by(Estimator::TwoVariance)).unwrap()).unwrap();
    // The residuals are the noise itself: more of it averages out.
    let weak = |diagnosis: &Diagnosis| sentences(diagnosis.findings.iter().filter(|f| f.code == "weak-joint"));
    let noise_alone = weak(&diagnosis);
    // Errors far above the stated noise: the model limits the result.
    let mut dice = Dice::new(7);
    let mut limited = measured.clone();
    for displacement in limited.iter_mut().flat_map(|m| &mut m.displacements) {
        displacement.value += dice.vector(2e-4);
    }
    let diagnosis = diagnose(&Fit::new(&cell, &limited, &by(Estimator::TwoVariance)).unwrap()).unwrap();
    insta::assert_snapshot!(noise_alone + &weak(&diagnosis), @"
    [weak-joint] joint 6: The loads put 1 N·m RMS on joint 6 (53 to 685 on joint 1, joint 2, joint 3, joint 4 and joint 5). It moves the measuring points by 1.2 µm RMS, less than the residuals of 0.013 mm: it is barely determined (standard error 90.2 %). More leverage of the load about its axis would help most. The residuals are no more than noise, so more postures help too: four times as many halve the error.
    [weak-joint] joint 4: The loads put 53 N·m RMS on joint 4 (181 to 685 on joint 1, joint 2, joint 3 and joint 5). It moves the measuring points by 0.027 mm RMS, less than the residuals of 0.109 mm: it is barely determined (standard error 38.2 %). More leverage of the load about its axis would help, more postures of this kind would not much.
    [weak-joint] joint 6: The loads put 1 N·m RMS on joint 6 (53 to 685 on joint 1, joint 2, joint 3, joint 4 and joint 5). It moves the measuring points by 0.064 µm RMS, less than the residuals of 0.109 mm: it is barely determined (standard error 14544 %). More leverage of the load about its axis would help, more postures of this kind would not much.
    ");

    // Six times nearly the same posture: pairs of joints cannot be told apart.
    let cell = noisy_cell(0.0);
    let mut dice = Dice::new(1);
    let base = &group1()[0];
    let alike = (0..6).map(|_| base.iter().map(|a| a + dice.between(-0.01, 0.01)).collect());
    let group = numbered(alike);
    let measured = simulate_measurements(&cell, &group, &truth(&cell), Model::Linear, 1, 0).unwrap();
    let diagnosis = diagnose(&Fit::new(&cell, &measured, &by(Estimator::Ordinary)).unwrap()).unwrap();
    assert!(!diagnosis.correlated.is_empty() && codes(&diagnosis).contains(&"correlated"));
    assert!(diagnosis.correlated.iter().all(|p| p.correlation.abs() > 0.9));
}

/// Poor data are answered, not refused.
#[test]
fn diagnoses_of_poor_data() {
    let cell = noisy_cell(0.0);
    let all = measure(&cell, 1);
    for estimator in Estimator::ALL {
        for count in [1, 2, 3] {
            diagnose(&Fit::new(&cell, &all[..count], &by(estimator)).unwrap()).unwrap();
        }
    }
    let mut quiet = cell.clone();
    quiet.noise.reading_variance = 0.0;
    let exact = measure(&quiet, 1);
    let diagnosis = diagnose(&Fit::new(&quiet, &exact, &by(Estimator::TwoVariance)).unwrap()).unwrap();
    assert!(diagnosis.noise.is_none() && diagnosis.outliers.found.is_empty(), "{:?}", codes(&diagnosis));
    // One point only: nothing is shared, nothing can be told apart.
    let mut single = all.clone();
    for m in &mut single {
        m.displacements.truncate(1);
    }
    let diagnosis = diagnose(&Fit::new(&cell, &single, &by(Estimator::TwoVariance)).unwrap()).unwrap();
    assert!(diagnosis.outliers.found.is_empty());
    let json = serde_json::to_string(&diagnosis).unwrap();
    let back: Diagnosis = serde_json::from_str(&json).unwrap();
    assert_eq!(back.findings, diagnosis.findings);
}

#[test]
fn what_an_engineer_reads_cause_by_cause() {
    let cell = noisy_cell(0.0);
    let two = by(Estimator::TwoVariance);
    let mut out = String::new();
    let mut tell = |title: &str, cell: &Cell, measured: &[MeasuredPosture]| {
        out += &format!("» {title}\n");
        out += &(sentences(&diagnose(&Fit::new(cell, measured, &two).unwrap()).unwrap().findings) + "\n");
    };
    tell("as it should be", &cell, &measure(&cell, 2));
    let mut measured = measure(&cell, 2);
    measured[3].displacements[1].value.x += 1e-3;
    tell("one reading off by 1 mm", &cell, &measured);
    let mut measured = measure(&cell, 2);
    let tilted = |terms: &PostureTerms| ExtraTerm::JointTilt(2).column(terms) * 5e-7;
    move_points(&cell, &mut measured, tilted);
    tell("joint 3 tilts", &cell, &measured);
    let lost = in_states(&cell, &BOTH, 2, |terms, s, d| {
        let column = ExtraTerm::LostMotion(1).column(terms);
        let held = if s > 2 { 6e-5 } else { 3e-5 };
        column.fixed_rows::<3>(3 * d.point) * held
    });
    tell("lost motion and friction, five load states", &cell, &lost);
    insta::assert_snapshot!("sentences", out);
}
