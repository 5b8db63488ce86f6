//! `reduce` gives back what a simulated experiment put in: displacements,
//! wrenches, base motion, drift, noise.

use crate::common;

use common::random::Dice;
use common::readings::*;
use common::{cases, reference_cell};
use nalgebra::{DVector, Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use stiffarm::Code;
use stiffarm::findings::Severity;
use stiffarm::measure::experiment::{
    BaseCompliance, Experiment, ExperimentState, ForceRecord, ToolWeight, TrackerNoise,
};
use stiffarm::measure::reduction::{Clock, ReduceOptions, Reduction, reduce};
use stiffarm::model::cell::Cell;
use stiffarm::model::instruments::{Mount, Sensor, TrackerAccuracy};
use stiffarm::model::kinematics::Frames;
use stiffarm::model::load::{Load, Wrench};
use stiffarm::model::measurement::{
    Displacement, MeasuredPosture, Reading, ReadingTable, ReadingTarget,
};
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::tool::NamedPoint;

/// Tracker anywhere, sensor turned and shifted, weights, offsets, drift, servo
/// give, base motion, several load states.
fn everything(preload: f64, tilt: f64) -> Experiment {
    let mut list = states(&[
        ("unloaded", 0.0, 2),
        ("preload", preload, 2),
        ("up-250", 0.5, 2),
        ("full", 1.0, 3),
        ("down-250", 0.5, 1),
        ("preload-2", preload, 2),
        ("unloaded-2", 0.0, 2),
    ]);
    list.retain(|state| preload > 0.0 || !state.name.starts_with("preload"));
    Experiment {
        base_from_tracker: tracker_pose(),
        states: list,
        force: ForceRecord::ForceAndMoment,
        base_reflectors: base_reflectors(),
        base_compliance: Some(BaseCompliance { tilt, shift: 3e-8 }),
        seconds_per_reading: 7.0,
        drift: Vector3::new(2e-8, -1e-8, 3e-8),
        servo_deflection: Some(GIVE.to_vec()),
        tool_weight: Some(ToolWeight {
            mass_kg: 30.0,
            centre: Vector3::new(0.03, 0.02, 0.15),
        }),
        sensor_offset: Wrench {
            force: Vector3::new(12.0, -30.0, 8.0),
            moment: Vector3::new(1.0, 2.0, -3.0),
        },
        ..Experiment::default()
    }
}

#[test]
fn everything_at_once_comes_back() {
    let mut cell = reference_cell();
    cell.sensor = Some(sensor());
    // Against a preload, axes are those of the preloaded arm: its base has
    // turned by some µrad and its servo given way.
    for (preload, tilt, displacement_limit, wrench_limit) in [
        (0.0, 2e-8, 1e-11, 1e-12),
        (0.2, 0.0, 1e-11, 1e-4),
        (0.2, 2e-8, 1e-5, 1e-4),
    ] {
        let options = everything(preload, tilt);
        let table = take(&cell, &options, 1);
        let factor = |state: &str| {
            if state == "full" {
                1.0 - preload
            } else {
                0.5 - preload
            }
        };
        let result = reduce(&cell, &table, &given(tracker_pose())).unwrap();
        assert_eq!(result.measured.len(), 18);
        let error = displacement_error(&cell, &result.measured, factor, Some(GIVE));
        // Rounding of coordinates of 6 m, against displacements of 1 mm.
        assert!(error < displacement_limit, "{error:e}");
        let error = wrench_error(&cell, &result.measured, factor);
        assert!(error < wrench_limit, "{error:e}");
        for m in &result.measured {
            let give = m.servo_deflection.as_ref().unwrap();
            let q = planned(m);
            let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
            let coupling = cell.setup.robot.coupling();
            let torque = coupling.tr_mul(&DVector::from_column_slice(terms.torque()));
            for j in 0..6 {
                let full = GIVE[j] * torque[j];
                assert!((give[j] - full * factor(&m.state)).abs() < 1e-14);
                assert!((m.posture.q[j] - q[j] - preload * full).abs() < 1e-14);
            }
            // The states before and after stand behind every reference.
            let mut displacements = m.displacements.iter();
            assert!(displacements.all(|d| d.reference == 0 && (2..=4).contains(&d.readings[1])));
        }
        let full = &result.measured[1];
        assert_eq!(
            (full.state.as_str(), full.displacements[0].readings[0]),
            ("full", 3)
        );
        assert_eq!(result.base_motion.len(), 6);
        let mut motions = result.base_motion.iter();
        assert!(motions.all(|b| b.turn_removed && b.state == "full"));
        let rate = result.drift.as_ref().unwrap().rate_m_per_hour.unwrap();
        let put_in = tracker_pose().rotation * options.drift * 3600.0;
        assert!((Vector3::from(rate) - put_in).amax() < 1e-9 * put_in.norm());
        let point = result.wrench_check.unwrap().application_point.unwrap();
        assert!(point.distance_m < 1e-4, "{point:?}");
    }
}

#[test]
fn the_wrench_of_a_flange_sensor_comes_back_in_load_coordinates() {
    for (mount, reports_by_robot) in [
        (Mount::Flange, true),
        (Mount::Flange, false),
        (Mount::Base, true),
    ] {
        let mut cell = reference_cell();
        cell.sensor = Some(Sensor {
            mount,
            reports_by_robot,
            ..sensor()
        });
        let options = Experiment {
            force: ForceRecord::ForceAndMoment,
            tool_weight: Some(ToolWeight {
                mass_kg: 55.0,
                centre: Vector3::new(0.1, 0.0, 0.2),
            }),
            sensor_offset: Wrench {
                force: Vector3::new(5.0, 5.0, -9.0),
                moment: Vector3::new(0.3, 0.1, 0.7),
            },
            ..Experiment::default()
        };
        let result = reduced(&cell, &take(&cell, &options, 1));
        let error = wrench_error(&cell, &result.measured, |_| 1.0);
        assert!(error < 1e-12, "{mount:?}: {error:e}");
        let point = result.wrench_check.unwrap().application_point.unwrap();
        assert!(point.distance_m < 1e-12 && point.determined, "{point:?}");
        // Forces alone: through the loading point.
        let forces = Experiment {
            force: ForceRecord::Force,
            ..options
        };
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
        let options = Experiment {
            states: states.to_vec(),
            force,
            ..Experiment::default()
        };
        reduced(&cell, &take(&cell, &options, 1))
    };
    // No sensor: forces on the robot in base axes.
    for force in [
        ForceRecord::Force,
        ForceRecord::ForceAndMoment,
        ForceRecord::Load,
    ] {
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
        let error = displacement_error(&cell, &result.measured, |_| 0.8, None);
        assert!(error < 1e-11, "{error:e}");
    }
    // Nothing recorded: the cell's own load.
    let result = run(ForceRecord::Nothing, &levels);
    assert!(result.measured.iter().all(|m| m.wrench.is_none()));
    assert!(result.wrench_check.is_none());
    // Unloaded rows without force count as zero.
    let options = Experiment {
        force: ForceRecord::Force,
        ..Experiment::default()
    };
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
fn registration_comes_from_the_unloaded_readings() {
    let cell = reference_cell();
    let options = Experiment {
        base_from_tracker: tracker_pose(),
        servo_deflection: Some(GIVE.to_vec()),
        ..Experiment::default()
    };
    let table = take(&cell, &options, 1);
    let result = reduced(&cell, &table);
    let difference = result.base_from_tracker.inverse() * tracker_pose();
    assert!(difference.rotation.angle() < 1e-14 && difference.translation.vector.norm() < 1e-13);
    let registration = result.registration.as_ref().unwrap();
    assert!(!registration.given && registration.rms_m < 1e-13);
    assert!(
        registration
            .turn_standard_error_rad
            .unwrap()
            .iter()
            .all(|e| *e < 1e-13)
    );
    assert!(registration.fit.is_some());
    assert_eq!(registration.postures.len(), 6);
    assert!(
        registration
            .postures
            .iter()
            .all(|p| p.used && p.points.len() == 4)
    );
    let error = displacement_error(&cell, &result.measured, |_| 1.0, Some(GIVE));
    assert!(error < 1e-11, "{error:e}");
    // Given, by the options or by the cell: the same, and the readings check it.
    let mut with_pose = cell.clone();
    with_pose.tracker.base_from_tracker = Some(tracker_pose());
    for result in [
        reduce(&cell, &table, &given(tracker_pose())).unwrap(),
        reduced(&with_pose, &table),
    ] {
        let registration = result.registration.as_ref().unwrap();
        assert!(registration.given && registration.rms_m < 1e-13 && registration.fit.is_none());
        assert!(found(&result, "given-registration").is_empty());
        let error = displacement_error(&cell, &result.measured, |_| 1.0, Some(GIVE));
        assert!(error < 1e-11, "{error:e}");
    }
    // The options go before the cell.
    with_pose.tracker.base_from_tracker = Some(Isometry3::identity());
    let result = reduce(&with_pose, &table, &given(tracker_pose())).unwrap();
    assert_eq!(result.base_from_tracker, tracker_pose());
}

#[test]
fn one_or_two_wrong_postures_do_not_spoil_the_registration() {
    let mut cell = reference_cell();
    cell.noise.reading_variance = 1e-10;
    let options = Experiment {
        base_from_tracker: tracker_pose(),
        tracker_noise: TrackerNoise::Isotropic,
        ..Experiment::default()
    };
    for wrong in [vec![0], vec![3], vec![1, 4]] {
        let mut table = take(&cell, &options, 5);
        for p in &wrong {
            table.postures[*p].posture.q[1 + p % 3] += 0.2;
        }
        let result = reduced(&cell, &table);
        let registration = result.registration.as_ref().unwrap();
        let left_out: Vec<usize> = (0..6).filter(|i| !registration.postures[*i].used).collect();
        assert_eq!(left_out, wrong);
        let difference = result
            .base_from_tracker
            .rotation
            .angle_to(&tracker_pose().rotation);
        assert!(difference < 2e-5, "{difference:e}");
        assert_eq!(found(&result, "registration-outlier").len(), 1);
        // Left out of the registration only.
        assert_eq!(result.measured.len(), 6);
    }
}

#[test]
fn a_given_transform_that_is_wrong_is_named() {
    let cell = reference_cell();
    let options = Experiment {
        base_from_tracker: tracker_pose(),
        ..Experiment::default()
    };
    let table = take(&cell, &options, 1);
    let turned = pose(0.0, 0.0, 0.0, [0.0, 0.0, 0.005]) * tracker_pose();
    let result = reduce(&cell, &table, &given(turned)).unwrap();
    let finding = found(&result, "given-registration")[0];
    assert_eq!(finding.severity, Severity::Caution);
    assert!(
        finding.sentence.contains("5.00 mrad"),
        "{}",
        finding.sentence
    );
    assert!(result.registration.unwrap().rms_m > 1e-3);
}

#[test]
fn drift_is_removed_by_time_and_by_order() {
    let cell = reference_cell();
    let options = Experiment {
        base_from_tracker: tracker_pose(),
        states: states(&[
            ("unloaded", 0.0, 2),
            ("up", 0.5, 2),
            ("full", 1.0, 2),
            ("unloaded-2", 0.0, 2),
        ]),
        seconds_per_reading: 5.0,
        drift: Vector3::new(3e-7, 2e-7, -4e-7),
        ..Experiment::default()
    };
    let factor = |state: &str| if state == "up" { 0.5 } else { 1.0 };
    let mut table = take(&cell, &options, 1);
    let by_time = reduce(&cell, &table, &given(tracker_pose())).unwrap();
    let drift = by_time.drift.as_ref().unwrap();
    assert!(drift.postures.iter().all(|p| p.clock == Clock::Time));
    let error = displacement_error(&cell, &by_time.measured, factor, None);
    assert!(error < 1e-11, "{error:e}");
    // States equally long: their order tells as much.
    for reading in readings(&mut table) {
        reading.time = None;
    }
    let by_order = reduce(&cell, &table, &given(tracker_pose())).unwrap();
    assert!(by_order.drift.as_ref().unwrap().rate_m_per_hour.is_none());
    assert!(
        by_order
            .measured
            .iter()
            .all(|m| m.displacements[0].time.is_none())
    );
    let error = displacement_error(&cell, &by_order.measured, factor, None);
    assert!(error < 1e-11, "{error:e}");
    // Some times only: the order again, and a note.
    table.postures[2].states[1].readings[0].time = Some(4.0);
    let result = reduce(&cell, &table, &given(tracker_pose())).unwrap();
    assert_eq!(result.measured, by_order.measured);
    assert_eq!(found(&result, "times-incomplete").len(), 1);
    // Nothing after the load: nothing removed, and said.
    for posture in &mut table.postures {
        posture.states.pop();
    }
    let result = reduce(&cell, &table, &given(tracker_pose())).unwrap();
    assert!(result.drift.is_none());
    assert_eq!(found(&result, "drift-unknown").len(), 1);
    assert!(displacement_error(&cell, &result.measured, factor, None) > 1e-3);
}

#[test]
fn one_state_read_before_and_after_the_load_shows_drift_by_its_times() {
    let cell = reference_cell();
    let options = Experiment {
        states: there_and_back(1),
        seconds_per_reading: 30.0,
        drift: Vector3::new(1e-7, 0.0, 2e-7),
        ..Experiment::default()
    };
    let mut table = take(&cell, &options, 1);
    for posture in &mut table.postures {
        let after = posture.states.pop().unwrap();
        posture.states[0].readings.extend(after.readings);
    }
    let result = reduce(&cell, &table, &given(Isometry3::identity())).unwrap();
    let error = displacement_error(&cell, &result.measured, |_| 1.0, None);
    assert!(error < 1e-11, "{error:e}");
    assert!(
        result
            .measured
            .iter()
            .all(|m| m.displacements[0].readings == [1, 2])
    );
    // Two readings and a line leave no degree of freedom.
    assert!(result.repeatability.is_none());
}

#[test]
fn a_load_after_the_last_unloaded_reading_takes_the_nearest() {
    let cell = reference_cell();
    let options = Experiment {
        states: states(&[
            ("unloaded", 0.0, 1),
            ("loaded", 1.0, 1),
            ("unloaded-2", 0.0, 3),
            ("loaded-2", 1.0, 1),
        ]),
        ..Experiment::default()
    };
    let mut table = take(&cell, &options, 1);
    for posture in &mut table.postures {
        for reading in &mut posture.states[2].readings {
            reading.position.x += 1e-5;
        }
    }
    let result = reduce(&cell, &table, &given(Isometry3::identity())).unwrap();
    let [first, second] = [&result.measured[0], &result.measured[1]];
    let q = &postures()[0].q;
    let (points, _) = truth(&cell, q, 1.0, None);
    // Between: half the shift by the order of the states; after: all of it.
    let shift = |m: &MeasuredPosture| m.displacements[0].value.x - points[0].x;
    assert!((shift(first) + 5e-6).abs() < 1e-14, "{:e}", shift(first));
    assert!((shift(second) + 1e-5).abs() < 1e-14, "{:e}", shift(second));
    let numbers = |m: &MeasuredPosture| (m.displacements[0].reference, m.displacements[0].readings);
    // 1 + 3 readings on a line, taken in its middle, are worth 3 (1/4 + 1/4·1/3 = 1/3).
    assert_eq!(numbers(first), (0, [1, 3]));
    assert_eq!(numbers(second), (1, [1, 3]));
    assert_eq!(found(&result, "drift-unknown").len(), 1);
}

#[test]
fn base_motion_is_taken_back() {
    let mut cell = reference_cell();
    cell.noise.reading_variance = 1e-12;
    let with = |reflectors: &[NamedPoint], tilt: f64| {
        let options = Experiment {
            base_from_tracker: tracker_pose(),
            base_reflectors: reflectors.to_vec(),
            base_compliance: Some(BaseCompliance { tilt, shift: 8e-8 }),
            ..Experiment::default()
        };
        let result = reduced(&cell, &take(&cell, &options, 1));
        let error = displacement_error(&cell, &result.measured, |_| 1.0, None);
        (result, error)
    };
    let all = base_reflectors();
    let line = [
        named("a", [0.1, 0.2, 0.1]),
        named("b", [0.3, 0.4, 0.1]),
        named("c", [0.7, 0.8, 0.1]),
    ];
    // A shift needs one reflector, a turn three that are not on a line.
    for reflectors in [&all[..1], &all[..2], &all[..], &line[..]] {
        let (result, error) = with(reflectors, 0.0);
        assert!(error < 1e-11, "{}: {error:e}", reflectors.len());
        let shift = result.base_motion[0].shift_m;
        assert!((Vector3::from(shift).norm() - 500.0 * 8e-8).abs() < 1e-13);
        assert_eq!(result.base_motion[0].reflectors, reflectors.len());
    }
    let (result, error) = with(&all, 4e-8);
    assert!(error < 1e-11, "{error:e}");
    assert!(result.base_motion.iter().all(|m| m.turn_removed));
    let frames = Frames::new(&cell.setup.robot, &postures()[0].q);
    let at = frames.point(&cell.setup.tool.loading_point);
    let moment = at.cross(&truth(&cell, &postures()[0].q, 1.0, None).1.force);
    let turn = Vector3::from(result.base_motion[0].turn_rad);
    assert!((turn - Vector3::new(moment.x, moment.y, 0.0) * 4e-8).norm() < 1e-12);
    assert!(found(&result, "base-motion")[0].severity == Severity::Note);
    for few in [&all[..1], &line[..]] {
        let (result, error) = with(few, 4e-8);
        assert!(error > 1e-3 && !result.base_motion[0].turn_removed);
        assert!(found(&result, "base-motion")[0].severity == Severity::Caution);
    }
    // Without reflectors all of it stays.
    let (result, error) = with(&[], 4e-8);
    assert!(error > 1e-2 && result.base_motion.is_empty());
    assert!(found(&result, "base-motion-unknown").is_empty());
}

#[test]
fn a_reflector_read_in_some_states_only_is_left_out_of_its_posture() {
    let cell = reference_cell();
    let options = Experiment {
        states: there_and_back(1),
        base_reflectors: base_reflectors(),
        base_compliance: Some(BaseCompliance {
            tilt: 0.0,
            shift: 8e-8,
        }),
        ..Experiment::default()
    };
    let mut table = take(&cell, &options, 1);
    let second = ReadingTarget::Base("base-2".to_string());
    table.postures[0].states[2]
        .readings
        .retain(|r| r.target != second);
    table.postures[1].states[1]
        .readings
        .retain(|r| matches!(r.target, ReadingTarget::Point(_)));
    let result = reduced(&cell, &table);
    assert_eq!(found(&result, "base-reflector-incomplete").len(), 2);
    assert_eq!(found(&result, "base-motion-unknown").len(), 1);
    let motions: Vec<(&str, usize)> = result
        .base_motion
        .iter()
        .map(|m| (m.posture.as_str(), m.reflectors))
        .collect();
    assert_eq!(motions, [("1", 2), ("3", 3), ("4", 3), ("5", 3), ("6", 3)]);
    let good: Vec<MeasuredPosture> = result
        .measured
        .iter()
        .filter(|m| m.posture.name != "2")
        .cloned()
        .collect();
    assert!(displacement_error(&cell, &good, |_| 1.0, None) < 1e-11);
}

#[test]
fn servo_give_needs_angles_that_change() {
    let cell = reference_cell();
    let options = Experiment {
        servo_deflection: Some(GIVE.to_vec()),
        ..Experiment::default()
    };
    let mut table = take(&cell, &options, 1);
    let result = reduced(&cell, &table);
    assert_eq!(found(&result, "servo-give")[0].severity, Severity::Note);
    assert!(result.measured.iter().all(|m| m.servo_deflection.is_some()));
    table.postures[4].states[1].angles = None;
    let result = reduced(&cell, &table);
    assert!(result.measured[4].servo_deflection.is_none());
    assert_eq!(found(&result, "servo-give")[0].severity, Severity::Caution);
    for state in table.postures.iter_mut().flat_map(|p| &mut p.states) {
        state.angles = Some(vec![0.1; 6]);
    }
    let result = reduce(&cell, &table, &given(Isometry3::identity())).unwrap();
    assert!(
        result
            .measured
            .iter()
            .all(|m| m.servo_deflection.is_none() && m.posture.q == vec![0.1; 6])
    );
}

#[test]
fn the_trackers_covariance_is_turned_into_base_axes() {
    let mut cell = reference_cell();
    let accuracy = TrackerAccuracy {
        station: Vector3::new(0.1, 0.2, 0.3),
        range: 4e-6,
        range_per_metre: 1e-6,
        angle: 6e-6,
    };
    cell.tracker.accuracy = Some(accuracy);
    let options = Experiment {
        base_from_tracker: tracker_pose(),
        ..Experiment::default()
    };
    let table = take(&cell, &options, 1);
    let result = reduced(&cell, &table);
    let covariance = result.measured[0].displacements[0].covariance.unwrap();
    let reading = &table.postures[0].states[1].readings[0];
    let own = accuracy.covariance(&reading.position).unwrap();
    let rotation = tracker_pose().rotation;
    let direction = rotation * (reading.position - accuracy.station).normalize();
    let expected = (direction.transpose() * covariance * direction)[0];
    let distance = (reading.position - accuracy.station).norm();
    assert!((expected / (4e-6 + 1e-6 * distance).powi(2) - 1.0).abs() < 1e-9);
    assert!((covariance.trace() / own.trace() - 1.0).abs() < 1e-12);
    assert_eq!(covariance, covariance.transpose());
    assert_ne!(covariance, Matrix3::zeros());
}

fn largest_difference(a: &[MeasuredPosture], b: &[MeasuredPosture]) -> f64 {
    assert_eq!(a.len(), b.len());
    let mut largest = 0.0_f64;
    for (a, b) in a.iter().zip(b) {
        assert_eq!((&a.posture, &a.state), (&b.posture, &b.state));
        assert_eq!(a.displacements.len(), b.displacements.len());
        for (x, y) in a.displacements.iter().zip(&b.displacements) {
            assert_eq!(
                (x.point, x.readings, x.reference),
                (y.point, y.readings, y.reference)
            );
            largest = largest.max((x.value - y.value).amax());
        }
    }
    largest
}

proptest! {
    #![proptest_config(cases(24))]

    /// Where the tracker stands changes nothing.
    #[test]
    fn a_rigid_motion_of_the_tracker_changes_nothing(seed in 0..1000u64) {
        let cell = sensor_cell();
        let table = full_table(&cell, seed);
        let motion = Dice::new(seed).pose();
        let mut moved = table.clone();
        for reading in readings(&mut moved) {
            reading.position = motion.rotation * reading.position + motion.translation.vector;
        }
        let (a, b) = (reduced(&cell, &table), reduced(&cell, &moved));
        prop_assert!(largest_difference(&a.measured, &b.measured) < 1e-13);
        prop_assert_eq!(codes(&a), codes(&b));
    }

    /// The order of rows within a state, of postures, and the zero of time
    /// change nothing; the order of states neither, where there are times.
    #[test]
    fn the_order_of_rows_changes_nothing(seed in 0..1000u64, turn in 1..5usize, by in -1e6..1e6f64) {
        let cell = sensor_cell();
        let table = full_table(&cell, seed);
        let result = reduced(&cell, &table);
        let mut shuffled = table.clone();
        for state in shuffled.postures.iter_mut().flat_map(|p| &mut p.states) {
            state.readings.rotate_left(turn);
            state.readings.swap(0, 1);
        }
        prop_assert_eq!(&reduced(&cell, &shuffled), &result);
        for reading in readings(&mut shuffled) {
            reading.time = reading.time.map(|t| t + by.round());
        }
        let shifted = reduced(&cell, &shuffled);
        prop_assert!(largest_difference(&shifted.measured, &result.measured) < 1e-13);
        for posture in &mut shuffled.postures {
            posture.states.reverse();
        }
        let mut reversed = reduced(&cell, &shuffled);
        let order = |m: &MeasuredPosture| (m.posture.name.clone(), m.state == "full");
        reversed.measured.sort_by_key(order);
        prop_assert!(largest_difference(&reversed.measured, &result.measured) < 1e-13);
    }

    /// Nothing that a table can hold makes it panic.
    #[test]
    fn tables_with_holes_give_a_result_or_an_error(seed in 0..10_000u64) {
        let cell = sensor_cell();
        let mut table = full_table(&cell, seed);
        let mut dice = Dice::new(seed);
        for posture in &mut table.postures {
            for state in &mut posture.states {
                let keep = dice.between(0.0, 1.2);
                state.readings.retain(|_| dice.chance(keep));
                if dice.chance(0.05) { state.wrench = None; }
                if dice.chance(0.2) { state.angles = None; }
            }
            if dice.chance(0.2) { posture.states.remove(0); }
            if dice.chance(0.2) { posture.states.pop(); }
        }
        if let Ok(result) = reduce(&cell, &table, &ReduceOptions::default()) {
            let values = result.measured.iter().flat_map(|m| &m.displacements);
            prop_assert!(values.clone().all(|d| d.value.iter().all(|v| v.is_finite())));
            prop_assert!(values.count() > 0);
        }
    }
}

/// Spoils a table.
type Change = Box<dyn Fn(&mut ReadingTable)>;

#[test]
fn faults_of_a_table_are_errors() {
    let cell = sensor_cell();
    let good = full_table(&cell, 1);
    let error = |change: &dyn Fn(&mut ReadingTable)| {
        let mut table = good.clone();
        change(&mut table);
        reduce(&cell, &table, &ReduceOptions::default()).unwrap_err()
    };
    let cases: Vec<(Code, Change)> = vec![
        (Code::TooFewData, Box::new(|t| t.postures.clear())),
        (
            Code::Duplicate,
            Box::new(|t| t.postures[1].posture.name = "1".to_string()),
        ),
        (
            Code::Duplicate,
            Box::new(|t| t.postures[1].states[1].state = "unloaded".to_string()),
        ),
        (
            Code::Dimension,
            Box::new(|t| t.postures[1].posture.q.truncate(5)),
        ),
        (
            Code::Dimension,
            Box::new(|t| t.postures[1].states[0].angles = Some(vec![0.0; 7])),
        ),
        (
            Code::NotFinite,
            Box::new(|t| t.postures[1].states[0].readings[2].position.y = f64::NAN),
        ),
        (
            Code::NotFinite,
            Box::new(|t| t.postures[1].states[0].readings[2].time = Some(f64::INFINITY)),
        ),
        (
            Code::NotFinite,
            Box::new(|t| t.postures[1].states[0].load = Some(f64::NAN)),
        ),
        (
            Code::NotFinite,
            Box::new(|t| {
                t.postures[1].states[0].wrench = Some(Wrench::force(Vector3::repeat(f64::NAN)))
            }),
        ),
        (
            Code::UnknownName,
            Box::new(|t| t.postures[1].states[0].readings[2].target = ReadingTarget::Point(4)),
        ),
        (
            Code::MissingKey,
            Box::new(|t| t.postures[1].states[1].wrench = None),
        ),
        (
            Code::TooFewData,
            Box::new(|t| t.postures.iter_mut().for_each(|p| p.states.truncate(1))),
        ),
        (
            Code::TooFewData,
            Box::new(|t| {
                for state in t.postures.iter_mut().flat_map(|p| &mut p.states) {
                    state.readings.clear();
                }
            }),
        ),
    ];
    for (i, (code, change)) in cases.iter().enumerate() {
        let error = error(change);
        assert_eq!(error.code(), *code, "case {i}: {error}");
    }
    let mut table = good.clone();
    table.postures[1].states[1].wrench = None;
    table.postures[1].states[1].readings[0].line = 17;
    let error = reduce(&cell, &table, &ReduceOptions::default()).unwrap_err();
    assert_eq!(error.place().line, Some(17));
    // One point of one posture, or points on a line, say nothing about the tracker.
    table = good.clone();
    table.postures.truncate(1);
    for state in &mut table.postures[0].states {
        state
            .readings
            .retain(|r| r.target == ReadingTarget::Point(0) || r.target == ReadingTarget::Point(2));
    }
    let error = reduce(&cell, &table, &ReduceOptions::default()).unwrap_err();
    assert_eq!(error.code(), Code::TooFewData);
    let broken = Isometry3::from_parts(
        Translation3::new(f64::NAN, 0.0, 0.0),
        UnitQuaternion::identity(),
    );
    let error = reduce(&cell, &table, &given(broken)).unwrap_err();
    assert_eq!(error.code(), Code::NotFinite);
    assert!(reduce(&cell, &table, &given(tracker_pose())).is_ok());
}

#[test]
fn forces_that_contradict_the_cell_are_errors() {
    let cell = reference_cell();
    let with = |force, first: &str| {
        let options = Experiment {
            states: states(&[(first, 0.0, 1), ("loaded", 1.0, 1)]),
            force,
            ..Experiment::default()
        };
        take(&cell, &options, 1)
    };
    let error = |cell: &Cell, table: &ReadingTable| {
        reduce(cell, table, &given(Isometry3::identity())).unwrap_err()
    };
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
    assert_eq!(
        error(&cell, &with(ForceRecord::Nothing, "preload")).code(),
        Code::MissingKey
    );
}

#[test]
fn a_reduction_is_saved_without_its_displacements() {
    let cell = sensor_cell();
    let result = reduced(&cell, &full_table(&cell, 1));
    let text = serde_json::to_string(&result).unwrap();
    assert!(!text.contains("measured\""), "{text}");
    let back: Reduction = serde_json::from_str(&text).unwrap();
    assert!(back.measured.is_empty());
    let registration = back.registration.unwrap();
    let rotation = result.base_from_tracker.rotation.to_rotation_matrix();
    for i in 0..3 {
        for j in 0..3 {
            assert!((registration.rotation[i][j] - rotation[(i, j)]).abs() < 1e-15);
        }
    }
    assert_eq!(back.findings, result.findings);
    assert_eq!(back.base_motion.len(), 6);
    assert!(back.drift.is_some() && back.wrench_check.is_some());
}

/// What is left out is said.
#[test]
fn postures_and_points_without_reference_are_named() {
    let cell = reference_cell();
    let mut table = take(&cell, &Experiment::default(), 1);
    table.postures[0].states.remove(0);
    table.postures[1].states.remove(1);
    table.postures[2].states[0]
        .readings
        .retain(|r| r.target != ReadingTarget::Point(3));
    let result = reduced(&cell, &table);
    assert_eq!(result.measured.len(), 4);
    let points: Vec<usize> = result.measured[0]
        .displacements
        .iter()
        .map(|d: &Displacement| d.point)
        .collect();
    assert_eq!(
        (result.measured[0].posture.name.as_str(), points),
        ("3", vec![0, 1, 2])
    );
    for code in [
        "posture-without-reference",
        "posture-without-load",
        "point-without-reference",
    ] {
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
                    text += &format!(
                        "{:?} {} [{}] {}\n",
                        f.severity, f.code, f.subject, f.sentence
                    );
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
        state
            .readings
            .retain(|r| !matches!(&r.target, ReadingTarget::Base(name) if name != "base"));
    }
    show("one base reflector", &cell, &few, &none);

    let mut gap = table.clone();
    gap.postures[0].states[3]
        .readings
        .retain(|r| matches!(r.target, ReadingTarget::Point(_)));
    gap.postures[1].states.pop();
    gap.postures[2].states.remove(0);
    gap.postures[2].states.pop();
    gap.postures[4].states[0]
        .readings
        .retain(|r| r.target != ReadingTarget::Point(1));
    gap.postures[4].states[3]
        .readings
        .retain(|r| r.target != ReadingTarget::Point(1));
    gap.postures[5].states.truncate(1);
    show("gaps", &cell, &gap, &none);

    let mut line = table.clone();
    line.postures.truncate(1);
    for state in &mut line.postures[0].states {
        state
            .readings
            .retain(|r| r.target == ReadingTarget::Point(0));
    }
    show("one point of one posture", &cell, &line, &none);

    let mut no_force = table.clone();
    no_force.postures[2].states[2].wrench = None;
    no_force.postures[2].states[2].readings[0].line = 71;
    show("a loaded state without force", &cell, &no_force, &none);
    insta::assert_snapshot!("findings", text);
}
