//! Numbers of the library are those of independent tools; `golden/README.md` has their sources.
//!
//! `cargo test --workspace --test it golden -- --nocapture` prints the agreement reached.

mod robots;

use crate::common::model::{M4, rot_x, rot_z, shift, times};
use crate::common::prelude::*;
use crate::common::{
    entrywise_error, list, matrix, number, numbers, postures_from_deg, random_group, reference, vector3,
};
use nalgebra::Matrix4;
use serde_json::Value;
use stiffarm::estimate::identify::JointEstimate;
use stiffarm::model::dexterity;
use stiffarm::model::robot::catalogue;

/// Agreement asked of everything that is not a finite difference.
const TIGHT: f64 = 1e-9;

fn check(what: &str, error: f64, tolerance: f64) {
    println!("{what:<44} {error:.1e}");
    assert!(error <= tolerance, "{what}: off by {error:e}, allowed {tolerance:e}");
}

fn slice(m: &DMatrix<f64>) -> &[f64] {
    m.as_slice()
}

#[test]
fn terms_of_single_postures() {
    let cell = reference_cell();
    let data = reference();
    let setup = &cell.setup;
    let stiffness = cell.require_prior().unwrap().to_vec();
    let postures = list(&data["postures"]);
    let angles = postures_from_deg(&Value::Array(postures.iter().map(|p| p["q_deg"].clone()).collect()));
    assert_eq!(angles.len(), 5);
    let mut worst = std::collections::BTreeMap::<&str, f64>::new();
    let mut note = |what, ours: &[f64], golden: &[f64]| {
        let entry = worst.entry(what).or_insert(0.0);
        *entry = entry.max(relative_error(ours, golden));
    };
    for (golden, q) in postures.iter().zip(&angles) {
        let terms = PostureTerms::new(setup, q, None).unwrap();
        let p = terms.loading_point();
        let loading = numbers(&golden["loading_point_xyz"]);
        note("loading point", p.as_slice(), &loading);
        let measuring = terms.measuring_points()[0];
        for (what, at) in [("J_loading", p), ("J_measuring_1", &measuring)] {
            let ours = terms.frames().jacobian(at);
            note(what, ours.as_slice(), slice(&matrix(&golden[what])));
        }
        let force = terms.wrench().force;
        note("force", force.as_slice(), &numbers(&golden["force"]));
        note("torque", terms.torque(), &numbers(&golden["torque"]));
        let psi = terms.block(&setup.robot);
        note("psi", slice(&psi), slice(&matrix(&golden["psi"])));
        let k = dexterity::condition_number(terms.frames(), &measuring, 0.773).unwrap();
        note("k_jn", &[k], &[number(&golden["k_jn"])]);
        let ours = stiffness_correction(&terms);
        let theirs = matrix(&golden["k_c"]);
        note("k_c (finite differences)", slice(&ours), slice(&theirs));
        let displacement = |correction: Option<&DMatrix<f64>>| {
            linear_displacement(setup, &terms, &measuring, &stiffness, correction).unwrap()
        };
        let expected = numbers(&golden["displacement_m1"]);
        note("displacement", displacement(None).as_slice(), &expected);
        let expected = numbers(&golden["displacement_m1_with_kc"]);
        // With the reference's own K_C its finite differences don't count.
        for (what, correction) in [("displacement with K_C", &theirs), ("displacement with our K_C", &ours)] {
            note(what, displacement(Some(correction)).as_slice(), &expected);
        }
    }
    for (what, error) in worst {
        let is_finite_difference = what.ends_with("(finite differences)");
        check(what, error, if is_finite_difference { 1e-8 } else { TIGHT });
    }
}

#[test]
fn indices_and_expected_errors_of_groups() {
    let cell = reference_cell();
    let data = reference();
    let sigma = cell.noise.displacement_std();
    for name in ["group1", "random_group"] {
        let golden = &data[name];
        let group = postures_from_deg(&golden["q_deg"]);
        let ours = evaluate(&cell, name, &group).unwrap();
        let all = |v: &[Option<f64>]| v.iter().map(|v| v.unwrap()).collect::<Vec<f64>>();
        let per_joint = |ours: &[f64], key: &str| {
            let error = entrywise_error(ours, &numbers(&golden[key]));
            check(&format!("{name} {key}"), error, TIGHT);
        };
        per_joint(&all(&ours.k_jn), "k_jn");
        per_joint(&ours.singular_values, "singular_values_psi");
        let per_unit = all(&ours.relative_standard_error);
        let per_unit: Vec<f64> = per_unit.iter().map(|e| e / sigma).collect();
        per_joint(&per_unit, "relative_std_per_unit_sigma_m");
        let deviation = all(&ours.expected_deviation);
        per_joint(&deviation, "expected_deviation_level2");
        let indices = ours.indices;
        let k_max = numbers(&golden["k_jn"]).into_iter().fold(0.0, f64::max);
        // The RMS and the largest of the reference's own errors.
        let errors = numbers(&golden["relative_std_per_unit_sigma_m"]);
        let rms = sigma * (errors.iter().map(|e| e * e).sum::<f64>() / 6.0).sqrt();
        let largest = sigma * errors.iter().copied().fold(0.0, f64::max);
        let condition = number(&golden["cond_psi"]);
        let scaled = number(&golden["cond_psi_scaled"]);
        let o = |i: usize| number(&golden["observability"][format!("O{i}")]);
        let d = sigma * number(&golden["d_per_unit_sigma_m"]);
        for (what, ours, golden) in [
            ("cond(psi)", indices.condition, condition),
            ("novel", indices.novel, number(&golden["novel"])),
            ("scaled condition", indices.scaled_condition, scaled),
            ("d", indices.d, d),
            ("O1", indices.o1, o(1)),
            ("O2", indices.o2, o(2)),
            ("O3", indices.o3, o(3)),
            ("O4", indices.o4, o(4)),
            ("O5", indices.o5, o(5)),
            ("classical", indices.classical, k_max),
            ("scaled", indices.scaled, k_max * scaled),
            ("expected error", indices.expected_error, rms),
            ("worst joint", indices.worst_joint, largest),
        ] {
            let error = relative_error(&[ours.unwrap()], &[golden]);
            check(&format!("{name} {what}"), error, TIGHT);
        }
    }
}

#[test]
fn identification_of_noisy_displacements() {
    let cell = reference_cell();
    let golden = &reference()["identification"];
    let displacements = numbers(&golden["displacements_m"]);
    let measured: Vec<MeasuredPosture> = numbered(random_group())
        .into_iter()
        .zip(displacements.chunks_exact(12))
        .map(|(posture, rows)| {
            let points = rows.chunks_exact(3).map(Vector3::from_column_slice);
            let displacements = points.enumerate().map(|(point, v)| Displacement::new(point, v));
            MeasuredPosture::new(posture, displacements.collect())
        })
        .collect();
    assert_eq!(measured.len(), 6);
    let result = identify(&cell, &measured, &by(Estimator::Ordinary)).unwrap();
    assert_eq!((result.estimates.rows, result.estimates.degrees_of_freedom), (72, 66));
    assert!(result.estimates.is_complete());
    let joints = &result.estimates.joints;
    let per_joint = |what: &str, get: &dyn Fn(&JointEstimate) -> Option<f64>| -> Vec<f64> {
        let ours: Vec<f64> = joints.iter().map(|j| get(j).unwrap()).collect();
        check(what, entrywise_error(&ours, &numbers(&golden[what])), TIGHT);
        ours
    };
    per_joint("compliance", &|j| j.compliance);
    per_joint("stiffness", &|j| j.stiffness);
    let errors = per_joint("compliance_std", &|j| j.compliance_standard_error);
    let variance = result.residual_std_m.unwrap().powi(2);
    let expected = number(&golden["residual_variance_m2"]);
    check("residual variance", relative_error(&[variance], &[expected]), TIGHT);

    // The same with the size of the noise known: the errors scale by σ/s.
    let options = changed(by(Estimator::Ordinary), |o| o.noise = NoiseSource::Known);
    let identification = identify(&cell, &measured, &options).unwrap();
    let ratio = cell.noise.displacement_std() / variance.sqrt();
    for (joint, error) in identification.estimates.joints.iter().zip(&errors) {
        let with_sigma = joint.compliance_standard_error.unwrap();
        check("known noise", relative_error(&[with_sigma], &[error * ratio]), TIGHT);
    }
}

/// Correct decimal digits of `ours`.
fn digits(ours: f64, certified: f64) -> f64 {
    -((ours - certified).abs() / certified.abs()).max(1e-16).log10()
}

#[test]
fn longley_regression_reaches_the_certified_values() {
    let certified: Value = serde_json::from_str(include_str!("../../golden/nist/longley.json")).unwrap();
    let rows: Vec<Vec<f64>> = include_str!("../../golden/nist/longley.csv")
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|v| v.trim().parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 16);
    let design = DMatrix::from_fn(16, 7, |i, j| if j == 0 { 1.0 } else { rows[i][j + 1] });
    let response = DVector::from_fn(16, |i, _| rows[i][1]);
    let factor = Factor::new(&design).unwrap();
    assert_eq!(factor.rank(), 7);
    let ours = factor.solve(&response);
    let residual = &response - &design * &ours;
    let deviation = (residual.norm_squared() / 9.0).sqrt();
    let worst = |ours: &[f64], certified: &[f64]| {
        ours.iter().zip(certified).map(|(a, b)| digits(*a, *b)).fold(f64::INFINITY, f64::min)
    };
    let coefficients = worst(ours.as_slice(), &numbers(&certified["beta"]));
    let errors: Vec<f64> = factor.standard_errors().iter().map(|e| e.unwrap() * deviation).collect();
    let errors = worst(&errors, &numbers(&certified["stderr"]));
    let deviation = digits(deviation, number(&certified["rsd"]));
    let by_inverse = worst((factor.pseudo_inverse(16) * &response).as_slice(), &numbers(&certified["beta"]));
    println!("Longley, correct digits: coefficients {coefficients:.1}, by pseudo-inverse {by_inverse:.1},");
    println!("standard errors {errors:.1}, residual deviation {deviation:.1}");
    assert!(coefficients >= 10.0, "coefficients: {coefficients:.2} digits");
    assert!(by_inverse >= 10.0, "by pseudo-inverse: {by_inverse:.2} digits");
    assert!(errors >= 10.0, "standard errors: {errors:.2} digits");
    assert!(deviation >= 10.0, "residual deviation: {deviation:.2} digits");
}

#[test]
fn full_pose_rows_repeat_the_translations_and_weigh_the_turns() {
    let cell = reference_cell();
    let group = random_group();
    let translations = observation_matrix(&cell.setup, &group, Rows::Translations).unwrap();
    let full = observation_matrix(&cell.setup, &group, Rows::FullPose { length: 0.5 }).unwrap();
    assert_eq!(full.shape(), (144, 6));
    for (p, q) in group.iter().enumerate() {
        let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
        for point in 0..4 {
            let at = 4 * p + point;
            assert_eq!(full.rows(6 * at, 3), translations.rows(3 * at, 3));
            for j in 0..6 {
                let turn = terms.frames().axes()[j] * (terms.torque()[j] * 0.5);
                assert!((full.fixed_view::<3, 1>(6 * at + 3, j) - turn).amax() < 1e-9);
            }
        }
    }
    // The anchor is where the load points.
    let anchor = vector3(&reference()["load"]["anchor"]);
    let terms = PostureTerms::new(&cell.setup, &group[0], None).unwrap();
    let along = (anchor - terms.loading_point()).normalize();
    assert!((terms.wrench().force / 500.0 - along).amax() < 1e-12);
}
