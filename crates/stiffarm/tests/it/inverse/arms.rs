//! Every arm is solved, each with its method, and no branch is missed.

use super::*;

#[test]
fn every_arm_of_the_catalogue_is_solved_in_closed_form() {
    let many: Vec<&str> = arms().iter().map(|e| e.key).collect();
    for entry in catalogue() {
        let robot = entry.robot().unwrap();
        let inverse = InverseKinematics::new(&robot);
        if robot.joint_count() != 6 {
            assert_eq!(inverse.method(), Method::Numeric, "{}", entry.key);
            continue;
        }
        assert_eq!(inverse.method(), Method::ClosedForm, "{}", entry.key);
        let mut dice = Dice::new(11);
        let (mut worst, mut most) = (0.0_f64, 0);
        let poses = if many.contains(&entry.key) { 10_000 } else { 500 };
        for _ in 0..poses {
            let q = within(&robot, &mut dice);
            let pose = flange(&robot, &q);
            let branches = inverse.branches(&pose).unwrap();
            worst = worst.max(check_branches(&robot, &pose, &branches));
            let distances = branches.iter().map(|b| (difference(&robot, &b.q, &q), b));
            let (nearest, branch) = distances.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            // Rounding of the pose moves the posture by the condition number.
            assert!(nearest < 1e-12 * branch.condition.max(100.0), "{}: {nearest:e} at {q:?}", entry.key);
            most = most.max(branches.len());
        }
        println!("{:<20} FK(IK) {worst:.1e}", entry.key);
        assert!(worst <= 1e-12, "{}: {worst:e}", entry.key);
        assert_eq!(most, 8, "{}", entry.key);
    }
}

#[test]
fn no_branch_is_missed() {
    let mut robots: Vec<Robot> = arms().iter().map(|e| e.robot().unwrap()).collect();
    robots.push(ur10(0.0));
    for robot in &robots {
        let inverse = InverseKinematics::new(robot);
        let mut dice = Dice::new(5);
        let (mut ours, mut theirs) = (0, 0);
        for _ in 0..40 {
            let pose = flange(robot, &dice.posture(6));
            let branches = inverse.branches(&pose).unwrap();
            let others = multi_start(robot, &pose, 200, &mut dice);
            for q in &others {
                assert!(is_among(robot, q, &branches, 1e-5), "{}: {q:?} is missing from {branches:?}", robot.name());
            }
            ours += branches.len();
            theirs += others.len();
        }
        println!("{:<24} {ours} branches, {theirs} found", robot.name());
        // The search itself must be one that would notice.
        assert!(theirs as f64 > 0.95 * ours as f64, "{theirs} of {ours}");
    }
}

#[test]
fn arms_without_a_closed_form_are_solved_numerically() {
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
    for value in rows.as_flattened_mut() {
        *value += 2e-3 * dice.normal();
    }
    let calibrated = chain("calibrated", DhConvention::Modified, &rows)
        .with_coupling(robot("comau-nj165-3.0").coupling().clone())
        .unwrap();
    // No two axes parallel, no two that meet.
    let rows = [
        [0.3, 0.1, 0.4, 0.2],
        [-1.3, 0.3, 0.1, 0.0],
        [0.4, 0.6, -0.1, 0.5],
        [-1.1, 0.15, 0.5, 0.0],
        [1.4, 0.1, 0.1, 0.0],
        [-1.2, 0.05, 0.2, 0.3],
    ];
    let general = chain("general", DhConvention::Modified, &rows);
    for (robot, mut dice, poses, searched, starts, near) in
        [(calibrated, dice, 200, 20, 100, 1e-6), (general, Dice::new(2), 30, 30, 60, 1e-5)]
    {
        let inverse = InverseKinematics::new(&robot);
        assert_eq!(inverse.method(), Method::Numeric);
        for i in 0..poses {
            let q = dice.posture(6);
            let pose = flange(&robot, &q);
            let branches = inverse.branches(&pose).unwrap();
            assert!(check_branches(&robot, &pose, &branches) < 1e-10);
            assert!(is_among(&robot, &q, &branches, near), "{q:?}");
            if i >= searched {
                continue;
            }
            for solution in multi_start(&robot, &pose, starts, &mut dice) {
                assert!(is_among(&robot, &solution, &branches, 1e-5), "{solution:?}");
            }
            // Same bytes each time.
            let again = InverseKinematics::new(&robot).branches(&pose).unwrap();
            assert_eq!(branches, again);
        }
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
    assert_eq!((missing.region, missing.rotation_rad), (Region::Outside, 0.0));
    assert!((2.9..3.1).contains(&missing.distance_m), "{missing:?}");
}

#[test]
fn fewer_joints_reach_their_own_poses() {
    let rows = [[0.0, 0.0, 0.3, 0.0], [-FRAC_PI_2, 0.1, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [-FRAC_PI_2, 0.0, 0.4, 0.0]];
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
    assert!(missing.distance_m > 0.01 && missing.distance_m < 0.5, "{missing:?}");

    // Parallel axes give none but turns about them.
    let rows = [[0.0, 0.0, 0.1, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.4, 0.1, 0.0]];
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
    assert!(missing.rotation_rad > 0.5 * tilt && missing.rotation_rad < tilt + 1e-6, "{missing:?}");
    let error = inverse.branches(&pose).unwrap_err();
    assert_eq!(error.code(), Code::Unreachable);
    // The distance beside it is what the search left.
    let turn = format!(" and {:.1}° away.", missing.rotation_rad.to_degrees());
    assert!(error.message().ends_with(&turn), "{error}");
}

/// A random arm with a spherical wrist or three parallel axes.
fn random_arm(dice: &mut Dice, three_parallel: bool) -> Robot {
    let right = |dice: &mut Dice| dice.signed(1.0, 1.0) * FRAC_PI_2;
    let straight = |dice: &mut Dice| if dice.chance(0.5) { PI } else { 0.0 };
    // Axis 1 at any angle to axis 2.
    let shoulder = if dice.chance(0.5) { right(dice) } else { dice.signed(0.3, 2.8) };
    let mut rows = [
        [dice.between(-PI, PI), dice.signed(0.0, 0.4), dice.between(-0.5, 0.5)],
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
    let rows: Vec<DhRow> =
        rows.iter().map(|[alpha, a, d]| DhRow { alpha: *alpha, a: *a, d: *d, offset: dice.between(-PI, PI) }).collect();
    let mut coupling = DMatrix::from_fn(6, 6, |i, j| if i == j { dice.signed(1.0, 1.0) } else { 0.0 });
    coupling[(2, 1)] = (dice.below(3) as f64) - 1.0;
    coupling[(5, 4)] = (dice.below(3) as f64) - 1.0;
    Robot::from_dh("random", DhConvention::Modified, &rows, dice.pose()).unwrap().with_coupling(coupling).unwrap()
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
