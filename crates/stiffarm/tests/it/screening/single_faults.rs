//! One planted fault each: it is found, named and nothing else is said.

use super::*;
use stiffarm::model::measurement::{PostureReadings, StateReadings};

/// Adds what is said of one fault in readings of group 1. It alone is found: its cause, then the
/// postures, states, points and joints that it names.
#[track_caller]
fn fault(said: &mut String, seed: u64, expected: &str, plant: impl FnOnce(&mut Cell, &mut ReadingTable)) -> Suspicion {
    let (mut cell, mut table) = (cell(), group1_table(seed));
    plant(&mut cell, &mut table);
    let (screening, suspicion) = alone(&cell, &table);
    let named = [&suspicion.postures, &suspicion.states, &suspicion.points, &suspicion.joints];
    let named: Vec<String> = named.into_iter().flatten().cloned().collect();
    assert_eq!(format!("{:?}: {}", suspicion.cause, named.join(", ")), expected);
    *said += &(sentences(&screening) + "\n");
    suspicion
}

fn states(table: &mut ReadingTable) -> impl Iterator<Item = &mut StateReadings> {
    table.postures.iter_mut().flat_map(|p| &mut p.states)
}

/// The loaded and the unloaded rows of a posture exchanged.
fn turn_round(posture: &mut PostureReadings) {
    let [unloaded, loaded] = &mut posture.states[..] else {
        panic!("two states");
    };
    std::mem::swap(&mut unloaded.readings, &mut loaded.readings);
}

pub(crate) fn couple(cell: &mut Cell, change: impl FnOnce(&mut DMatrix<f64>)) {
    let mut coupling = cell.setup.robot.coupling().clone();
    change(&mut coupling);
    cell.setup.robot = cell.setup.robot.clone().with_coupling(coupling).unwrap();
}

#[test]
fn every_single_fault_is_named_alone() {
    let mut said = String::new();
    // Neighbours, whose distances tell, and opposite points of the square, whose
    // distances do not; in a loaded and in an unloaded state.
    for ((p, s), a, b, expected) in [
        ((1, 1), 0, 1, "ExchangedPoints: 2, loaded, 1, 2"),
        ((3, 0), 1, 2, "ExchangedPoints: 4, unloaded, 2, 3"),
        ((2, 1), 0, 2, "ExchangedPoints: 3, loaded, 1, 3"),
        ((4, 0), 1, 3, "ExchangedPoints: 5, unloaded, 2, 4"),
    ] {
        fault(&mut said, 2, expected, |_, t| relabel(t, Some((p, s)), a, b));
    }
    for (a, b) in [(0, 1), (0, 2), (1, 3)] {
        let expected = format!("ExchangedPoints: {}, {}", a + 1, b + 1);
        fault(&mut said, 3, &expected, |_, t| relabel(t, None, a, b));
    }
    fault(&mut said, 3, "ExchangedPoints: 3, 1, 3", |_, t| {
        relabel(t, Some((2, 0)), 0, 2);
        relabel(t, Some((2, 1)), 0, 2);
    });
    for (p, j) in [(0, 0), (1, 3), (5, 5), (3, 1), (2, 2), (4, 4)] {
        let expected = format!("AngleSign: {}, joint {}", p + 1, j + 1);
        fault(&mut said, 4, &expected, |_, t| {
            let q = &mut t.postures[p].posture.q[j];
            *q = -*q;
        });
    }
    // Digits exchanged, a decimal point, another number.
    for (p, j, wrong) in [(3, 3, -2.0_f64), (1, 1, 51.0), (2, 5, 1.0), (5, 4, -23.5), (4, 0, 52.0)] {
        let expected = format!("MistypedAngle: {}, joint {}", p + 1, j + 1);
        let right = rad_to_deg(group1()[p][j]);
        let suspicion = fault(&mut said, 5, &expected, |_, t| {
            t.postures[p].posture.q[j] = wrong.to_radians();
        });
        assert!((suspicion.angles_deg[0] - wrong).abs() < 1e-9);
        assert!((suspicion.angles_deg[1] - right).abs() < 0.02, "{suspicion:?}");
    }
    for factor in [1e-3, 1e3, 25.4, 1.0 / 25.4] {
        let suspicion = fault(&mut said, 6, "Units: ", |_, t| {
            each_position(t, |p| *p *= factor);
        });
        assert_eq!(suspicion.factor, Some(factor));
    }
    fault(&mut said, 6, "Units: 3", |_, t| {
        let states = t.postures[2].states.iter_mut();
        for reading in states.flat_map(|s| &mut s.readings) {
            reading.position *= 1e-3;
        }
    });
    // The tool in the cell, not the readings.
    fault(&mut said, 6, "ToolUnits: ", |cell, _| {
        for point in &mut cell.setup.tool.measuring_points {
            point.position *= 1e-3;
        }
    });
    fault(&mut said, 7, "MirroredFrame: ", |_, t| {
        each_position(t, |p| p.x = -p.x);
    });
    for prior in [true, false] {
        fault(&mut said, 8, "ReversedForce: ", |cell, _| {
            cell.sensor.as_mut().unwrap().reports_by_robot = false;
            cell.prior = cell.prior.take().filter(|_| prior);
        });
    }
    // Without a sensor the cell's own load is at fault.
    fault(&mut said, 8, "ReversedForce: ", |cell, t| {
        let anchor = *rope_anchor(cell);
        cell.setup.load = Load::Constant {
            wrench: Wrench::force(-(anchor - Vector3::new(1.7, 0.0, 1.8)).normalize() * 500.0),
            axes: Axes::Base,
        };
        cell.prior = None;
        cell.sensor = None;
        states(t).for_each(|state| state.wrench = None);
    });
    fault(&mut said, 9, "ExchangedStates: 4, loaded", |_, t| {
        turn_round(&mut t.postures[3]);
    });
    fault(&mut said, 9, "ReversedForce: ", |_, t| {
        t.postures.iter_mut().for_each(turn_round);
    });
    // Kilonewtons under a heading in newtons.
    let suspicion = fault(&mut said, 10, "LoadUnits: ", |_, t| {
        for wrench in states(t).filter_map(|state| state.wrench.as_mut()) {
            wrench.force *= 1e-3;
            wrench.moment *= 1e-3;
        }
    });
    assert_eq!(suspicion.factor, Some(1e3));
    // One posture measured without load; loaded rows that are copies.
    fault(&mut said, 10, "NoDisplacement: 5, loaded", |cell, t| {
        let unloaded = Experiment {
            states: ["unloaded", "loaded"].map(|name| ExperimentState::new(name, 0.0)).to_vec(),
            ..options(10)
        };
        let mut still = experiment(cell, &numbered(group1()), &truth(cell), &unloaded, 10, 1).unwrap();
        let measured = t.postures[4].states.iter_mut();
        for (now, then) in measured.zip(&mut still.postures[4].states) {
            std::mem::swap(&mut now.readings, &mut then.readings);
        }
    });
    fault(&mut said, 10, "NoDisplacement: ", |_, t| {
        for posture in &mut t.postures {
            posture.states[1].readings = posture.states[0].readings.clone();
        }
    });
    let suspicion = fault(&mut said, 11, "Coupling: ", |cell, _| {
        couple(cell, |c| c[(2, 1)] = 0.0);
    });
    assert_eq!(suspicion.factor, Some(-1.0));
    for j in 0..6 {
        let expected = format!("JointSign: joint {}", j + 1);
        fault(&mut said, 11, &expected, |cell, _| {
            couple(cell, |c| c.column_mut(j).neg_mut());
        });
    }
    // A newcomer's chain: no signs, no coupling.
    let expected = "Coupling: joint 1, joint 3, joint 4, joint 6";
    let suspicion = fault(&mut said, 11, expected, |cell, _| {
        couple(cell, |c| *c = DMatrix::identity(6, 6));
    });
    assert_eq!(suspicion.factor, Some(-1.0));
    let suspicion = fault(&mut said, 12, "JointOffset: joint 3", |_, t| {
        for posture in &mut t.postures {
            posture.posture.q[2] += 90.0_f64.to_radians();
        }
    });
    assert!((suspicion.angles_deg[0] + 90.0).abs() < 0.01, "{suspicion:?}");
    fault(&mut said, 12, "Radians: ", |_, t| {
        let angles = t.postures.iter_mut().flat_map(|p| &mut p.posture.q);
        angles.for_each(|q| *q = q.to_radians());
    });
    fault(&mut said, 13, "ExchangedPostures: 2, 5", |_, t| {
        let [_, second, .., fifth, _] = &mut t.postures[..] else {
            panic!("six postures");
        };
        std::mem::swap(&mut second.states, &mut fifth.states);
    });
    // Only the loaded ones.
    fault(&mut said, 13, "ExchangedPostures: 2, 5, loaded", |_, t| {
        let [_, second, .., fifth, _] = &mut t.postures[..] else {
            panic!("six postures");
        };
        std::mem::swap(&mut second.states[1], &mut fifth.states[1]);
    });
    // A posture measured twice in place of another.
    fault(&mut said, 13, "OtherPosture: 4, 1", |_, t| {
        t.postures[3].states = t.postures[0].states.clone();
    });
    insta::assert_snapshot!("single_faults", said);
}

#[test]
fn newtons_under_a_heading_in_kilonewtons_are_more_than_a_robot_carries() {
    let mut sentence = String::new();
    let suspicion = fault(&mut sentence, 10, "LoadUnits: ", |cell, t| {
        cell.sensor = None;
        t.wrench_columns = WrenchColumns::None;
        for state in states(t) {
            state.wrench = None;
            state.load = (state.state == "loaded").then_some(500e3);
        }
    });
    assert_eq!(suspicion.factor, Some(1e-3));
    insta::assert_snapshot!(sentence, @"[load-units] Serious, load: The loads look like newtons read as kilonewtons: factor 1/1000. As typed, the joint stiffness comes out 986 times above the prior, all joints alike. The file itself says so too: the load that cell or table states and 500000 N, more than such a robot can carry. Check load_n and load.magnitude_n (N), and whether a heading says kn (load_kn, fx_kn) above numbers in newtons.");
}

/// A tool that is not flat shows the mirror image in its own shape.
#[test]
fn exchanged_columns_are_a_mirror_image_for_a_deep_tool() {
    let mut deep = cell();
    deep.setup.tool.measuring_points[2].position.z += 0.12;
    let mut table = simulated(&deep, &numbered(group1()), 7);
    each_position(&mut table, |p| p.swap_rows(0, 1));
    assert_eq!(alone(&deep, &table).1.cause, Cause::MirroredFrame);
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
    let mut report = String::new();
    for (i, j, names) in [(0, 1, "x and y"), (1, 2, "y and z"), (0, 2, "x and z")] {
        let pose = tracker_pose(7);
        let screening = screen(&cell(), &exchanged(&table, i, j), Some(&pose)).unwrap();
        let suspicion = only(&screening);
        assert_eq!(suspicion.axis_slips, [format!("whether {names} are exchanged")]);
        report += &format!("{}\n", sentences(&screening));
    }
    insta::assert_snapshot!(report, @"
    [mirrored-frame] Serious, readings: The readings are mirrored: an axis has the wrong sign, or two columns are exchanged. With that undone the misfit of the unloaded points falls from 683 mm to 0.015 mm. First check whether x and y are exchanged: so the tracker stands as given, or parallel to the base.
    [mirrored-frame] Serious, readings: The readings are mirrored: an axis has the wrong sign, or two columns are exchanged. With that undone the misfit of the unloaded points falls from 683 mm to 0.015 mm. First check whether y and z are exchanged: so the tracker stands as given, or parallel to the base.
    [mirrored-frame] Serious, readings: The readings are mirrored: an axis has the wrong sign, or two columns are exchanged. With that undone the misfit of the unloaded points falls from 683 mm to 0.015 mm. First check whether x and z are exchanged: so the tracker stands as given, or parallel to the base.
    ");
    // Without it by the base, where the tracker's axes are nearly its own.
    let level =
        Experiment { base_from_tracker: Isometry3::new(Vector3::new(3.0, 1.0, 0.5), Vector3::z() * 0.1), ..options(7) };
    let table = experiment(&cell(), &numbered(group1()), &truth(&cell()), &level, 7, 0).unwrap();
    let screening = screen(&cell(), &exchanged(&table, 0, 1), None).unwrap();
    assert_eq!(only(&screening).axis_slips, ["whether x and y are exchanged"]);
    let mut flipped = table.clone();
    each_position(&mut flipped, |p| p.y = -p.y);
    let screening = screen(&cell(), &flipped, None).unwrap();
    assert_eq!(only(&screening).axis_slips, ["the sign of y"]);
    // Else nothing tells.
    let screening = screen(&cell(), &exchanged(&group1_table(7), 0, 1), None).unwrap();
    assert!(only(&screening).axis_slips.is_empty());
    insta::assert_snapshot!(sentences(&screening), @"[mirrored-frame] Serious, readings: The readings are mirrored: an axis has the wrong sign, or two columns are exchanged. With that undone the misfit of the unloaded points falls from 683 mm to 0.015 mm. Which it is the readings cannot tell: look at the export.");
}

/// A tool that sits turned on the flange is what an offset of the last joint would be: both are named, the tool first.
#[test]
fn a_tool_turned_on_the_flange_is_named_before_the_last_joint() {
    let (mut cell, table) = (cell(), group1_table(12));
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 37.0_f64.to_radians());
    for point in &mut cell.setup.tool.measuring_points {
        point.position = turn * point.position;
    }
    insta::assert_snapshot!(sentences(&screen(&cell, &table, None).unwrap()), @"[joint-offset] Serious, robot: The cell does not fit its unloaded readings, but would if the tool sat turned by 37° about the axis of joint 6 on the flange, or joint 6 were off by that throughout: the misfit falls from 98.8 mm to 0.014 mm. Check the turn of tool.measuring_point first, then robot.dh (offset) against the pendant.");
}

/// Seven postures, the last one the first again.
fn with_a_repeat(seed: u64) -> ReadingTable {
    let mut all = group1();
    all.push(all[0].clone());
    simulated(&cell(), &numbered(all), seed)
}

/// An exchange explains the rows of both postures: it is named, though the angles of a third posture fit one of them as well.
#[test]
fn rows_exchanged_with_a_posture_that_was_measured_twice_are_one_fault() {
    for seed in 0..4 {
        for rows in [0..2, 1..2] {
            let mut table = with_a_repeat(seed);
            let (before, after) = table.postures.split_at_mut(6);
            for s in rows.clone() {
                std::mem::swap(&mut before[2].states[s], &mut after[0].states[s]);
            }
            let (screening, suspicion) = alone(&cell(), &table);
            assert_eq!(suspicion.cause, Cause::ExchangedPostures);
            assert_eq!(suspicion.postures, ["3", "7"], "{}", sentences(&screening));
        }
    }
}

/// Where a row was copied from cannot be told if two postures are the same: both are named.
#[test]
fn a_row_copied_from_a_posture_that_was_measured_twice_names_both() {
    let mut table = with_a_repeat(3);
    table.postures[2].states[1] = table.postures[0].states[1].clone();
    let (screening, suspicion) = alone(&cell(), &table);
    assert_eq!(suspicion.cause, Cause::OtherPosture);
    let said = sentences(&screening);
    let both = [&suspicion.postures[1], &suspicion.alternatives[0]];
    let both = both.map(|name| name.replace("the angles of posture ", ""));
    assert!(both == ["1", "7"] || both == ["7", "1"], "{said}");
    insta::assert_snapshot!(said, @"[other-posture] Serious, postures 3 and 1, loaded: The readings of posture 3 in state loaded were taken at the angles of posture 1: the misfit falls from 1091 mm to 0.017 mm. Explains it as well: the angles of posture 7. Copied rows, or the robot was not moved?");
}

/// Rows that are exchanged have their forces with them: nothing is said of these.
#[test]
fn rows_are_exchanged_with_their_forces() {
    for seed in 0..runs(12) {
        let cell = kuka();
        let mut table = random_table(&cell, Arm::Rough, 9, seed);
        let p = seed as usize % 8;
        let (before, after) = table.postures.split_at_mut(8);
        std::mem::swap(&mut before[p].states[0], &mut after[0].states[0]);
        let (screening, suspicion) = alone(&cell, &table);
        assert_eq!(suspicion.cause, Cause::ExchangedPostures);
        assert_eq!(suspicion.postures, [(p + 1).to_string(), "9".to_string()]);
        assert_eq!(suspicion.states, ["unloaded"], "{}", sentences(&screening));
    }
}
