//! Validation: bands about predicted displacements hold what they say, and folds over postures are honest.

use crate::common::prelude::*;
use crate::common::random_group;
use statrs::distribution::{Binomial, ContinuousCDF, DiscreteCDF, StudentsT};
use stiffarm::estimate::validate::{Validation, validate};

const FALSE_ALARM: f64 = 1e-6;

fn group(angles: Vec<Vec<f64>>) -> Vec<Posture> {
    numbered(angles)
}

/// Postures named apart from those of the identification.
fn held_out(angles: Vec<Vec<f64>>) -> Vec<Posture> {
    let mut postures = group(angles);
    for posture in &mut postures {
        posture.name.insert(0, 'v');
    }
    postures
}

fn measure(cell: &Cell, postures: &[Posture], stream: usize) -> Vec<MeasuredPosture> {
    let truth = cell.require_prior().unwrap();
    simulate_measurements(cell, postures, truth, Model::Linear, 5, stream).unwrap()
}

/// What predicts after an identification at the random group.
fn predictor(cell: &Cell, options: &IdentifyOptions, stream: usize) -> IdentifiedCompliance {
    let measured = measure(cell, &group(random_group()), stream);
    let fit = identify(cell, measured, options).unwrap();
    IdentifiedCompliance::from_identification(cell, &fit).unwrap()
}

fn folded(
    cell: &Cell,
    measured: &[MeasuredPosture],
    options: &IdentifyOptions,
    folds: usize,
    tolerance: Option<f64>,
) -> stiffarm::Result<Validation> {
    cross_validate(&Fit::new(cell, measured, options)?, folds, tolerance)
}

fn validated(cell: &Cell, options: &IdentifyOptions, stream: usize) -> Validation {
    let predictor = predictor(cell, options, 2 * stream);
    let measured = measure(cell, &held_out(group1()), 2 * stream + 1);
    validate_with(cell, &predictor, &measured, Model::Linear, None).unwrap()
}

#[test]
fn bands_hold_as_many_readings_as_they_say() {
    let runs = runs(150) as usize;
    let independent = reference_cell();
    let mut common = independent.clone();
    common.noise.posture_common_std = 2.0 * common.noise.displacement_std();
    let known_noise = changed(by(Estimator::Weighted), |o| o.noise = NoiseSource::Known);
    // Shares of single components, one of each experiment, are independent.
    let binomial = Binomial::new(0.95, runs as u64).unwrap();
    let (least, most) = (binomial.inverse_cdf(FALSE_ALARM), binomial.inverse_cdf(1.0 - FALSE_ALARM));
    for (cell, options, what) in [
        (&independent, &by(Estimator::Ordinary), "ordinary"),
        (&independent, &known_noise, "known noise"),
        (&common, &known_noise, "known noise with shifts"),
        (&common, &by(Estimator::Weighted), "weighted with shifts"),
    ] {
        let (mut one, mut all) = (0, 0);
        for run in 0..runs {
            let result = validated(cell, options, run);
            let band = result.band.as_ref().unwrap();
            assert_eq!(band.components, 72);
            all += band.inside;
            one += u64::from(result.points[run % 24].band.as_ref().unwrap().inside[run % 3]);
        }
        println!("{what}: {one} of {runs} single components, {:.2} % of all", 100.0 * all as f64 / (72 * runs) as f64);
        assert!((least..=most).contains(&one), "{what}: {one}, expected {least} to {most}");
    }
    // Both variances estimated: conservative by its degrees of freedom.
    let (mut one, runs) = (0, runs / 5);
    for run in 0..runs {
        let result = validated(&common, &by(Estimator::TwoVariance), run);
        one += u64::from(result.points[run % 24].band.as_ref().unwrap().inside[run % 3]);
    }
    println!("two variances: {one} of {runs}");
    let binomial = Binomial::new(0.93, runs as u64).unwrap();
    assert!(one >= binomial.inverse_cdf(1e-4), "{one} of {runs}");
}

#[test]
fn a_band_is_that_of_the_dense_formula() {
    let mut cell = reference_cell();
    cell.noise.readings_per_displacement = 2;
    cell.noise.posture_common_std = 1.5e-5;
    let predictor = predictor(&cell, &by(Estimator::TwoVariance), 0);
    let spread = predictor.spread.clone().unwrap();
    // Two load states, the second with half of the load, against one reference.
    let mut measured = measure(&cell, &held_out(group1()), 1);
    let mut half = measured.clone();
    for (full, half) in measured.iter_mut().zip(&mut half) {
        let terms = PostureTerms::new(&cell.setup, &full.posture.q, None).unwrap();
        half.wrench = Some(Wrench::force(terms.wrench().force * 0.5));
        half.state = "half".to_string();
        for d in &mut half.displacements {
            d.value *= 0.5;
            d.readings = 4;
        }
    }
    measured.extend(half);
    let result = validate_with(&cell, &predictor, &measured, Model::Linear, None).unwrap();
    assert_eq!(result.points.len(), 48);
    let t = StudentsT::new(0.0, 1.0, spread.degrees_of_freedom.unwrap() as f64).unwrap().inverse_cdf(0.975);
    for (p, point) in result.points.iter().enumerate() {
        let m = &measured[p / 4];
        let terms = PostureTerms::new(&cell.setup, &m.posture.q, m.wrench.as_ref()).unwrap();
        let psi = terms.block(&cell.setup.robot).rows(3 * (p % 4), 3).into_owned();
        let calculated = &psi * &predictor.values;
        let prediction = &psi * &spread.covariance * psi.transpose();
        let (readings, load) = if p < 24 { (1.0, 1.0) } else { (0.5 / 4.0 + 0.5, 0.5) };
        let noise = (readings * spread.sigma.powi(2) + (load * spread.shift).powi(2)).sqrt();
        let band = point.band.as_ref().unwrap();
        let unit = calculated.normalize();
        let along = (unit.transpose() * &prediction * &unit)[(0, 0)].sqrt();
        assert!((band.norm_half_width_m / (t * along) - 1.0).abs() < 1e-9);
        for axis in 0..3 {
            let std = prediction[(axis, axis)].sqrt();
            assert!((point.calculated_m[axis] - calculated[axis]).abs() < 1e-15);
            assert!((band.prediction_std_m[axis] / std - 1.0).abs() < 1e-9);
            assert!((band.noise_std_m[axis] / noise - 1.0).abs() < 1e-9, "{p}");
            assert!((band.prediction_half_width_m[axis] / (t * std) - 1.0).abs() < 1e-9);
            let half = t * std.hypot(noise);
            assert!((band.half_width_m[axis] / half - 1.0).abs() < 1e-9);
            let error = (point.measured_m[axis] - calculated[axis]).abs();
            assert_eq!(band.inside[axis], error <= half);
        }
    }
}

#[test]
fn readings_that_the_fit_does_not_explain_are_said_to_lie_outside() {
    let cell = reference_cell();
    let predictor = predictor(&cell, &by(Estimator::Ordinary), 0);
    let mut measured = measure(&cell, &held_out(group1()), 1);
    let codes = |measured: &[MeasuredPosture]| -> Vec<String> {
        let result = validate_with(&cell, &predictor, measured, Model::Linear, None).unwrap();
        result.findings.into_iter().map(|f| f.code).collect()
    };
    assert_eq!(codes(&measured), Vec::<String>::new());
    for m in &mut measured {
        for d in &mut m.displacements {
            d.value += Vector3::new(1e-4, -1e-4, 1e-4);
        }
    }
    assert_eq!(codes(&measured), ["outside-bands"]);
}

#[test]
fn leaving_out_one_posture_is_what_the_identification_says_it_is() {
    let cell = reference_cell();
    let measured = measure(&cell, &group(random_group()), 3);
    for estimator in [Estimator::TwoVariance, Estimator::Ordinary, Estimator::Huber] {
        let options = by(estimator);
        let count = measured.len();
        let result = folded(&cell, &measured, &options, count, Some(1.0)).unwrap();
        let fit = Fit::new(&cell, &measured, &options).unwrap();
        let same = fit.leave_one_out().unwrap();
        assert!((result.component_rms_m / same.rms_m.unwrap() - 1.0).abs() < 1e-12);
        assert_eq!((result.folds, result.passed), (Some(count), Some(true)));
        assert!(result.unpredicted.is_empty());
        let labels = result.points.iter().take(5).map(|p| p.label.as_str());
        let labels: Vec<&str> = labels.collect();
        assert_eq!(labels, ["1-1", "1-2", "1-3", "1-4", "2-1"]);
    }
}

#[test]
fn each_fold_is_predicted_by_a_fit_without_it() {
    let cell = reference_cell();
    let mut angles = group1();
    angles.extend(random_group());
    let measured = measure(&cell, &group(angles), 4);
    let options = changed(by(Estimator::Ordinary), |o| o.extra = vec![ExtraTerm::JointTilt(2)]);
    let result = folded(&cell, &measured, &options, 3, None).unwrap();
    for fold in 0..3 {
        let (left, others): (Vec<_>, Vec<_>) = measured.iter().cloned().enumerate().partition(|(i, _)| i % 3 == fold);
        let strip = |list: Vec<(usize, MeasuredPosture)>| list.into_iter().map(|(_, m)| m).collect::<Vec<_>>();
        let (left, others) = (strip(left), strip(others));
        let fit = identify(&cell, &others, &options).unwrap();
        let predictor = IdentifiedCompliance::from_identification(&cell, &fit).unwrap();
        let apart = validate_with(&cell, &predictor, &left, Model::Linear, None).unwrap();
        for point in apart.points {
            let same = result.points.iter().find(|p| p.posture == point.posture && p.point == point.point).unwrap();
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * 1e-3;
            assert!((0..3).all(|i| close(same.calculated_m[i], point.calculated_m[i])));
            let (a, b) = (same.band.as_ref().unwrap(), point.band.as_ref().unwrap());
            assert!((0..3).all(|i| close(a.half_width_m[i], b.half_width_m[i])));
            assert_eq!(a.inside, b.inside);
        }
    }
}

#[test]
fn a_posture_that_alone_sees_a_joint_is_named() {
    let cell = reference_cell();
    // All but one posture under a wrench that leaves joint 1 dark.
    let mut measured = measure(&cell, &group(random_group()), 6);
    let truth = cell.require_prior().unwrap();
    let compliance = compliance_of(truth);
    for m in measured.iter_mut().skip(1) {
        let wrench = Wrench::force(Vector3::new(0.0, 0.0, -500.0));
        let terms = PostureTerms::new(&cell.setup, &m.posture.q, Some(&wrench)).unwrap();
        let exact: DMatrix<f64> = terms.block(&cell.setup.robot);
        let exact = exact * &compliance;
        m.wrench = Some(wrench);
        for d in &mut m.displacements {
            d.value = exact.fixed_rows::<3>(3 * d.point).into_owned();
        }
    }
    let count = measured.len();
    let result = folded(&cell, &measured, &by(Estimator::Ordinary), count, Some(1.0)).unwrap();
    assert_eq!(result.unpredicted, ["1"]);
    assert_eq!(result.points.len(), 4 * (count - 1));
    assert_eq!(result.passed, Some(false));
    assert!(result.points.iter().all(|p| p.posture != "1"));
}

#[test]
fn further_terms_and_servo_give_are_predicted() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let mut values: Vec<f64> = truth.iter().map(|k| 1.0 / k).collect();
    let extra = vec![ExtraTerm::JointTilt(1), ExtraTerm::LostMotion(3)];
    values.extend([2e-7, 3e-5]);
    let mut dice = Dice::new(7);
    let mut measured = measure(&cell, &group(random_group()), 0);
    for m in &mut measured {
        m.servo_deflection = Some((0..6).map(|_| dice.between(-1e-4, 1e-4)).collect());
        for d in &mut m.displacements {
            d.value = Vector3::zeros();
        }
    }
    let system = measured_system(&cell, &measured, &extra, Default::default()).unwrap();
    // Of zero displacements, Δ is what is known with its sign turned.
    let exact = &system.psi * DVector::from_vec(values.clone()) - &system.delta;
    for label in &system.labels {
        let value = exact.fixed_rows::<3>(label.rows.start).into_owned();
        measured[label.measured].displacements[label.displacement].value = value;
    }
    let predictor = IdentifiedCompliance {
        common: Default::default(),
        values: DVector::from_vec(values),
        extra: extra.clone(),
        undetermined: Vec::new(),
        spread: None,
        doubts: Vec::new(),
    };
    let result = validate_with(&cell, &predictor, &measured, Model::Linear, None).unwrap();
    let deviation_max_m = result.deviation_max_m;
    assert!(deviation_max_m < 1e-15, "{deviation_max_m:e}");
    assert!(result.band.is_none() && result.points[0].band.is_none());
    let error = validate_with(&cell, &predictor, &measured, Model::Equilibrium, None).unwrap_err();
    assert_eq!(error.code(), Code::Unsupported);
    let without = validate(&cell, truth, &measured, Model::Linear, None).unwrap();
    assert!(without.deviation_max_m > 1e-5);
    // And through an identification.
    let options = changed(by(Estimator::Ordinary), |o| o.extra = extra);
    let fit = identify(&cell, &measured, &options).unwrap();
    let read_back = IdentifiedCompliance::from_identification(&cell, &fit).unwrap();
    for (a, b) in read_back.values.iter().zip(predictor.values.iter()) {
        assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
    }
}

#[test]
fn wrong_requests_are_refused() {
    let cell = reference_cell();
    let measured = measure(&cell, &group(random_group()), 0);
    let plain = by(Estimator::Ordinary);
    for folds in [0, 1, measured.len() + 1] {
        let error = folded(&cell, &measured, &plain, folds, None).unwrap_err();
        assert_eq!(error.code(), Code::InvalidValue);
    }
    let error = folded(&cell, &measured, &plain, 2, Some(f64::NAN)).unwrap_err();
    assert_eq!(error.code(), Code::InvalidValue);
    let mut dark = measured.clone();
    for m in &mut dark {
        m.wrench = Some(Wrench::force(Vector3::zeros()));
    }
    assert!(identify(&cell, &dark, &plain).is_ok());
    let fit = identify(&cell, &dark, &plain).unwrap();
    let error = IdentifiedCompliance::from_identification(&cell, &fit).unwrap_err();
    assert_eq!(error.code(), Code::NotIdentifiable);
    let error = IdentifiedCompliance::from_stiffness(&cell, &[1e6; 5]).unwrap_err();
    assert_eq!(error.code(), Code::Dimension);
}
