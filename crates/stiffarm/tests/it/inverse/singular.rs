//! Poses where branches meet give a representative of them.

use super::*;

#[test]
fn singular_poses_give_a_representative() {
    for entry in arms() {
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

#[test]
fn a_straight_wrist_of_three_parallel_axes_is_told() {
    let robot = ur10(0.0);
    let mut q = Dice::new(4).posture(6);
    q[4] = 0.0;
    let pose = flange(&robot, &q);
    let branches = InverseKinematics::new(&robot).branches(&pose).unwrap();
    assert!(check_branches(&robot, &pose, &branches) < 1e-10);
    assert!(branches.iter().any(|b| b.singular));
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
    for entry in arms() {
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
    assert!(near.iter().zip(&q).all(|(a, b)| (a - b).abs() < 1e-9), "{near:?}");
}
