//! Intervals of single joints are open or absent where nothing bounds them, and their quantiles are those of tables.

use super::*;
use stiffarm::estimate::identify::JointEstimate;
use stiffarm::internals::{estimates, moments, noise, quantile, sizes};

/// The estimate of one joint by a solution with this compliance and this standard error,
/// `held` at zero by the non-negative fit.
fn estimate(h: f64, error: Option<f64>, t: Option<f64>, held: bool) -> JointEstimate {
    let solution = Solution {
        values: DVector::from_element(1, h),
        covariance: error.map(|e| DMatrix::from_element(1, 1, e * e)),
        undetermined: Vec::new(),
        degrees_of_freedom: 3,
        t_degrees_of_freedom: Some(3),
        sigma: None,
        residual_std: None,
        gamma: 0.0,
        factor: Factor::new(&DMatrix::identity(1, 1)).unwrap(),
        weights: None,
        at_bound: if held { vec![0] } else { Vec::new() },
        independent_rows: false,
    };
    estimates(&["j".to_string()], 0..1, &solution, t).remove(0)
}

#[test]
fn intervals_are_asymmetric_open_or_absent() {
    let t = Some(2.0);
    for (what, joint, verdict, stiffness, interval) in [
        (
            "closed",
            estimate(1e-6, Some(1e-7), t, false),
            Verdict::Weak,
            Some(1e6),
            [Some(1.0 / 1.2e-6), Some(1.0 / 0.8e-6)],
        ),
        (
            "as unsure as it is large",
            estimate(1e-6, Some(1e-6), t, false),
            Verdict::LowerBoundOnly,
            Some(1e6),
            [Some(1.0 / 3e-6), None],
        ),
        ("negative", estimate(-1e-6, Some(1e-7), t, false), Verdict::SignOrModelFault, Some(-1e6), [None, None]),
        ("held at zero", estimate(0.0, Some(1e-7), t, true), Verdict::LowerBoundOnly, None, [Some(5e6), None]),
        ("held at zero without error", estimate(0.0, None, None, true), Verdict::NoInterval, None, [None, None]),
    ] {
        assert_eq!(joint.verdict, verdict, "{what}");
        let numbers =
            [(joint.stiffness, stiffness), (joint.interval[0], interval[0]), (joint.interval[1], interval[1])];
        for (ours, expected) in numbers {
            let close = ours.zip(expected).is_none_or(|(ours, expected)| (ours - expected).abs() < 1e-3);
            assert!(close && ours.is_some() == expected.is_some(), "{what}: {joint:?}");
        }
    }
}

#[test]
fn quantiles_are_those_of_the_tables() {
    let table = [
        (Some(3), 3.182_446_305_284_263),
        (Some(6), 2.446_911_848_791_681),
        (Some(12), 2.178_812_829_663_418),
        (Some(66), 1.996_564_418_952_312),
        (None, 1.959_963_984_540_054),
    ];
    for (dof, expected) in table {
        assert!((quantile(dof, 0.95).unwrap() / expected - 1.0).abs() < 1e-9);
    }
}

#[test]
fn many_degrees_of_freedom_take_no_time_and_join_the_exact_ones() {
    for confidence in [0.5, 0.95, 0.999] {
        let at = |n| quantile(Some(n), confidence).unwrap();
        assert!((at(10_000) - at(10_001)).abs() < 1e-6);
    }
    // z + (z³ + z)/(4·10⁶) with z = 1.959963984540054.
    assert!((quantile(Some(1_000_000), 0.95).unwrap() - 1.959_966_356_81).abs() < 1e-10);
    let largest = quantile(Some(usize::MAX), 0.95).unwrap();
    assert!((largest - quantile(None, 0.95).unwrap()).abs() < 1e-12);
}

#[test]
fn a_quantile_that_does_not_exist_is_an_error() {
    for (dof, confidence) in [(Some(0), 0.95), (None, 1.0), (None, f64::NAN), (Some(3), 95.0)] {
        assert!(!quantile(dof, confidence).unwrap_err().code().is_internal());
    }
}

/// Where the readings say nothing, sizes are as stated.
#[test]
fn nothing_seen_is_nothing_learned() {
    let (mean, covariance) =
        moments(&DMatrix::zeros(3, 3), &DVector::zeros(3), &[true, true, false], &noise(Some(12))).unwrap();
    assert_eq!(mean, DVector::zeros(3));
    assert!((covariance - DMatrix::identity(3, 3)).norm() < 1e-14);
    let total: f64 = sizes().iter().map(|(_, weight)| weight).sum();
    assert!((total - 1.0).abs() < 1e-14);
    assert!((sizes().last().unwrap().0 - 3f64.sqrt()).abs() < 0.05);
}

/// A part that is seen well and found to be absent says that those alike
/// are small, too; one that is not alike keeps its size.
#[test]
fn what_one_joint_shows_is_said_of_those_alike() {
    let mut seen = DMatrix::zeros(3, 3);
    seen[(0, 0)] = 1e4;
    let (_, covariance) = moments(&seen, &DVector::zeros(3), &[true, true, false], &noise(None)).unwrap();
    assert!(covariance[(0, 0)] < 2e-4);
    assert!(covariance[(1, 1)] < 0.4, "{covariance}");
    assert!((covariance[(2, 2)] - 1.0).abs() < 1e-12);
    let said = DVector::from_vec(vec![2e4, 0.0, 0.0]);
    let (mean, covariance) = moments(&seen, &said, &[true, true, false], &noise(None)).unwrap();
    assert!((mean[0] - 2.0).abs() < 1e-3 && covariance[(1, 1)] > 1.2);
}
