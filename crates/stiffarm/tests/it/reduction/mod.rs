//! `reduce` gives back what a simulated experiment put in: displacements,
//! wrenches, base motion, drift, noise.

mod drift;
mod faults;
mod registration;
mod wrench;

use crate::common::prelude::*;
use crate::common::readings::*;
use nalgebra::Matrix3;
use proptest::prelude::*;
use stiffarm::measure::reduction::Clock;
use stiffarm::model::measurement::Reading;
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
        tool_weight: Some(ToolWeight { mass_kg: 30.0, centre: Vector3::new(0.03, 0.02, 0.15) }),
        sensor_offset: Wrench { force: Vector3::new(12.0, -30.0, 8.0), moment: Vector3::new(1.0, 2.0, -3.0) },
        ..Experiment::default()
    }
}

#[test]
fn everything_at_once_comes_back() {
    let mut cell = reference_cell();
    cell.sensor = Some(sensor());
    // Against a preload, axes are those of the preloaded arm: its base has
    // turned by some µrad and its servo given way.
    for (preload, tilt, displacement_limit, wrench_limit) in
        [(0.0, 2e-8, 1e-11, 1e-12), (0.2, 0.0, 1e-11, 1e-4), (0.2, 2e-8, 1e-5, 1e-4)]
    {
        let options = everything(preload, tilt);
        let table = take(&cell, &options, 1);
        let factor = |state: &str| {
            if state == "full" { 1.0 - preload } else { 0.5 - preload }
        };
        let result = reduced_by(&cell, &table, tracker_pose());
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
            assert!(displacements.all(|d| (0.25..=0.5).contains(&d.shared_reference(d))));
        }
        let full = &result.measured[1];
        assert_eq!((full.state.as_str(), full.displacements[0].readings), ("full", 3));
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
    let line = [named("a", [0.1, 0.2, 0.1]), named("b", [0.3, 0.4, 0.1]), named("c", [0.7, 0.8, 0.1])];
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
        base_compliance: Some(BaseCompliance { tilt: 0.0, shift: 8e-8 }),
        ..Experiment::default()
    };
    let mut table = take(&cell, &options, 1);
    let second = ReadingTarget::Base("base-2".to_string());
    keep(&mut table.postures[0].states[2], |t| *t != second);
    keep(&mut table.postures[1].states[1], is_point);
    let result = reduced(&cell, &table);
    assert_eq!(found(&result, "base-reflector-incomplete").len(), 2);
    assert_eq!(found(&result, "base-motion-unknown").len(), 1);
    let motions: Vec<(&str, usize)> = result.base_motion.iter().map(|m| (m.posture.as_str(), m.reflectors)).collect();
    assert_eq!(motions, [("1", 2), ("3", 3), ("4", 3), ("5", 3), ("6", 3)]);
    let good: Vec<MeasuredPosture> = result.measured.iter().filter(|m| m.posture.name != "2").cloned().collect();
    assert_displaced(&cell, &good, |_| 1.0, None);
}

#[test]
fn servo_give_needs_angles_that_change() {
    let cell = reference_cell();
    let options = Experiment { servo_deflection: Some(GIVE.to_vec()), ..Experiment::default() };
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
    let result = reduced_by(&cell, &table, Isometry3::identity());
    assert!(result.measured.iter().all(|m| m.servo_deflection.is_none() && m.posture.q == vec![0.1; 6]));
}

#[test]
fn the_trackers_covariance_is_turned_into_base_axes() {
    let mut cell = reference_cell();
    let accuracy =
        TrackerAccuracy { station: Vector3::new(0.1, 0.2, 0.3), range: 4e-6, range_per_metre: 1e-6, angle: 6e-6 };
    cell.tracker.accuracy = Some(accuracy);
    let options = Experiment { base_from_tracker: tracker_pose(), ..Experiment::default() };
    let table = take(&cell, &options, 1);
    let result = reduced(&cell, &table);
    let covariance = result.measured[0].displacements[0].covariance.unwrap();
    let reading = &table.postures[0].states[1].readings[0];
    let stated = accuracy.covariance(&reading.position).unwrap();
    let rotation = tracker_pose().rotation;
    let direction = rotation * (reading.position - accuracy.station).normalize();
    let expected = (direction.transpose() * covariance * direction)[0];
    let distance = (reading.position - accuracy.station).norm();
    assert!((expected / (4e-6 + 1e-6 * distance).powi(2) - 1.0).abs() < 1e-9);
    assert!((covariance.trace() / stated.trace() - 1.0).abs() < 1e-12);
    assert_eq!(covariance, covariance.transpose());
    assert_ne!(covariance, Matrix3::zeros());
}

#[test]
fn what_the_tracker_states_of_a_reading_comes_before_its_accuracy() {
    let cell = reference_cell();
    let options = Experiment { base_from_tracker: tracker_pose(), states: there_and_back(2), ..Experiment::default() };
    let mut table = take(&cell, &options, 1);
    assert!(reduced(&cell, &table).measured[0].displacements[0].covariance.is_none());
    for state in table.postures.iter_mut().flat_map(|p| &mut p.states) {
        for i in 0..state.readings.len() {
            let [before, following] = [&state.readings[..i], &state.readings[i..]];
            let repeats = before.iter().filter(|r| r.target == following[0].target).count();
            let size = 4e-6 * (repeats + 1) as f64;
            state.readings[i].expanded = Some(Vector3::new(size, 0.0, 2.0 * size));
        }
    }
    let result = reduced(&cell, &table);
    let rotation = tracker_pose().rotation.to_rotation_matrix();
    // Standard uncertainties 2 and 4 µm, not below 0.5 µm, 4 and 8 µm: means of their squares.
    let expanded = Matrix3::from_diagonal(&Vector3::new(10e-12, 0.25e-12, 40e-12));
    let wanted = rotation * expanded * rotation.transpose();
    for displacement in result.measured.iter().flat_map(|m| &m.displacements) {
        assert!((displacement.covariance.unwrap() - wanted).norm() < 1e-24);
    }
    // One reading without: nothing is known of the mean.
    table.postures[0].states[1].readings[0].expanded = None;
    let point = match table.postures[0].states[1].readings[0].target {
        ReadingTarget::Point(point) => point,
        ReadingTarget::Base(_) => unreachable!(),
    };
    let result = reduced(&cell, &table);
    let of = |d: &Displacement| d.covariance.is_none();
    let displacements = &result.measured[0].displacements;
    assert!(displacements.iter().all(|d| of(d) == (d.point == point)));
}

fn largest_difference(a: &[MeasuredPosture], b: &[MeasuredPosture]) -> f64 {
    assert_eq!(a.len(), b.len());
    let mut largest = 0.0_f64;
    for (a, b) in a.iter().zip(b) {
        assert_eq!((&a.posture, &a.state), (&b.posture, &b.state));
        assert_eq!(a.displacements.len(), b.displacements.len());
        for (x, y) in a.displacements.iter().zip(&b.displacements) {
            assert_eq!((x.point, x.readings, &x.reference), (y.point, y.readings, &y.reference));
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
