//! Tables that cannot be reduced are refused with their line; what is odd in others is said in words.

use super::*;

#[test]
fn faults_of_a_table_are_errors() {
    let cell = sensor_cell();
    let good = full_table(&cell, 1);
    let error = |change: &dyn Fn(&mut ReadingTable)| {
        let mut table = good.clone();
        change(&mut table);
        reduce(&cell, &table, &ReduceOptions::default()).unwrap_err()
    };
    let refused = |code: Code, change: fn(&mut ReadingTable)| {
        let error = error(&change);
        assert_eq!(error.code(), code, "{error}");
    };
    refused(Code::TooFewData, |t| t.postures.clear());
    refused(Code::Duplicate, |t| {
        t.postures[1].posture.name = "1".to_string();
    });
    refused(Code::Duplicate, |t| {
        t.postures[1].states[1].state = "unloaded".to_string();
    });
    refused(Code::Dimension, |t| t.postures[1].posture.q.truncate(5));
    refused(Code::Dimension, |t| {
        t.postures[1].states[0].angles = Some(vec![0.0; 7]);
    });
    refused(Code::NotFinite, |t| {
        t.postures[1].states[0].readings[2].position.y = f64::NAN;
    });
    refused(Code::NotFinite, |t| {
        t.postures[1].states[0].readings[2].time = Some(f64::INFINITY);
    });
    refused(Code::NotFinite, |t| {
        t.postures[1].states[0].load = Some(f64::NAN);
    });
    refused(Code::NotFinite, |t| {
        t.postures[1].states[0].wrench = Some(Wrench::force(Vector3::repeat(f64::NAN)));
    });
    refused(Code::UnknownName, |t| {
        t.postures[1].states[0].readings[2].target = ReadingTarget::Point(4);
    });
    refused(Code::MissingKey, |t| t.postures[1].states[1].wrench = None);
    refused(Code::TooFewData, |t| {
        t.postures.iter_mut().for_each(|p| p.states.truncate(1));
    });
    refused(Code::TooFewData, |t| {
        for state in t.postures.iter_mut().flat_map(|p| &mut p.states) {
            state.readings.clear();
        }
    });
    let mut table = good.clone();
    table.postures[1].states[1].wrench = None;
    table.postures[1].states[1].readings[0].line = 17;
    let error = reduce(&cell, &table, &ReduceOptions::default()).unwrap_err();
    assert_eq!(error.place().line, Some(17));
    // One point of one posture, or points on a line, say nothing about the tracker.
    table = good.clone();
    table.postures.truncate(1);
    for state in &mut table.postures[0].states {
        state.readings.retain(|r| r.target == ReadingTarget::Point(0) || r.target == ReadingTarget::Point(2));
    }
    let error = reduce(&cell, &table, &ReduceOptions::default()).unwrap_err();
    assert_eq!(error.code(), Code::TooFewData);
    let broken = Isometry3::from_parts(Translation3::new(f64::NAN, 0.0, 0.0), UnitQuaternion::identity());
    let error = reduce(&cell, &table, &given(broken)).unwrap_err();
    assert_eq!(error.code(), Code::NotFinite);
    assert!(reduce(&cell, &table, &given(tracker_pose())).is_ok());
}

#[test]
fn a_reduction_is_saved_without_its_displacements() {
    let cell = sensor_cell();
    let result = reduced(&cell, &full_table(&cell, 1));
    // What is there is enough to know the transform and all that was noticed;
    // displacements are not, so nothing reads it back as a reduction.
    let saved: serde_json::Value = serde_json::to_value(&result).unwrap();
    let keys: Vec<&str> = saved.as_object().unwrap().keys().map(String::as_str).collect();
    insta::assert_snapshot!(keys.join("\n"), @"
    base_motion
    drift
    findings
    registration
    repeatability
    temperatures
    wrench_check
    ");
    let rotation = result.base_from_tracker.rotation.to_rotation_matrix();
    for i in 0..3 {
        for j in 0..3 {
            let entry = saved["registration"]["rotation"][i][j].as_f64().unwrap();
            assert!((entry - rotation[(i, j)]).abs() < 1e-15);
        }
    }
    assert_eq!(saved["findings"].as_array().unwrap().len(), result.findings.len());
    assert_eq!(saved["base_motion"].as_array().unwrap().len(), 6);
    assert!(saved["drift"].is_object() && saved["wrench_check"].is_object());
}

/// What is left out is said.
#[test]
fn postures_and_points_without_reference_are_named() {
    let cell = reference_cell();
    let mut table = take(&cell, &Experiment::default(), 1);
    table.postures[0].states.remove(0);
    table.postures[1].states.remove(1);
    keep(&mut table.postures[2].states[0], |t| *t != ReadingTarget::Point(3));
    let result = reduced(&cell, &table);
    assert_eq!(result.measured.len(), 4);
    let points: Vec<usize> = result.measured[0].displacements.iter().map(|d: &Displacement| d.point).collect();
    assert_eq!((result.measured[0].posture.name.as_str(), points), ("3", vec![0, 1, 2]));
    for code in ["posture-without-reference", "posture-without-load", "point-without-reference"] {
        assert_eq!(found(&result, code).len(), 1, "{:?}", codes(&result));
    }
}

/// The sentences, fault by fault.
#[test]
fn findings_in_words() {
    let cell = sensor_cell();
    let table = full_table(&cell, 7);
    let mut text = String::new();
    let mut show = |title: &str, cell: &Cell, table: &ReadingTable, options: &ReduceOptions| {
        text += &format!("# {title}\n");
        match reduce(cell, table, options) {
            Ok(result) => {
                for f in &result.findings {
                    text += &format!("{:?} {} [{}] {}\n", f.severity, f.code, f.subject, f.sentence);
                }
            }
            Err(error) => text += &format!("error {}: {error}\n", error.code().as_str()),
        }
        text += "\n";
    };
    let none = ReduceOptions::default();
    show("a good experiment", &cell, &table, &none);

    let mut flipped = cell.clone();
    flipped.sensor.as_mut().unwrap().reports_by_robot = false;
    show("sign of the sensor", &flipped, &table, &none);

    let mut turned = cell.clone();
    let sensor = turned.sensor.as_mut().unwrap();
    sensor.pose.rotation *= UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, 0.1));
    show("sensor turned by 0.1 rad", &turned, &table, &none);

    let mut kilograms = table.clone();
    for state in kilograms.postures.iter_mut().flat_map(|p| &mut p.states) {
        let wrench = state.wrench.as_mut().unwrap();
        wrench.force /= 9.80665;
        wrench.moment /= 9.80665;
    }
    show("forces in kilograms", &cell, &kilograms, &none);

    let mut beside = cell.clone();
    beside.setup.tool.loading_point.x += 0.02;
    show("loading point 20 mm beside", &beside, &table, &none);

    let mut mistyped = table.clone();
    for state in &mut mistyped.postures[3].states {
        state.angles.as_mut().unwrap()[1] += 0.05;
    }
    show("a mistyped angle", &cell, &mistyped, &none);

    let wrong = pose(0.0, 0.0, 0.0, [0.0, 0.01, 0.0]) * tracker_pose();
    show("a wrong transform", &cell, &table, &given(wrong));

    let mut quiet = cell.clone();
    quiet.noise.reading_variance = 1e-11;
    show("noise set too small", &quiet, &table, &none);
    quiet.noise.reading_variance = 1e-9;
    show("noise set too large", &quiet, &table, &none);

    let mut copied = table.clone();
    for posture in &mut copied.postures {
        let first: Vec<Reading> = posture.states[0].readings.clone();
        let half = first.len() / 2;
        for i in 0..half {
            posture.states[0].readings[half + i].position = first[i].position;
        }
    }
    show("copied rows", &cell, &copied, &none);

    let mut few = table.clone();
    for state in few.postures.iter_mut().flat_map(|p| &mut p.states) {
        state.readings.retain(|r| !matches!(&r.target, ReadingTarget::Base(name) if name != "base"));
    }
    show("one base reflector", &cell, &few, &none);

    let mut gap = table.clone();
    keep(&mut gap.postures[0].states[3], is_point);
    gap.postures[1].states.pop();
    gap.postures[2].states.remove(0);
    gap.postures[2].states.pop();
    keep(&mut gap.postures[4].states[0], |t| *t != ReadingTarget::Point(1));
    keep(&mut gap.postures[4].states[3], |t| *t != ReadingTarget::Point(1));
    gap.postures[5].states.truncate(1);
    show("gaps", &cell, &gap, &none);

    let mut line = table.clone();
    line.postures.truncate(1);
    for state in &mut line.postures[0].states {
        keep(state, |t| *t == ReadingTarget::Point(0));
    }
    show("one point of one posture", &cell, &line, &none);

    let mut no_force = table.clone();
    no_force.postures[2].states[2].wrench = None;
    no_force.postures[2].states[2].readings[0].line = 71;
    show("a loaded state without force", &cell, &no_force, &none);
    insta::assert_snapshot!("findings", text);
}

#[test]
fn a_hint_names_each_measured_posture_once() {
    let cell = reference_cell();
    let levels = states(&[("unloaded", 0.0, 1), ("up", 0.5, 1), ("full", 1.0, 1)]);
    let options = Experiment { states: levels, force: ForceRecord::Load, ..Experiment::default() };
    let mut measured = reduced(&cell, &take(&cell, &options, 1)).measured;
    // The states of a posture need not stand together.
    measured.sort_by(|a, b| a.state.cmp(&b.state));
    assert_eq!(measured.len(), 12);
    let error = Measured::from(measured).exclude(&["9".to_string()]).unwrap_err();
    assert_eq!(error.hint_text(), Some("measured postures: 1, 2, 3, 4, 5, 6"));
}
