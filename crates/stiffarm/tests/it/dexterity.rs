//! Derivatives of the condition number k(J_N) are those of differences, and it is not told where there is none.

use crate::common::differences::slope;
use crate::common::prelude::*;
use stiffarm::model::dexterity::{condition_number, log_condition_gradient};

fn arm(n: usize) -> Robot {
    let rows: Vec<DhRow> = (0..n)
        .map(|i| {
            let i = i as f64;
            DhRow { alpha: 1.1 - 0.5 * i, a: 0.2 + 0.1 * i, d: 0.3 - 0.15 * i, offset: 0.4 * i }
        })
        .collect();
    Robot::from_dh("bent", DhConvention::Standard, &rows, Isometry3::identity()).unwrap()
}

#[test]
fn derivatives_by_the_length_and_the_angles_are_those_of_differences() {
    let in_flange = Vector3::new(0.1, -0.2, 0.3);
    for n in [6, 7] {
        let robot = arm(n);
        let theta: Vec<f64> = (0..n).map(|j| 0.5 + 0.9 * (j as f64 * 1.7).sin()).collect();
        let log_k = |theta: &[f64], log_length: f64| {
            let frames = Frames::at_serial_angles(&robot, theta);
            condition_number(&frames, &frames.point(&in_flange), log_length.exp()).unwrap().ln()
        };
        for length in [0.1, 0.7, 3.0_f64] {
            let frames = Frames::at_serial_angles(&robot, &theta);
            let mut gradient = vec![0.0; n];
            let (value, by_length) = log_condition_gradient(&frames, &frames.point(&in_flange), length, &mut gradient);
            let at = length.ln();
            assert!((value - log_k(&theta, at)).abs() < 1e-10);
            let expected = slope(|h| log_k(&theta, at + h), 2e-3);
            assert!((by_length - expected).abs() < 1e-8, "n {n} L {length}: {by_length} {expected}");
            // k(J_N) changes with the length, or the test says nothing.
            assert!(expected.abs() > 1e-3);
            for k in 0..n {
                let moved = |h: f64| {
                    let mut theta = theta.clone();
                    theta[k] += h;
                    log_k(&theta, at)
                };
                let expected = slope(moved, 2e-3);
                assert!((gradient[k] - expected).abs() < 1e-7, "n {n} joint {k}: {} {expected}", gradient[k]);
            }
        }
    }
}

#[test]
fn a_singular_posture_and_a_short_chain_have_no_condition_number() {
    let p = Vector3::new(0.4, 0.1, 0.2);
    // Every joint about one axis.
    let row = DhRow { alpha: 0.0, a: 0.0, d: 0.1, offset: 0.0 };
    let flat = Robot::from_dh("flat", DhConvention::Modified, &[row; 6], Isometry3::identity()).unwrap();
    for robot in [flat, arm(5)] {
        let n = robot.joint_count();
        let frames = Frames::new(&robot, &vec![0.3; n]);
        assert_eq!(condition_number(&frames, &p, 0.7), None);
        let mut gradient = vec![0.0; n];
        let (value, by_length) = log_condition_gradient(&frames, &p, 0.7, &mut gradient);
        assert_eq!((value, by_length), (f64::INFINITY, 0.0));
        assert!(gradient.iter().all(|g| *g == 0.0));
    }
}
