//! Drift between the readings, by time and by order.

use super::*;

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
    let by_time = reduced_by(&cell, &table, tracker_pose());
    let drift = by_time.drift.as_ref().unwrap();
    assert!(drift.postures.iter().all(|p| p.clock == Clock::Time));
    assert_displaced(&cell, &by_time.measured, factor, None);
    // States equally long: their order tells as much.
    for reading in readings(&mut table) {
        reading.time = None;
    }
    let by_order = reduced_by(&cell, &table, tracker_pose());
    assert!(by_order.drift.as_ref().unwrap().rate_m_per_hour.is_none());
    assert!(
        by_order
            .measured
            .iter()
            .all(|m| m.displacements[0].time.is_none())
    );
    assert_displaced(&cell, &by_order.measured, factor, None);
    // Some times only: the order again, and a note.
    table.postures[2].states[1].readings[0].time = Some(4.0);
    let result = reduced_by(&cell, &table, tracker_pose());
    assert_eq!(result.measured, by_order.measured);
    assert_eq!(found(&result, "times-incomplete").len(), 1);
    // Nothing after the load: nothing removed, and said.
    for posture in &mut table.postures {
        posture.states.pop();
    }
    let result = reduced_by(&cell, &table, tracker_pose());
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
    let result = reduced_by(&cell, &table, Isometry3::identity());
    assert_displaced(&cell, &result.measured, |_| 1.0, None);
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
fn drift_goes_with_the_temperature() {
    let cell = reference_cell();
    let options = Experiment {
        base_from_tracker: tracker_pose(),
        states: there_and_back(1),
        seconds_per_reading: 30.0,
        ..Experiment::default()
    };
    let mut table = take(&cell, &options, 1);
    assert!(
        reduced_by(&cell, &table, tracker_pose())
            .temperatures
            .is_none()
    );
    // The air warms by 0.3 K in each posture, and everything moves with it.
    let slope = Vector3::new(4e-6, -2e-6, 5e-6);
    for (p, posture) in table.postures.iter_mut().enumerate() {
        let count = posture.states.len();
        for (s, state) in posture.states.iter_mut().enumerate() {
            let warmer = 0.3 * s as f64 / (count - 1) as f64;
            for reading in &mut state.readings {
                reading.temperature = Some(20.0 + p as f64 + warmer);
                reading.position += slope * warmer;
            }
        }
    }
    let result = reduced_by(&cell, &table, tracker_pose());
    let found_here = result.temperatures.clone().unwrap();
    assert_eq!(found_here.lowest_c, 20.0);
    assert!((found_here.highest_c - 20.3 - (table.postures.len() - 1) as f64).abs() < 1e-12);
    assert!((found_here.largest_change_k - 0.3).abs() < 1e-12);
    let drift = Vector3::from(found_here.drift_m_per_k.unwrap());
    assert!(
        (drift - tracker_pose().rotation * slope).norm() < 1e-9,
        "{drift}"
    );
    assert_eq!(found(&result, "temperature")[0].severity, Severity::Note);
    for reading in table.postures[0].states[0].readings.iter_mut() {
        reading.temperature = Some(18.0);
    }
    let result = reduced_by(&cell, &table, tracker_pose());
    assert_eq!(found(&result, "temperature")[0].severity, Severity::Caution);
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
    let result = reduced_by(&cell, &table, Isometry3::identity());
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
