//! Clamped end-effector: the same stiffness as with a free one.

use crate::common;

use common::random::Dice;
use common::{cases, reference_cell};
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix6, Translation3, UnitQuaternion, Vector3, Vector6,
};
use proptest::prelude::*;
use statrs::distribution::{Binomial, DiscreteCDF};
use stiffarm::Code;
use stiffarm::estimate::clamped::{
    ClampedPosture, ClampedSimulation, MotorMove, clamped_system, identify_clamped,
    simulate_clamped,
};
use stiffarm::estimate::compliance::IdentifiedCompliance;
use stiffarm::estimate::identify::{
    Estimator, IdentifyOptions, NoiseSource, Verdict, Weights, identify,
};
use stiffarm::estimate::validate::{Model, simulate_measurements, validate_with};
use stiffarm::files::table::{read_clamped, write_clamped};
use stiffarm::model::cell::Cell;
use stiffarm::model::instruments::{Mount, Sensor};
use stiffarm::model::kinematics::Frames;
use stiffarm::model::load::{Load, Wrench};
use stiffarm::model::observation::{ExtraTerm, PostureTerms};
use stiffarm::model::posture::Posture;
use stiffarm::model::robot::{DhConvention, DhRow, Robot};
use stiffarm::model::stiffness::{displacement_between, linear_displacement};

const FALSE_ALARM: f64 = 1e-6;

/// A seven-joint Panda with Franka's rows, loaded at the flange.
fn panda() -> Cell {
    let rows = [
        [0.0, 0.0, 0.333],
        [-std::f64::consts::FRAC_PI_2, 0.0, 0.0],
        [std::f64::consts::FRAC_PI_2, 0.0, 0.316],
        [std::f64::consts::FRAC_PI_2, 0.0825, 0.0],
        [-std::f64::consts::FRAC_PI_2, -0.0825, 0.384],
        [std::f64::consts::FRAC_PI_2, 0.0, 0.0],
        [std::f64::consts::FRAC_PI_2, 0.088, 0.107],
    ]
    .map(|[alpha, a, d]| DhRow {
        alpha,
        a,
        d,
        offset: 0.0,
    });
    let base = Isometry3::identity();
    let mut cell = reference_cell();
    cell.setup.robot = Robot::from_dh("Panda", DhConvention::Modified, &rows, base).unwrap();
    cell.prior = Some(vec![1.4e4, 2e4, 1.2e4, 1.1e4, 9e3, 8e3, 7e3]);
    cell
}

/// Postures whose Jacobian at the clamp is far from singular, so that exact
/// data keep their digits.
fn postures(cell: &Cell, dice: &mut Dice, count: usize) -> Vec<Posture> {
    let robot = &cell.setup.robot;
    let n = robot.joint_count();
    let mut out = Vec::new();
    while out.len() < count {
        let q = dice.posture(n);
        let frames = Frames::new(robot, &q);
        let jacobian = frames.jacobian(&frames.point(&cell.setup.tool.loading_point));
        let dense = DMatrix::from_iterator(6, n, jacobian.iter().copied());
        let gram = match n {
            n if n < 6 => dense.transpose() * &dense,
            _ => &dense * dense.transpose(),
        };
        let eigen = gram.symmetric_eigenvalues();
        if eigen.min() > 3e-3 * eigen.max() {
            let name = (out.len() + 1).to_string();
            out.push(Posture { name, q });
        }
    }
    out
}

/// Moves that put about `torque` N·m on each joint.
fn moves(cell: &Cell, dice: &mut Dice, count: usize, torque: f64) -> Vec<MotorMove> {
    let prior = cell.require_prior().unwrap();
    (0..count)
        .map(|i| MotorMove {
            state: format!("loaded-{}", i + 1),
            motor: prior
                .iter()
                .map(|k| dice.signed(0.5, 1.0) * torque / k)
                .collect(),
        })
        .collect()
}

fn exact(cell: &Cell, seed: u64, count: usize, states: usize) -> Vec<ClampedPosture> {
    let mut dice = Dice::new(seed);
    let postures = postures(cell, &mut dice, count);
    let simulation = ClampedSimulation {
        moves: moves(cell, &mut dice, states, 300.0),
        ..ClampedSimulation::default()
    };
    let truth = cell.require_prior().unwrap();
    simulate_clamped(cell, &postures, truth, &simulation, 1, 0).unwrap()
}

fn stiffness(cell: &Cell, clamped: &[ClampedPosture]) -> Vec<f64> {
    let result = identify_clamped(cell, clamped, None, &IdentifyOptions::default()).unwrap();
    result.estimates.stiffness().unwrap()
}

fn assert_close(found: &[f64], truth: &[f64], tolerance: f64, what: &str) {
    for (k, t) in found.iter().zip(truth) {
        assert!(
            (k / t - 1.0).abs() < tolerance,
            "{what}: {found:?}, not {truth:?}"
        );
    }
}

fn free_end(cell: &Cell, seed: u64) -> Vec<f64> {
    let mut cell = cell.clone();
    cell.noise.reading_variance = 0.0;
    cell.noise.posture_common_std = 0.0;
    let postures = postures(&cell, &mut Dice::new(seed), 12);
    let truth = cell.require_prior().unwrap();
    let measured = simulate_measurements(&cell, &postures, truth, Model::Linear, 1, 0).unwrap();
    let result = identify(&cell, &measured, &IdentifyOptions::default()).unwrap();
    result.stiffness().unwrap()
}

#[test]
fn clamped_and_free_end_data_give_the_same_stiffness() {
    // The coupled COMAU and a redundant arm.
    for (cell, what) in [(reference_cell(), "COMAU"), (panda(), "Panda")] {
        let truth = cell.require_prior().unwrap();
        let clamped = stiffness(&cell, &exact(&cell, 5, 4, 2));
        assert_close(&clamped, truth, 1e-9, what);
        assert_close(&clamped, &free_end(&cell, 6), 1e-9, what);
    }
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn random_arms_give_the_same_stiffness(n in 3..=8usize, elastic in any::<bool>(), seed in any::<u64>()) {
        let cell = Dice::new(seed).model(n, 0, elastic, false).cell();
        let truth = cell.require_prior().unwrap();
        let clamped = exact(&cell, seed, 6, 2);
        assert_close(&stiffness(&cell, &clamped), truth, 1e-7, "clamped");
        let system = clamped_system(&cell, &clamped, &[]).unwrap();
        prop_assert_eq!(system.psi.nrows(), clamped.len() * n.min(6));
    }

    #[test]
    fn for_six_joints_it_decouples(seed in any::<u64>()) {
        // C Δq_m = −K_θ⁻¹ Γ, joint by joint.
        let cell = Dice::new(seed).model(6, 0, false, false).cell();
        let truth = cell.require_prior().unwrap();
        for clamped in exact(&cell, seed, 2, 2) {
            let terms = PostureTerms::new(&cell.setup, &clamped.posture.q, Some(&clamped.wrench)).unwrap();
            let turned = cell.setup.robot.coupling() * DVector::from_column_slice(&clamped.motor);
            for (j, torque) in terms.torque().iter().enumerate() {
                let error = (turned[j] + torque / truth[j]).abs();
                prop_assert!(error < 1e-9 * turned.amax(), "joint {}: {error}", j + 1);
            }
        }
    }
}

#[test]
fn the_simulated_flange_stays_where_it_is() {
    // Forward kinematics of the moved motors, and the free end's deflection under
    // the fixture's wrench, cancel: other code than that of the clamped rows.
    for cell in [reference_cell(), panda()] {
        let truth = cell.require_prior().unwrap();
        let mut dice = Dice::new(8);
        let postures = postures(&cell, &mut dice, 3);
        let simulation = ClampedSimulation {
            // Small, so that the second order does not show.
            moves: moves(&cell, &mut dice, 2, 1e-3),
            ..ClampedSimulation::default()
        };
        for c in simulate_clamped(&cell, &postures, truth, &simulation, 1, 0).unwrap() {
            let robot = &cell.setup.robot;
            let moved: Vec<f64> = c
                .posture
                .q
                .iter()
                .zip(&c.motor)
                .map(|(q, d)| q + d)
                .collect();
            let (before, after) = (Frames::new(robot, &c.posture.q), Frames::new(robot, &moved));
            let point = &cell.setup.tool.loading_point;
            let by_motors = displacement_between(&before, &after, point);
            let terms = PostureTerms::new(&cell.setup, &c.posture.q, Some(&c.wrench)).unwrap();
            let by_springs =
                linear_displacement(&cell.setup, &terms, terms.loading_point(), truth, None)
                    .unwrap();
            let gap = (by_motors + by_springs).norm();
            assert!(
                gap < 1e-5 * by_motors.norm(),
                "{gap:e} of {:e}",
                by_motors.norm()
            );
        }
    }
}

#[test]
fn both_signs_of_the_sensor_give_the_same_and_a_wrong_one_is_named() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap().to_vec();
    let clamped = exact(&cell, 2, 4, 2);
    let pose = Isometry3::from_parts(
        Translation3::new(0.02, -0.01, 0.08),
        UnitQuaternion::from_euler_angles(0.3, -0.8, 1.9),
    );
    for reports_by_robot in [false, true] {
        let sensor = Sensor {
            mount: Mount::Flange,
            pose,
            reports_by_robot,
        };
        let through = |assumed: &Sensor| -> Vec<ClampedPosture> {
            let read = |c: &ClampedPosture| {
                let frames = Frames::new(&cell.setup.robot, &c.posture.q);
                let clamp = frames.point(&cell.setup.tool.loading_point);
                // What the real sensor shows: turned back, about its own origin.
                let at = frames.flange() * sensor.pose;
                let moved = c.wrench.moved(&clamp, &at.translation.vector);
                let sign = if reports_by_robot { -1.0 } else { 1.0 };
                let reading = Wrench {
                    force: at.rotation.inverse() * moved.force * sign,
                    moment: at.rotation.inverse() * moved.moment * sign,
                };
                let wrench = assumed.wrench_on_robot(&frames, &reading, &clamp);
                ClampedPosture {
                    wrench,
                    ..c.clone()
                }
            };
            clamped.iter().map(read).collect()
        };
        assert_close(&stiffness(&cell, &through(&sensor)), &truth, 1e-9, "sensor");
        let wrong = Sensor {
            reports_by_robot: !reports_by_robot,
            ..sensor.clone()
        };
        let noisy = {
            let mut data = through(&wrong);
            let mut dice = Dice::new(3);
            for c in &mut data {
                for q in &mut c.motor {
                    *q += dice.between(-1e-6, 1e-6);
                }
            }
            data
        };
        let result = identify_clamped(&cell, &noisy, None, &IdentifyOptions::default()).unwrap();
        assert!(
            result
                .estimates
                .joints
                .iter()
                .all(|j| j.verdict == Verdict::SignOrModelFault)
        );
        let finding = &result.findings[0];
        assert_eq!(finding.code, "wrench-sign");
        assert!(
            finding.sentence.contains("sign or model fault"),
            "{}",
            finding.sentence
        );
    }
}

#[test]
fn intervals_cover_as_often_as_they_say() {
    const RUNS: usize = 3000;
    let binomial = Binomial::new(0.95, RUNS as u64).unwrap();
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
        let largest = simulation.moves[0]
            .motor
            .iter()
            .fold(0.0_f64, |m, q| m.max(q.abs()));
        simulation.angle_std = 0.01 * largest;
        for noise in [NoiseSource::Estimated, NoiseSource::Known] {
            let options = IdentifyOptions {
                noise,
                ..IdentifyOptions::default()
            };
            let mut covered = vec![0; n];
            for run in 0..RUNS {
                let data = simulate_clamped(&cell, &postures, truth, &simulation, 9, run).unwrap();
                let result =
                    identify_clamped(&cell, &data, Some(simulation.angle_std), &options).unwrap();
                assert!(result.estimates.independent_rows);
                for (j, joint) in result.estimates.joints.iter().enumerate() {
                    let [low, high] = joint.interval;
                    let above = low.is_some_and(|low| low <= truth[j]);
                    covered[j] += u64::from(above && high.is_none_or(|high| truth[j] <= high));
                }
            }
            println!("{what}, {noise:?}: {covered:?} of {RUNS}");
            let tail = 0.5 * FALSE_ALARM / (4 * n) as f64;
            let (least, most) = (binomial.inverse_cdf(tail), binomial.inverse_cdf(1.0 - tail));
            assert!(
                covered.iter().all(|c| (least..=most).contains(c)),
                "{what} {noise:?}: {covered:?}"
            );
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
fn a_soft_fixture_is_mistaken_for_soft_joints_unless_its_motion_is_known() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let mut dice = Dice::new(21);
    let postures = postures(&cell, &mut dice, 6);
    let diagonal = Vector6::new(1e-8, 1e-8, 1e-8, 1e-7, 1e-7, 1e-7);
    let mut simulation = ClampedSimulation {
        moves: moves(&cell, &mut dice, 2, 300.0),
        fixture_compliance: Matrix6::from_diagonal(&diagonal),
        ..ClampedSimulation::default()
    };
    let data = simulate_clamped(&cell, &postures, truth, &simulation, 1, 0).unwrap();
    let biased = stiffness(&cell, &data);
    let ratios: Vec<f64> = biased.iter().zip(truth).map(|(k, t)| k / t).collect();
    println!("with a soft fixture: {ratios:.3?} of the truth");
    assert!(ratios.iter().any(|r| (r - 1.0).abs() > 0.02), "{ratios:?}");
    simulation.records_fixture_motion = true;
    let data = simulate_clamped(&cell, &postures, truth, &simulation, 1, 0).unwrap();
    assert_close(
        &stiffness(&cell, &data),
        truth,
        1e-9,
        "with the fixture's motion",
    );
}

#[test]
fn a_posture_at_a_singularity_gives_what_the_flange_holds() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap().to_vec();
    let mut postures = postures(&cell, &mut Dice::new(31), 3);
    // Axes 4 and 6 in line.
    postures[1].q = [10.0, 5.0, -95.0, 20.0, 0.0, 30.0_f64]
        .map(f64::to_radians)
        .to_vec();
    let simulation = ClampedSimulation {
        moves: moves(&cell, &mut Dice::new(32), 2, 300.0),
        ..ClampedSimulation::default()
    };
    let data = simulate_clamped(&cell, &postures, &truth, &simulation, 1, 0).unwrap();
    let result = identify_clamped(&cell, &data, None, &IdentifyOptions::default()).unwrap();
    assert_eq!(result.estimates.rows, 2 * (6 + 5 + 6));
    assert_close(
        &result.estimates.stiffness().unwrap(),
        &truth,
        1e-9,
        "singular",
    );
    let finding = result
        .findings
        .iter()
        .find(|f| f.code == "near-singular")
        .unwrap();
    assert_eq!(finding.subject, "2");
    // Alone it separates neither joint 4 nor joint 6 … but tells what it can.
    let alone: Vec<ClampedPosture> = data.into_iter().filter(|c| c.posture.name == "2").collect();
    let result = identify_clamped(&cell, &alone, None, &IdentifyOptions::default()).unwrap();
    assert_eq!(result.estimates.rows, 10);
}

#[test]
fn what_moves_along_the_null_space_says_nothing() {
    let cell = panda();
    let mut data = exact(&cell, 41, 4, 2);
    let before = stiffness(&cell, &data);
    for c in &mut data {
        let frames = Frames::new(&cell.setup.robot, &c.posture.q);
        let jacobian = frames.jacobian(&frames.point(&cell.setup.tool.loading_point));
        // The null vector of J: the eigenvector of JᵀJ with the smallest eigenvalue.
        let gram = jacobian.transpose() * &jacobian;
        let eigen =
            nalgebra::SymmetricEigen::new(DMatrix::from_iterator(7, 7, gram.iter().copied()));
        let null = eigen
            .eigenvectors
            .column(eigen.eigenvalues.imin())
            .into_owned();
        for (q, v) in c.motor.iter_mut().zip(null.iter()) {
            *q += 1e-2 * v;
        }
    }
    assert_close(&stiffness(&cell, &data), &before, 1e-6, "null space");
}

#[test]
fn a_tilting_joint_and_lost_motion_are_further_terms() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let n = truth.len();
    for (term, size) in [
        (ExtraTerm::JointTilt(2), 3e-7),
        (ExtraTerm::BaseTilt, 2e-8),
        (ExtraTerm::LostMotion(1), 2e-5),
    ] {
        let mut data = exact(&cell, 51, 6, 2);
        for c in &mut data {
            let terms = PostureTerms::new(&cell.setup, &c.posture.q, Some(&c.wrench)).unwrap();
            let jacobian =
                terms.frames().jacobian(terms.loading_point()) * cell.setup.robot.coupling();
            let square = DMatrix::from_iterator(6, n, jacobian.iter().copied());
            let twist = term.twist(&terms, terms.loading_point()) * size;
            // The motors have to make up for the term as well.
            let more = square
                .lu()
                .solve(&DVector::from_iterator(6, twist.iter().copied()))
                .unwrap();
            for (q, m) in c.motor.iter_mut().zip(more.iter()) {
                *q -= m;
            }
        }
        let options = IdentifyOptions {
            extra: vec![term],
            ..IdentifyOptions::default()
        };
        let result = identify_clamped(&cell, &data, None, &options).unwrap();
        assert_close(
            &result.estimates.stiffness().unwrap(),
            truth,
            1e-8,
            "with the term",
        );
        let found = match term.is_spring() {
            true => result.estimates.extra_springs[0].compliance,
            false => result.estimates.lost_motion[0].angle,
        };
        assert!(
            (found.unwrap() / size - 1.0).abs() < 1e-6,
            "{term:?}: {found:?}"
        );
        let without = stiffness(&cell, &data);
        assert!(
            without
                .iter()
                .zip(truth)
                .any(|(k, t)| (k / t - 1.0).abs() > 1e-3)
        );
    }
}

#[test]
fn a_known_series_compliance_is_not_the_joints() {
    let plain = reference_cell();
    let truth = plain.require_prior().unwrap();
    let mut cell = plain.clone();
    cell.setup.tool.series_compliance = Some(
        stiffarm::model::tool::SeriesCompliance::from_stiffness(
            Vector3::new(0.0, 0.0, 0.05),
            [1e8, 1e8, 2e8],
            [3e5, 3e5, 4e5],
        )
        .unwrap(),
    );
    let mut data = exact(&plain, 61, 4, 2);
    for c in &mut data {
        let terms = PostureTerms::new(&cell.setup, &c.posture.q, Some(&c.wrench)).unwrap();
        // Beyond the compliance the clamp stays; the flange moves against it.
        c.fixture_motion = Some(terms.known_twist(&cell.setup.tool, terms.loading_point()));
    }
    assert_close(&stiffness(&cell, &data), truth, 1e-9, "series compliance");
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
    let expected = information
        .lu()
        .solve(&(system.psi.transpose() * precision * &system.delta))
        .unwrap();
    let options = IdentifyOptions {
        estimator: Estimator::Weighted,
        ..IdentifyOptions::default()
    };
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
    let simulation = ClampedSimulation {
        moves: moves(&cell, &mut dice, 3, 300.0),
        angle_std: 2e-6,
        ..ClampedSimulation::default()
    };
    let postures = postures(&cell, &mut dice, 8);
    let mut data = simulate_clamped(&cell, &postures, truth, &simulation, 2, 0).unwrap();
    for q in &mut data[4].motor {
        *q *= 3.0;
    }
    let error = |estimator| {
        let options = IdentifyOptions {
            estimator,
            ..IdentifyOptions::default()
        };
        let result = identify_clamped(&cell, &data, None, &options).unwrap();
        let found = result.estimates.stiffness().unwrap();
        let worst = found
            .iter()
            .zip(truth)
            .map(|(k, t)| (k / t - 1.0).abs())
            .fold(0.0, f64::max);
        (worst, result)
    };
    let (ordinary, _) = error(Estimator::Ordinary);
    let (robust, result) = error(Estimator::Huber);
    assert!(robust < 0.2 * ordinary, "{robust} and {ordinary}");
    assert_eq!(
        (
            result.weights[0].posture.as_str(),
            result.weights[0].state.as_str()
        ),
        ("2", "loaded-2")
    );
    assert!(result.weights[0].weight < 0.05 && result.weights[1].weight > 0.2);
}

#[test]
fn loads_up_and_down_show_the_friction() {
    for elastic in [false, true] {
        let cell = Dice::new(91).model(6, 0, elastic, false).cell();
        let robot = &cell.setup.robot;
        let truth = cell.require_prior().unwrap();
        let mut dice = Dice::new(92);
        let postures = postures(&cell, &mut dice, 5);
        let up = moves(&cell, &mut dice, 1, 400.0).remove(0).motor;
        let simulation = ClampedSimulation {
            moves: ["up-400", "down-400"]
                .map(|state| MotorMove {
                    state: state.to_string(),
                    motor: up.clone(),
                })
                .to_vec(),
            ..ClampedSimulation::default()
        };
        let mut data = simulate_clamped(&cell, &postures, truth, &simulation, 1, 0).unwrap();
        // Friction of 12 N·m in spring 2 turns the motors by ±12/k further.
        let mixing = robot
            .spring_mixing()
            .cloned()
            .unwrap_or_else(|| DMatrix::identity(6, 6));
        let give = robot.coupling().clone().try_inverse().unwrap() * mixing;
        for c in &mut data {
            let sign = if c.state.starts_with("up") { 1.0 } else { -1.0 };
            for (i, q) in c.motor.iter_mut().enumerate() {
                *q += sign * give[(i, 1)] * 12.0 / truth[1];
            }
        }
        let result = identify_clamped(&cell, &data, None, &IdentifyOptions::default()).unwrap();
        // Up and down cancel in the estimate.
        assert_close(
            &result.estimates.stiffness().unwrap(),
            truth,
            1e-7,
            "up and down",
        );
        for (j, friction) in result.friction.iter().enumerate() {
            let expected = if j == 1 { 12.0 } else { 0.0 };
            assert_eq!(friction.pairs, 5);
            assert!(
                (friction.torque_nm.unwrap() - expected).abs() < 1e-4,
                "{friction:?}"
            );
        }
    }
}

#[test]
fn the_size_of_friction_is_said_with_its_joint() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let mut dice = Dice::new(95);
    let postures = postures(&cell, &mut dice, 4);
    let motor = moves(&cell, &mut dice, 1, 200.0).remove(0).motor;
    let simulation = ClampedSimulation {
        moves: ["up", "down"]
            .map(|state| MotorMove {
                state: state.to_string(),
                motor: motor.clone(),
            })
            .to_vec(),
        angle_std: 1e-7,
        ..ClampedSimulation::default()
    };
    let mut data = simulate_clamped(&cell, &postures, truth, &simulation, 1, 0).unwrap();
    for c in &mut data {
        c.motor[3] += if c.state == "up" { 40.0 } else { -40.0 } / truth[3];
    }
    let result = identify_clamped(&cell, &data, Some(1e-7), &IdentifyOptions::default()).unwrap();
    let sentences: Vec<&str> = result
        .findings
        .iter()
        .map(|f| f.sentence.as_str())
        .collect();
    insta::assert_snapshot!("friction_and_errors", sentences.join("\n"));
}

#[test]
fn wrong_input_is_refused() {
    let cell = reference_cell();
    let data = exact(&cell, 3, 2, 1);
    let refusal = |data: &[ClampedPosture], options: IdentifyOptions| {
        let error = identify_clamped(&cell, data, None, &options).unwrap_err();
        (error.code(), error.to_string())
    };
    let plain = IdentifyOptions::default;
    assert_eq!(refusal(&[], plain()).0, Code::TooFewData);
    let with = |change: fn(&mut ClampedPosture)| {
        let mut data = data.clone();
        change(&mut data[1]);
        data
    };
    assert_eq!(
        refusal(&with(|c| c.motor[2] = f64::NAN), plain()).0,
        Code::NotFinite
    );
    assert_eq!(
        refusal(&with(|c| c.wrench.moment.y = f64::INFINITY), plain()).0,
        Code::NotFinite
    );
    let motion = with(|c| c.fixture_motion = Some(Vector6::repeat(f64::NAN)));
    assert_eq!(refusal(&motion, plain()).0, Code::NotFinite);
    assert_eq!(
        refusal(&with(|c| c.motor.truncate(5)), plain()).0,
        Code::Dimension
    );
    let noise = |noise| IdentifyOptions { noise, ..plain() };
    assert_eq!(
        refusal(&data, noise(NoiseSource::Known)).0,
        Code::MissingKey
    );
    assert_eq!(
        refusal(
            &data,
            IdentifyOptions {
                estimator: Estimator::Weighted,
                ..noise(NoiseSource::Repeats)
            }
        )
        .0,
        Code::Conflict
    );
    assert_eq!(
        refusal(
            &data,
            IdentifyOptions {
                weights: Weights::Tracker,
                ..plain()
            }
        )
        .0,
        Code::Conflict
    );
    let extra = |extra| IdentifyOptions { extra, ..plain() };
    assert_eq!(
        refusal(&data, extra(vec![ExtraTerm::BaseTilt, ExtraTerm::BaseTilt])).0,
        Code::Duplicate
    );
    assert_eq!(
        refusal(&data, extra(vec![ExtraTerm::JointTilt(6)])).0,
        Code::UnknownName
    );
    let error = identify_clamped(&cell, &data, Some(0.0), &plain()).unwrap_err();
    assert_eq!(error.code(), Code::InvalidValue);
}

#[test]
fn the_load_of_the_cell_plays_no_part() {
    // The wrench comes with each state; a measured load needs no other.
    let mut cell = reference_cell();
    let data = exact(&cell, 3, 3, 2);
    let before = stiffness(&cell, &data);
    cell.setup.load = Load::Measured;
    assert_eq!(stiffness(&cell, &data), before);
}

fn from_table(cell: &Cell, text: &str) -> Vec<ClampedPosture> {
    read_clamped(text.as_bytes(), "clamped.csv", cell, None).unwrap()
}

#[test]
fn a_written_table_is_read_again() {
    let cell = reference_cell();
    let mut data = exact(&cell, 3, 2, 2);
    let text = write_clamped(&data, &cell.setup.robot);
    let again = from_table(&cell, &text);
    assert_eq!(write_clamped(&again, &cell.setup.robot), text);
    assert_close(
        &stiffness(&cell, &again),
        &stiffness(&cell, &data),
        1e-9,
        "read again",
    );
    data[1].fixture_motion = Some(Vector6::new(1e-5, -2e-5, 3e-6, 1e-4, 0.0, -2e-4));
    let text = write_clamped(&data, &cell.setup.robot);
    let again = from_table(&cell, &text);
    assert_eq!(write_clamped(&again, &cell.setup.robot), text);
    let motion = again[1].fixture_motion.unwrap();
    assert!((motion - data[1].fixture_motion.unwrap()).amax() < 1e-15);
}

#[test]
fn states_are_taken_against_their_reference() {
    let mut cell = reference_cell();
    let pose = Isometry3::translation(0.0, 0.0, 0.1);
    cell.sensor = Some(Sensor {
        mount: Mount::Flange,
        pose,
        reports_by_robot: true,
    });
    let text = "posture;state;q1_deg;q2_deg;q3_deg;q4_deg;q5_deg;q6_deg;fx_n;fy_n;fz_n;mx_nm;my_nm;mz_nm\n\
                A;unloaded;10;0;-90;10;50;20;1;2;3;4;5;6\n\
                A;up;10,01;0;-90;10;50;20;101;2;3;4;5;6\n\
                B;unloaded;20;0;-90;10;50;20;;;;;;\n\
                B;unloaded-2;20,002;0;-90;10;50;20;;;;;;\n\
                B;up;20;0,1;-90;10;50;20;0;0;7;0;0;0\n";
    let read = from_table(&cell, text);
    assert_eq!(read.len(), 2);
    let a = &read[0];
    assert!((a.motor[0] - 0.01_f64.to_radians()).abs() < 1e-15);
    assert_eq!(
        (a.reference, a.posture.q[0]),
        (Some(0), 10.0_f64.to_radians())
    );
    // 100 N along the flange's x, by the robot: turned, with its sign, moved to the clamp.
    let frames = Frames::new(&cell.setup.robot, &a.posture.q);
    let force = frames.direction(&Vector3::new(-100.0, 0.0, 0.0));
    assert!((a.wrench.force - force).norm() < 1e-9);
    let arm = frames.direction(&(Vector3::new(0.0, 0.0, 0.1) - cell.setup.tool.loading_point));
    assert!((a.wrench.moment - arm.cross(&force)).norm() < 1e-9);
    let b = &read[1];
    assert!((b.posture.q[0] - 20.001_f64.to_radians()).abs() < 1e-15);
    assert!((b.motor[0] + 0.001_f64.to_radians()).abs() < 1e-15);
    assert!((b.wrench.force.norm() - 7.0).abs() < 1e-12);
}

#[test]
fn a_table_that_cannot_be_meant_is_refused_with_its_place() {
    let cell = reference_cell();
    let wrench = "fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm";
    let q = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg";
    let dq = "dq1_deg,dq2_deg,dq3_deg,dq4_deg,dq5_deg,dq6_deg";
    let cases = [
        format!("posture,state,{wrench},{q}\nA,up,1,2,3,4,5,6,10,0,-90,10,50,20\n"),
        format!("posture,state,{wrench},{q}\nA,unloaded,1,2,3,4,5,6,10,0,-90,10,50,20\n"),
        format!(
            "posture,state,{wrench},{q}\nA,unloaded,1,2,3,4,5,6,10,0,-90,10,50,20\nA,up,1,2,3,4,5,6,10,0,-90,10,50,26\n"
        ),
        format!(
            "posture,state,{wrench},{q}\nA,unloaded,1,2,3,4,5,6,10,0,-90,10,50,20\nA,up,,,,,,,10,0,-90,10,50,20\n"
        ),
        format!("posture,state,{wrench},{dq}\nA,up,1,2,3,4,5,6,0,0,0,0,0,0\n"),
        format!(
            "posture,state,{wrench},{dq},{q}\nA,unloaded,1,2,3,4,5,6,0,0,0,0,0,0,10,0,-90,10,50,20\n"
        ),
        format!("posture,state,fx_n,fy_n,fz_n,{q}\nA,up,1,2,3,10,0,-90,10,50,20\n"),
        format!("posture,state,{wrench},dq1_rad,{q}\nA,up,1,2,3,4,5,6,0,10,0,-90,10,50,20\n"),
        format!("posture,state,{wrench},dx_mm,{q}\nA,up,1,2,3,4,5,6,0,10,0,-90,10,50,20\n"),
        format!("posture,state,{wrench}\nA,up,1,2,3,4,5,6\n"),
    ];
    let mut said = String::new();
    for text in cases {
        let error = read_clamped(text.as_bytes(), "clamped.csv", &cell, None).unwrap_err();
        said += &format!("[{}] {error}\n", error.code().as_str());
    }
    insta::assert_snapshot!("refused_tables", said);
}

#[test]
fn a_clamped_identification_predicts_free_deflections() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let mut dice = Dice::new(14);
    let simulation = ClampedSimulation {
        moves: moves(&cell, &mut dice, 2, 300.0),
        angle_std: 1e-6,
        ..ClampedSimulation::default()
    };
    let postures = postures(&cell, &mut dice, 6);
    let data = simulate_clamped(&cell, &postures, truth, &simulation, 4, 0).unwrap();
    let fit = identify_clamped(&cell, &data, None, &IdentifyOptions::default()).unwrap();
    // Bands take the noise of the readings from the cell: the fit saw angles only.
    let predictor =
        IdentifiedCompliance::from_estimates(&cell, &fit.estimates, Default::default()).unwrap();
    let spread = predictor.spread.as_ref().unwrap();
    assert_eq!(spread.sigma, cell.noise.displacement_std());
    let measured = simulate_measurements(&cell, &postures, truth, Model::Linear, 8, 0).unwrap();
    let result = validate_with(&cell, &predictor, &measured, Model::Linear, None).unwrap();
    let band = result.band.unwrap();
    let share = band.inside as f64 / band.components as f64;
    assert!(share > 0.85, "{band:?}");
}

#[test]
fn every_estimator_takes_clamped_rows() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let mut dice = Dice::new(101);
    let simulation = ClampedSimulation {
        moves: moves(&cell, &mut dice, 2, 300.0),
        angle_std: 2e-6,
        ..ClampedSimulation::default()
    };
    let postures = postures(&cell, &mut dice, 6);
    let data = simulate_clamped(&cell, &postures, truth, &simulation, 6, 0).unwrap();
    for estimator in Estimator::ALL {
        let options = IdentifyOptions {
            estimator,
            ..IdentifyOptions::default()
        };
        let result = identify_clamped(&cell, &data, None, &options).unwrap();
        assert!(result.estimates.independent_rows);
        let found = result.estimates.stiffness().unwrap();
        assert_close(&found, truth, 0.05, estimator.as_str());
    }
}
