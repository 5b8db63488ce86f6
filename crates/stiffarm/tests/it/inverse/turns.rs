//! Full turns within the limits are all told, the nearest branch is the nearest, and input that is none is refused.

use super::*;
use crate::common::cases::refusals;

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
    let plain = robot("kuka-kr500-r2800-2");
    let mut coupling = plain.coupling().clone();
    coupling[(4, 3)] = 0.375;
    coupling[(5, 4)] = -0.25;
    let limits: Vec<[f64; 2]> = [2.0, 1.5, 2.0, 8.0, 9.0, 7.0].map(|l| [-l, l]).to_vec();
    let robot = plain.with_coupling(coupling).unwrap().with_limits(&limits).unwrap();
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
    for robot in [robot("comau-nj165-3.0"), robot("fanuc-r2000ic165f"), panda(), ur10(0.0)] {
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
            let pose = Isometry3::from_parts(Translation3::from(first.translation.vector + way), turn * first.rotation);
            led = inverse.follow(&pose, &led).unwrap_or_else(|e| panic!("{} at {i}: {e}", robot.name()));
            let before = chosen.clone();
            chosen = inverse.nearest(&pose, &chosen).unwrap();
            assert!(pose_error(&robot, &led, &pose) < 1e-11);
            assert!(pose_error(&robot, &chosen, &pose) < 1e-11);
            let pairs = chosen.iter().zip(&before);
            let change = pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(change < 0.05, "{}: {change}", robot.name());
            if robot.joint_count() == 6 {
                let pairs = chosen.iter().zip(&led);
                assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-8), "{}", robot.name());
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
        let all = branches.iter().flat_map(|b| inverse.turns_within_limits(&b.q));
        let least = all.map(|q| change(&q)).fold(f64::INFINITY, f64::min);
        assert!((change(&near) - least).abs() < 1e-9);
    }
}

#[test]
fn input_that_is_not_finite_is_refused() {
    let inverse = InverseKinematics::new(&robot("comau-nj165-3.0"));
    let mut pose = Isometry3::identity();
    pose.translation.vector.y = f64::NAN;
    let there = Isometry3::translation(2.0, 0.0, 1.0);
    let rows = [
        ("branches", Code::NotFinite, inverse.branches(&pose).map(drop)),
        ("solve", Code::NotFinite, inverse.solve(&pose).map(drop)),
        ("nearest", Code::NotFinite, inverse.nearest(&pose, &[0.0; 6]).map(drop)),
        ("follow", Code::NotFinite, inverse.follow(&pose, &[0.0; 6]).map(drop)),
        ("nearest to endless angles", Code::NotFinite, inverse.nearest(&there, &[f64::INFINITY; 6]).map(drop)),
        ("follow from five angles", Code::Dimension, inverse.follow(&Isometry3::identity(), &[0.0; 5]).map(drop)),
    ];
    insta::assert_snapshot!(refusals(rows), @"
    » branches
    [not-finite] The pose has a number that is not finite.

    » solve
    [not-finite] The pose has a number that is not finite.

    » nearest
    [not-finite] The pose has a number that is not finite.

    » follow
    [not-finite] The pose has a number that is not finite.

    » nearest to endless angles
    [not-finite] The angle of joint 1 is not a finite number.

    » follow from five angles
    [dimension] 5 angles for the 6 joints of COMAU SMART5 NJ 165-3.0.
    ");
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
