//! Postures along paths: continuity, limits, branches, and the free turn about
//! the tool axis.

use crate::common::cases::slip;
use crate::common::prelude::*;
use nalgebra::UnitVector3;
use stiffarm::model::path::{PathPoint, PathTarget};
use stiffarm::model::process::{ProcessLoad, TipLoad};
use stiffarm::work::posture_path::{Origin, PosturePathOptions, PosturePathSummary, posture_path};

fn arm(cell: &Cell) -> LoadedArm {
    LoadedArm::from_stiffness(cell, cell.require_prior().unwrap()).unwrap()
}

/// The default cell, whose bounds are the machine's limits.
fn unbounded() -> Cell {
    let mut cell = default_cell();
    let joints = cell.setup.robot.joints().iter();
    cell.bounds = joints.map(|joint| joint.limits).collect();
    cell
}

fn point(i: usize, target: PathTarget) -> PathPoint {
    PathPoint { line: Some(i + 2), ..path_point(i + 1, target) }
}

/// The tool points down onto a circle in front of the robot.
fn circle(count: usize) -> Vec<Isometry3<f64>> {
    let down = UnitQuaternion::from_euler_angles(PI, 0.0, 0.0);
    (0..count)
        .map(|i| {
            let angle = std::f64::consts::TAU * i as f64 / (count - 1) as f64;
            let at = Vector3::new(1.9 + 0.25 * angle.cos(), 0.25 * angle.sin(), 0.8);
            Isometry3::from_parts(at.into(), down)
        })
        .collect()
}

fn poses(poses: &[Isometry3<f64>]) -> Vec<PathPoint> {
    let targets = poses.iter().map(|pose| PathTarget::Pose(*pose));
    targets.enumerate().map(|(i, t)| point(i, t)).collect()
}

fn milling() -> Option<ProcessLoad> {
    let load = TipLoad { force: Vector3::new(-180.0, 240.0, -60.0), moment: Vector3::zeros(), axes: ForceAxes::Path };
    Some(load.into())
}

fn run(
    cell: &Cell,
    points: &[PathPoint],
    options: &PosturePathOptions,
) -> stiffarm::Result<(Vec<LoadedPosture>, PosturePathSummary)> {
    let inverse = InverseKinematics::new(&cell.setup.robot);
    posture_path(&arm(cell), &inverse, points, options, Control::default())
}

/// Distance of the tips from their poses, up to a turn about z where it is free.
fn worst_gap(cell: &Cell, postures: &[LoadedPosture], poses: &[Isometry3<f64>], free: bool) -> f64 {
    let arm = arm(cell);
    let gaps = postures.iter().zip(poses).map(|(posture, pose)| {
        let tip = arm.tip_pose(&posture.q);
        let shift = (tip.translation.vector - pose.translation.vector).norm();
        let turn = if free {
            (tip.rotation * Vector3::z() - pose.rotation * Vector3::z()).norm()
        } else {
            tip.rotation.angle_to(&pose.rotation)
        };
        shift.max(turn)
    });
    gaps.fold(0.0, f64::max)
}

fn assert_continuous(cell: &Cell, postures: &[LoadedPosture], step: f64) {
    for pair in postures.windows(2) {
        for (a, b) in pair[0].q.iter().zip(&pair[1].q) {
            assert!((b - a).abs() <= step);
        }
    }
    for posture in postures {
        assert!(cell.setup.robot.outside_limits(&posture.q).is_none());
    }
}

#[test]
fn poses_are_held_on_one_branch() {
    let cell = unbounded();
    let circle = circle(90);
    let options = with(|o: &mut PosturePathOptions| o.process = milling());
    let (postures, summary) = run(&cell, &poses(&circle), &options).unwrap();
    assert_eq!(summary.origin, Origin::ClosedForm);
    assert!(worst_gap(&cell, &postures, &circle, false) < 1e-11);
    assert_continuous(&cell, &postures, 0.2);
    // The load turns with the feed: 300 N and more everywhere, never the same.
    assert!(postures.iter().all(|p| (p.wrench.force.norm() - 305.9).abs() < 0.1));
    assert!((postures[0].wrench.force - postures[45].wrench.force).norm() > 400.0);
    // Among all branches the one that bends least: any start gives no less.
    let inverse = InverseKinematics::new(&cell.setup.robot);
    let arm = arm(&cell);
    let mut others = 0;
    for branch in inverse.branches(&(circle[0] * arm.tip().inverse())).unwrap() {
        let options = changed(options.clone(), |o| o.start = Some(branch.q.clone()));
        if let Ok((_, other)) = run(&cell, &poses(&circle), &options) {
            assert!(other.deflection_rms_m >= summary.deflection_rms_m * (1.0 - 1e-12));
            others += 1;
        }
    }
    assert!(others >= 2);
}

#[test]
fn a_free_turn_bends_less_and_keeps_continuity_and_limits() {
    let cell = default_cell();
    let circle = circle(60);
    let fixed = with(|o: &mut PosturePathOptions| o.process = milling());
    let free = changed(fixed.clone(), |o| o.free_turn = true);
    let (_, posed) = run(&cell, &poses(&circle), &fixed).unwrap();
    let (postures, summary) = run(&cell, &poses(&circle), &free).unwrap();
    println!(
        "RMS deflection {:.4} mm as given, {:.4} mm with the turn free; largest step {:.2}°",
        1e3 * posed.deflection_rms_m,
        1e3 * summary.deflection_rms_m,
        summary.largest_step.to_degrees()
    );
    let as_given = summary.given_rms_m.unwrap();
    assert!((as_given / posed.deflection_rms_m - 1.0).abs() < 1e-9);
    assert!(summary.deflection_rms_m < 0.98 * posed.deflection_rms_m);
    assert!(worst_gap(&cell, &postures, &circle, true) < 1e-11);
    assert_continuous(&cell, &postures, free.largest_step);
    // No single turn does better: a thousandth of the RMS for the finite grid.
    let arm = arm(&cell);
    for turn in 0..36 {
        let spin = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), f64::from(turn) * 0.1745);
        let turned: Vec<_> = circle.iter().map(|pose| pose * spin).collect();
        if let Ok((_, other)) = run(&cell, &poses(&turned), &fixed) {
            assert!(other.deflection_rms_m >= 0.999 * summary.deflection_rms_m);
        }
    }
    // Axis rows are the same freedom.
    let axes: Vec<PathPoint> = circle
        .iter()
        .enumerate()
        .map(|(i, pose)| {
            let target = PathTarget::Axis {
                position: pose.translation.vector,
                axis: UnitVector3::new_normalize(pose.rotation * Vector3::z()),
            };
            point(i, target)
        })
        .collect();
    let (postures, by_axis) = run(&cell, &axes, &fixed).unwrap();
    assert!((by_axis.deflection_rms_m / summary.deflection_rms_m - 1.0).abs() < 1e-3);
    assert!(worst_gap(&cell, &postures, &circle, true) < 1e-11);
    // And joint angles, whose own turn is then the given one.
    let angles: Vec<PathPoint> =
        postures.iter().enumerate().map(|(i, posture)| point(i, PathTarget::Angles(posture.q.clone()))).collect();
    let (with_turns, from_angles) = run(&cell, &angles, &free).unwrap();
    assert!(from_angles.deflection_rms_m <= from_angles.given_rms_m.unwrap() * (1.0 + 1e-12));
    assert_continuous(&cell, &with_turns, free.largest_step);
    let (same, unturned) = run(&cell, &angles, &fixed).unwrap();
    assert_eq!(unturned.origin, Origin::Given);
    assert_eq!(same[7].q, postures[7].q);
    assert_eq!(arm.tip_pose(&same[7].q), arm.tip_pose(&postures[7].q));
}

#[test]
fn long_paths_choose_turns_at_knots() {
    let cell = default_cell();
    let circle = circle(3000);
    let options = with(|o: &mut PosturePathOptions| {
        o.process = milling();
        o.free_turn = true;
        o.turns = 24;
    });
    let (postures, summary) = run(&cell, &poses(&circle), &options).unwrap();
    assert!(worst_gap(&cell, &postures, &circle, true) < 1e-11);
    assert_continuous(&cell, &postures, 0.1);
    assert!(summary.deflection_rms_m < summary.given_rms_m.unwrap());
}

#[test]
fn unreachable_points_jumps_and_limits_are_named_with_their_line() {
    let cell = default_cell();
    let options = PosturePathOptions::default();
    let mut far = circle(10);
    far[4].translation.vector.x = 4.5;
    let narrow = changed(options.clone(), |o| o.largest_step = 0.01);
    let free = changed(narrow.clone(), |o| o.free_turn = true);
    let fed = changed(options.clone(), |o| o.process = milling());
    let mut held = cell.clone();
    limit_joint(&mut held, 0, [1.2, 1.6]);
    let round = circle(8);
    let mut report = String::new();
    for (what, cell, path, options, code, line) in [
        ("a point beyond the reach", &cell, &far[..], &options, Code::Unreachable, Some(6)),
        ("three points of a circle are a jump", &cell, &round, &narrow, Code::InvalidValue, Some(3)),
        ("the same with a free turn", &cell, &round, &free, Code::InvalidValue, Some(3)),
        ("a feed load where nothing moves", &cell, &[round[0]; 3], &fed, Code::InvalidValue, Some(2)),
        ("no points", &cell, &[], &options, Code::TooFewData, None),
        ("a joint that cannot get there", &held, &round, &options, Code::OutsideLimits, Some(2)),
    ] {
        let error = run(cell, &poses(path), options).expect_err(what);
        assert_eq!((error.code(), error.place().line), (code, line), "{what}: {error}");
        report += &slip::<()>(what, Err(error));
    }
    insta::assert_snapshot!("posture_paths_refused", report);
}

#[test]
fn singular_postures_are_found() {
    let cell = default_cell();
    let q: Vec<f64> = [0.0, 20.0, -120.0, 0.0, 0.2, 0.0].map(f64::to_radians).to_vec();
    let (_, summary) = run(&cell, &[point(0, PathTarget::Angles(q))], &PosturePathOptions::default()).unwrap();
    let finding = &summary.findings[0];
    assert_eq!(finding.code, "singular-posture");
    insta::assert_snapshot!(finding.sentence, @"The posture at point 1 (line 2) is singular or nearly so: in one direction the tool hardly moves, whatever the joints do, and a controller may stop there.");
}

#[test]
fn arms_without_closed_form_follow_and_turn_as_well() {
    // The shape of a KUKA KR240 whose axes 2 and 3 are not parallel by half a
    // degree and whose wrist axes miss each other by a millimetre.
    let rows = [
        [0.0, 0.0, 0.0, 0.75],
        [-FRAC_PI_2, 0.35, 0.0, 0.0],
        [0.009, 1.25, -FRAC_PI_2, 0.0],
        [-FRAC_PI_2, -0.055, 0.0, 1.1],
        [FRAC_PI_2, 0.001, 0.0, 0.0],
        [-FRAC_PI_2, 0.0, PI, 0.23],
    ];
    let rows = rows.map(|[alpha, a, offset, d]| [alpha, a, d, offset]);
    let mut cell = default_cell();
    cell.setup.robot = chain("calibrated", DhConvention::Modified, &rows);
    cell.prior = Some(vec![3.8e6, 6.6e6, 3.9e6, 5.6e5, 6.6e5, 4.7e5]);
    let circle = circle(30);
    let options = with(|o: &mut PosturePathOptions| {
        o.process = milling();
        o.turns = 24;
    });
    let (postures, fixed) = run(&cell, &poses(&circle), &options).unwrap();
    assert_eq!(fixed.origin, Origin::Numeric);
    assert!(worst_gap(&cell, &postures, &circle, false) < 1e-9);
    let free = changed(options, |o| o.free_turn = true);
    let (postures, turned) = run(&cell, &poses(&circle), &free).unwrap();
    assert!(worst_gap(&cell, &postures, &circle, true) < 1e-9);
    assert_continuous(&cell, &postures, free.largest_step);
    assert!(turned.deflection_rms_m < fixed.deflection_rms_m);
}

/// A circle beside the fixture of the cell with shapes, with the tool axis down.
fn beside_the_fixture(y: f64) -> Vec<PathPoint> {
    let at = |i: u32| {
        let angle = std::f64::consts::TAU * f64::from(i) / 53.0;
        Vector3::new(1.7 + 0.2 * angle.cos(), y + 0.2 * angle.sin(), 0.8)
    };
    let axis = UnitVector3::new_unchecked(-Vector3::z());
    let targets = (0..54).map(|i| PathTarget::Axis { position: at(i), axis });
    targets.enumerate().map(|(i, t)| point(i, t)).collect()
}

fn is_forbidden(cell: &Cell, postures: &[LoadedPosture]) -> bool {
    let predicted = predict(cell, &prior(cell), postures, &PredictOptions::default(), Control::default());
    let findings = predicted.unwrap().findings;
    findings.iter().any(|finding| finding.code == "forbidden")
}

fn said<'a>(summary: &'a PosturePathSummary, code: &str) -> &'a str {
    let mut findings = summary.findings.iter().filter(|f| f.code == code);
    let finding = findings.next().unwrap_or_else(|| panic!("{code}: {summary:?}"));
    assert!(findings.next().is_none());
    &finding.sentence
}

#[test]
fn a_free_turn_keeps_shapes_and_says_what_that_costs() {
    let cell = builtin::cell("comau-shapes").unwrap();
    let points = beside_the_fixture(-0.75);
    let options = with(|o: &mut PosturePathOptions| o.process = milling());
    let (postures, summary) = run(&cell, &points, &options).unwrap();
    assert!(!is_forbidden(&cell, &postures));
    assert_continuous(&cell, &postures, options.largest_step);
    let unkept = summary.unkept_rms_m.unwrap();
    assert!(unkept < summary.deflection_rms_m && summary.deflection_rms_m < 1.3 * unkept);
    insta::assert_snapshot!(said(&summary, "limits-kept"), @"The way that bends least, 1.069 mm RMS, is forbidden by the cell's bounds, limits or shapes at 46 of 54 points: another was taken, which bends by 1.088 mm.");
    // Where nothing is in the way the same way is the one that bends least.
    let mut empty = cell.clone();
    empty.scene = Default::default();
    let (free, without) = run(&empty, &points, &options).unwrap();
    assert!((without.deflection_rms_m / unkept - 1.0).abs() < 1e-9);
    assert_eq!(without.unkept_rms_m, None);
    assert!(without.findings.iter().all(|f| f.code != "limits-kept"));
    assert!(is_forbidden(&cell, &free));
}

#[test]
fn the_worst_point_is_named_where_nothing_is_free() {
    let cell = builtin::cell("comau-shapes").unwrap();
    // Into the fixture.
    let points = beside_the_fixture(-1.0);
    let options = with(|o: &mut PosturePathOptions| o.process = milling());
    let (postures, summary) = run(&cell, &points, &options).unwrap();
    assert!(is_forbidden(&cell, &postures));
    insta::assert_snapshot!(said(&summary, "nothing-free"), @"At point 41 (line 42) and 22 more nothing is free, whatever the branch and the turn about the tool axis: at best, it has 135 mm too little room between reflector plate and fixture.");
}

#[test]
fn of_the_branches_of_given_poses_one_that_is_free_is_taken() {
    let mut cell = unbounded();
    let circle = poses(&circle(40));
    let options = with(|o: &mut PosturePathOptions| o.process = milling());
    let (postures, before) = run(&cell, &circle, &options).unwrap();
    // The bounds leave out the side of the wrist that was taken.
    let wrist = postures.iter().map(|posture| posture.q[4]).sum::<f64>();
    let [low, high] = cell.bounds[4];
    cell.bounds[4] = if wrist > 0.0 { [low, -0.01] } else { [0.01, high] };
    let (other, after) = run(&cell, &circle, &options).unwrap();
    let inside = |posture: &LoadedPosture| cell.outside_bounds(&posture.q).next().is_none();
    assert!(other.iter().all(inside));
    // Flipped wrists bend alike: nothing is lost, and nothing to be said.
    assert!((after.deflection_rms_m / before.deflection_rms_m - 1.0).abs() < 1e-9);
    assert!(after.findings.is_empty(), "{:?}", after.findings);
    // The branch that is asked for is kept.
    let near = changed(options, |o| o.start = Some(postures[0].q.clone()));
    let (near_postures, summary) = run(&cell, &circle, &near).unwrap();
    assert!(!near_postures.iter().any(inside));
    insta::assert_snapshot!(said(&summary, "nothing-free"), @"Each point by itself has a free posture, but no way that was found leads through them all without a jump near the posture that is asked for: at point 20 (line 21), joint 5 would leave the cell's bounds by 152.2°.");
}

/// Who counts the tool axis into the tool, or has turned the workpiece, is told what would make the path reachable.
#[test]
fn an_axis_the_other_way_round_is_named() {
    let cell = reference_cell();
    let hint = |poses: &[Isometry3<f64>], workpiece: Isometry3<f64>| {
        let options = with(|o: &mut PosturePathOptions| o.workpiece = workpiece);
        let error = run(&cell, &self::poses(poses), &options).unwrap_err();
        format!("{:?}", error.hint_text())
    };
    let moved = |by: [f64; 3]| -> Vec<Isometry3<f64>> {
        let by = Isometry3::translation(by[0], by[1], by[2]);
        circle(9).iter().map(|pose| by * pose).collect()
    };
    let works = |poses: &[Isometry3<f64>]| run(&cell, &self::poses(poses), &Default::default()).is_ok();
    let half = |axis| UnitQuaternion::from_axis_angle(&axis, PI);
    // So low that the arm reaches it from above alone.
    let round =
        |poses: Vec<Isometry3<f64>>| -> Vec<_> { poses.iter().map(|pose| pose * half(Vector3::x_axis())).collect() };
    let low = (0..30).map(|i| moved([0.0, 0.0, -0.1 * f64::from(i)]));
    let low = low.filter(|poses| works(poses)).map(round).rfind(|poses| !works(poses));
    insta::assert_snapshot!(hint(&low.unwrap(), Isometry3::identity()), @r#"Some("move or turn the pose, or place the robot's base differently; with the tool axis of every pose the other way round it reaches them: say which way z of the poses points, out of the tool or into it")"#);
    // Beyond the workpiece, on the side of it where the arm does not reach.
    let workpiece = Isometry3::translation(1.9, 0.0, 0.8);
    let turned = |poses: &Vec<Isometry3<f64>>| -> Vec<_> {
        let turn = workpiece * half(Vector3::z_axis()) * workpiece.inverse();
        poses.iter().map(|pose| turn * pose).collect()
    };
    let beyond = (0..30).map(|i| moved([0.1 * f64::from(i), 0.0, 0.0]));
    let beyond = beyond.filter(|poses| works(&turned(poses))).rfind(|poses| !works(poses));
    insta::assert_snapshot!(hint(&beyond.unwrap(), workpiece), @r#"Some("move or turn the pose, or place the robot's base differently; with the workpiece turned by 180° about its z it reaches them: check the turn of the workpiece frame")"#);
    // Nor is one point beyond the reach a path that is turned.
    let mut one = moved([0.0; 3]);
    one[4].translation.x += 1.6;
    insta::assert_snapshot!(hint(&one, workpiece), @r#"Some("move or turn the pose, or place the robot's base differently")"#);
    // What nothing of this explains says nothing of it.
    insta::assert_snapshot!(hint(&moved([9.0, 0.0, 0.0]), workpiece), @r#"Some("move or turn the pose, or place the robot's base differently")"#);
}
