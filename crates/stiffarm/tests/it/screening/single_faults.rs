//! One planted fault each: it is found, named and nothing else is said.

use super::*;

#[test]
fn two_points_exchanged_in_one_state() {
    // Neighbours, whose distances tell, and opposite points of the square, whose
    // distances do not; in a loaded and in an unloaded state.
    let mut said = Vec::new();
    for (at, a, b) in [
        ((1, 1), 0, 1),
        ((3, 0), 1, 2),
        ((2, 1), 0, 2),
        ((4, 0), 1, 3),
    ] {
        let mut table = group1_table(2);
        relabel(&mut table, Some(at), a, b);
        let (screening, found) = alone(&cell(), &table);
        assert_eq!(found.cause, Cause::ExchangedPoints);
        assert_eq!(found.postures, [(at.0 + 1).to_string()]);
        assert_eq!(found.states, [["unloaded", "loaded"][at.1]]);
        assert_eq!(found.points, [(a + 1).to_string(), (b + 1).to_string()]);
        said.push(sentences(&screening));
    }
    insta::assert_snapshot!("points_in_one_state", said.join("\n"));
}

#[test]
fn two_points_exchanged_throughout() {
    let mut said = Vec::new();
    for (a, b) in [(0, 1), (0, 2), (1, 3)] {
        let mut table = group1_table(3);
        relabel(&mut table, None, a, b);
        let (screening, found) = alone(&cell(), &table);
        assert_eq!(found.cause, Cause::ExchangedPoints);
        assert!(found.postures.is_empty());
        assert_eq!(found.points, [(a + 1).to_string(), (b + 1).to_string()]);
        said.push(sentences(&screening));
    }
    insta::assert_snapshot!("points_throughout", said.join("\n"));
}

#[test]
fn two_points_exchanged_in_all_states_of_a_posture() {
    let mut table = group1_table(3);
    relabel(&mut table, Some((2, 0)), 0, 2);
    relabel(&mut table, Some((2, 1)), 0, 2);
    let (screening, found) = alone(&cell(), &table);
    assert_eq!(found.cause, Cause::ExchangedPoints);
    assert!(found.postures == ["3"] && found.states.is_empty());
    assert_eq!(found.points, ["1", "3"]);
    insta::assert_snapshot!("points_in_a_posture", sentences(&screening));
}

#[test]
fn one_angle_with_the_wrong_sign() {
    let mut said = Vec::new();
    for (p, j) in [(0, 0), (1, 3), (5, 5), (3, 1), (2, 2), (4, 4)] {
        let mut table = group1_table(4);
        let q = &mut table.postures[p].posture.q;
        q[j] = -q[j];
        let (screening, found) = alone(&cell(), &table);
        assert_eq!(found.cause, Cause::AngleSign);
        assert_eq!(found.postures, [(p + 1).to_string()]);
        assert_eq!(found.joints, [format!("joint {}", j + 1)]);
        assert!(found.alternatives.is_empty(), "{}", sentences(&screening));
        said.push(sentences(&screening));
    }
    insta::assert_snapshot!("angle_sign", said.join("\n"));
}

#[test]
fn one_angle_mistyped() {
    let mut said = Vec::new();
    // Digits exchanged, a decimal point, another number.
    for (p, j, wrong) in [
        (3, 3, -2.0_f64),
        (1, 1, 51.0),
        (2, 5, 1.0),
        (5, 4, -23.5),
        (4, 0, 52.0),
    ] {
        let mut table = group1_table(5);
        let q = &mut table.postures[p].posture.q;
        let right = rad_to_deg(q[j]);
        q[j] = wrong.to_radians();
        let (screening, found) = alone(&cell(), &table);
        assert_eq!(found.cause, Cause::MistypedAngle);
        assert_eq!(found.postures, [(p + 1).to_string()]);
        assert_eq!(found.joints, [format!("joint {}", j + 1)]);
        assert!((found.angles_deg[0] - wrong).abs() < 1e-9);
        assert!(
            (found.angles_deg[1] - right).abs() < 0.02,
            "{}",
            sentences(&screening)
        );
        assert!(found.alternatives.is_empty(), "{}", sentences(&screening));
        said.push(sentences(&screening));
    }
    insta::assert_snapshot!("mistyped_angle", said.join("\n"));
}

#[test]
fn another_unit() {
    let mut said = Vec::new();
    for factor in [1e-3, 1e3, 25.4, 1.0 / 25.4] {
        let mut table = group1_table(6);
        each_position(&mut table, |p| *p *= factor);
        let (screening, found) = alone(&cell(), &table);
        assert_eq!((found.cause, found.factor), (Cause::Units, Some(factor)));
        assert!(found.postures.is_empty());
        said.push(sentences(&screening));
    }
    // In one posture only.
    let mut table = group1_table(6);
    for reading in table.postures[2]
        .states
        .iter_mut()
        .flat_map(|s| &mut s.readings)
    {
        reading.position *= 1e-3;
    }
    let (screening, found) = alone(&cell(), &table);
    assert_eq!(found.cause, Cause::Units);
    assert!(found.postures == ["3"] && found.states.is_empty());
    said.push(sentences(&screening));
    // The tool in the cell, not the readings.
    let table = group1_table(6);
    let mut wrong = cell();
    for point in &mut wrong.setup.tool.measuring_points {
        point.position *= 1e-3;
    }
    let (screening, found) = alone(&wrong, &table);
    assert_eq!(found.cause, Cause::ToolUnits);
    said.push(sentences(&screening));
    insta::assert_snapshot!("units", said.join("\n"));
}

#[test]
fn mirrored_tracker_axes() {
    let mut said = Vec::new();
    for axis in 0..3 {
        let mut table = group1_table(7);
        each_position(&mut table, |p| p[axis] = -p[axis]);
        let (screening, found) = alone(&cell(), &table);
        assert_eq!(found.cause, Cause::MirroredFrame);
        said.push(sentences(&screening));
    }
    // A tool that is not flat shows the mirror image in its own shape.
    let mut deep = cell();
    deep.setup.tool.measuring_points[2].position.z += 0.12;
    let mut table = simulated(&deep, &numbered(group1()), 7);
    each_position(&mut table, |p| p.swap_rows(0, 1));
    let (_, found) = alone(&deep, &table);
    assert_eq!(found.cause, Cause::MirroredFrame);
    insta::assert_snapshot!("mirrored", said[0]);
}

#[test]
fn exchanged_columns_are_told_by_where_the_tracker_stands() {
    let exchanged = |table: &ReadingTable, i: usize, j: usize| {
        let mut table = table.clone();
        each_position(&mut table, |p| p.swap_rows(i, j));
        table
    };
    // By the transform that is given, wherever the tracker stands.
    let table = group1_table(7);
    for (i, j, names) in [(0, 1, "x and y"), (1, 2, "y and z"), (0, 2, "x and z")] {
        let given = tracker_pose(7);
        let screening = screen(&cell(), &exchanged(&table, i, j), Some(&given)).unwrap();
        let found = only(&screening);
        assert_eq!(found.axis_slips, [format!("whether {names} are exchanged")]);
        let said = sentences(&screening);
        assert!(
            said.contains(&format!("First check whether {names}")),
            "{said}"
        );
    }
    // Without it by the base, where the tracker's axes are nearly its own.
    let level = Experiment {
        base_from_tracker: Isometry3::new(Vector3::new(3.0, 1.0, 0.5), Vector3::z() * 0.1),
        ..options(7)
    };
    let table = experiment(&cell(), &numbered(group1()), &truth(&cell()), &level, 7, 0).unwrap();
    let screening = screen(&cell(), &exchanged(&table, 0, 1), None).unwrap();
    assert_eq!(
        only(&screening).axis_slips,
        ["whether x and y are exchanged"]
    );
    let mut flipped = table.clone();
    each_position(&mut flipped, |p| p.y = -p.y);
    let screening = screen(&cell(), &flipped, None).unwrap();
    assert_eq!(only(&screening).axis_slips, ["the sign of y"]);
    // Else nothing tells.
    let screening = screen(&cell(), &exchanged(&group1_table(7), 0, 1), None).unwrap();
    assert!(only(&screening).axis_slips.is_empty());
    assert!(sentences(&screening).contains("readings cannot tell"));
}

#[test]
fn force_sign_reversed() {
    let table = group1_table(8);
    let mut wrong = cell();
    wrong.sensor.as_mut().unwrap().reports_by_robot = false;
    let mut said = Vec::new();
    for prior in [true, false] {
        if !prior {
            wrong.prior = None;
        }
        let (screening, found) = alone(&wrong, &table);
        assert_eq!(found.cause, Cause::ReversedForce);
        said.push(sentences(&screening));
    }
    // Without a sensor the cell's own load is at fault.
    wrong.sensor = None;
    let anchor = *rope_anchor(&mut wrong);
    let pushed = Load::Constant {
        wrench: Wrench::force(-(anchor - Vector3::new(1.7, 0.0, 1.8)).normalize() * 500.0),
        axes: Axes::Base,
    };
    wrong.setup.load = pushed;
    let mut table = table;
    for state in table.postures.iter_mut().flat_map(|p| &mut p.states) {
        state.wrench = None;
    }
    let (screening, found) = alone(&wrong, &table);
    assert_eq!(found.cause, Cause::ReversedForce);
    said.push(sentences(&screening));
    insta::assert_snapshot!("force_sign", said.join("\n"));
}

#[test]
fn loaded_and_unloaded_rows_exchanged() {
    let mut said = Vec::new();
    for all in [false, true] {
        let mut table = group1_table(9);
        for (p, posture) in table.postures.iter_mut().enumerate() {
            if all || p == 3 {
                let first = posture.states[0].readings.clone();
                let second = std::mem::replace(&mut posture.states[1].readings, first);
                posture.states[0].readings = second;
            }
        }
        let (screening, found) = alone(&cell(), &table);
        if all {
            assert_eq!(found.cause, Cause::ReversedForce)
        } else {
            assert_eq!(found.cause, Cause::ExchangedStates);
            assert_eq!(found.postures, ["4"]);
        }
        said.push(sentences(&screening));
    }
    insta::assert_snapshot!("states_exchanged", said.join("\n"));
}

#[test]
fn a_load_of_another_size() {
    let mut said = Vec::new();
    // Newtons under a heading in kilonewtons.
    let mut table = group1_table(10);
    let mut cell_by_load = cell();
    cell_by_load.sensor = None;
    table.wrench_columns = WrenchColumns::None;
    for state in table.postures.iter_mut().flat_map(|p| &mut p.states) {
        state.wrench = None;
        state.load = (state.state == "loaded").then_some(500e3);
    }
    let (screening, found) = alone(&cell_by_load, &table);
    assert_eq!((found.cause, found.factor), (Cause::LoadUnits, Some(1e-3)));
    let sentence = sentences(&screening);
    assert!(
        sentence.contains("500000 N, more than such a robot can carry"),
        "{sentence}"
    );
    assert!(
        sentence.contains("whether a heading says kn (load_kn, fx_kn)"),
        "{sentence}"
    );
    assert!(!sentence.contains("hardly bends"), "{sentence}");
    let mut table = group1_table(10);
    for state in table.postures.iter_mut().flat_map(|p| &mut p.states) {
        // Kilonewtons under a heading in newtons.
        if let Some(wrench) = &mut state.wrench {
            wrench.force *= 1e-3;
            wrench.moment *= 1e-3;
        }
    }
    let (screening, found) = alone(&cell(), &table);
    assert_eq!((found.cause, found.factor), (Cause::LoadUnits, Some(1e3)));
    said.push(sentences(&screening));
    // One posture measured without load; one whose loaded rows are copies.
    let mut table = group1_table(10);
    let unloaded = Experiment {
        states: vec![
            ExperimentState::new("unloaded", 0.0),
            ExperimentState::new("loaded", 0.0),
        ],
        ..options(10)
    };
    let still = experiment(
        &cell(),
        &numbered(group1()),
        &truth(&cell()),
        &unloaded,
        10,
        1,
    )
    .unwrap();
    for (now, then) in table.postures[4]
        .states
        .iter_mut()
        .zip(&still.postures[4].states)
    {
        now.readings.clone_from(&then.readings);
    }
    let (screening, found) = alone(&cell(), &table);
    assert_eq!(found.cause, Cause::NoDisplacement);
    assert_eq!(found.postures, ["5"]);
    said.push(sentences(&screening));
    let mut table = group1_table(10);
    for posture in &mut table.postures {
        posture.states[1].readings = posture.states[0].readings.clone();
    }
    let (screening, found) = alone(&cell(), &table);
    assert_eq!(found.cause, Cause::NoDisplacement);
    assert!(only(&screening).postures.is_empty());
    said.push(sentences(&screening));
    insta::assert_snapshot!("load_size", said.join("\n"));
}

#[test]
fn axis_three_uncoupled_or_a_joint_turned_round() {
    let table = group1_table(11);
    let mut said = Vec::new();
    let with = |change: &dyn Fn(&mut DMatrix<f64>)| {
        let mut wrong = cell();
        let mut coupling = wrong.setup.robot.coupling().clone();
        change(&mut coupling);
        wrong.setup.robot = wrong.setup.robot.with_coupling(coupling).unwrap();
        wrong
    };
    let wrong = with(&|c| c[(2, 1)] = 0.0);
    let (screening, found) = alone(&wrong, &table);
    assert_eq!((found.cause, found.factor), (Cause::Coupling, Some(-1.0)));
    assert!(found.joints.is_empty() && found.alternatives.is_empty());
    said.push(sentences(&screening));
    for j in 0..6 {
        let wrong = with(&|c| c.column_mut(j).neg_mut());
        let (screening, found) = alone(&wrong, &table);
        assert_eq!(found.cause, Cause::JointSign, "{}", sentences(&screening));
        assert_eq!(found.joints, [format!("joint {}", j + 1)]);
        assert!(found.alternatives.is_empty(), "{}", sentences(&screening));
        said.push(sentences(&screening));
    }
    // A newcomer's chain: no signs, no coupling.
    let wrong = with(&|c| *c = DMatrix::identity(6, 6));
    let (screening, found) = alone(&wrong, &table);
    assert_eq!((found.cause, found.factor), (Cause::Coupling, Some(-1.0)));
    assert_eq!(
        found.joints,
        names(&["joint 1", "joint 3", "joint 4", "joint 6"])
    );
    said.push(sentences(&screening));
    insta::assert_snapshot!("robot", said.join("\n"));
}

#[test]
fn a_joint_with_an_offset_and_angles_in_radians() {
    let mut said = Vec::new();
    let mut table = group1_table(12);
    for posture in &mut table.postures {
        posture.posture.q[2] += 90.0_f64.to_radians();
    }
    let (screening, found) = alone(&cell(), &table);
    assert_eq!(found.cause, Cause::JointOffset);
    assert_eq!(found.joints, ["joint 3"]);
    assert!(
        (found.angles_deg[0] + 90.0).abs() < 0.01,
        "{}",
        sentences(&screening)
    );
    said.push(sentences(&screening));
    let mut table = group1_table(12);
    for posture in &mut table.postures {
        posture
            .posture
            .q
            .iter_mut()
            .for_each(|q| *q = q.to_radians());
    }
    let (screening, found) = alone(&cell(), &table);
    assert_eq!(found.cause, Cause::Radians);
    said.push(sentences(&screening));
    insta::assert_snapshot!("offset_radians", said.join("\n"));
}

#[test]
fn rows_of_two_postures_exchanged() {
    let mut said = Vec::new();
    let mut table = group1_table(13);
    let first = table.postures[1].states.clone();
    table.postures[1].states = std::mem::replace(&mut table.postures[4].states, first);
    let (screening, found) = alone(&cell(), &table);
    assert_eq!(found.cause, Cause::ExchangedPostures);
    assert_eq!(found.postures, ["2", "5"]);
    said.push(sentences(&screening));
    // Only the loaded ones.
    let mut table = group1_table(13);
    let first = table.postures[1].states[1].clone();
    table.postures[1].states[1] = std::mem::replace(&mut table.postures[4].states[1], first);
    let (screening, found) = alone(&cell(), &table);
    assert_eq!(found.cause, Cause::ExchangedPostures);
    assert_eq!(found.postures, ["2", "5"]);
    assert_eq!(found.states, ["loaded"]);
    said.push(sentences(&screening));
    // A posture measured twice in place of another.
    let mut table = group1_table(13);
    table.postures[3].states = table.postures[0].states.clone();
    let (screening, found) = alone(&cell(), &table);
    assert_eq!(found.cause, Cause::OtherPosture);
    assert_eq!(found.postures, ["4", "1"]);
    said.push(sentences(&screening));
    insta::assert_snapshot!("postures_exchanged", said.join("\n"));
}
