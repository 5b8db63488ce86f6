//! The wrench of the sensor.

use super::*;

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
    let error = |cell: &Cell, table: &ReadingTable| reduce(cell, table, &given(Isometry3::identity())).unwrap_err();
    let mut measured = cell.clone();
    measured.setup.load = Load::Measured;
    let nothing = with(ForceRecord::Nothing, "unloaded");
    assert_eq!(error(&measured, &nothing).code(), Code::MissingKey);
    let load = with(ForceRecord::Load, "unloaded");
    assert_eq!(error(&measured, &load).code(), Code::Conflict);
    for force in [ForceRecord::Force, ForceRecord::Load] {
        let mut table = with(force, "preload");
        table.postures[2].states[0].wrench = None;
        table.postures[2].states[0].load = None;
        let error = error(&cell, &table);
        assert_eq!(error.code(), Code::MissingKey);
        assert!(error.message().contains("preload"), "{error}");
    }
    // A preload of unknown force in a cell with a rope.
    assert_eq!(error(&cell, &with(ForceRecord::Nothing, "preload")).code(), Code::MissingKey);
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
    assert!(said[0].sentence.contains("mirrored_axis = \"x\""), "{}", said[0].sentence);
}
