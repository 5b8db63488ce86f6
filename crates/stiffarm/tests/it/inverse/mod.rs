//! Inverse kinematics finds every posture of a pose, and says what is missing where there is none.

mod arms;
mod singular;
mod turns;
mod unreachable;

use crate::common::prelude::*;
use proptest::prelude::*;
use std::f64::consts::TAU;
use stiffarm::model::inverse::{Branch, Method, Outcome, Region, Unreachable};
use stiffarm::model::robot::{CatalogueEntry, catalogue};

fn robot(key: &str) -> Robot {
    find_in_catalogue(key).unwrap().robot().unwrap()
}

/// Robots for tests that look at many poses of each: one of every kind of
/// spherical wrist arm in the catalogue.
fn arms() -> Vec<&'static CatalogueEntry> {
    let keys = ["comau-nj165-3.0", "fanuc-r2000ic165f", "kuka-kr240-2", "kuka-kr500-r2800-2"];
    keys.map(|key| find_in_catalogue(key).unwrap()).to_vec()
}

/// Franka's published arm with its limits.
fn panda() -> Robot {
    let limits = [
        [-2.8973, 2.8973],
        [-1.7628, 1.7628],
        [-2.8973, 2.8973],
        [-3.0718, -0.0698],
        [-2.8973, 2.8973],
        [-0.0175, 3.7525],
        [-2.8973, 2.8973],
    ];
    common::set_ups::panda().with_limits(&limits).unwrap()
}

fn flange(robot: &Robot, q: &[f64]) -> Isometry3<f64> {
    *Frames::new(robot, q).flange()
}

/// Controller angles spread over the limits.
fn within(robot: &Robot, dice: &mut Dice) -> Vec<f64> {
    let limits = robot.joints().iter().map(|j| j.limits);
    limits.map(|[low, high]| dice.between(low, high)).collect()
}

/// Errors of the pose of `q`: position \[m\] and rotation \[rad\].
fn pose_error(robot: &Robot, q: &[f64], pose: &Isometry3<f64>) -> f64 {
    let reached = flange(robot, q);
    let turn = (reached.rotation.inverse() * pose.rotation).imag().norm() * 2.0;
    let way = (reached.translation.vector - pose.translation.vector).norm();
    assert!(way.is_finite() && turn.is_finite());
    way.max(turn)
}

/// Largest difference of the serial angles, full turns aside \[rad\].
fn difference(robot: &Robot, a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (robot.serial_angles(a), robot.serial_angles(b));
    let apart = (a - b).map(|d| (d - (d / TAU).round() * TAU).abs());
    apart.amax()
}

fn is_among(robot: &Robot, q: &[f64], branches: &[Branch], tolerance: f64) -> bool {
    let near = |b: &Branch| difference(robot, &b.q, q) < tolerance;
    branches.iter().any(near)
}

/// What holds of the branches of any pose; the largest error of the pose.
fn check_branches(robot: &Robot, pose: &Isometry3<f64>, branches: &[Branch]) -> f64 {
    assert!(!branches.is_empty());
    let mut worst = 0.0_f64;
    for (i, branch) in branches.iter().enumerate() {
        worst = worst.max(pose_error(robot, &branch.q, pose));
        let inside = robot.outside_limits(&branch.q).is_none();
        assert_eq!(branch.within_limits, inside);
        assert_eq!(branch.singular, branch.condition > 1e6);
        assert!(branch.condition >= 0.99, "{}", branch.condition);
        let before = &branches[..i];
        assert!(!is_among(robot, &branch.q, before, 1e-7), "{branches:?}");
    }
    worst
}

fn unreachable(inverse: &InverseKinematics, pose: &Isometry3<f64>) -> Unreachable {
    match inverse.solve(pose).unwrap() {
        Outcome::Unreachable(unreachable) => unreachable,
        Outcome::Reachable(branches) => panic!("reached by {branches:?}"),
    }
}

/// Postures of a pose by plain Newton steps from random starts: nothing of the
/// library's inverse kinematics.
fn multi_start(robot: &Robot, pose: &Isometry3<f64>, starts: usize, dice: &mut Dice) -> Vec<Vec<f64>> {
    let n = robot.joint_count();
    let mut solutions: Vec<Vec<f64>> = Vec::new();
    for _ in 0..starts {
        let mut q = DVector::from_vec(dice.posture(n));
        for _ in 0..40 {
            let frames = Frames::new(robot, q.as_slice());
            let reached = frames.flange();
            let way = pose.translation.vector - reached.translation.vector;
            let turn = (pose.rotation * reached.rotation.inverse()).scaled_axis();
            let error = DVector::from_iterator(6, way.iter().chain(turn.iter()).copied());
            if error.norm() < 1e-12 {
                let mut earlier = solutions.iter();
                if earlier.all(|k| difference(robot, k, q.as_slice()) > 1e-5) {
                    solutions.push(q.as_slice().to_vec());
                }
                break;
            }
            let jacobian = frames.jacobian(&reached.translation.vector) * robot.coupling();
            let square = jacobian.tr_mul(&jacobian) + DMatrix::identity(n, n) * (1e-3 * error.norm_squared()).min(1e-2);
            let Some(step) = square.lu().solve(&(jacobian.tr_mul(&error))) else {
                break;
            };
            q += &step * (1.0 / step.amax()).min(1.0);
        }
    }
    solutions
}

/// Six angles with the COMAU's wrist at `bend` from straight.
fn with_wrist(bend: f64) -> Vec<f64> {
    vec![0.3, 0.2, -1.9, 0.7, bend, -0.4]
}
