//! Readings, postures and reflectors that do not fit.

use super::*;

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
            let found = Fit::new(&cell, &measured, &options(estimator))
                .and_then(|fit| outliers(&fit))
                .unwrap();
            let first = &found.found[0];
            assert_eq!(first.kind, OutlierKind::Displacement, "{i}: {first:?}");
            assert_eq!(
                first.posture.as_deref(),
                Some(measured[posture].posture.name.as_str())
            );
            assert_eq!(
                first.point.as_deref(),
                Some((point + 1).to_string().as_str())
            );
            assert_eq!(first.axis.as_deref(), Some(["x", "y", "z"][axis]));
            let deviation = first.deviation_m.unwrap()[axis];
            let error = first.standard_error_m.unwrap()[axis];
            assert!(
                (deviation + 1e-3).abs() < 5.0 * error,
                "{deviation} ± {error}"
            );
            // Once it is set aside the rest fits.
            assert!(
                found.found.len() == 1 && !found.more,
                "{i}: {:?}",
                found.found
            );
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
    let options = options(Estimator::Ordinary);
    let found = &Fit::new(&cell, &measured, &options)
        .and_then(|fit| outliers(&fit))
        .unwrap()
        .found[0];
    let mut without = measured.clone();
    let taken = without[4].displacements.remove(2);
    let fit = identify(&cell, &without, &options).unwrap();
    let predicted = calculated_displacements(
        &cell,
        &measured[4],
        &fit.estimates.stiffness().unwrap(),
        Model::Linear,
    )
    .unwrap()[2];
    let direct = taken.value - predicted;
    let deviation = Vector3::from(found.deviation_m.unwrap());
    assert!((deviation - direct).norm() < 1e-12, "{deviation} {direct}");
}

#[test]
fn a_posture_that_does_not_fit_is_named_as_a_whole() {
    for (common_part, estimator) in [(0.0, Estimator::Ordinary), (1.0, Estimator::TwoVariance)] {
        let cell = noisy_cell(common_part);
        for posture in 0..12 {
            let mut measured = measure(&cell, 2000 + posture as u64);
            // The load of this posture was 20 % larger than stated.
            let exact =
                calculated_displacements(&cell, &measured[posture], &truth(&cell), Model::Linear)
                    .unwrap();
            for d in &mut measured[posture].displacements {
                d.value += exact[d.point] * 0.2;
            }
            let found = Fit::new(&cell, &measured, &options(estimator))
                .and_then(|fit| outliers(&fit))
                .unwrap();
            let first = &found.found[0];
            assert_eq!(
                first.kind,
                OutlierKind::Posture,
                "{posture}: {:?}",
                found.found
            );
            assert_eq!(
                first.posture.as_deref(),
                Some(measured[posture].posture.name.as_str())
            );
            assert_eq!(found.found.len(), 1, "{posture}: {:?}", found.found);
            assert!(found.postures[posture].p_value.unwrap() < 1e-4);
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
            let found = Fit::new(&cell, &measured, &options(estimator))
                .and_then(|fit| outliers(&fit))
                .unwrap();
            let first = &found.found[0];
            assert_eq!(first.kind, OutlierKind::Point, "{point}: {:?}", found.found);
            assert_eq!(
                first.point.as_deref(),
                Some((point + 1).to_string().as_str())
            );
            assert_eq!(found.found.len(), 1, "{point}: {:?}", found.found);
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
    let found = Fit::new(&cell, &measured, &options(Estimator::Ordinary))
        .and_then(|fit| outliers(&fit))
        .unwrap();
    assert!(found.more && found.found.len() == 5);
    assert_eq!(found.findings().last().unwrap().code, "more-outliers");
}
