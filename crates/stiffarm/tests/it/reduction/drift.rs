//! Drift between the readings is removed by time, by order and by temperature.

use super::*;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use stiffarm::Fit;
use stiffarm::model::measurement::{PostureReadings, StateReadings};

#[test]
fn drift_is_removed_by_time_and_by_order() {
    let cell = reference_cell();
    let options = Experiment {
        base_from_tracker: tracker_pose(),
        states: states(&[("unloaded", 0.0, 2), ("up", 0.5, 2), ("full", 1.0, 2), ("unloaded-2", 0.0, 2)]),
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
    assert!(by_order.measured.iter().all(|m| m.displacements[0].time.is_none()));
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
    assert!(result.measured.iter().all(|m| m.displacements[0].readings == 1 && variance(&m.displacements[0]) == 0.5));
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
    assert!(reduced_by(&cell, &table, tracker_pose()).temperatures.is_none());
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
    assert!((drift - tracker_pose().rotation * slope).norm() < 1e-9, "{drift}");
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
        states: states(&[("unloaded", 0.0, 1), ("loaded", 1.0, 1), ("unloaded-2", 0.0, 3), ("loaded-2", 1.0, 1)]),
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
    let [first, second] = [first, second].map(|m| &m.displacements[0]);
    // 1 + 3 readings on a line, taken in its middle: 1/4 + 1/4·1/3 = 1/3. The second state has the 3 readings for
    // itself, which count one half in the first.
    assert!((variance(first) - 1.0 / 3.0).abs() < 1e-12 && (variance(second) - 1.0 / 3.0).abs() < 1e-12);
    assert!((first.shared_reference(second) - 0.5 / 3.0).abs() < 1e-12);
    assert_eq!(found(&result, "drift-unknown").len(), 1);
}

/// Variance of a reference in variances of one reading.
fn variance(displacement: &Displacement) -> f64 {
    displacement.shared_reference(displacement)
}

/// The table with its rows in another order: postures, states and readings as they come then.
fn shuffled(table: &ReadingTable, seed: u64) -> ReadingTable {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut rows = Vec::new();
    for posture in &table.postures {
        for state in &posture.states {
            for reading in &state.readings {
                rows.push((posture, state, reading.clone()));
            }
        }
    }
    rows.shuffle(&mut rng);
    let mut out = ReadingTable { postures: Vec::new(), ..table.clone() };
    for (posture, state, reading) in rows {
        let index = out.postures.iter().position(|other| other.posture == posture.posture);
        let at = index.unwrap_or_else(|| {
            out.postures.push(PostureReadings { states: Vec::new(), ..posture.clone() });
            out.postures.len() - 1
        });
        let states = &mut out.postures[at].states;
        let index = states.iter().position(|other| other.state == state.state);
        let at = index.unwrap_or_else(|| {
            states.push(StateReadings { readings: Vec::new(), ..state.clone() });
            states.len() - 1
        });
        states[at].readings.push(reading);
    }
    out
}

/// Unloaded, loads up and down, unloaded between and behind, noise, drift, uneven numbers of readings.
fn a_day() -> (Cell, ReadingTable) {
    let mut cell = reference_cell();
    cell.noise.readings_per_displacement = 2;
    cell.noise.reading_variance = 1e-10;
    let options = Experiment {
        base_from_tracker: tracker_pose(),
        states: states(&[
            ("unloaded", 0.0, 2),
            ("up-250", 0.5, 1),
            ("unloaded-2", 0.0, 3),
            ("full", 1.0, 2),
            ("unloaded-3", 0.0, 1),
            ("down-250", 0.5, 1),
        ]),
        base_reflectors: base_reflectors(),
        seconds_per_reading: 7.0,
        drift: Vector3::new(2e-8, -1e-8, 3e-8),
        tracker_noise: TrackerNoise::Isotropic,
        ..Experiment::default()
    };
    let table = take(&cell, &options, 3);
    (cell, table)
}

/// Where every reading has its time, the rows may stand in any order: the same stiffness to the last bit.
#[test]
fn the_order_of_rows_does_not_count_where_all_have_times() {
    let (cell, table) = a_day();
    let identified = |table: &ReadingTable| {
        let measured = prepare(&cell, table.clone(), &given(tracker_pose())).unwrap();
        let fit = Fit::new(&cell, &measured, &Default::default()).unwrap();
        serde_json::to_string(&fit.identification().unwrap()).unwrap()
    };
    let first = identified(&table);
    for seed in 0..8 {
        assert_eq!(identified(&shuffled(&table, seed)), first, "seed {seed}");
    }
}

/// The covariance of two references is that of the sums which they are: every reading moved by itself.
#[test]
fn references_covary_as_their_readings_do() {
    let (cell, table) = a_day();
    let of = |table: &ReadingTable| reduced_by(&cell, table, tracker_pose()).measured;
    let exact = of(&table);
    let state = |name: &str| exact.iter().position(|m| m.posture == exact[0].posture && m.state == name).unwrap();
    let states = ["up-250", "full", "down-250"].map(state);
    let point = |m: &MeasuredPosture| m.displacements.iter().find(|d| d.point == 1).unwrap().clone();
    let rotation = tracker_pose().rotation;
    // What one reading counts in each reference, along x of the tracker.
    let mut counts: Vec<[f64; 3]> = Vec::new();
    let posture = table.postures.iter().position(|p| p.posture.name == exact[0].posture.name).unwrap();
    for (s, state) in table.postures[posture].states.iter().enumerate() {
        for r in 0..state.readings.len() {
            if state.readings[r].target != ReadingTarget::Point(1) || !state.state.starts_with("unloaded") {
                continue;
            }
            let mut moved = table.clone();
            moved.postures[posture].states[s].readings[r].position.x += 1e-3;
            let moved = of(&moved);
            counts.push(states.map(|m| {
                let off = rotation.inverse() * (point(&moved[m]).value - point(&exact[m]).value);
                -off.x / 1e-3
            }));
        }
    }
    assert_eq!(counts.len(), 6);
    for i in 0..3 {
        for j in 0..3 {
            let wanted: f64 = counts.iter().map(|count| count[i] * count[j]).sum();
            let shared = point(&exact[states[i]]).shared_reference(&point(&exact[states[j]]));
            assert!((shared - wanted).abs() < 1e-6, "{i} {j}: {shared} {wanted}");
        }
    }
}
