//! Servo deflection counts against the reference that a displacement is taken against.

use crate::common::prelude::*;
use crate::common::readings::{GIVE, keep, postures, reduced, states, take, tracker_pose};

/// Angle by which the controller stands elsewhere in the two references \[rad\].
const OFF: [f64; 6] = [2e-6, -3e-6, 2.5e-6, 4e-6, -3e-6, 5e-6];

/// Exact readings; the controller stands at −OFF in `unloaded` and at +OFF in
/// `unloaded-2`, and says so.
fn table(cell: &Cell, states: Vec<ExperimentState>, seconds: f64) -> ReadingTable {
    let done = Experiment {
        base_from_tracker: tracker_pose(),
        states,
        force: ForceRecord::Load,
        servo_deflection: Some(GIVE.to_vec()),
        seconds_per_reading: seconds,
        ..Experiment::default()
    };
    let mut table = take(cell, &done, 1);
    let robot = &cell.setup.robot;
    for (posture, planned) in table.postures.iter_mut().zip(postures()) {
        for state in &mut posture.states {
            let sign = match state.state.as_str() {
                "unloaded" => -1.0,
                "unloaded-2" => 1.0,
                _ => continue,
            };
            let moved = planned.q.iter().zip(&OFF).map(|(q, off)| q + sign * off);
            let moved: Vec<f64> = moved.collect();
            let frames = [Frames::new(robot, &planned.q), Frames::new(robot, &moved)];
            for reading in &mut state.readings {
                let ReadingTarget::Point(a) = reading.target else {
                    continue;
                };
                let point = &cell.setup.tool.measuring_points[a].position;
                let shift = frames[1].point(point) - frames[0].point(point);
                reading.position += tracker_pose().rotation.inverse() * shift;
            }
            state.angles = Some(moved);
        }
    }
    table
}

/// Largest relative error of the identified stiffness.
fn error(cell: &Cell, table: &ReadingTable) -> f64 {
    let options = with(|o: &mut ReduceOptions| o.base_from_tracker = Some(tracker_pose()));
    let measured = prepare(cell, table.clone(), &options).unwrap();
    let identification = identify(cell, &measured, &IdentifyOptions::default()).unwrap();
    let prior = cell.prior.as_ref().unwrap();
    let errors = identification.estimates.joints.iter().zip(prior);
    errors.map(|(joint, k)| (joint.stiffness.unwrap() / k - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn each_displacement_is_against_the_angles_of_its_own_reference() {
    let cell = reference_cell();
    // On the line between both references, at two places of it; by order and by time.
    let between = [("unloaded", 0.0, 1), ("half", 0.5, 1), ("full", 1.0, 1), ("unloaded-2", 0.0, 1)];
    // Against the nearest of them.
    let after = [("unloaded", 0.0, 1), ("unloaded-2", 0.0, 1), ("full", 1.0, 1)];
    for (list, seconds) in [(&between[..], 0.0), (&between[..], 8.0), (&after[..], 0.0), (&after[..], 8.0)] {
        let error = error(&cell, &table(&cell, states(list), seconds));
        assert!(error < 1e-6, "{list:?}: {error}");
    }
}

#[test]
fn a_point_that_one_reference_lacks_has_another_reference() {
    let cell = reference_cell();
    let between = [("unloaded", 0.0, 1), ("full", 1.0, 1), ("half", 0.5, 1), ("unloaded-2", 0.0, 1)];
    let mut table = table(&cell, states(&between), 0.0);
    for posture in &mut table.postures {
        let last = posture.states.last_mut().unwrap();
        keep(last, |t| *t != ReadingTarget::Point(1));
    }
    let error = error(&cell, &table);
    assert!(error < 1e-6, "{error}");
    let reduction = reduced(&cell, &table);
    assert!(reduction.measured.iter().all(|m| m.servo_deflection.is_some()));
}
