//! Wrong signs, soft fixtures, friction and wrong input at a clamped arm are named.

use super::*;
use crate::common::cases::{refusals, sentences};

#[test]
fn both_signs_of_the_sensor_give_the_same_and_a_wrong_one_is_named() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap().to_vec();
    let clamped = exact(&cell, 2, 4, 2);
    let pose =
        Isometry3::from_parts(Translation3::new(0.02, -0.01, 0.08), UnitQuaternion::from_euler_angles(0.3, -0.8, 1.9));
    let mut first = Vec::new();
    for reports_by_robot in [false, true] {
        let sensor = Sensor { mount: Mount::Flange, pose, reports_by_robot, mirrored: None };
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
                ClampedPosture { wrench, ..c.clone() }
            };
            clamped.iter().map(read).collect()
        };
        assert_close(&stiffness(&cell, &through(&sensor)), &truth, 1e-9, "sensor");
        let wrong = Sensor { reports_by_robot: !reports_by_robot, mirrored: None, ..sensor.clone() };
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
        assert!(result.estimates.joints.iter().all(|j| j.verdict == Verdict::SignOrModelFault));
        first.push(result.findings[0].clone());
    }
    insta::assert_snapshot!(sentences(&first), @"
    [wrench-sign] measurements: The compliance of 6 of 6 joints comes out negative: a sign or model fault. The wrench seems to be that of the robot on the fixture, and the one of the fixture on the robot is needed. Check which way the sensor counts (sensor.reports of the cell), and that the angles are loaded minus reference.
    [wrench-sign] measurements: The compliance of 6 of 6 joints comes out negative: a sign or model fault. The wrench seems to be that of the robot on the fixture, and the one of the fixture on the robot is needed. Check which way the sensor counts (sensor.reports of the cell), and that the angles are loaded minus reference.
    ");
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
    assert_close(&stiffness(&cell, &data), truth, 1e-9, "with the fixture's motion");
}

/// The same move of the motors in two states.
fn alike(states: [&str; 2], motor: &[f64]) -> Vec<MotorMove> {
    let state = |state: &str| MotorMove { state: state.to_string(), motor: motor.to_vec() };
    states.map(state).to_vec()
}

#[test]
fn loads_up_and_down_show_the_friction() {
    for elastic in [false, true] {
        let cell = Dice::new(91).model(6, 0, elastic, false).cell();
        let robot = &cell.setup.robot;
        let truth = cell.require_prior().unwrap();
        let mut dice = Dice::new(92);
        let postures = postures(&cell, &mut dice, 5);
        let motor = moves(&cell, &mut dice, 1, 400.0).remove(0).motor;
        let moves = alike(["up-400", "down-400"], &motor);
        let mut data = simulated(&cell, &postures, moves, 0.0, 1);
        // Friction of 12 N·m in spring 2 turns the motors by ±12/k further.
        let mixing = robot.spring_mixing().cloned().unwrap_or_else(|| DMatrix::identity(6, 6));
        let give = robot.coupling().clone().try_inverse().unwrap() * mixing;
        for c in &mut data {
            let sign = if c.state.starts_with("up") { 1.0 } else { -1.0 };
            for (i, q) in c.motor.iter_mut().enumerate() {
                *q += sign * give[(i, 1)] * 12.0 / truth[1];
            }
        }
        let result = identify_clamped(&cell, &data, None, &IdentifyOptions::default()).unwrap();
        // Up and down cancel in the estimate.
        assert_close(&result.estimates.stiffness().unwrap(), truth, 1e-7, "up and down");
        for (j, friction) in result.friction.iter().enumerate() {
            let expected = if j == 1 { 12.0 } else { 0.0 };
            assert_eq!(friction.pairs, 5);
            assert!((friction.torque_nm.unwrap() - expected).abs() < 1e-4, "{friction:?}");
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
    let moves = alike(["up", "down"], &motor);
    let mut data = simulated(&cell, &postures, moves, 1e-7, 1);
    for c in &mut data {
        c.motor[3] += if c.state == "up" { 40.0 } else { -40.0 } / truth[3];
    }
    let result = identify_clamped(&cell, &data, Some(1e-7), &IdentifyOptions::default()).unwrap();
    let sentences: Vec<&str> = result.findings.iter().map(|f| f.sentence.as_str()).collect();
    insta::assert_snapshot!("friction_and_errors", sentences.join("\n"));
}

#[test]
fn wrong_input_is_refused() {
    let cell = reference_cell();
    let data = exact(&cell, 3, 2, 1);
    let plain = IdentifyOptions::default();
    let of = |data: &[ClampedPosture]| identify_clamped(&cell, data, None, &plain);
    let spoiled = |change: fn(&mut ClampedPosture)| of(&changed(data.clone(), |d| change(&mut d[1])));
    let with = |change: fn(&mut IdentifyOptions)| identify_clamped(&cell, &data, None, &changed(plain.clone(), change));
    let rows = [
        ("no posture", Code::TooFewData, of(&[])),
        ("a motor that is no number", Code::NotFinite, spoiled(|c| c.motor[2] = f64::NAN)),
        ("an endless moment", Code::NotFinite, spoiled(|c| c.wrench.moment.y = f64::INFINITY)),
        (
            "a fixture's motion that is no number",
            Code::NotFinite,
            spoiled(|c| c.fixture_motion = Some(Vector6::repeat(f64::NAN))),
        ),
        ("five motors of six", Code::Dimension, spoiled(|c| c.motor.truncate(5))),
        ("known noise that nobody states", Code::MissingKey, with(|o| o.noise = NoiseSource::Known)),
        (
            "repeats beside weights",
            Code::Conflict,
            with(|o| (o.noise, o.estimator) = (NoiseSource::Repeats, Estimator::Weighted)),
        ),
        ("weights of a tracker", Code::Conflict, with(|o| o.weights = Weights::Tracker)),
        ("a term twice", Code::Duplicate, with(|o| o.extra = vec![ExtraTerm::BaseTilt, ExtraTerm::BaseTilt])),
        ("a seventh joint", Code::UnknownName, with(|o| o.extra = vec![ExtraTerm::JointTilt(6)])),
        ("noise of zero", Code::InvalidValue, identify_clamped(&cell, &data, Some(0.0), &plain)),
    ];
    insta::assert_snapshot!("clamped_refusals", refusals(rows));
}
