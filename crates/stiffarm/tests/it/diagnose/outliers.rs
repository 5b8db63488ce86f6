//! Readings, postures and reflectors that do not fit are named, whichever they are, by tests that fits without them
//! confirm.

use super::*;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// One reading off by 1 mm is named with posture, point and axis, whichever
/// it is, under either noise model.
#[test]
fn one_displaced_reading_is_named() {
    for (common_part, estimator) in [(0.0, Estimator::Ordinary), (3.0, Estimator::TwoVariance)] {
        let cell = noisy_cell(common_part);
        for (i, axis) in (0..48).zip([0, 1, 2].into_iter().cycle()) {
            let mut measured = measure(&cell, 1000 + i as u64);
            let (posture, point) = (i / 4, i % 4);
            measured[posture].displacements[point].value[axis] -= 1e-3;
            let outliers = outliers(&Fit::new(&cell, &measured, &by(estimator)).unwrap()).unwrap();
            // Once it is set aside the rest fits.
            let [first] = &outliers.found[..] else { panic!("{i}: {outliers:?}") };
            assert!(!outliers.more, "{i}: {outliers:?}");
            assert_eq!(first.kind, OutlierKind::Displacement, "{i}: {first:?}");
            assert_eq!(first.posture.as_deref(), Some(measured[posture].posture.name.as_str()));
            assert_eq!(first.point.as_deref(), Some((point + 1).to_string().as_str()));
            assert_eq!(first.axis.as_deref(), Some(["x", "y", "z"][axis]));
            let deviation = first.deviation_m.unwrap()[axis];
            let error = first.standard_error_m.unwrap()[axis];
            assert!((deviation + 1e-3).abs() < 5.0 * error, "{deviation} ± {error}");
        }
    }
}

/// The deleted residual is the displacement less its prediction by a fit
/// without it, and the tests of least squares are the exact F tests.
#[test]
fn deleted_residuals_are_those_of_fits_without() {
    let cell = noisy_cell(0.0);
    let mut measured = measure(&cell, 7);
    measured[4].displacements[2].value.y += 2e-4;
    let options = by(Estimator::Ordinary);
    let outlier = &outliers(&Fit::new(&cell, &measured, &options).unwrap()).unwrap().found[0];
    let mut without = measured.clone();
    let taken = without[4].displacements.remove(2);
    let fit = identify(&cell, &without, &options).unwrap();
    let predicted =
        calculated_displacements(&cell, &measured[4], &fit.estimates.stiffness().unwrap(), Model::Linear).unwrap()[2];
    let direct = taken.value - predicted;
    let deviation = Vector3::from(outlier.deviation_m.unwrap());
    assert!((deviation - direct).norm() < 1e-12, "{deviation} {direct}");
}

/// A point's probability is that of the F test between the fits with and without it.
#[test]
fn points_are_judged_by_fits_without_them() {
    let cell = noisy_cell(0.0);
    let measured = measure(&cell, 8);
    let options = by(Estimator::Ordinary);
    let fit = Fit::new(&cell, &measured, &options).unwrap();
    let outliers = outliers(&fit).unwrap();
    // Sum of squares and degrees of freedom.
    let left = |measured: &[MeasuredPosture]| {
        let fit = identify(&cell, measured, &options).unwrap();
        let free = fit.estimates.degrees_of_freedom as f64;
        (fit.residual_std_m.unwrap().powi(2) * free, free)
    };
    let all = left(&measured);
    for (point, by) in outliers.points.iter().enumerate() {
        let mut others = measured.clone();
        for m in &mut others {
            m.displacements.retain(|d| d.point != point);
        }
        let rest = left(&others);
        let freedom = all.1 - rest.1;
        let f = (all.0 - rest.0) / freedom / (rest.0 / rest.1);
        let p = FisherSnedecor::new(freedom, rest.1).unwrap().sf(f);
        let ours = by.p_value.unwrap();
        assert!((ours / p - 1.0).abs() < 1e-9, "{ours} {p}");
    }
}

#[test]
fn a_posture_that_does_not_fit_is_named_as_a_whole() {
    for (common_part, estimator) in [(0.0, Estimator::Ordinary), (1.0, Estimator::TwoVariance)] {
        let cell = noisy_cell(common_part);
        for posture in 0..12 {
            let mut measured = measure(&cell, 2000 + posture as u64);
            // The load of this posture was 20 % larger than stated.
            let exact = calculated_displacements(&cell, &measured[posture], &truth(&cell), Model::Linear).unwrap();
            for d in &mut measured[posture].displacements {
                d.value += exact[d.point] * 0.2;
            }
            let outliers = outliers(&Fit::new(&cell, &measured, &by(estimator)).unwrap()).unwrap();
            let [first] = &outliers.found[..] else { panic!("{posture}: {outliers:?}") };
            assert_eq!(first.kind, OutlierKind::Posture, "{posture}: {first:?}");
            assert_eq!(first.posture.as_deref(), Some(measured[posture].posture.name.as_str()));
            assert!(outliers.postures[posture].p_value.unwrap() < 1e-4);
        }
    }
}

#[test]
fn a_loose_reflector_is_named() {
    for (common_part, estimator) in [(0.0, Estimator::Ordinary), (3.0, Estimator::TwoVariance)] {
        let cell = noisy_cell(common_part);
        for point in 0..4 {
            let mut measured = measure(&cell, 3000 + point as u64);
            let mut dice = Dice::new(point as u64);
            for m in &mut measured {
                m.displacements[point].value += dice.vector(2e-4);
            }
            let outliers = outliers(&Fit::new(&cell, &measured, &by(estimator)).unwrap()).unwrap();
            let [first] = &outliers.found[..] else { panic!("{point}: {outliers:?}") };
            assert_eq!(first.kind, OutlierKind::Point, "{point}: {first:?}");
            assert_eq!(first.point.as_deref(), Some((point + 1).to_string().as_str()));
        }
    }
}

#[test]
fn many_contradictions_are_the_model() {
    let cell = noisy_cell(0.0);
    let mut measured = measure(&cell, 11);
    let mut dice = Dice::new(4);
    for m in &mut measured {
        m.displacements[dice.below(4)].value += dice.direction() * 5e-3 * dice.between(0.5, 2.0);
    }
    let outliers = outliers(&Fit::new(&cell, &measured, &by(Estimator::Ordinary)).unwrap()).unwrap();
    assert!(outliers.more && outliers.found.len() == 5);
    assert_eq!(outliers.findings().last().unwrap().code, "more-outliers");
}
