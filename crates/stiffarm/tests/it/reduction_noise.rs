//! What `reduce` says of noise is the noise that was put in: repeatability,
//! drift, readings behind a displacement, standard errors, and false alarms.

use crate::common::prelude::*;
use crate::common::readings::*;
use crate::common::runs::wider;

/// Postures of an arm whose geometry is wrong as real ones are, none of them
/// mistyped: how often is one left out?
#[test]
fn the_errors_of_a_real_arm_are_not_taken_for_wrong_postures() {
    let cell = reference_cell();
    let mut dice = Dice::new(11);
    for count in [4, 5, 6, 10, 20] {
        let mut left_out = 0;
        let runs = runs(20);
        for run in 0..runs {
            let list: Vec<Posture> = (0..count)
                .map(|i| Posture {
                    name: i.to_string(),
                    q: cell.bounds.iter().map(|b| dice.between(b[0], b[1])).collect(),
                })
                .collect();
            let options = Experiment { tracker_noise: TrackerNoise::Isotropic, ..Experiment::default() };
            let prior = cell.prior.clone().unwrap();
            let mut table = experiment(&cell, &list, &prior, &options, run, 0).unwrap();
            // Joint offsets of 0.03° and errors of the angles of 0.01°.
            let offset: Vec<f64> = (0..6).map(|_| dice.between(-9e-4, 9e-4)).collect();
            for posture in &mut table.postures {
                for (q, offset) in posture.posture.q.iter_mut().zip(&offset) {
                    *q += offset + dice.between(-3e-4, 3e-4);
                }
            }
            let result = reduced(&cell, &table);
            let registration = result.registration.unwrap();
            left_out += registration.postures.iter().filter(|p| !p.used).count();
        }
        let share = left_out as f64 / (runs * count as u64) as f64;
        eprintln!("{count} postures: {:.2} % left out", share * 100.0);
        let postures = runs * count as u64;
        let allowed = most(0.005, postures, 200 * count as u64);
        assert!(left_out as u64 <= allowed, "{count} postures: {share}");
    }
}

#[test]
fn repeatability_is_the_noise_that_was_put_in() {
    let mut cell = reference_cell();
    cell.noise.reading_variance = 1e-10;
    let options = Experiment {
        states: there_and_back(3),
        tracker_noise: TrackerNoise::Isotropic,
        seconds_per_reading: 4.0,
        drift: Vector3::new(2e-7, 0.0, -1e-7),
        ..Experiment::default()
    };
    let (mut chi_squared, mut freedom, mut alarms) = (0.0, 0, 0);
    let runs = runs(20);
    for seed in 0..runs {
        let result = reduced(&cell, &take(&cell, &options, seed));
        let repeats = result.repeatability.unwrap();
        chi_squared += repeats.std_m.powi(2) / 1e-10 * repeats.degrees_of_freedom as f64;
        freedom += repeats.degrees_of_freedom;
        alarms += codes(&result).iter().filter(|c| c.starts_with("repeats")).count();
        assert_eq!(repeats.identical_readings, 0);
    }
    // 6 postures, 4 points, 3 states, 2 of 3 repeats, 3 axes; the drift's line costs next to nothing.
    assert!((430..=432).contains(&(freedom / runs as usize)));
    let z = (chi_squared - freedom as f64) / (2.0 * freedom as f64).sqrt();
    assert!(z.abs() < 4.0, "{z}");
    // Two-sided error probability of 0.001: 0.2 expected in 200.
    assert!(alarms <= 3, "{alarms}");
    for (variance, code) in [(4e-11, "repeats-worse-than-noise"), (4e-10, "repeats-better-than-noise")] {
        let mut other = cell.clone();
        other.noise.reading_variance = variance;
        let result = reduced(&other, &take(&cell, &options, 3));
        assert_eq!(found(&result, code).len(), 1, "{:?}", codes(&result));
    }
}

#[test]
fn drift_is_estimated_with_its_standard_error() {
    let mut cell = reference_cell();
    cell.noise.reading_variance = 1e-10;
    let put_in = Vector3::new(2e-8, -1e-8, 3e-8);
    let with = |drift| Experiment {
        base_from_tracker: tracker_pose(),
        states: there_and_back(2),
        tracker_noise: TrackerNoise::Isotropic,
        seconds_per_reading: 10.0,
        drift,
        ..Experiment::default()
    };
    let (mut squares, mut ratio, mut alarms) = (0.0, 0.0, 0);
    let runs = runs(20);
    for seed in 0..runs {
        let table = take(&cell, &with(put_in), seed);
        let result = reduced_by(&cell, &table, tracker_pose());
        let drift = result.drift.unwrap();
        let rate = Vector3::from(drift.rate_m_per_hour.unwrap()) / 3600.0;
        let error = drift.rate_standard_error_m_per_hour.unwrap() / 3600.0;
        squares += (rate - tracker_pose().rotation * put_in).norm_squared() / error.powi(2);
        let table = take(&cell, &with(Vector3::zeros()), seed);
        let result = reduced_by(&cell, &table, tracker_pose());
        let drift = result.drift.as_ref().unwrap();
        ratio += (drift.rms_m / drift.expected_rms_m).powi(2);
        alarms += usize::from(drift.significance.unwrap() < 1e-3);
        assert_eq!(found(&result, "drift")[0].severity, Severity::Note);
    }
    // χ² with 3 degrees of freedom a run; the noise itself is estimated to 2.4 % by 200.
    let freedom = 3.0 * runs as f64;
    let z = (squares - freedom) / (2.0 * freedom).sqrt();
    assert!(z.abs() < 4.0, "{z}");
    let ratio = ratio / runs as f64;
    assert!((ratio - 1.0).abs() < 0.05 * wider(runs, 200), "{ratio}");
    assert!(alarms <= 3, "{alarms}");
}

/// The variance of a displacement is that of its `readings`: σ²/loaded + σ²/reference.
#[test]
fn readings_behind_a_displacement_give_its_variance() {
    let mut cell = reference_cell();
    cell.noise.reading_variance = 1e-10;
    let plain = states(&[("unloaded", 0.0, 3), ("loaded", 1.0, 2)]);
    let between = states(&[("unloaded", 0.0, 2), ("loaded", 1.0, 4), ("unloaded-2", 0.0, 2)]);
    let preload = states(&[("preload", 0.2, 2), ("loaded", 1.0, 1), ("preload-2", 0.2, 2)]);
    for (states, readings, factor) in [(plain, [2, 3], 1.0), (between, [4, 4], 1.0), (preload, [1, 4], 0.8)] {
        let options = Experiment {
            states,
            tracker_noise: TrackerNoise::Isotropic,
            force: ForceRecord::Load,
            ..Experiment::default()
        };
        let (mut sum, mut count) = (0.0, 0.0_f64);
        for seed in 0..runs(6) {
            let table = take(&cell, &options, seed);
            let result = reduced_by(&cell, &table, Isometry3::identity());
            for m in &result.measured {
                let q = &planned(m);
                let (points, _) = truth(&cell, q, factor, None);
                for d in &m.displacements {
                    let reference = 1.0 / d.shared_reference(d);
                    assert!(d.readings == readings[0] && (reference - f64::from(readings[1])).abs() < 1e-9);
                    sum += (d.value - points[d.point]).norm_squared();
                    count += 3.0;
                }
            }
        }
        let expected = 1e-10 * readings.iter().map(|n| 1.0 / f64::from(*n)).sum::<f64>();
        let z = (sum / expected - count) / (2.0 * count).sqrt();
        assert!(z.abs() < 4.0, "{readings:?}: {z}");
    }
}

#[test]
fn base_motion_by_noise_alone_is_not_named_and_its_noise_is_as_stated() {
    let mut cell = reference_cell();
    cell.noise.reading_variance = 1e-10;
    let options = Experiment {
        base_reflectors: base_reflectors(),
        tracker_noise: TrackerNoise::Isotropic,
        ..Experiment::default()
    };
    let (mut sum, mut expected) = (0.0, 0.0);
    let runs = runs(10);
    for seed in 0..runs {
        let table = take(&cell, &options, seed);
        let result = reduced_by(&cell, &table, Isometry3::identity());
        assert!(found(&result, "base-motion").is_empty(), "{seed}");
        let mut bare = table.clone();
        for state in bare.postures.iter_mut().flat_map(|p| &mut p.states) {
            keep(state, is_point);
        }
        let without = reduced_by(&cell, &bare, Isometry3::identity());
        for ((with, without), motion) in result.measured.iter().zip(&without.measured).zip(&result.base_motion) {
            let pairs = with.displacements.iter().zip(&without.displacements);
            sum += pairs.map(|(a, b)| (a.value - b.value).norm_squared()).sum::<f64>();
            expected += 12.0 * motion.noise_m.powi(2);
        }
    }
    // 6 postures a run with 6 degrees of freedom each, unequally weighted.
    let ratio = sum / expected;
    assert!((ratio - 1.0).abs() < 0.1 * wider(runs, 100), "{ratio}");
}

#[test]
fn the_application_point_is_found_with_its_standard_error() {
    let mut cell = reference_cell();
    cell.sensor = Some(sensor());
    let options = Experiment { force: ForceRecord::ForceAndMoment, sensor_noise: [0.5, 0.2], ..Experiment::default() };
    let mut stated = cell.clone();
    let offset = Vector3::new(0.004, -0.003, 0.006);
    stated.setup.tool.loading_point -= offset;
    let (mut squares, mut count, mut alarms) = (0.0, 0.0, 0);
    let runs = runs(20);
    for seed in 0..runs {
        let table = take(&cell, &options, seed);
        let result = reduced(&stated, &table);
        let point = result.wrench_check.as_ref().unwrap().application_point.as_ref().unwrap();
        let error = point.distance_standard_error_m.unwrap();
        squares += ((point.distance_m - offset.norm()) / error).powi(2);
        count += 1.0;
        assert!((Vector3::from(point.offset_m) - offset).norm() < 0.004);
        assert_eq!(found(&result, "loading-point").len(), 1);
        alarms += found(&reduced(&cell, &table), "loading-point").len();
    }
    // t with 15 degrees of freedom: variance 15/13.
    let ratio: f64 = squares / count / (15.0 / 13.0);
    let wider = wider(runs, 200);
    assert!((1.0 - 0.4 * wider..1.0 + 0.6 * wider).contains(&ratio), "{ratio}");
    assert_eq!(alarms, 0);
    // A moment that no point explains: about the force itself.
    let mut table = take(&cell, &options, 1);
    for posture in &mut table.postures {
        let wrench = posture.states[1].wrench.as_mut().unwrap();
        wrench.moment += wrench.force.normalize() * 20.0;
    }
    let result = reduced(&cell, &table);
    assert_eq!(found(&result, "unexplained-moment").len(), 1, "{:?}", codes(&result));
}
