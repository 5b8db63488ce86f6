//! Registration: exact without noise, an honest covariance with it, the same
//! whatever the order and the frames.

use crate::common::prelude::*;
use proptest::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};
use stiffarm::measure::registration::{RegisterOptions, Registration, RegistrationRecord, register_with};

/// Points well off any line; flat ones lie in a plane.
fn points(dice: &mut Dice, count: usize, flat: bool) -> Vec<Vector3<f64>> {
    loop {
        let (turn, half) = (dice.pose(), dice.between(0.3, 1.5));
        let points: Vec<Vector3<f64>> = (0..count)
            .map(|_| {
                let mut point = dice.vector(half);
                if flat {
                    point.z = 0.0;
                }
                turn.rotation * point
            })
            .collect();
        if distance_from_line(&points) > 0.2 {
            return points;
        }
    }
}

/// Largest distance of a point from the line through the two furthest apart,
/// as a share of their distance.
fn distance_from_line(points: &[Vector3<f64>]) -> f64 {
    let pairs = points.iter().flat_map(|a| points.iter().map(move |b| (*a, *b)));
    let (a, b) = pairs.max_by(|(a, b), (c, d)| (a - b).norm().total_cmp(&(c - d).norm())).unwrap();
    let along = (b - a).normalize();
    let off = |p: &Vector3<f64>| (p - a).cross(&along).norm() / (b - a).norm();
    points.iter().map(off).fold(0.0, f64::max)
}

/// Pairs of the same points in base axes and, through `pose`, tracker axes.
fn pairs(base: &[Vector3<f64>], pose: &Isometry3<f64>) -> Vec<PointPair> {
    base.iter()
        .enumerate()
        .map(|(i, base)| PointPair {
            name: format!("p{}", i + 1),
            tracker: pose.inverse_transform_vector(&(base - pose.translation.vector)),
            base: *base,
        })
        .collect()
}

/// The turn that takes `from` into `to`, base axes \[rad\].
fn turn(from: &UnitQuaternion<f64>, to: &UnitQuaternion<f64>) -> Vector3<f64> {
    (to * from.inverse()).scaled_axis()
}

#[test]
fn a_known_transform_is_reproduced_to_1e_12() {
    let mut dice = Dice::new(1);
    let mut worst = [0.0f64; 3];
    for case in 0..4000 {
        let count = 3 + case % 8;
        let mut base = points(&mut dice, count, case % 3 == 0);
        let mut pose = dice.pose();
        if case % 5 == 0 {
            // A cell ten metres from the base's origin, a tracker as far away.
            let far = dice.direction() * 10.0;
            base.iter_mut().for_each(|p| *p += far);
            pose.translation.vector += dice.direction() * 10.0;
        }
        let registration = register(&pairs(&base, &pose)).unwrap();
        assert!(!registration.is_serious(), "{case}: {:?}", registration.findings);
        let angle = turn(&pose.rotation, &registration.base_from_tracker.rotation).norm();
        let shift = (registration.base_from_tracker.translation.vector - pose.translation.vector).norm();
        for (worst, value) in worst.iter_mut().zip([angle, shift, registration.rms]) {
            *worst = worst.max(value);
        }
    }
    println!("worst turn {:e} rad, shift {:e} m, RMS {:e} m", worst[0], worst[1], worst[2]);
    assert!(worst.iter().all(|v| *v < 1e-12), "{worst:?}");
}

#[test]
fn long_thin_sets_keep_their_digits() {
    let mut dice = Dice::new(2);
    for _ in 0..500 {
        // 2 m long, 4 mm wide: the cross-covariance alone would keep ten digits.
        let pose = dice.pose();
        let base: Vec<Vector3<f64>> =
            (0..5).map(|i| Vector3::new(0.5 * f64::from(i), 0.0, 0.0) + dice.vector(4e-3)).collect();
        let registration = register(&pairs(&base, &pose)).unwrap();
        let angle = turn(&pose.rotation, &registration.base_from_tracker.rotation).norm();
        assert!(angle < 2e-12, "{angle:e}");
    }
}

/// One simulated registration: its result, and shift and turn that are missing
/// to the truth in units of the convention.
fn draw(
    dice: &mut Dice,
    exact: &[PointPair],
    pose: &Isometry3<f64>,
    std: [f64; 2],
    options: &RegisterOptions,
) -> (Registration, Vector6<f64>) {
    let noisy: Vec<PointPair> = exact
        .iter()
        .enumerate()
        .map(|(i, pair)| {
            let scale = options.weights.get(i).map_or(1.0, |w| 1.0 / w.sqrt());
            PointPair {
                name: pair.name.clone(),
                tracker: pair.tracker + dice.noise(std[0] * scale),
                base: pair.base + dice.noise(std[1] * scale),
            }
        })
        .collect();
    let registration = register_with(&noisy, options).unwrap();
    let phi = turn(&registration.base_from_tracker.rotation, &pose.rotation);
    // The tracker position that the registration puts on its centroid.
    let at = registration.base_from_tracker.inverse_transform_point(&registration.centroid.into());
    let delta = (pose * at).coords - registration.centroid;
    let error = Vector6::from_iterator(delta.iter().chain(phi.iter()).copied());
    (registration, error)
}

#[test]
fn the_covariance_agrees_with_simulation() {
    let draws = runs(2_000) as usize;
    let mut dice = Dice::new(3);
    let weighted = vec![1.0, 4.0, 0.5, 2.0, 1.0, 0.25];
    for (count, std, weights) in [(3, [3e-5, 0.0], vec![]), (5, [2e-5, 4e-5], vec![]), (6, [0.0, 5e-5], weighted)] {
        let base = points(&mut dice, count, false);
        let pose = dice.pose();
        let exact = pairs(&base, &pose);
        let total = f64::hypot(std[0], std[1]);
        let options = with(|o: &mut RegisterOptions| {
            o.std = Some(total);
            o.weights = weights;
        });
        // First order: the covariance at the truth.
        let truth = register_with(&exact, &options).unwrap().covariance;
        let root = truth.cholesky().unwrap();
        let mut sample = Matrix6::zeros();
        let mut distance = 0.0;
        for _ in 0..draws {
            let (_, error) = draw(&mut dice, &exact, &pose, std, &options);
            let white = root.l().solve_lower_triangular(&error).unwrap();
            sample += white * white.transpose() / draws as f64;
            distance += white.norm_squared() / draws as f64;
        }
        // Whitened errors have the identity for covariance; its entries have
        // standard errors sqrt(2/draws) and sqrt(1/draws).
        let worst = (sample - Matrix6::identity()).amax();
        println!("{count} pairs: worst entry off by {worst:.4}, mean square distance {distance:.3}");
        assert!(worst < 4.5 * (2.0 / draws as f64).sqrt(), "{sample}");
        // The mean of χ² with six degrees of freedom.
        assert!((distance - 6.0).abs() < 4.5 * (12.0 / draws as f64).sqrt(), "{distance}");
    }
}

#[test]
fn intervals_of_shift_and_turn_cover_what_they_say() {
    let draws = runs(2_000) as usize;
    let mut dice = Dice::new(4);
    for count in [3, 4, 6] {
        let base = points(&mut dice, count, false);
        let pose = dice.pose();
        let exact = pairs(&base, &pose);
        let options = RegisterOptions::default();
        let freedom = (3 * count - 6) as f64;
        let t = StudentsT::new(0.0, 1.0, freedom).unwrap().inverse_cdf(0.975);
        let mut covered = [0usize; 6];
        let mut variance = 0.0;
        for _ in 0..draws {
            let (registration, error) = draw(&mut dice, &exact, &pose, [3e-5, 3e-5], &options);
            for (i, covered) in covered.iter_mut().enumerate() {
                let half = t * registration.covariance[(i, i)].sqrt();
                *covered += usize::from(error[i].abs() <= half);
            }
            variance += registration.residual_std.powi(2) / draws as f64;
        }
        let shares = covered.map(|c| 100.0 * c as f64 / draws as f64);
        println!("{count} pairs, {freedom} degrees of freedom: {shares:.2?} %");
        let most = 450.0 * standard_error(0.95, draws as u64);
        assert!(shares.iter().all(|s| (s - 95.0).abs() < most), "{shares:?}");
        let ratio = variance / (2.0 * 3e-5f64.powi(2));
        let spread = (2.0 / freedom / draws as f64).sqrt();
        assert!((ratio - 1.0).abs() < 4.5 * spread, "{ratio}");
    }
}

#[test]
fn a_transformed_point_has_the_covariance_of_shift_and_turn() {
    let draws = runs(2_000) as usize;
    let mut dice = Dice::new(5);
    let base = points(&mut dice, 5, false);
    let pose = dice.pose();
    let exact = pairs(&base, &pose);
    let options = with(|o: &mut RegisterOptions| o.std = Some(4e-5));
    let at = Vector3::new(2.0, -1.0, 0.5);
    let tracker = pose.inverse_transform_point(&at.into()).coords;
    let expected = register_with(&exact, &options).unwrap().covariance_at(&at);
    let mut sample = nalgebra::Matrix3::zeros();
    for _ in 0..draws {
        let (registration, _) = draw(&mut dice, &exact, &pose, [0.0, 4e-5], &options);
        let error = registration.to_base(&tracker) - at;
        sample += error * error.transpose() / draws as f64;
    }
    let root = expected.cholesky().unwrap().l();
    let inverse = root.try_inverse().unwrap();
    let white = inverse * sample * inverse.transpose();
    let worst = (white - nalgebra::Matrix3::identity()).amax();
    assert!(worst < 4.5 * (2.0 / draws as f64).sqrt(), "{worst}");
}

#[test]
fn a_pair_of_weight_two_counts_as_two_pairs() {
    let mut dice = Dice::new(6);
    let base = points(&mut dice, 5, false);
    let mut noisy = pairs(&base, &dice.pose());
    noisy.iter_mut().for_each(|p| p.base += dice.noise(1e-3));
    let options = with(|o: &mut RegisterOptions| {
        o.std = Some(1e-3);
        o.weights = vec![2.0, 1.0, 1.0, 1.0, 1.0];
    });
    let weighted = register_with(&noisy, &options).unwrap();
    let mut twice = noisy.clone();
    twice.push(PointPair { name: "again".to_string(), ..noisy[0].clone() });
    let known_std = with(|o: &mut RegisterOptions| o.std = Some(1e-3));
    let repeated = register_with(&twice, &known_std).unwrap();
    let difference = weighted.base_from_tracker.to_matrix() - repeated.base_from_tracker.to_matrix();
    assert!(difference.amax() < 1e-13);
    let difference = weighted.covariance - repeated.covariance;
    assert!(difference.amax() < 1e-12 * repeated.covariance.amax());
}

#[test]
fn a_record_holds_the_registration() {
    let mut dice = Dice::new(7);
    let base = points(&mut dice, 6, false);
    let mut noisy = pairs(&base, &dice.pose());
    noisy.iter_mut().for_each(|p| p.base += dice.noise(1e-4));
    let registration = register(&noisy).unwrap();
    let record = RegistrationRecord::from(&registration);
    let text = serde_json::to_string(&record).unwrap();
    let back: RegistrationRecord = serde_json::from_str(&text).unwrap();
    let again = Registration::try_from(back).unwrap();
    let [a, b] = [&registration, &again].map(|r| r.base_from_tracker.to_matrix());
    assert!((a - b).amax() < 1e-15);
    let [roll, pitch, yaw] = record.roll_pitch_yaw;
    let turned = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    assert!(turned.angle_to(&registration.base_from_tracker.rotation) < 1e-14);
    assert_eq!(again.names, registration.names);
    assert!((again.rms / registration.rms - 1.0).abs() < 1e-15);
    // Text gives a number back to its last digit but one.
    let difference = again.covariance - registration.covariance;
    assert!(difference.amax() < 1e-15 * registration.covariance.amax());

    // What is no registration is refused.
    let mut mirrored = record.clone();
    mirrored.rotation[0] = mirrored.rotation[0].map(|v| -v);
    let mut stretched = record.clone();
    stretched.rotation[1][1] += 1e-6;
    let mut infinite = record.clone();
    infinite.translation_m[2] = f64::NAN;
    let mut negative = record.clone();
    negative.covariance[3][3] = -1.0;
    let mut short = record;
    short.residuals_m.pop();
    for (wrong, key) in [
        (mirrored, "rotation"),
        (stretched, "rotation"),
        (infinite, "translation_m"),
        (negative, "covariance"),
        (short, "residuals_m"),
    ] {
        let error = Registration::try_from(wrong).unwrap_err();
        assert_eq!(error.place().key.as_deref(), Some(key), "{error}");
    }
}

/// Noisy pairs with seed, number and flatness drawn.
fn noisy_pairs() -> impl Strategy<Value = (Vec<PointPair>, u64)> {
    (3..9usize, any::<bool>(), any::<u64>()).prop_map(|(count, flat, seed)| {
        let mut dice = Dice::new(seed);
        let base = points(&mut dice, count, flat);
        let mut pairs = pairs(&base, &dice.pose());
        pairs.iter_mut().for_each(|p| p.base += dice.noise(2e-4));
        (pairs, seed)
    })
}

fn close(a: &Isometry3<f64>, b: &Isometry3<f64>) -> bool {
    (a.to_matrix() - b.to_matrix()).amax() < 1e-12
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn the_order_of_the_pairs_changes_nothing((pairs, _) in noisy_pairs(), shift in 1..8usize) {
        let mut other = pairs.clone();
        other.rotate_left(shift % pairs.len());
        let (a, b) = (register(&pairs).unwrap(), register(&other).unwrap());
        prop_assert!(close(&a.base_from_tracker, &b.base_from_tracker));
        prop_assert!((a.rms / b.rms - 1.0).abs() < 1e-9);
        let codes = |r: &Registration| r.findings.iter().map(|f| f.code.clone()).collect::<Vec<_>>();
        prop_assert_eq!(codes(&a), codes(&b));
        prop_assert!((a.covariance - b.covariance).amax() < 1e-9 * a.covariance.amax());
    }

    #[test]
    fn frames_moved_on_either_side_move_the_transform((pairs, seed) in noisy_pairs()) {
        let mut dice = Dice::new(!seed);
        let (left, right) = (dice.pose(), dice.pose());
        let moved: Vec<PointPair> = pairs
            .iter()
            .map(|p| PointPair {
                name: p.name.clone(),
                tracker: (right * nalgebra::Point3::from(p.tracker)).coords,
                base: (left * nalgebra::Point3::from(p.base)).coords,
            })
            .collect();
        let (a, b) = (register(&pairs).unwrap(), register(&moved).unwrap());
        prop_assert!(close(&(left * a.base_from_tracker * right.inverse()), &b.base_from_tracker));
        prop_assert!((a.rms / b.rms - 1.0).abs() < 1e-8);
        // Shift and turn turn with the base.
        let mut turned = Matrix6::zeros();
        let rotation = left.rotation.to_rotation_matrix();
        for at in [0, 3] {
            turned.fixed_view_mut::<3, 3>(at, at).copy_from(rotation.matrix());
        }
        let expected = turned * a.covariance * turned.transpose();
        prop_assert!((expected - b.covariance).amax() < 1e-8 * b.covariance.amax());
    }

    #[test]
    fn the_frames_exchanged_give_the_inverse((pairs, _) in noisy_pairs()) {
        let exchanged: Vec<PointPair> = pairs
            .iter()
            .map(|p| PointPair { name: p.name.clone(), tracker: p.base, base: p.tracker })
            .collect();
        let (a, b) = (register(&pairs).unwrap(), register(&exchanged).unwrap());
        prop_assert!(close(&a.base_from_tracker.inverse(), &b.base_from_tracker));
    }

    #[test]
    fn the_fit_is_the_best_there_is((pairs, seed) in noisy_pairs(), size in 1e-6..1e-2f64) {
        let registration = register(&pairs).unwrap();
        let mut dice = Dice::new(!seed);
        let nudge = Isometry3::from_parts(
            Translation3::from(dice.direction() * size),
            UnitQuaternion::from_scaled_axis(dice.direction() * size),
        );
        let other = nudge * registration.base_from_tracker;
        let square = |p: &PointPair| (p.base - (other * nalgebra::Point3::from(p.tracker)).coords).norm_squared();
        let rms = (pairs.iter().map(square).sum::<f64>() / pairs.len() as f64).sqrt();
        prop_assert!(rms > registration.rms, "{rms} {}", registration.rms);
    }
}
