//! A simulated experiment, undone by hand, gives what the model says.

use crate::common::cases::refusals;
use crate::common::prelude::*;
use crate::common::readings::{postures, take};
use stiffarm::model::measurement::{PostureReadings, Role, StateReadings};
use stiffarm::model::tool::NamedPoint;

fn cell_with_sensor() -> Cell {
    changed(reference_cell(), |cell| {
        cell.sensor =
            Some(Sensor { mount: Mount::Flange, pose: Dice::new(3).pose(), reports_by_robot: true, mirrored: None });
    })
}

fn state(posture: &PostureReadings, name: &str) -> StateReadings {
    let state = posture.states.iter().find(|s| s.state == name);
    state.unwrap_or_else(|| panic!("no state {name}")).clone()
}

fn position(state: &StateReadings, target: &ReadingTarget) -> Vector3<f64> {
    let readings = state.readings.iter().filter(|r| r.target == *target);
    let all: Vec<_> = readings.map(|r| r.position).collect();
    all.iter().sum::<Vector3<f64>>() / all.len() as f64
}

/// Way of a measuring point from one state to another.
fn way(from: &StateReadings, to: &StateReadings, point: usize) -> Vector3<f64> {
    let target = ReadingTarget::Point(point);
    position(to, &target) - position(from, &target)
}

fn run(cell: &Cell, options: &Experiment) -> ReadingTable {
    take(cell, options, 7)
}

/// ΨH of one posture: rows for point, x, y, z.
fn model(cell: &Cell, q: &[f64]) -> DVector<f64> {
    let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
    let prior = cell.prior.as_ref().unwrap();
    let compliance = compliance_of(prior);
    terms.block(&cell.setup.robot) * compliance + terms.known_displacement(&cell.setup.tool)
}

fn worst(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    (a - b).amax()
}

#[test]
fn without_disturbance_it_is_the_linear_model() {
    let mut cell = reference_cell();
    let series = SeriesCompliance::from_stiffness(Vector3::zeros(), [5e7; 3], [3.3e5; 3]).unwrap();
    cell.setup.tool.series_compliance = Some(series);
    let table = run(&cell, &Experiment::default());
    assert_eq!(table.postures.len(), 6);
    for (measured, posture) in table.postures.iter().zip(postures()) {
        assert_eq!(measured.posture, posture);
        let frames = Frames::new(&cell.setup.robot, &posture.q);
        let expected = model(&cell, &posture.q);
        for (a, point) in cell.setup.tool.measuring_points.iter().enumerate() {
            let unloaded = position(&state(measured, "unloaded"), &ReadingTarget::Point(a));
            let loaded = position(&state(measured, "loaded"), &ReadingTarget::Point(a));
            assert!(worst(&unloaded, &frames.point(&point.position)) < 1e-14);
            let shift = expected.fixed_rows::<3>(3 * a).into_owned();
            assert!(shift.norm() > 1e-5 && worst(&(loaded - unloaded), &shift) < 2e-15);
        }
    }
}

#[test]
fn the_equilibrium_is_the_reference_and_close_to_the_linear_model() {
    let cell = reference_cell();
    let options = Experiment { model: DisplacementModel::Equilibrium, ..Experiment::default() };
    let prior = cell.prior.clone().unwrap();
    let mut second_order = 0.0_f64;
    for measured in run(&cell, &options).postures {
        let q = &measured.posture.q;
        let linear = model(&cell, q);
        for (a, point) in cell.setup.tool.measuring_points.iter().enumerate() {
            let shift = way(&state(&measured, "unloaded"), &state(&measured, "loaded"), a);
            let exact = equilibrium_displacement(&cell.setup, q, &point.position, &prior, None).unwrap();
            let exact = exact.fixed_rows::<3>(0).into_owned();
            assert!(worst(&shift, &exact) < 5e-15);
            let linear = linear.fixed_rows::<3>(3 * a).into_owned();
            second_order = second_order.max(worst(&shift, &linear));
        }
    }
    assert!(second_order > 1e-9 && second_order < 2e-5, "{second_order}");
}

/// Everything at once: tracker anywhere, drift, base motion, preload, servo
/// give, tool weight and offsets of the sensor.
#[test]
fn undone_by_hand_step_by_step() {
    let cell = cell_with_sensor();
    let sensor = cell.sensor.clone().unwrap();
    let mut dice = Dice::new(11);
    let base_reflectors: Vec<NamedPoint> = ["base", "base-2", "base-3"]
        .iter()
        .map(|name| NamedPoint { name: name.to_string(), position: dice.vector(0.5) })
        .collect();
    let give: Vec<f64> = (0..6).map(|_| dice.between(0.5e-7, 2e-7)).collect();
    let mut loaded = ExperimentState::new("up-250", 0.5);
    loaded.repeats = 3;
    let options = Experiment {
        base_from_tracker: dice.pose(),
        states: vec![
            ExperimentState::new("unloaded", 0.0),
            ExperimentState::new("preload", 0.2),
            loaded,
            ExperimentState::new("loaded", 1.0),
            ExperimentState::new("unloaded-2", 0.0),
        ],
        force: ForceRecord::ForceAndMoment,
        base_reflectors: base_reflectors.clone(),
        base_compliance: Some(BaseCompliance { tilt: 1e-8, shift: 1e-8 }),
        seconds_per_reading: 4.0,
        drift: Vector3::new(2e-9, -1e-9, 3e-9),
        servo_deflection: Some(give.clone()),
        tool_weight: Some(ToolWeight { mass_kg: 40.0, centre: Vector3::new(0.02, -0.01, 0.15) }),
        sensor_offset: Wrench { force: Vector3::new(12.0, -7.0, 30.0), moment: Vector3::new(-1.0, 2.0, 0.5) },
        ..Experiment::default()
    };
    let table = run(&cell, &options);
    let mut largest_base_motion = 0.0_f64;
    let mut clock = 0.0;
    for measured in &table.postures {
        let q = &measured.posture.q;
        let frames = Frames::new(&cell.setup.robot, q);
        let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
        let at = *terms.loading_point();
        let roles: Vec<Role> = measured.states.iter().map(|s| Role::of(&s.state)).collect();
        use Role::{Loaded, Preload, Unloaded};
        assert_eq!(roles, [Unloaded, Preload, Loaded, Loaded, Unloaded]);
        // Each state as base axes, drift and base motion undone.
        let undone: Vec<Vec<Vector3<f64>>> = measured
            .states
            .iter()
            .map(|s| {
                let mut still = s.clone();
                for reading in &mut still.readings {
                    assert_eq!(reading.time, Some(clock));
                    clock += 4.0;
                    reading.position -= options.drift * reading.time.unwrap();
                }
                let pairs: Vec<PointPair> = base_reflectors
                    .iter()
                    .map(|p| PointPair {
                        name: p.name.clone(),
                        tracker: position(&still, &ReadingTarget::Base(p.name.clone())),
                        base: p.position,
                    })
                    .collect();
                let registration = register(&pairs).unwrap();
                assert!(registration.rms < 1e-14);
                let moved = registration.base_from_tracker * options.base_from_tracker.inverse();
                largest_base_motion = largest_base_motion.max(moved.translation.vector.norm());
                (0..4)
                    .map(|a| {
                        let p = position(&still, &ReadingTarget::Point(a));
                        registration.base_from_tracker.rotation * p + registration.base_from_tracker.translation.vector
                    })
                    .collect()
            })
            .collect();
        let elastic = model(&cell, q);
        let torque = DVector::from_column_slice(terms.torque());
        let controller = cell.setup.robot.coupling().transpose() * &torque;
        for (s, readings) in measured.states.iter().enumerate() {
            let factor = options.states[s].load_factor;
            // Servo give: written angles, and their part of the displacement.
            let angles = readings.angles.as_ref().unwrap();
            let mut shift = elastic.clone() * factor;
            for j in 0..6 {
                let expected = give[j] * controller[j] * factor;
                assert!((angles[j] - q[j] - expected).abs() < 1e-15);
                let serial = cell.setup.robot.coupling().column(j).into_owned() * expected;
                for a in 0..4 {
                    let p = frames.point(&cell.setup.tool.measuring_points[a].position);
                    for i in 0..6 {
                        let mut part = shift.fixed_rows_mut::<3>(3 * a);
                        part += frames.column(i, &p) * serial[i];
                    }
                }
            }
            for a in 0..4 {
                let measured_shift = undone[s][a] - undone[0][a];
                let expected = shift.fixed_rows::<3>(3 * a).into_owned();
                assert!(worst(&measured_shift, &expected) < 2e-14, "state {s}");
            }
            // Wrench: offset and weight drop out of the difference.
            let (now, before) = (readings.wrench.unwrap(), measured.states[0].wrench.unwrap());
            let difference = Wrench { force: now.force - before.force, moment: now.moment - before.moment };
            let wrench = sensor.wrench_on_robot(&frames, &difference, &at);
            assert!(worst(&wrench.force, &(terms.wrench().force * factor)) < 1e-10);
            assert!(wrench.moment.norm() < 1e-10);
            // The unloaded reading itself: weight and offset.
            let alone = Wrench {
                force: before.force - options.sensor_offset.force,
                moment: before.moment - options.sensor_offset.moment,
            };
            let centre = frames.point(&options.tool_weight.unwrap().centre);
            let weight = sensor.wrench_on_robot(&frames, &alone, &centre);
            assert!(worst(&weight.force, &Vector3::new(0.0, 0.0, -40.0 * 9.80665)) < 1e-10);
            assert!(weight.moment.norm() < 1e-10);
        }
    }
    // 0.005 mm and more: the base motion was not a formality.
    assert!(largest_base_motion > 4e-6, "{largest_base_motion}");
}

#[test]
fn joint_tilt_and_lost_motion_have_their_own_springs() {
    let cell = reference_cell();
    let tilt: Vec<f64> = (1..=6).map(|j| 1e-8 * f64::from(j)).collect();
    let lost = vec![1e-5; 6];
    let plain = run(&cell, &Experiment::default());
    let disturbed =
        run(&cell, &Experiment { joint_tilt: Some(tilt.clone()), lost_motion: Some(lost), ..Experiment::default() });
    for (a, b) in plain.postures.iter().zip(&disturbed.postures) {
        let terms = PostureTerms::new(&cell.setup, &a.posture.q, None).unwrap();
        let (axes, origins) = (terms.frames().axes(), terms.frames().origins());
        for i in 0..4 {
            let target = ReadingTarget::Point(i);
            let unloaded = position(&state(a, "unloaded"), &target);
            assert_eq!(unloaded, position(&state(b, "unloaded"), &target));
            let more = way(&state(a, "loaded"), &state(b, "loaded"), i);
            let mut expected = Vector3::zeros();
            for j in 0..6 {
                // Two springs across the joint's own axis, whichever pair.
                let other = axes[j].cross(&Vector3::new(0.3, -0.5, 0.8)).normalize();
                for across in [other, other.cross(&axes[j])] {
                    let arm = terms.loading_point() - origins[j];
                    let moment = across.dot(&arm.cross(&terms.wrench().force));
                    expected += across.cross(&(unloaded - origins[j])) * moment * tilt[j];
                }
                expected += terms.frames().column(j, &unloaded) * 1e-5 * terms.torque()[j].signum();
            }
            assert!(expected.norm() > 1e-6 && worst(&more, &expected) < 1e-14);
        }
    }
}

#[test]
fn noise_has_the_spread_asked_for_and_its_own_stream() {
    let mut cell = cell_with_sensor();
    let truth = cell.prior.clone().unwrap();
    let mut options = Experiment {
        tracker_noise: TrackerNoise::Isotropic,
        force: ForceRecord::ForceAndMoment,
        sensor_noise: [2.0, 0.3],
        ..Experiment::default()
    };
    options.states[1].repeats = 200;
    let again = |options: &Experiment, stream: u64| experiment(&cell, &postures(), &truth, options, 7, stream).unwrap();
    let first = again(&options, 0);
    assert_eq!(first, again(&options, 0));
    assert_ne!(first, again(&options, 1));
    let spread = |table: &ReadingTable, along: Option<Vector3<f64>>| {
        let (mut sum, mut count) = (0.0, 0.0);
        for posture in &table.postures {
            for a in 0..4 {
                let loaded = state(posture, "loaded");
                let mean = position(&loaded, &ReadingTarget::Point(a));
                let beam = along.map(|station| (mean - station).normalize());
                for reading in loaded.readings.iter().filter(|r| r.target == ReadingTarget::Point(a)) {
                    let deviation = reading.position - mean;
                    let (part, axes) = match beam {
                        Some(beam) => (deviation.dot(&beam).powi(2), 1.0),
                        None => (deviation.norm_squared(), 3.0),
                    };
                    sum += part;
                    count += axes * 199.0 / 200.0;
                }
            }
        }
        let std: f64 = (sum / count).sqrt();
        std
    };
    // The sensor draws once per state: 12 forces and moments of 3 components.
    options.sensor_noise = [0.0, 0.0];
    let quiet = again(&options, 0);
    options.sensor_noise = [2.0, 0.3];
    let (mut force, mut moment) = (0.0, 0.0);
    for (a, b) in first.postures.iter().zip(&quiet.postures) {
        for (a, b) in a.states.iter().zip(&b.states) {
            let (a, b) = (a.wrench.unwrap(), b.wrench.unwrap());
            force += (a.force - b.force).norm_squared() / 36.0;
            moment += (a.moment - b.moment).norm_squared() / 36.0;
        }
    }
    assert!((f64::sqrt(force) / 2.0 - 1.0).abs() < 0.4, "{force}");
    assert!((f64::sqrt(moment) / 0.3 - 1.0).abs() < 0.4, "{moment}");
    // 4800 and 14400 values: the standard error of the ratio is 1 and 0.6 %.
    let ratio = spread(&first, None) / 9.23e-11_f64.sqrt();
    assert!((ratio - 1.0).abs() < 0.025, "{ratio}");
    let station = Vector3::new(4.0, -3.0, 1.0);
    cell.tracker.accuracy = Some(TrackerAccuracy { station, range: 5e-6, range_per_metre: 0.0, angle: 10e-6 });
    options.tracker_noise = TrackerNoise::RangeAndAngle;
    let table = experiment(&cell, &postures(), &truth, &options, 7, 0).unwrap();
    let along = spread(&table, Some(station)) / 5e-6;
    assert!((along - 1.0).abs() < 0.04, "{along}");
    // Across the beam, 10 µrad at 3 to 5 m.
    let all = spread(&table, None);
    assert!(all > 2e-5 && all < 4.5e-5, "{all}");
}

#[test]
fn the_common_shift_moves_all_points_of_a_loaded_state_alike() {
    let cell = reference_cell();
    let plain = run(&cell, &Experiment::default());
    let shifted = run(&cell, &with(|e: &mut Experiment| e.posture_common_std = 1e-4));
    for (a, b) in plain.postures.iter().zip(&shifted.postures) {
        assert_eq!(state(a, "unloaded"), state(b, "unloaded"));
        let shift = |i| way(&state(a, "loaded"), &state(b, "loaded"), i);
        assert!(shift(0).norm() > 1e-6);
        for i in 1..4 {
            assert!(worst(&shift(i), &shift(0)) < 1e-15);
        }
    }
}

#[test]
fn the_force_is_written_as_asked() {
    let cell = reference_cell();
    let with = |force| {
        let table = run(&cell, &with(|e: &mut Experiment| e.force = force));
        let loaded = state(&table.postures[0], "loaded");
        (loaded.wrench, loaded.load)
    };
    let terms = PostureTerms::new(&cell.setup, &postures()[0].q, None).unwrap();
    assert_eq!(with(ForceRecord::Nothing), (None, None));
    assert_eq!(with(ForceRecord::Load), (None, Some(500.0)));
    // Without a sensor: on the robot, base axes, loading point.
    assert_eq!(with(ForceRecord::ForceAndMoment).0, Some(*terms.wrench()));
    let mut at_anchor = cell.clone();
    let anchor = *rope_anchor(&mut at_anchor);
    at_anchor.sensor = Some(Sensor {
        mount: Mount::Base,
        pose: Isometry3::translation(anchor.x, anchor.y, anchor.z),
        reports_by_robot: true,
        mirrored: None,
    });
    let options = Experiment { force: ForceRecord::Force, ..Experiment::default() };
    let table = run(&at_anchor, &options);
    let force = state(&table.postures[0], "loaded").wrench.unwrap().force;
    assert!(worst(&force, &-terms.wrench().force) < 1e-12);
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    let cell = reference_cell();
    let truth = cell.prior.clone().unwrap();
    let of = |cell: &Cell, change: fn(&mut Experiment)| experiment(cell, &postures(), &truth, &with(change), 1, 0);
    let measured = changed(cell.clone(), |cell| cell.setup.load = Load::Measured);
    let rows = [
        ("a measured load", Code::MissingKey, of(&measured, |_| ())),
        ("no state", Code::InvalidValue, of(&cell, |e| e.states = Vec::new())),
        ("servo give of five joints", Code::InvalidValue, of(&cell, |e| e.servo_deflection = Some(vec![1e-7; 5]))),
        ("a tracker without accuracy", Code::MissingKey, of(&cell, |e| e.tracker_noise = TrackerNoise::RangeAndAngle)),
        ("a shift that is no number", Code::InvalidValue, of(&cell, |e| e.posture_common_std = f64::NAN)),
        ("a drift that is no number", Code::InvalidValue, of(&cell, |e| e.drift = Vector3::new(0.0, f64::NAN, 0.0))),
    ];
    insta::assert_snapshot!("experiment_refusals", refusals(rows));
}

#[test]
fn a_cell_with_a_tracker_does_not_doubt_its_own_rehearsal() {
    // A tracker that stands elsewhere than the rehearsal's own, and reads worse than [noise] says.
    let mut cell = default_cell();
    cell.tracker.base_from_tracker = Some(Isometry3::from_parts(
        Translation3::new(3.5, -1.2, 0.9),
        UnitQuaternion::from_euler_angles(0.0, 0.0, 2.6),
    ));
    cell.tracker.accuracy =
        Some(TrackerAccuracy { station: Vector3::zeros(), range: 16e-6, range_per_metre: 0.8e-6, angle: 6e-6 });
    let done = Experiment::as_measured(&cell);
    let postures = numbered(group1());
    let truth = cell.require_prior().unwrap().to_vec();
    let table = experiment(&cell, &postures, &truth, &done, 3, 0).unwrap();
    let measured = prepare(&cell, table, &ReduceOptions::default()).unwrap();
    let reduction = measured.reduction.as_ref().unwrap();
    let screening = measured.screening.as_ref().unwrap();
    for doubt in reduction.findings.iter().chain(&screening.findings) {
        assert!(doubt.severity < Severity::Serious, "{doubt:?}");
        assert_ne!(doubt.code, "repeats-worse-than-noise", "{doubt:?}");
    }
}
