//! Inverse kinematics: every posture of a pose, and what is said where there is none.

use crate::common;

use common::cases;
use common::random::Dice;
use nalgebra::{DMatrix, DVector, Isometry3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use stiffarm::Code;
use stiffarm::model::inverse::{Branch, InverseKinematics, Method, Outcome, Region, Unreachable};
use stiffarm::model::kinematics::Frames;
use stiffarm::model::robot::{DhConvention, DhRow, Robot, catalogue, find_in_catalogue};

fn robot(key: &str) -> Robot {
    find_in_catalogue(key).unwrap().robot().unwrap()
}

fn chain(name: &str, convention: DhConvention, rows: &[[f64; 4]]) -> Robot {
    let row = |r: &[f64; 4]| DhRow {
        alpha: r[0],
        a: r[1],
        d: r[2],
        offset: r[3],
    };
    let rows: Vec<DhRow> = rows.iter().map(row).collect();
    Robot::from_dh(name, convention, &rows, Isometry3::identity()).unwrap()
}

/// Universal Robots' published lengths, with axis 4 twisted against axis 3 \[rad\].
fn ur10(twist: f64) -> Robot {
    let rows = [
        [FRAC_PI_2, 0.0, 0.1273, 0.0],
        [0.0, -0.612, 0.0, 0.0],
        [twist, -0.5723, 0.0, 0.0],
        [FRAC_PI_2, 0.0, 0.163_941, 0.0],
        [-FRAC_PI_2, 0.0, 0.1157, 0.0],
        [0.0, 0.0, 0.0922, 0.0],
    ];
    chain("UR10", DhConvention::Standard, &rows)
}

/// Franka's published lengths and limits.
fn panda() -> Robot {
    let rows = [
        [0.0, 0.0, 0.333, 0.0],
        [-FRAC_PI_2, 0.0, 0.0, 0.0],
        [FRAC_PI_2, 0.0, 0.316, 0.0],
        [FRAC_PI_2, 0.0825, 0.0, 0.0],
        [-FRAC_PI_2, -0.0825, 0.384, 0.0],
        [FRAC_PI_2, 0.0, 0.0, 0.0],
        [FRAC_PI_2, 0.088, 0.107, 0.0],
    ];
    let limits = [
        [-2.8973, 2.8973],
        [-1.7628, 1.7628],
        [-2.8973, 2.8973],
        [-3.0718, -0.0698],
        [-2.8973, 2.8973],
        [-0.0175, 3.7525],
        [-2.8973, 2.8973],
    ];
    let robot = chain("Panda", DhConvention::Modified, &rows);
    robot.with_limits(&limits).unwrap()
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
fn multi_start(
    robot: &Robot,
    pose: &Isometry3<f64>,
    starts: usize,
    dice: &mut Dice,
) -> Vec<Vec<f64>> {
    let n = robot.joint_count();
    let mut found: Vec<Vec<f64>> = Vec::new();
    for _ in 0..starts {
        let mut q = DVector::from_vec(dice.posture(n));
        for _ in 0..40 {
            let frames = Frames::new(robot, q.as_slice());
            let reached = frames.flange();
            let way = pose.translation.vector - reached.translation.vector;
            let turn = (pose.rotation * reached.rotation.inverse()).scaled_axis();
            let error = DVector::from_iterator(6, way.iter().chain(turn.iter()).copied());
            if error.norm() < 1e-12 {
                let mut known = found.iter();
                if known.all(|k| difference(robot, k, q.as_slice()) > 1e-5) {
                    found.push(q.as_slice().to_vec());
                }
                break;
            }
            let jacobian = frames.jacobian(&reached.translation.vector) * robot.coupling();
            let square = jacobian.tr_mul(&jacobian)
                + DMatrix::identity(n, n) * (1e-3 * error.norm_squared()).min(1e-2);
            let Some(step) = square.lu().solve(&(jacobian.tr_mul(&error))) else {
                break;
            };
            q += &step * (1.0 / step.amax()).min(1.0);
        }
    }
    found
}

#[test]
fn every_arm_of_the_catalogue_is_solved_in_closed_form() {
    for entry in catalogue() {
        let robot = entry.robot().unwrap();
        let inverse = InverseKinematics::new(&robot);
        assert_eq!(inverse.method(), Method::ClosedForm, "{}", entry.key);
        let mut dice = Dice::new(11);
        let (mut worst, mut most) = (0.0_f64, 0);
        for _ in 0..10_000 {
            let q = within(&robot, &mut dice);
            let pose = flange(&robot, &q);
            let branches = inverse.branches(&pose).unwrap();
            worst = worst.max(check_branches(&robot, &pose, &branches));
            let found = branches.iter().map(|b| (difference(&robot, &b.q, &q), b));
            let (nearest, branch) = found.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            // Rounding of the pose moves the posture by the condition number.
            assert!(
                nearest < 1e-12 * branch.condition.max(100.0),
                "{}: {nearest:e} at {q:?}",
                entry.key
            );
            most = most.max(branches.len());
        }
        println!("{:<20} FK(IK) {worst:.1e}", entry.key);
        assert!(worst <= 1e-12, "{}: {worst:e}", entry.key);
        assert_eq!(most, 8, "{}", entry.key);
    }
}

#[test]
fn no_branch_is_missed() {
    let mut robots: Vec<Robot> = catalogue().iter().map(|e| e.robot().unwrap()).collect();
    robots.push(ur10(0.0));
    for robot in &robots {
        let inverse = InverseKinematics::new(robot);
        let mut dice = Dice::new(5);
        let (mut ours, mut theirs) = (0, 0);
        for _ in 0..40 {
            let pose = flange(robot, &dice.posture(6));
            let branches = inverse.branches(&pose).unwrap();
            let found = multi_start(robot, &pose, 200, &mut dice);
            for q in &found {
                assert!(
                    is_among(robot, q, &branches, 1e-5),
                    "{}: {q:?} is missing from {branches:?}",
                    robot.name()
                );
            }
            ours += branches.len();
            theirs += found.len();
        }
        println!("{:<24} {ours} branches, {theirs} found", robot.name());
        // The search itself must be one that would notice.
        assert!(theirs as f64 > 0.95 * ours as f64, "{theirs} of {ours}");
    }
}

#[test]
fn a_calibrated_arm_is_solved_numerically() {
    let mut dice = Dice::new(8);
    // COMAU's rows with errors as a calibration finds them.
    let mut rows = [
        [0.0, 0.0, 0.83, 0.0],
        [-FRAC_PI_2, 0.4, 0.0, -FRAC_PI_2],
        [0.0, 1.175, 0.0, -FRAC_PI_2],
        [-FRAC_PI_2, 0.25, 1.444, 0.0],
        [FRAC_PI_2, 0.0, 0.0, 0.0],
        [-FRAC_PI_2, 0.0, 0.23, PI],
    ];
    for row in &mut rows {
        for value in row {
            *value += 2e-3 * dice.normal();
        }
    }
    let robot = chain("calibrated", DhConvention::Modified, &rows)
        .with_coupling(robot("comau-nj165-3.0").coupling().clone())
        .unwrap();
    let inverse = InverseKinematics::new(&robot);
    assert_eq!(inverse.method(), Method::Numeric);
    let mut counts = [0; 2];
    for i in 0..200 {
        let q = dice.posture(6);
        let pose = flange(&robot, &q);
        let branches = inverse.branches(&pose).unwrap();
        assert!(check_branches(&robot, &pose, &branches) < 1e-10);
        counts[0] += usize::from(is_among(&robot, &q, &branches, 1e-6));
        if i < 20 {
            for q in multi_start(&robot, &pose, 100, &mut dice) {
                counts[1] += usize::from(!is_among(&robot, &q, &branches, 1e-5));
            }
        }
    }
    assert_eq!(counts, [200, 0]);
}

#[test]
fn arms_without_a_closed_form_are_solved_numerically() {
    // No two axes parallel, no two that meet.
    let rows = [
        [0.3, 0.1, 0.4, 0.2],
        [-1.3, 0.3, 0.1, 0.0],
        [0.4, 0.6, -0.1, 0.5],
        [-1.1, 0.15, 0.5, 0.0],
        [1.4, 0.1, 0.1, 0.0],
        [-1.2, 0.05, 0.2, 0.3],
    ];
    let robot = chain("general", DhConvention::Modified, &rows);
    let inverse = InverseKinematics::new(&robot);
    assert_eq!(inverse.method(), Method::Numeric);
    let mut dice = Dice::new(2);
    for _ in 0..30 {
        let q = dice.posture(6);
        let pose = flange(&robot, &q);
        let branches = inverse.branches(&pose).unwrap();
        assert!(check_branches(&robot, &pose, &branches) < 1e-10);
        for found in multi_start(&robot, &pose, 60, &mut dice) {
            assert!(is_among(&robot, &found, &branches, 1e-5), "{found:?}");
        }
        // Same bytes each time.
        assert_eq!(
            branches,
            InverseKinematics::new(&robot).branches(&pose).unwrap()
        );
    }
}

#[test]
fn panda_is_solved_numerically() {
    let robot = panda();
    let inverse = InverseKinematics::new(&robot);
    assert_eq!(inverse.method(), Method::Numeric);
    let mut dice = Dice::new(7);
    for i in 0..1000 {
        let q = within(&robot, &mut dice);
        let pose = flange(&robot, &q);
        // From anywhere.
        let led = inverse.nearest(&pose, &within(&robot, &mut dice)).unwrap();
        assert!(robot.outside_limits(&led).is_none());
        assert!(pose_error(&robot, &led, &pose) < 1e-10);
        if i % 4 == 0 {
            let branches = inverse.branches(&pose).unwrap();
            assert!(check_branches(&robot, &pose, &branches) < 1e-10);
            assert!(branches.iter().all(|b| b.within_limits), "{i}");
        }
    }
    // Every posture of it stretched: 855 mm above the shoulder with wrist and flange.
    let pose = flange(&robot, &[0.0, 0.0, 0.0, -0.0698, 0.0, 1.2, 0.0]);
    let far = Translation3::new(0.0, 0.0, 3.0) * pose;
    let missing = unreachable(&inverse, &far);
    assert_eq!(
        (missing.region, missing.rotation_rad),
        (Region::Outside, 0.0)
    );
    assert!((2.9..3.1).contains(&missing.distance_m), "{missing:?}");
}

#[test]
fn fewer_joints_reach_their_own_poses() {
    let rows = [
        [0.0, 0.0, 0.3, 0.0],
        [-FRAC_PI_2, 0.1, 0.0, 0.0],
        [0.0, 0.5, 0.0, 0.0],
        [-FRAC_PI_2, 0.0, 0.4, 0.0],
    ];
    let robot = chain("palletiser", DhConvention::Modified, &rows);
    let inverse = InverseKinematics::new(&robot);
    let mut dice = Dice::new(12);
    for _ in 0..20 {
        let q = dice.posture(4);
        let pose = flange(&robot, &q);
        let branches = inverse.branches(&pose).unwrap();
        assert!(check_branches(&robot, &pose, &branches) < 1e-9);
        assert!(is_among(&robot, &q, &branches, 1e-5));
    }
    // Its three directions of axes give any orientation, elsewhere.
    let tilted = UnitQuaternion::from_scaled_axis(Vector3::new(0.3, 0.2, 0.0));
    let pose = flange(&robot, &[0.2, 0.3, 0.4, 0.5]) * tilted;
    let missing = unreachable(&inverse, &pose);
    assert_eq!(missing.rotation_rad, 0.0);
    assert!(
        missing.distance_m > 0.01 && missing.distance_m < 0.5,
        "{missing:?}"
    );

    // Parallel axes give none but turns about them.
    let rows = [
        [0.0, 0.0, 0.1, 0.0],
        [0.0, 0.5, 0.0, 0.0],
        [0.0, 0.4, 0.1, 0.0],
    ];
    let robot = chain("planar", DhConvention::Modified, &rows);
    let inverse = InverseKinematics::new(&robot);
    let pose = flange(&robot, &[0.2, 0.9, 0.4]);
    assert_eq!(inverse.branches(&pose).unwrap().len(), 2);
    let above = Translation3::new(0.0, 0.0, 0.25) * pose;
    let missing = unreachable(&inverse, &above);
    assert_eq!(missing.rotation_rad, 0.0);
    assert!((missing.distance_m - 0.25).abs() < 1e-9, "{missing:?}");
    let pose = pose * tilted;
    let missing = unreachable(&inverse, &pose);
    let tilt = tilted.angle();
    assert!(
        missing.rotation_rad > 0.5 * tilt && missing.rotation_rad < tilt + 1e-6,
        "{missing:?}"
    );
    let error = inverse.branches(&pose).unwrap_err();
    assert_eq!(error.code(), Code::Unreachable);
    assert!(error.message().contains("° away."), "{error}");
}

/// Six angles with the COMAU's wrist at `bend` from straight.
fn with_wrist(bend: f64) -> Vec<f64> {
    vec![0.3, 0.2, -1.9, 0.7, bend, -0.4]
}

#[test]
fn singular_poses_give_a_representative() {
    for entry in catalogue() {
        let robot = entry.robot().unwrap();
        let inverse = InverseKinematics::new(&robot);
        let mut dice = Dice::new(3);
        for bend in [0.0, 1e-13, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2] {
            for _ in 0..50 {
                let mut q = dice.posture(6);
                q[4] = bend;
                let pose = flange(&robot, &q);
                let branches = inverse.branches(&pose).unwrap();
                let worst = check_branches(&robot, &pose, &branches);
                assert!(worst < 1e-11, "{worst:e} at {bend:e}");
                let straight = branches.iter().filter(|b| b.singular).count();
                // Between, the rest of the posture decides.
                if !(1e-7..1e-3).contains(&bend) {
                    assert_eq!(straight > 0, bend < 1e-7, "{bend:e} {branches:?}");
                }
                if bend == 0.0 {
                    // One stands for the two flips, which are one family here.
                    assert!(branches.len() <= 7, "{branches:?}");
                }
            }
        }
    }
}

/// The elbow's angle at which the robot is stretched or folded: axes 2 and 3
/// and the wrist's centre in a plane.
fn stretched(robot: &Robot, mut q: Vec<f64>, folded: bool) -> Vec<f64> {
    let reach = |q: &[f64]| {
        let frames = Frames::new(robot, q);
        (frames.wrist_centre() - frames.origins()[1]).norm()
    };
    let value = |q3: f64| {
        let mut q = q.clone();
        q[2] = q3;
        if folded { -reach(&q) } else { reach(&q) }
    };
    // A third of a turn each way holds one maximum only.
    let mut centre = 0.0;
    for i in 0..360 {
        if value(f64::from(i).to_radians()) > value(centre) {
            centre = f64::from(i).to_radians();
        }
    }
    let mut half = 0.02;
    while half > 1e-12 {
        // Parabola through three points.
        let [a, b, c] = [centre - half, centre, centre + half].map(value);
        let bend = a - 2.0 * b + c;
        if bend >= 0.0 {
            break;
        }
        centre += (0.5 * half * (a - c) / bend).clamp(-half, half);
        half *= 0.1;
        if half < 1e-5 {
            break;
        }
    }
    q[2] = centre;
    q
}

#[test]
fn stretched_arms_and_wrists_above_axis_one() {
    for entry in catalogue() {
        let robot = entry.robot().unwrap();
        let inverse = InverseKinematics::new(&robot);
        let mut dice = Dice::new(9);
        for folded in [false, true] {
            for _ in 0..20 {
                let q = stretched(&robot, dice.posture(6), folded);
                let pose = flange(&robot, &q);
                let branches = inverse.branches(&pose).unwrap();
                assert!(check_branches(&robot, &pose, &branches) < 1e-9);
                // Half the digits of a stretched elbow are lost in any pose.
                assert!(is_among(&robot, &q, &branches, 1e-5), "{q:?}");
            }
        }
        // Wrist centre on axis 1: any θ1 will do.
        for _ in 0..20 {
            let mut q = dice.posture(6);
            let out = |q2: f64| {
                let mut q = q.clone();
                q[1] = q2;
                let frames = Frames::new(&robot, &q);
                let z = frames.axes()[0];
                let side = z.cross(&frames.axes()[1]);
                (frames.wrist_centre() - frames.origins()[0]).dot(&side)
            };
            let steps: Vec<f64> = (0..=72).map(|i| f64::from(i) * TAU / 72.0).collect();
            let Some(pair) = steps.windows(2).find(|p| out(p[0]) * out(p[1]) < 0.0) else {
                continue;
            };
            let [mut low, mut high] = [pair[0], pair[1]];
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if out(low) * out(middle) <= 0.0 {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            q[1] = low;
            let pose = flange(&robot, &q);
            let branches = inverse.branches(&pose).unwrap();
            assert!(check_branches(&robot, &pose, &branches) < 1e-10);
            assert!(branches.iter().any(|b| b.singular));
            // Free angles stay near the start.
            let near = inverse.nearest(&pose, &q);
            if let Ok(near) = near {
                assert!(pose_error(&robot, &near, &pose) < 1e-10);
            }
        }
    }
    // Straight wrist: the start's own angles, although any sum of 4 and 6 holds.
    let robot = robot("comau-nj165-3.0");
    let inverse = InverseKinematics::new(&robot);
    let q = with_wrist(0.0);
    let near = inverse.nearest(&flange(&robot, &q), &q).unwrap();
    assert!(
        near.iter().zip(&q).all(|(a, b)| (a - b).abs() < 1e-9),
        "{near:?}"
    );
}

/// Smallest distance of the flange's position under any posture that keeps the
/// orientation, by a coarse grid of three joints and a refined one: the wrist
/// of these arms can always give the orientation.
fn distance_by_grid(robot: &Robot, pose: &Isometry3<f64>) -> f64 {
    // The wrist's centre asked for, from the flange's frame.
    let frames = Frames::new(robot, &[0.0; 6]);
    let centre_in_flange =
        frames.flange().inverse() * nalgebra::Point3::from(frames.wrist_centre());
    let goal = (pose * centre_in_flange).coords;
    let away = |q: &[f64; 3]| {
        let frames = Frames::new(robot, &[q[0], q[1], q[2], 0.0, 0.0, 0.0]);
        (frames.wrist_centre() - goal).norm()
    };
    let mut best = ([0.0; 3], f64::INFINITY);
    const STEPS: i32 = 24;
    for i in 0..STEPS.pow(3) {
        let digit = |k: i32| f64::from(i / STEPS.pow(k as u32) % STEPS) * TAU / f64::from(STEPS);
        let q = [digit(0), digit(1), digit(2)];
        let value = away(&q);
        if value < best.1 {
            best = (q, value);
        }
    }
    let mut step = TAU / f64::from(STEPS);
    while step > 1e-8 {
        let before = best.1;
        for i in 0..27 {
            let move_by = |k: u32| f64::from(i / 3_i32.pow(k) % 3 - 1) * step;
            let q = [0, 1, 2].map(|k| best.0[k] + move_by(k as u32));
            let value = away(&q);
            if value < best.1 {
                best = (q, value);
            }
        }
        if best.1 == before {
            step *= 0.5;
        }
    }
    best.1
}

#[test]
fn unreachable_poses_say_how_far() {
    for entry in catalogue() {
        let robot = entry.robot().unwrap();
        let inverse = InverseKinematics::new(&robot);
        let mut dice = Dice::new(21);
        let mut regions = Vec::new();
        let mut compared = 0;
        for i in 0..60 {
            let half = if i % 2 == 0 { 6.0 } else { 0.7 };
            let mut pose = dice.pose();
            pose.translation = Translation3::from(dice.vector(half));
            let Outcome::Unreachable(missing) = inverse.solve(&pose).unwrap() else {
                continue;
            };
            let expected = distance_by_grid(&robot, &pose);
            assert!(
                (missing.distance_m - expected).abs() < 1e-6,
                "{}: {missing:?}, {expected}",
                entry.key
            );
            assert_eq!(missing.rotation_rad, 0.0);
            regions.push(missing.region);
            compared += 1;
            let error = inverse.nearest(&pose, &[0.0; 6]).unwrap_err();
            assert_eq!(error.code(), Code::Unreachable);
        }
        assert!(compared > 15, "{compared}");
        assert!(regions.contains(&Region::Beyond));
    }
}

#[test]
fn sentences_of_unreachable_poses() {
    let robot = robot("comau-nj165-3.0");
    let inverse = InverseKinematics::new(&robot);
    let at = |x: f64, y: f64, z: f64| Isometry3::translation(x, y, z);
    let far = inverse.branches(&at(4.0, 0.0, 1.5)).unwrap_err();
    assert_eq!(far.code(), Code::Unreachable);
    // Flange axis up: the wrist centre lies 230 mm below; shoulder at (400, 830).
    let long = 1.175 + 0.25_f64.hypot(1.444);
    let distance = 3.6_f64.hypot(1.5 - 0.23 - 0.83) - long;
    assert_eq!(
        far.message(),
        format!(
            "The pose lies {:.1} mm beyond the arm's reach.",
            distance * 1e3
        )
    );
    assert!(far.hint_text().is_some());
    // Without the shoulder's offset the backward posture does not help.
    let rows = [
        [0.0, 0.0, 0.83, 0.0],
        [-FRAC_PI_2, 0.0, 0.0, 0.0],
        [0.0, 1.175, 0.0, 0.0],
        [-FRAC_PI_2, 0.25, 1.444, 0.0],
        [FRAC_PI_2, 0.0, 0.0, 0.0],
        [-FRAC_PI_2, 0.0, 0.23, 0.0],
    ];
    let upright = InverseKinematics::new(&chain("upright", DhConvention::Modified, &rows));
    let folded = upright.branches(&at(0.1, 0.0, 0.83 + 0.23)).unwrap_err();
    let short = (1.175 - 0.25_f64.hypot(1.444)).abs() - 0.1;
    assert_eq!(
        folded.message(),
        format!(
            "The pose lies {:.1} mm inside the hole about the axis of joint 2 that the folded arm leaves.",
            short * 1e3
        )
    );
    // A lateral offset leaves a hole about axis 1.
    let inverse = InverseKinematics::new(&ur10(0.0));
    let hole = inverse.branches(&at(0.0, 0.0, 0.5)).unwrap_err();
    assert!(
        hole.message()
            .ends_with("mm inside the hole about the axis of joint 1."),
        "{hole}"
    );

    // Reachable, but joint 2 or 3 would leave its limits.
    let inverse = InverseKinematics::new(&robot);
    let mut dice = Dice::new(1);
    let (q, branches) = (0..100)
        .map(|_| dice.posture(6))
        .map(|q| (q.clone(), inverse.branches(&flange(&robot, &q)).unwrap()))
        .find(|(_, branches)| branches.iter().all(|b| !b.within_limits))
        .unwrap();
    let pose = flange(&robot, &q);
    let error = inverse.nearest(&pose, &q).unwrap_err();
    assert_eq!(error.code(), Code::OutsideLimits);
    // By hand: the least of the largest excesses.
    let limits: Vec<[f64; 2]> = robot.joints().iter().map(|j| j.limits).collect();
    let excess = |b: &Branch| {
        let pairs = b.q.iter().zip(&limits);
        pairs
            .map(|(q, l)| (l[0] - q).max(q - l[1]))
            .fold(f64::NEG_INFINITY, f64::max)
    };
    let least = branches.iter().map(excess).fold(f64::INFINITY, f64::min);
    let text = format!("{:.1}° outside the machine's limits", least.to_degrees());
    assert!(error.message().contains(&text), "{error}");
    assert!(
        error.message().starts_with("The pose takes joint "),
        "{error}"
    );
}

#[test]
fn ur10_has_its_branches_in_closed_form() {
    let place = Isometry3::from_parts(
        Translation3::new(0.3, -1.0, 2.0),
        UnitQuaternion::from_scaled_axis(Vector3::new(2.0, 0.4, -1.0)),
    );
    for robot in [ur10(0.0), ur10(0.0).with_base(&place)] {
        let inverse = InverseKinematics::new(&robot);
        assert_eq!(inverse.method(), Method::ClosedForm);
        let mut dice = Dice::new(4);
        let mut counts = [0; 9];
        for _ in 0..2000 {
            let q = dice.posture(6);
            let pose = flange(&robot, &q);
            let branches = inverse.branches(&pose).unwrap();
            assert!(check_branches(&robot, &pose, &branches) < 1e-12);
            assert!(is_among(&robot, &q, &branches, 1e-6), "{q:?}");
            counts[branches.len()] += 1;
        }
        assert!(counts[8] > 500, "{counts:?}");
        // Wrist straight.
        let mut q = dice.posture(6);
        q[4] = 0.0;
        let pose = flange(&robot, &q);
        let branches = inverse.branches(&pose).unwrap();
        assert!(check_branches(&robot, &pose, &branches) < 1e-10);
        assert!(branches.iter().any(|b| b.singular));
    }
}

/// An arm a little beside its family is searched numerically: two ways to the
/// same distance.
#[test]
fn distances_agree_between_both_methods() {
    let six = |twist: f64| {
        let rows = [
            [0.0, 0.0, 0.83, 0.0],
            [-FRAC_PI_2, 0.4, 0.0, -FRAC_PI_2],
            [twist, 1.175, 0.0, -FRAC_PI_2],
            [-FRAC_PI_2, 0.25, 1.444, 0.0],
            [FRAC_PI_2, 0.0, 0.0, 0.0],
            [-FRAC_PI_2, 0.0, 0.23, PI],
        ];
        chain("six", DhConvention::Modified, &rows)
    };
    for (robot, beside) in [(ur10(0.0), ur10(3e-8)), (six(0.0), six(3e-8))] {
        let exact = InverseKinematics::new(&robot);
        let numeric = InverseKinematics::new(&beside);
        assert_eq!(
            (exact.method(), numeric.method()),
            (Method::ClosedForm, Method::Numeric)
        );
        let mut dice = Dice::new(6);
        let mut compared = 0;
        for i in 0..16 {
            let mut pose = dice.pose();
            pose.translation = Translation3::from(dice.vector(if i % 2 == 0 { 5.0 } else { 0.3 }));
            let Outcome::Unreachable(expected) = exact.solve(&pose).unwrap() else {
                continue;
            };
            let missing = unreachable(&numeric, &pose);
            assert_eq!(missing.rotation_rad, 0.0);
            assert!(
                (missing.distance_m - expected.distance_m).abs() < 1e-5,
                "{}: {missing:?} {expected:?}",
                robot.name()
            );
            compared += 1;
        }
        assert!(compared > 5, "{compared}");
    }
}

#[test]
fn turns_within_the_limits() {
    let robot = robot("comau-nj165-3.0");
    let inverse = InverseKinematics::new(&robot);
    let q = with_wrist(0.5);
    let all = inverse.turns_within_limits(&q);
    // ±720° of joints 4 and 6 hold four turns each, the other joints one.
    assert_eq!(all.len(), 16);
    for turned in &all {
        assert!(robot.outside_limits(turned).is_none());
        assert!(difference(&robot, turned, &q) < 1e-12);
        assert!(pose_error(&robot, turned, &flange(&robot, &q)) < 1e-12);
    }
    let mut near = q.clone();
    near[3] += 2.0 * TAU;
    near[5] -= 4.0 * TAU;
    let turned = inverse.turns_near(&q, &near).unwrap();
    // Joint 6 at −0.4 rad goes down one turn only: two would pass −720°.
    assert!((turned[3] - q[3] - TAU).abs() < 1e-12, "{turned:?}");
    assert!((turned[5] - q[5] + TAU).abs() < 1e-12, "{turned:?}");
    let mut outside = q.clone();
    outside[1] = 2.0;
    assert_eq!(inverse.turns_near(&outside, &q), None);
    assert!(inverse.turns_within_limits(&outside).is_empty());
    assert_eq!(inverse.turns_near(&q[..5], &q), None);
    assert!(inverse.turns_within_limits(&[f64::NAN; 6]).is_empty());
    // Without known limits ±360° stand in.
    let free = InverseKinematics::new(&ur10(0.0));
    assert_eq!(free.turns_within_limits(&[1.0; 6]).len(), 64);
}

/// A wrist whose gears are coupled by a fraction: a turn of θ4 moves q5 as well.
#[test]
fn turns_of_coupled_gears() {
    let plain = robot("kuka-kr500-r2830");
    let mut coupling = plain.coupling().clone();
    coupling[(4, 3)] = 0.375;
    coupling[(5, 4)] = -0.25;
    let limits: Vec<[f64; 2]> = [2.0, 1.5, 2.0, 8.0, 9.0, 7.0].map(|l| [-l, l]).to_vec();
    let robot = plain
        .with_coupling(coupling)
        .unwrap()
        .with_limits(&limits)
        .unwrap();
    let inverse = InverseKinematics::new(&robot);
    let mut dice = Dice::new(15);
    for _ in 0..20 {
        let q = within(&robot, &mut dice);
        let pose = flange(&robot, &q);
        let all = inverse.turns_within_limits(&q);
        // Every lattice point by hand.
        let mut expected = 0;
        for i in 0..11_i32.pow(3) {
            let turns = [0, 1, 2].map(|k| f64::from(i / 11_i32.pow(k) % 11 - 5) * TAU);
            let whole = DVector::from_vec(vec![0.0, 0.0, 0.0, turns[0], turns[1], turns[2]]);
            let moved = robot.coupling().clone().lu().solve(&whole).unwrap();
            let turned: Vec<f64> = q.iter().zip(&moved).map(|(a, b)| a + b).collect();
            if robot.outside_limits(&turned).is_none() {
                expected += 1;
                let near = |other: &Vec<f64>| {
                    let pairs = other.iter().zip(&turned);
                    pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) < 1e-9
                };
                assert_eq!(all.iter().filter(|a| near(a)).count(), 1);
            }
        }
        assert_eq!(all.len(), expected);
        assert!(all.iter().all(|a| pose_error(&robot, a, &pose) < 1e-12));
        let branches = inverse.branches(&pose).unwrap();
        assert!(check_branches(&robot, &pose, &branches) < 1e-12);
        assert!(branches.iter().any(|b| b.within_limits));
        let near = inverse.nearest(&pose, &q).unwrap();
        assert!(near.iter().zip(&q).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}

#[test]
fn a_line_is_followed() {
    for robot in [
        robot("comau-nj165-3.0"),
        robot("fanuc-r2000ic-165f"),
        panda(),
        ur10(0.0),
    ] {
        let inverse = InverseKinematics::new(&robot);
        let start = match robot.joint_count() {
            7 => vec![0.2, 0.3, -0.1, -1.8, 0.2, 2.0, 0.4],
            _ if robot.name().starts_with("FANUC") => vec![0.3, 0.2, 0.1, 0.7, 0.8, -0.4],
            _ if robot.name() == "UR10" => vec![0.3, -1.2, 1.6, -1.0, -1.5, 0.2],
            _ => vec![0.3, 0.2, -1.9, 0.7, 0.8, -0.4],
        };
        let first = flange(&robot, &start);
        let (mut led, mut chosen) = (start.clone(), start.clone());
        for i in 1..=200 {
            let share = f64::from(i) / 200.0;
            let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.1, -0.2, 0.3) * share);
            let way = Vector3::new(-0.1, 0.15, 0.1) * share;
            let pose = Isometry3::from_parts(
                Translation3::from(first.translation.vector + way),
                turn * first.rotation,
            );
            led = inverse
                .follow(&pose, &led)
                .unwrap_or_else(|e| panic!("{} at {i}: {e}", robot.name()));
            let before = chosen.clone();
            chosen = inverse.nearest(&pose, &chosen).unwrap();
            assert!(pose_error(&robot, &led, &pose) < 1e-11);
            assert!(pose_error(&robot, &chosen, &pose) < 1e-11);
            let pairs = chosen.iter().zip(&before);
            let change = pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(change < 0.05, "{}: {change}", robot.name());
            if robot.joint_count() == 6 {
                let pairs = chosen.iter().zip(&led);
                assert!(
                    pairs.clone().all(|(a, b)| (a - b).abs() < 1e-8),
                    "{}",
                    robot.name()
                );
            }
        }
        let far = Translation3::new(30.0, 0.0, 0.0) * first;
        let error = inverse.follow(&far, &led).unwrap_err();
        assert_eq!(error.code(), Code::Unreachable);
    }
}

#[test]
fn nearest_is_the_nearest_of_all_turns() {
    let robot = robot("comau-nj165-3.0");
    let inverse = InverseKinematics::new(&robot);
    let mut dice = Dice::new(31);
    for _ in 0..300 {
        let pose = flange(&robot, &within(&robot, &mut dice));
        let start = within(&robot, &mut dice);
        let near = inverse.nearest(&pose, &start).unwrap();
        assert!(robot.outside_limits(&near).is_none());
        let change = |q: &[f64]| {
            let pairs = q.iter().zip(&start);
            pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()))
        };
        let branches = inverse.branches(&pose).unwrap();
        let all = branches
            .iter()
            .flat_map(|b| inverse.turns_within_limits(&b.q));
        let least = all.map(|q| change(&q)).fold(f64::INFINITY, f64::min);
        assert!((change(&near) - least).abs() < 1e-9);
    }
}

#[test]
fn input_that_is_not_finite_is_refused() {
    let inverse = InverseKinematics::new(&robot("comau-nj165-3.0"));
    let mut pose = Isometry3::identity();
    pose.translation.vector.y = f64::NAN;
    for error in [
        inverse.branches(&pose).unwrap_err(),
        inverse.solve(&pose).unwrap_err(),
        inverse.nearest(&pose, &[0.0; 6]).unwrap_err(),
        inverse.follow(&pose, &[0.0; 6]).unwrap_err(),
        inverse
            .nearest(&Isometry3::translation(2.0, 0.0, 1.0), &[f64::INFINITY; 6])
            .unwrap_err(),
    ] {
        assert_eq!(error.code(), Code::NotFinite);
    }
    let error = inverse
        .follow(&Isometry3::identity(), &[0.0; 5])
        .unwrap_err();
    assert_eq!(error.code(), Code::Dimension);
    // Numbers whose squares overflow.
    let endless = Isometry3::translation(1e300, 0.0, 1.0);
    for robot in [robot("comau-nj165-3.0"), panda()] {
        let inverse = InverseKinematics::new(&robot);
        match inverse.solve(&endless) {
            Ok(Outcome::Unreachable(missing)) => assert!(missing.distance_m > 1e299),
            Ok(outcome) => panic!("{outcome:?}"),
            Err(error) => assert_eq!(error.code(), Code::Numerical),
        }
    }
    // A base that is not finite gives an error, neither a panic nor a posture.
    let robot = robot("comau-nj165-3.0").with_base(&pose);
    let broken = InverseKinematics::new(&robot);
    assert!(broken.branches(&Isometry3::identity()).is_err());
}

/// A random arm with a spherical wrist or three parallel axes.
fn random_arm(dice: &mut Dice, three_parallel: bool) -> Robot {
    let right = |dice: &mut Dice| dice.signed(1.0, 1.0) * FRAC_PI_2;
    let straight = |dice: &mut Dice| if dice.chance(0.5) { PI } else { 0.0 };
    // Axis 1 at any angle to axis 2.
    let shoulder = if dice.chance(0.5) {
        right(dice)
    } else {
        dice.signed(0.3, 2.8)
    };
    let mut rows = [
        [
            dice.between(-PI, PI),
            dice.signed(0.0, 0.4),
            dice.between(-0.5, 0.5),
        ],
        [shoulder, dice.signed(0.0, 0.5), dice.signed(0.0, 0.3)],
        [straight(dice), dice.signed(0.3, 1.3), dice.signed(0.0, 0.3)],
        [right(dice), dice.signed(0.05, 0.4), dice.signed(0.3, 1.4)],
        [right(dice), 0.0, 0.0],
        [right(dice), 0.0, dice.signed(0.0, 0.3)],
    ];
    if three_parallel {
        rows[3] = [straight(dice), dice.signed(0.3, 1.3), dice.signed(0.0, 0.4)];
        rows[4] = [right(dice), 0.0, dice.signed(0.05, 0.3)];
        if dice.chance(0.5) {
            rows[4][1] = dice.signed(0.01, 0.2);
        }
    }
    let rows: Vec<DhRow> = rows
        .iter()
        .map(|[alpha, a, d]| DhRow {
            alpha: *alpha,
            a: *a,
            d: *d,
            offset: dice.between(-PI, PI),
        })
        .collect();
    let mut coupling = DMatrix::from_fn(
        6,
        6,
        |i, j| {
            if i == j { dice.signed(1.0, 1.0) } else { 0.0 }
        },
    );
    coupling[(2, 1)] = (dice.below(3) as f64) - 1.0;
    coupling[(5, 4)] = (dice.below(3) as f64) - 1.0;
    Robot::from_dh("random", DhConvention::Modified, &rows, dice.pose())
        .unwrap()
        .with_coupling(coupling)
        .unwrap()
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn random_arms_of_both_families(seed in any::<u64>(), three_parallel in any::<bool>()) {
        let mut dice = Dice::new(seed);
        let robot = random_arm(&mut dice, three_parallel);
        let inverse = InverseKinematics::new(&robot);
        prop_assert_eq!(inverse.method(), Method::ClosedForm);
        for _ in 0..20 {
            let q = dice.posture(6);
            let pose = flange(&robot, &q);
            let branches = inverse.branches(&pose).unwrap();
            prop_assert!(branches.len() <= 8);
            let worst = check_branches(&robot, &pose, &branches);
            prop_assert!(worst < 1e-11, "{worst:e}");
            let nearest = branches
                .iter()
                .map(|b| difference(&robot, &b.q, &q) / b.condition)
                .fold(f64::INFINITY, f64::min);
            prop_assert!(nearest < 1e-11, "{nearest:e}");
        }
        // Away from the arm: out of reach, and never a number that is not one.
        let far = Translation3::from(dice.direction() * 20.0) * dice.pose();
        let missing = unreachable(&inverse, &far);
        prop_assert!(missing.distance_m > 5.0 && missing.distance_m < 25.0);
        prop_assert!(inverse.branches(&far).is_err());
    }
}
