//! What a newcomer meets first (loads that pass a joint by, too few postures or points, numbers that are none) is
//! answered or refused by name.

use crate::common::prelude::*;
use std::collections::BTreeSet;
use stiffarm::estimate::validate::Model as Deflection;
use stiffarm::plan::characteristic_length::characteristic_length;
use stiffarm::plan::index::{GroupEvaluation, error_bound};

/// Exact simulated measurements of the reference cell.
fn exact_measurements(cell: &Cell, postures: &[Vec<f64>]) -> Vec<MeasuredPosture> {
    let mut quiet = cell.clone();
    quiet.noise.reading_variance = 0.0;
    let truth = cell.require_prior().unwrap();
    simulate_measurements(&quiet, &numbered(postures.to_vec()), truth, Deflection::Linear, 1, 0).unwrap()
}

fn assert_only_classical(evaluation: &GroupEvaluation) {
    for index in Index::ALL {
        let is_there = evaluation.indices.get(index).is_some();
        assert_eq!(is_there, index == Index::Classical, "{index:?}");
    }
}

/// Asserts that every way to a result names `joints` and shows nothing for them.
fn assert_undetermined(cell: &Cell, postures: &[Vec<f64>], joints: &[&str]) {
    let evaluation = evaluate(cell, "blind", postures).unwrap();
    assert_eq!(evaluation.undetermined_joints, joints);
    assert_only_classical(&evaluation);
    let blind = |name: &String| joints.contains(&name.as_str());
    let names = cell.setup.robot.spring_names();
    for (j, name) in names.iter().enumerate() {
        assert_eq!(evaluation.relative_standard_error[j].is_none(), blind(name), "{name}");
        assert_eq!(evaluation.expected_deviation[j].is_none(), blind(name), "{name}");
    }
    let expected: Vec<f64> = evaluation.expected_deviation.iter().flatten().copied().collect();
    let measured = exact_measurements(cell, postures);
    let estimates = identify(cell, measured, &IdentifyOptions::default());
    let estimates = estimates.unwrap().estimates;
    assert_eq!(estimates.undetermined_joints, joints);
    assert!(!estimates.is_complete() && estimates.stiffness().is_none());
    assert_eq!((estimates.condition, estimates.scaled_condition), (None, None));
    for (joint, truth) in estimates.joints.iter().zip(cell.require_prior().unwrap()) {
        if blind(&joint.name) {
            assert_eq!(joint.verdict, Verdict::Undetermined);
            assert!(joint.stiffness.is_none() && joint.compliance.is_none());
            assert_eq!(joint.standard_error, None);
            assert_eq!(joint.interval, [None, None]);
        } else {
            let ratio = joint.stiffness.unwrap() / truth;
            assert!((ratio - 1.0).abs() < 1e-9, "{}", joint.name);
        }
    }
    let group = PostureGroup::from_angles("blind", postures.iter().cloned());
    let options = SimulationOptions::default();
    // The others are simulated, and the finding says which are not.
    let simulated = simulate(cell, &[group], &options, Control::default()).unwrap();
    let named: Vec<&str> = simulated.findings.iter().map(|f| f.subject.as_str()).collect();
    assert_eq!(named, joints);
    assert!(!simulated.joints.iter().any(blind));
    let levels = &simulated.groups[0].levels;
    let nominal = levels.iter().find(|level| level.variance_factor == 1.0);
    assert!(relative_error(&nominal.unwrap().expected_deviation, &expected) < 1e-9);
}

/// Every number in a JSON text.
fn all_numbers(value: &serde_json::Value, out: &mut Vec<f64>) {
    match value {
        serde_json::Value::Number(number) => out.push(number.as_f64().unwrap()),
        serde_json::Value::Array(items) => items.iter().for_each(|v| all_numbers(v, out)),
        serde_json::Value::Object(items) => items.values().for_each(|v| all_numbers(v, out)),
        _ => {}
    }
}

#[test]
fn load_through_the_axis_of_joint_6_leaves_joint_6_undetermined() {
    let mut cell = reference_cell();
    cell.setup.tool.loading_point = Vector3::new(0.0, 0.0, 0.25);
    assert_undetermined(&cell, &group1(), &["joint 6"]);
    // No choice of postures helps.
    let mut report = String::new();
    for index in [Index::ExpectedError, Index::Novel] {
        let error = local(&cell, index, &group1()).unwrap_err();
        assert_eq!(error.code(), Code::NotIdentifiable, "{index:?}: {error}");
        report += &format!("{index:?}: {error}\n");
    }
    insta::assert_snapshot!(report, @"
    ExpectedError: 6 postures with this load cannot determine joint 6.
      hint: add postures that differ, or measuring points, or move the load off the joint's axis
    Novel: 6 postures with this load cannot determine joint 6.
      hint: add postures that differ, or measuring points, or move the load off the joint's axis
    ");
}

#[test]
fn vertical_load_on_a_floor_mounted_robot_leaves_joint_1_undetermined() {
    let mut cell = reference_cell();
    cell.setup.load = hanging(500.0);
    assert_undetermined(&cell, &group1(), &["joint 1"]);
    // On the wall it works.
    cell.setup.load = Load::Weight { magnitude: 500.0, direction: Vector3::x() };
    assert!(evaluate(&cell, "wall", &group1()).unwrap().undetermined_joints.is_empty());
}

#[test]
fn equal_postures_with_one_point_name_what_they_cannot_tell() {
    let mut cell = reference_cell();
    cell.setup.tool.measuring_points.truncate(1);
    let postures = vec![group1()[0].clone(); 6];
    let evaluation = evaluate(&cell, "equal", &postures).unwrap();
    let undetermined_joints = &evaluation.undetermined_joints;
    assert!(undetermined_joints.len() >= 3, "{undetermined_joints:?}");
    assert_only_classical(&evaluation);
    let measured = exact_measurements(&cell, &postures);
    let result = identify(&cell, &measured, &IdentifyOptions::default()).unwrap();
    assert_eq!(result.estimates.undetermined_joints, evaluation.undetermined_joints);
    assert_eq!(result.estimates.degrees_of_freedom, 18 - 3);
    // Rounding must not pose as information anywhere in what is shown.
    for json in [serde_json::to_value(&evaluation).unwrap(), serde_json::to_value(&result).unwrap()] {
        let mut numbers = Vec::new();
        all_numbers(&json, &mut numbers);
        assert!(numbers.len() > 6);
        assert!(numbers.iter().all(|v| v.is_finite() && v.abs() < 1e9), "{numbers:?}");
    }
}

#[test]
fn one_posture_with_one_point_is_answered() {
    let mut cell = reference_cell();
    cell.setup.tool.measuring_points.truncate(1);
    let one = group1()[..1].to_vec();
    let evaluation = evaluate(&cell, "one", &one).unwrap();
    assert!(!evaluation.undetermined_joints.is_empty());
    assert!(evaluation.indices.classical.is_some() && evaluation.indices.condition.is_none());
    let result = identify(&cell, exact_measurements(&cell, &one), &IdentifyOptions::default()).unwrap();
    assert_eq!((result.estimates.rows, result.estimates.degrees_of_freedom, result.residual_std_m), (3, 0, None));
    assert_eq!(result.estimates.undetermined_joints, evaluation.undetermined_joints);
    let error = local(&cell, Index::D, &one).unwrap_err();
    assert_eq!(error.code(), Code::NotIdentifiable);
    // The classical index asks nothing of Ψ.
    let classical = local(&cell, Index::Classical, &one).unwrap();
    assert!((classical.value - 1.2157).abs() < 1e-4);
    // A robot of one joint, too.
    let mut dice = Dice::new(1);
    let mut model = dice.model(3, 0, false, false);
    model.rows.truncate(1);
    model.tasks.clear();
    model.prior.truncate(1);
    model.measuring_points.truncate(1);
    model.coupling = DMatrix::identity(1, 1);
    let evaluation = evaluate(&model.cell(), "one joint", &[vec![0.4]]).unwrap();
    assert!(evaluation.undetermined_joints.is_empty());
    assert!((evaluation.indices.condition.unwrap() - 1.0).abs() < 1e-12);
}

#[test]
fn angles_and_numbers_that_are_not_finite_are_errors() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap().to_vec();
    let options = IdentifyOptions::default();
    let identified =
        |measured: &[MeasuredPosture], options: &IdentifyOptions| identify(&cell, measured, options).unwrap_err();
    let exact = exact_measurements(&cell, &group1());
    let control = Control::default();
    let mut messages = BTreeSet::new();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut postures = group1();
        postures[2][4] = bad;
        let mut refused = |error: Error| {
            assert_eq!(error.code(), Code::NotFinite, "{error}");
            messages.insert(format!("{error}\n"));
        };
        refused(evaluate(&cell, "", &postures).unwrap_err());
        refused(observation_matrix(&cell.setup, &postures, Rows::Translations).unwrap_err());
        refused(PostureTerms::new(&cell.setup, &postures[2], None).unwrap_err());
        refused(local(&cell, Index::Classical, &postures).unwrap_err());
        let deflected = equilibrium(&cell.setup, &postures[2], &truth, None);
        refused(deflected.map(|_| ()).unwrap_err());
        let group = PostureGroup::from_angles("", postures.clone());
        refused(simulate(&cell, &[group], &Default::default(), control).unwrap_err());
        let named = numbered(postures);
        let exactly = Deflection::Equilibrium;
        refused(simulate_measurements(&cell, &named, &truth, exactly, 1, 0).unwrap_err());
        let mut measured = exact.clone();
        measured[2].posture.q[4] = bad;
        refused(identified(&measured, &options));

        let mut measured = exact.clone();
        measured[0].displacements[0].value.y = bad;
        assert_eq!(identified(&measured, &options).code(), Code::NotFinite);
        measured[0].displacements[0].value.y = 0.0;
        measured[0].wrench = Some(Wrench::force(Vector3::new(bad, 0.0, 0.0)));
        assert_eq!(identified(&measured, &options).code(), Code::NotFinite);

        let stiffness = [1e6, 1e6, bad, 1e6, 1e6, 1e6];
        let error = joint_compliance(&cell.setup.robot, &stiffness).unwrap_err();
        assert_eq!(error.code(), Code::InvalidValue);
        assert!(error_bound(bad, 0.0, 0.0).is_err() && error_bound(2.0, bad, 0.0).is_err());
    }
    insta::assert_snapshot!(messages.into_iter().collect::<String>(), @"The angle of joint 5 is not a finite number.");
    // Eq. (19) says where it bounds nothing; no condition number is below one.
    let lost = error_bound(100.0, 1e-3, 0.0).unwrap();
    assert!(lost.bound.is_none() && (lost.validity - 10.0).abs() < 1e-12);
    assert!(error_bound(0.5, 0.0, 0.0).is_err());
    let error = evaluate(&cell, "", &[vec![0.0; 5]]).unwrap_err();
    assert_eq!(error.code(), Code::Dimension);
    let error = evaluate::<Vec<f64>>(&cell, "", &[]).unwrap_err();
    assert_eq!(error.code(), Code::TooFewData);
    assert_eq!(identified(&[], &options).code(), Code::TooFewData);
    for confidence in [0.0, 1.0, f64::NAN] {
        let options = with(|o: &mut IdentifyOptions| o.confidence = confidence);
        assert_eq!(identified(&exact, &options).code(), Code::InvalidValue);
    }
}

#[test]
fn a_load_that_buckles_the_arm_is_said_so() {
    let mut cell = reference_cell();
    cell.setup.load = hanging(5e7);
    let truth = cell.require_prior().unwrap().to_vec();
    let error = equilibrium(&cell.setup, &group1()[0], &truth, None).map(|_| ()).unwrap_err();
    assert_eq!(error.code(), Code::InvalidValue);
    insta::assert_snapshot!(error, @"
    The loaded arm has no stable equilibrium near this posture.
      hint: check the load's magnitude and the unit of the joint stiffness (N·m/rad)
    ");
}

#[test]
fn short_chains_have_no_condition_number_and_say_so() {
    let mut dice = Dice::new(5);
    let model = dice.model(5, 0, false, false);
    let cell = model.cell();
    let postures = dice.postures(5, 6);
    let evaluation = evaluate(&cell, "", &postures).unwrap();
    assert!(evaluation.k_jn.iter().all(Option::is_none));
    assert_eq!((evaluation.indices.classical, evaluation.indices.novel, evaluation.indices.scaled), (None, None, None));
    assert!(evaluation.indices.condition.is_some() && evaluation.indices.expected_error.is_some());
    for index in [Index::Classical, Index::Novel, Index::Scaled] {
        let error = IndexFunction::new(&cell, index, 6).map(|_| ()).unwrap_err();
        assert_eq!(error.code(), Code::Unsupported);
    }
    assert_eq!(characteristic_length(&cell).unwrap_err().code(), Code::Unsupported);
}

#[test]
fn the_displacement_of_a_rigid_body_is_one_twist() {
    // What the linear model says of two points of the tool differs by rotation × arm.
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    for q in group1() {
        let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
        let at =
            |p: &Vector3<f64>| -> Vector6<f64> { linear_displacement(&cell.setup, &terms, p, truth, None).unwrap() };
        let [a, b] = [0, 2].map(|i| terms.measuring_points()[i]);
        let (first, second) = (at(&a), at(&b));
        let turn = first.fixed_rows::<3>(3).into_owned();
        assert!((second.fixed_rows::<3>(3) - turn).amax() < 1e-15);
        let arm = turn.cross(&(b - a));
        assert!((second.fixed_rows::<3>(0) - first.fixed_rows::<3>(0) - arm).amax() < 1e-15);
    }
}

/// A rope whose anchor lies on the loading point has no direction: refused with the
/// key, not taken for a load of 0 N.
#[test]
fn a_rope_of_no_length_is_refused() {
    let mut cell = reference_cell();
    let postures = group1();
    let terms = PostureTerms::new(&cell.setup, &postures[0], None).unwrap();
    let Load::Rope { magnitude, .. } = cell.setup.load else {
        panic!("the reference cell has a rope");
    };
    let anchor = *terms.loading_point();
    cell.setup.load = Load::Rope { anchor, magnitude };
    let error = evaluate(&cell, "", &postures).unwrap_err();
    assert_eq!(error.code(), Code::InvalidValue);
    assert_eq!(error.place().key.as_deref(), Some("load.anchor_mm"));
    // The other postures have a rope, and a force that is given needs none.
    PostureTerms::new(&cell.setup, &postures[1], None).unwrap();
    let force = Wrench::force([0.0, 0.0, 100.0]);
    PostureTerms::new(&cell.setup, &postures[0], Some(&force)).unwrap();
}
