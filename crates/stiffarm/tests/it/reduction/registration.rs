//! The frame of the tracker comes from the unloaded readings, whatever a few wrong postures say.

use super::*;

#[test]
fn registration_comes_from_the_unloaded_readings() {
    let cell = reference_cell();
    let options = Experiment {
        base_from_tracker: tracker_pose(),
        servo_deflection: Some(GIVE.to_vec()),
        ..Experiment::default()
    };
    let table = take(&cell, &options, 1);
    let result = reduced(&cell, &table);
    let difference = result.base_from_tracker.inverse() * tracker_pose();
    assert!(difference.rotation.angle() < 1e-14 && difference.translation.vector.norm() < 1e-13);
    let registration = result.registration.as_ref().unwrap();
    assert!(!registration.given && registration.rms_m < 1e-13);
    assert!(registration.turn_standard_error_rad.unwrap().iter().all(|e| *e < 1e-13));
    assert!(registration.fit.is_some());
    assert_eq!(registration.postures.len(), 6);
    assert!(registration.postures.iter().all(|p| p.used && p.points.len() == 4));
    assert_displaced(&cell, &result.measured, |_| 1.0, Some(GIVE));
    // Given, by the options or by the cell: the same, and the readings check it.
    let mut with_pose = cell.clone();
    with_pose.tracker.base_from_tracker = Some(tracker_pose());
    for result in [reduced_by(&cell, &table, tracker_pose()), reduced(&with_pose, &table)] {
        let registration = result.registration.as_ref().unwrap();
        assert!(registration.given && registration.rms_m < 1e-13 && registration.fit.is_none());
        assert!(found(&result, "given-registration").is_empty());
        assert_displaced(&cell, &result.measured, |_| 1.0, Some(GIVE));
    }
    // The options go before the cell.
    with_pose.tracker.base_from_tracker = Some(Isometry3::identity());
    let result = reduce(&with_pose, &table, &given(tracker_pose())).unwrap();
    assert_eq!(result.base_from_tracker, tracker_pose());
}

#[test]
fn one_or_two_wrong_postures_do_not_spoil_the_registration() {
    let mut cell = reference_cell();
    cell.noise.reading_variance = 1e-10;
    let options = Experiment {
        base_from_tracker: tracker_pose(),
        tracker_noise: TrackerNoise::Isotropic,
        ..Experiment::default()
    };
    for wrong in [vec![0], vec![3], vec![1, 4]] {
        let mut table = take(&cell, &options, 5);
        for p in &wrong {
            table.postures[*p].posture.q[1 + p % 3] += 0.2;
        }
        let result = reduced(&cell, &table);
        let registration = result.registration.as_ref().unwrap();
        let left_out: Vec<usize> = (0..6).filter(|i| !registration.postures[*i].used).collect();
        assert_eq!(left_out, wrong);
        let difference = result.base_from_tracker.rotation.angle_to(&tracker_pose().rotation);
        assert!(difference < 2e-5, "{difference:e}");
        assert_eq!(found(&result, "registration-outlier").len(), 1);
        // Left out of the registration only.
        assert_eq!(result.measured.len(), 6);
    }
}

#[test]
fn a_given_transform_that_is_wrong_is_named() {
    let cell = reference_cell();
    let options = Experiment { base_from_tracker: tracker_pose(), ..Experiment::default() };
    let table = take(&cell, &options, 1);
    let turned = pose(0.0, 0.0, 0.0, [0.0, 0.0, 0.005]) * tracker_pose();
    let result = reduce(&cell, &table, &given(turned)).unwrap();
    let finding = found(&result, "given-registration")[0];
    assert_eq!(finding.severity, Severity::Caution);
    insta::assert_snapshot!(finding.sentence, @"With the given transform the unloaded points lie 10.79 mm (RMS) from where the model puts them; a transform turned by 5.00 mrad against it brings them to 0.00 µm. Displacements are off by that turn.");
    assert!(result.registration.unwrap().rms_m > 1e-3);
}
