//! What a newcomer meets first (loads that pass a joint by, too few postures or points, numbers that are none) is
//! answered or refused by name.

use crate::common::cases::refusals;
use crate::common::prelude::*;
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
    let rows = [("expected error", Index::ExpectedError), ("novel", Index::Novel)]
        .map(|(what, index)| (what, Code::NotIdentifiable, local(&cell, index, &group1())));
    insta::assert_snapshot!(refusals(rows), @"
    » expected error
    [not-identifiable] 6 postures with this load cannot determine joint 6.
      hint: add postures that differ, or measuring points, or move the load off the joint's axis

    » novel
    [not-identifiable] 6 postures with this load cannot determine joint 6.
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
fn an_angle_that_is_not_finite_is_refused_by_all_that_take_it() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let exact = exact_measurements(&cell, &group1());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let postures = changed(group1(), |postures| postures[2][4] = bad);
        let q = &postures[2];
        let group = PostureGroup::from_angles("", postures.clone());
        let named = numbered(postures.clone());
        let measured = changed(exact.clone(), |measured| measured[2].posture.q[4] = bad);
        let rows: [(&str, stiffarm::Result<()>); 8] = [
            ("evaluate", evaluate(&cell, "", &postures).map(drop)),
            ("observation_matrix", observation_matrix(&cell.setup, &postures, Rows::Translations).map(drop)),
            ("PostureTerms", PostureTerms::new(&cell.setup, q, None).map(drop)),
            ("select_from", local(&cell, Index::Classical, &postures).map(drop)),
            ("equilibrium", equilibrium(&cell.setup, q, truth, None).map(drop)),
            ("simulate", simulate(&cell, &[group], &Default::default(), Control::default()).map(drop)),
            (
                "simulate_measurements",
                simulate_measurements(&cell, &named, truth, Deflection::Equilibrium, 1, 0).map(drop),
            ),
            ("identify", identify(&cell, &measured, &IdentifyOptions::default()).map(drop)),
        ];
        for (what, refused) in rows {
            let error = refused.unwrap_err();
            assert_eq!(error.code(), Code::NotFinite, "{what}, {bad}");
            assert_eq!(error.message(), "The angle of joint 5 is not a finite number.", "{what}, {bad}");
        }
    }
}

#[test]
fn numbers_that_are_none_or_do_not_fit_are_refused() {
    let cell = reference_cell();
    let exact = exact_measurements(&cell, &group1());
    let options = IdentifyOptions::default();
    let identified = |measured: &[MeasuredPosture]| identify(&cell, measured, &options).map(drop);
    let sure = |confidence| {
        let options = with(|o: &mut IdentifyOptions| o.confidence = confidence);
        identify(&cell, &exact, &options).map(drop)
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let moved = changed(exact.clone(), |m| m[0].displacements[0].value.y = bad);
        let pulled = changed(exact.clone(), |m| m[0].wrench = Some(Wrench::force(Vector3::new(bad, 0.0, 0.0))));
        for measured in [moved, pulled] {
            assert_eq!(identified(&measured).unwrap_err().code(), Code::NotFinite, "{bad}");
        }
        let stiffness = [1e6, 1e6, bad, 1e6, 1e6, 1e6];
        let error = joint_compliance(&cell.setup.robot, &stiffness).unwrap_err();
        assert_eq!(error.code(), Code::InvalidValue, "{bad}");
        assert!(error_bound(bad, 0.0, 0.0).is_err() && error_bound(2.0, bad, 0.0).is_err());
    }
    // Eq. (19) says where it bounds nothing; no condition number is below one.
    let lost = error_bound(100.0, 1e-3, 0.0).unwrap();
    assert!(lost.bound.is_none() && (lost.validity - 10.0).abs() < 1e-12);
    assert!(error_bound(0.5, 0.0, 0.0).is_err());
    let rows = [
        ("five angles of six", Code::Dimension, evaluate(&cell, "", &[vec![0.0; 5]]).map(drop)),
        ("no posture", Code::TooFewData, evaluate::<Vec<f64>>(&cell, "", &[]).map(drop)),
        ("nothing measured", Code::TooFewData, identified(&[])),
        ("no confidence", Code::InvalidValue, sure(0.0)),
        ("certainty", Code::InvalidValue, sure(1.0)),
        ("a confidence that is no number", Code::InvalidValue, sure(f64::NAN)),
    ];
    insta::assert_snapshot!(refusals(rows), @r#"
    » five angles of six
    [dimension] 5 angles for the 6 joints of COMAU NJ 165-3.0.

    » no posture
    [too-few-data] The group "" has no postures.

    » nothing measured
    [too-few-data] There are no displacements to identify from.

    » no confidence
    [invalid-value] The confidence must lie between 0.01 and 0.999999.

    » certainty
    [invalid-value] The confidence must lie between 0.01 and 0.999999.

    » a confidence that is no number
    [invalid-value] The confidence must lie between 0.01 and 0.999999.
    "#);
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
    let function = |index| IndexFunction::new(&cell, index, 6).map(drop);
    let rows = [
        ("classical", Code::Unsupported, function(Index::Classical)),
        ("novel", Code::Unsupported, function(Index::Novel)),
        ("scaled", Code::Unsupported, function(Index::Scaled)),
        ("characteristic length", Code::Unsupported, characteristic_length(&cell).map(drop)),
    ];
    insta::assert_snapshot!(refusals(rows), @"
    » classical
    [unsupported] k(J_N) needs at least 6 joints, and random has 5.
      hint: choose an index without dexterity: expected_error, scaled_condition, d

    » novel
    [unsupported] k(J_N) needs at least 6 joints, and random has 5.
      hint: choose an index without dexterity: expected_error, scaled_condition, d

    » scaled
    [unsupported] k(J_N) needs at least 6 joints, and random has 5.
      hint: choose an index without dexterity: expected_error, scaled_condition, d

    » characteristic length
    [unsupported] k(J_N) needs at least 6 joints, and random has 5.
    ");
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
