//! A pose out of reach is refused with the distance that it lacks.

use super::*;

/// Smallest distance of the flange's position under any posture that keeps the
/// orientation, by a coarse grid of three joints and a refined one: the wrist
/// of these arms can always give the orientation.
fn distance_by_grid(robot: &Robot, pose: &Isometry3<f64>) -> f64 {
    // The wrist's centre asked for, from the flange's frame.
    let frames = Frames::new(robot, &[0.0; 6]);
    let centre_in_flange = frames.flange().inverse() * nalgebra::Point3::from(frames.wrist_centre());
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
    for entry in arms() {
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
            assert!((missing.distance_m - expected).abs() < 1e-6, "{}: {missing:?}, {expected}", entry.key);
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
    assert_eq!(far.message(), format!("The pose lies {:.1} mm beyond the arm's reach.", distance * 1e3));
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
    insta::assert_snapshot!(hole, @"
    The pose lies 163.9 mm inside the hole about the axis of joint 1.
      hint: move or turn the pose, or place the robot's base differently
    ");

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
        pairs.map(|(q, l)| (l[0] - q).max(q - l[1])).fold(f64::NEG_INFINITY, f64::max)
    };
    let least = branches.iter().map(excess).fold(f64::INFINITY, f64::min);
    assert_eq!(format!("{:.1}", least.to_degrees()), "15.4");
    insta::assert_snapshot!(error, @"
    The pose takes joint 2 to 110.4°, 15.4° outside the machine's limits, -75° to 95°.
      hint: of the pose's 8 postures this one leaves the limits least; move or turn the pose
    ");
}

#[test]
fn small_distances_keep_two_digits() {
    let robot = robot("comau-nj165-3.0");
    for (mm, text) in
        [(1234.56, "1234.6"), (0.1, "0.1"), (0.0456, "0.046"), (1.23e-5, "0.000012"), (0.0, "0"), (5.6e-8, "0")]
    {
        let unreachable = Unreachable { distance_m: mm * 1e-3, rotation_rad: 0.0, region: Region::Beyond };
        let error = unreachable.error(&robot);
        let said = format!("The pose lies {text} mm beyond");
        assert!(error.message().starts_with(&said), "{error}");
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
        assert_eq!((exact.method(), numeric.method()), (Method::ClosedForm, Method::Numeric));
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
