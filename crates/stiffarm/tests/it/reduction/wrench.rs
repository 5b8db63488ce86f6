//! The wrench of the sensor is brought to the flange, or refused where it contradicts the cell.

use super::*;
use crate::common::cases::slip;

#[test]
fn the_wrench_of_a_flange_sensor_comes_back_in_load_coordinates() {
    for (mount, reports_by_robot) in [(Mount::Flange, true), (Mount::Flange, false), (Mount::Base, true)] {
        let mut cell = reference_cell();
        cell.sensor = Some(Sensor { mount, reports_by_robot, mirrored: None, ..sensor() });
        let options = Experiment {
            force: ForceRecord::ForceAndMoment,
            tool_weight: Some(ToolWeight { mass_kg: 55.0, centre: Vector3::new(0.1, 0.0, 0.2) }),
            sensor_offset: Wrench { force: Vector3::new(5.0, 5.0, -9.0), moment: Vector3::new(0.3, 0.1, 0.7) },
            ..Experiment::default()
        };
        let result = reduced(&cell, &take(&cell, &options, 1));
        let error = wrench_error(&cell, &result.measured, |_| 1.0);
        assert!(error < 1e-12, "{mount:?}: {error:e}");
        let point = result.wrench_check.unwrap().application_point.unwrap();
        assert!(point.distance_m < 1e-12 && point.determined, "{point:?}");
        // Forces alone: through the loading point.
        let forces = Experiment { force: ForceRecord::Force, ..options };
        let result = reduced(&cell, &take(&cell, &forces, 1));
        let error = wrench_error(&cell, &result.measured, |_| 1.0);
        assert!(error < 1e-12, "{mount:?}: {error:e}");
        assert!(result.wrench_check.unwrap().application_point.is_none());
    }
}

#[test]
fn each_source_of_the_wrench() {
    let cell = reference_cell();
    let levels = states(&[("unloaded", 0.0, 1), ("up", 0.5, 1), ("full", 1.0, 1)]);
    let factor = |state: &str| if state == "up" { 0.5 } else { 1.0 };
    let run = |force, states: &[ExperimentState]| {
        let options = Experiment { states: states.to_vec(), force, ..Experiment::default() };
        reduced(&cell, &take(&cell, &options, 1))
    };
    // No sensor: forces on the robot in base axes.
    for force in [ForceRecord::Force, ForceRecord::ForceAndMoment, ForceRecord::Load] {
        let result = run(force, &levels);
        let error = wrench_error(&cell, &result.measured, factor);
        assert!(error < 1e-13, "{force:?}: {error:e}");
    }
    // Against a preload.
    let preloaded = states(&[("unloaded", 0.0, 1), ("preload", 0.2, 1), ("full", 1.0, 1)]);
    for force in [ForceRecord::Force, ForceRecord::Load] {
        let result = run(force, &preloaded);
        let error = wrench_error(&cell, &result.measured, |_| 0.8);
        assert!(error < 1e-13, "{force:?}: {error:e}");
        assert_displaced(&cell, &result.measured, |_| 0.8, None);
    }
    // Nothing recorded: the cell's own load.
    let result = run(ForceRecord::Nothing, &levels);
    assert!(result.measured.iter().all(|m| m.wrench.is_none()));
    assert!(result.wrench_check.is_none());
    // Unloaded rows without force count as zero.
    let options = Experiment { force: ForceRecord::Force, ..Experiment::default() };
    let mut table = take(&cell, &options, 1);
    for posture in &mut table.postures {
        posture.states[0].wrench = None;
    }
    let result = reduced(&cell, &table);
    assert!(wrench_error(&cell, &result.measured, |_| 1.0) < 1e-13);
}

#[test]
fn a_drifting_sensor_is_taken_along_its_line() {
    let mut cell = reference_cell();
    cell.sensor = Some(sensor());
    let options = Experiment {
        states: there_and_back(1),
        force: ForceRecord::ForceAndMoment,
        seconds_per_reading: 20.0,
        ..Experiment::default()
    };
    let mut table = take(&cell, &options, 1);
    let (force, moment) = (Vector3::new(2.0, -3.0, 1.0), Vector3::new(0.3, 0.2, -0.5));
    for posture in &mut table.postures {
        for (i, state) in posture.states.iter_mut().enumerate() {
            let wrench = state.wrench.as_mut().unwrap();
            wrench.force += force * i as f64;
            wrench.moment += moment * i as f64;
        }
    }
    let result = reduced(&cell, &table);
    assert!(wrench_error(&cell, &result.measured, |_| 1.0) < 1e-12);
}

#[test]
fn forces_that_contradict_the_cell_are_errors() {
    let cell = reference_cell();
    let with = |force, first: &str| {
        let options =
            Experiment { states: states(&[(first, 0.0, 1), ("loaded", 1.0, 1)]), force, ..Experiment::default() };
        take(&cell, &options, 1)
    };
    let mut measured = cell.clone();
    measured.setup.load = Load::Measured;
    let forgotten = |force| {
        let mut table = with(force, "preload");
        table.postures[2].states[0].wrench = None;
        table.postures[2].states[0].load = None;
        table
    };
    let mut report = String::new();
    for (what, cell, table, code) in [
        ("no forces", &measured, with(ForceRecord::Nothing, "unloaded"), Code::MissingKey),
        ("load_n for a measured load", &measured, with(ForceRecord::Load, "unloaded"), Code::Conflict),
        ("a preload without its wrench", &cell, forgotten(ForceRecord::Force), Code::MissingKey),
        ("a preload without its load", &cell, forgotten(ForceRecord::Load), Code::MissingKey),
        ("preloads of unknown force", &cell, with(ForceRecord::Nothing, "preload"), Code::MissingKey),
    ] {
        let error = reduce(cell, &table, &given(Isometry3::identity())).expect_err(what);
        assert_eq!(error.code(), code, "{what}: {error}");
        report += &slip::<()>(what, Err(error));
    }
    insta::assert_snapshot!("forces_that_contradict_the_cell", report);
}

/// A sensor with left-handed axes, whose x counts the other way: named by the forces, and read as stated.
#[test]
fn a_mirrored_axis_of_a_sensor_is_named_and_can_be_stated() {
    let mut honest = sensor_cell();
    honest.sensor.as_mut().unwrap().mirrored = Some(0);
    let options = Experiment { force: ForceRecord::ForceAndMoment, ..Experiment::default() };
    let table = take(&honest, &options, 3);
    let right = reduced(&honest, &table);
    assert!(found(&right, "force-direction").is_empty());
    assert!(wrench_error(&honest, &right.measured, |_| 1.0) < 1e-9);
    let mut plain = honest.clone();
    plain.sensor.as_mut().unwrap().mirrored = None;
    let wrong = reduced(&plain, &table);
    let said = found(&wrong, "force-direction");
    assert_eq!(said.len(), 1, "{:?}", wrong.findings);
    insta::assert_snapshot!(said[0].sentence, @r#"The measured forces differ from the direction of the rope by 74.8° in the median. With x of the sensor counted the other way they point along it: its axes are left-handed (set sensor.mirrored_axis = "x"), or it is turned by half a turn."#);
}
