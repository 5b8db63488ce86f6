//! Joints that cannot be told apart are answered by their sum, and further springs in the truth are found.

use crate::common::prelude::*;
use stiffarm::estimate::identify::{EstimableCombination, Identification};

/// Postures in which only joints 1 and 2 move and the wrist stays as given.
fn two_joints_move(wrist_deg: [f64; 3]) -> Vec<Posture> {
    let rows = [[-40.0, -20.0], [-20.0, -5.0], [-5.0, 10.0], [10.0, 25.0], [25.0, -15.0], [40.0, 5.0]];
    let [q4, q5, q6] = wrist_deg;
    numbered(rows.map(|[q1, q2]| [q1, q2, -90.0, q4, q5, q6].map(f64::to_radians).to_vec()))
}

fn answer(cell: &Cell, postures: &[Posture], stream: usize) -> Identification {
    let truth = cell.require_prior().unwrap();
    let measured = simulate_measurements(cell, postures, truth, Model::Linear, 5, stream).unwrap();
    identify(cell, &measured, &IdentifyOptions::default()).unwrap()
}

/// The combination of joints 4 and 6 that the data determine.
fn sum_of_both(identification: &Identification) -> Option<&EstimableCombination> {
    identification.estimates.combinations.iter().find(|c| c.unknowns == ["joint 6", "joint 4"])
}

#[test]
fn joints_on_one_axis_are_answered_by_their_sum() {
    let cell = reference_cell();
    // With q5 = 0 the axes of joints 4 and 6 are one line.
    let identification = answer(&cell, &two_joints_move([0.0; 3]), 0);
    assert_eq!(identification.estimates.undetermined_joints, ["joint 4", "joint 6"]);
    assert!(!identification.estimates.is_complete());
    let sum = sum_of_both(&identification).expect("the sum of both compliances is determined");
    assert!(sum.coefficients.iter().all(|c| (c - 1.0).abs() < 1e-6), "{sum:?}");
    let prior = cell.require_prior().unwrap();
    let truth = 1.0 / prior[3] + 1.0 / prior[5];
    let error = sum.standard_error.unwrap();
    assert!(error < 0.2 * truth, "{sum:?}");
    assert!((sum.compliance - truth).abs() < 4.0 * error, "{sum:?}, {truth:e}");
}

#[test]
fn joints_nearly_on_one_axis_get_no_negative_stiffness() {
    let cell = reference_cell();
    let postures = two_joints_move([0.0, 0.02, 0.0]);
    let mut summed = 0;
    for stream in 0..40 {
        let identification = answer(&cell, &postures, stream);
        for joint in &identification.estimates.joints {
            if joint.verdict != Verdict::SignOrModelFault {
                assert!(joint.stiffness.is_none_or(|k| k > 0.0), "{joint:?}");
            }
        }
        assert!(!identification.estimates.is_complete());
        summed += usize::from(sum_of_both(&identification).is_some());
    }
    assert_eq!(summed, 40);
}

#[test]
fn columns_of_further_terms_are_small_turns() {
    let cell = reference_cell();
    let q = [0.3, -0.2, -1.4, 0.5, 0.9, -0.4];
    let robot = &cell.setup.robot;
    let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
    let frames = Frames::new(robot, &q);
    let compliance = 1e-7;
    for term in ["tilt1", "tilt3", "tilt6", "base", "lost2"] {
        let term = ExtraTerm::parse(term, robot).unwrap()[0];
        let (axis, origin) = match term {
            ExtraTerm::JointTilt(j) | ExtraTerm::LostMotion(j) => (frames.axes()[j], frames.origins()[j]),
            ExtraTerm::BaseTilt => {
                // The foot of axis 1.
                let origin = frames.origins()[0];
                (Vector3::z(), Vector3::new(origin.x, origin.y, 0.0))
            }
            ExtraTerm::Spring { .. } | ExtraTerm::Beam { .. } => unreachable!("none is parsed"),
        };
        let force = terms.wrench().force;
        let moment = (terms.loading_point() - origin).cross(&force);
        let turn = match term {
            // Turn about each of two axes across, under the moment about it.
            ExtraTerm::JointTilt(_) | ExtraTerm::BaseTilt => {
                let one = axis.cross(&Vector3::new(0.3, 0.5, 0.8)).normalize();
                let other = axis.cross(&one);
                (one * one.dot(&moment) + other * other.dot(&moment)) * compliance
            }
            ExtraTerm::LostMotion(j) => axis * terms.torque()[j].signum() * compliance,
            ExtraTerm::Spring { .. } | ExtraTerm::Beam { .. } => unreachable!("none is parsed"),
        };
        let rotation = nalgebra::Rotation3::new(turn);
        let column = term.column(&terms) * compliance;
        for (a, p) in terms.measuring_points().iter().enumerate() {
            let moved = rotation * (p - origin) - (p - origin);
            let ours = column.fixed_rows::<3>(3 * a);
            let small = turn.norm_squared() * p.norm() + 1e-15;
            assert!((moved - ours).norm() < 2.0 * small, "{term:?}");
        }
    }
}

/// Measurements of `postures` with compliances of joints and extra terms.
fn measured_with(
    cell: &Cell,
    postures: &[Posture],
    extra: &[ExtraTerm],
    values: &[f64],
    stream: usize,
) -> Vec<MeasuredPosture> {
    let truth = cell.require_prior().unwrap();
    let mut measured = simulate_measurements(cell, postures, truth, Model::Linear, 9, stream).unwrap();
    let system = measured_system(cell, &measured, extra, Weights::Readings).unwrap();
    let further = system.psi.columns(system.springs, extra.len());
    let shift = further * DVector::from_column_slice(values);
    for (i, label) in system.labels.iter().enumerate() {
        let displacement: &mut Displacement = &mut measured[label.measured].displacements[label.displacement];
        displacement.value += shift.fixed_rows::<3>(3 * i);
    }
    measured
}

#[test]
fn further_springs_in_the_truth_are_found_and_judged_by_postures_left_out() {
    let cell = reference_cell();
    let postures = random_group(&cell, StartKind::Uniform, 15, 3, 0).unwrap();
    let postures = numbered(postures);
    let robot = &cell.setup.robot;
    let extra = [ExtraTerm::parse("tilt3", robot).unwrap(), ExtraTerm::parse("lost2", robot).unwrap()].concat();
    let values = [5e-7, 3e-5];
    let measured = measured_with(&cell, &postures, &extra, &values, 0);
    let plain = IdentifyOptions::default();
    let with = changed(plain.clone(), |o| o.extra = extra);
    let identification = identify(&cell, &measured, &with).unwrap();
    let tilt = &identification.estimates.extra_springs[0];
    assert_eq!(tilt.name, "tilt of joint 3");
    let [low, high] = tilt.interval.map(|v| v.unwrap());
    assert!(low < 2e6 && 2e6 < high, "{tilt:?}");
    let lost = &identification.estimates.lost_motion[0];
    let [low, high] = lost.interval.map(|v| v.unwrap());
    assert!(low < 3e-5 && 3e-5 < high && low > 1e-5, "{lost:?}");
    for (joint, truth) in identification.estimates.joints.iter().zip(cell.require_prior().unwrap()) {
        let error = (joint.stiffness.unwrap() - truth) / joint.standard_error.unwrap();
        assert!(error.abs() < 4.5, "{joint:?}");
    }
    let rms = |options: &IdentifyOptions| {
        let fit = Fit::new(&cell, &measured, options).unwrap();
        fit.leave_one_out().unwrap().rms_m.unwrap()
    };
    let (without, better) = (rms(&plain), rms(&with));
    assert!(better < 0.5 * without, "{better} {without}");
}
