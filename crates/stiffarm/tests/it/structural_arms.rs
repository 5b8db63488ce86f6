//! Arms of a structural code, as seven compliances at the base and the frames of the robot's rows: what the mixed model
//! knows of them from twelve postures under one rope. `bench/structural_arms.py` counts it on all of them.

use crate::common::prelude::*;
use nalgebra::{Matrix3, Rotation3};
use serde_json::Value;
use stiffarm::Control;
use stiffarm::estimate::identified::{Identified, Wanted};
use stiffarm::estimate::mixed::MixedFit;
use stiffarm::plan::select::random_group;

/// α \[deg\], a, d \[mm\], offset \[deg\] of the rows, as their source prints them, and θ from the controller's angles.
const ROWS: [[f64; 4]; 6] = [
    [0.0, 0.0, 830.0, 0.0],
    [-90.0, 400.0, 0.0, -90.0],
    [0.0, 1175.0, 0.0, -90.0],
    [-90.0, 250.0, 1444.0, 0.0],
    [90.0, 0.0, 0.0, 0.0],
    [-90.0, 0.0, 230.0, 180.0],
];

/// Frames of the base and the rows.
fn frames(q: &[f64]) -> Vec<(Matrix3<f64>, Vector3<f64>)> {
    let theta = [-q[0], q[1], -q[1] - q[2], -q[3], q[4], -q[5]];
    let (mut rotation, mut origin) = (Matrix3::identity(), Vector3::zeros());
    let mut out = vec![(rotation, origin)];
    for ([alpha, a, d, offset], theta) in ROWS.iter().zip(theta) {
        rotation *= Rotation3::from_axis_angle(&Vector3::x_axis(), alpha.to_radians()).matrix();
        origin += rotation * Vector3::new(a * 1e-3, 0.0, 0.0);
        let turn = theta + offset.to_radians();
        rotation *= Rotation3::from_axis_angle(&Vector3::z_axis(), turn).matrix();
        origin += rotation * Vector3::new(0.0, 0.0, d * 1e-3);
        out.push((rotation, origin));
    }
    out
}

struct Arm {
    springs: Vec<Matrix6<f64>>,
    check: Value,
}

fn arms() -> Vec<(String, Arm)> {
    let all: Value = serde_json::from_str(include_str!("../golden/structural-arms.json")).unwrap();
    let number = |v: &Value| v.as_f64().unwrap();
    let arm = |(name, arm): (&String, &Value)| {
        let springs = arm["springs_beyond_axes"].as_array().unwrap();
        let springs = springs.iter().enumerate().map(|(place, own)| {
            let mut own = Matrix6::from_fn(|i, j| number(&own[i][j]));
            if place > 0 {
                own[(5, 5)] += 1.0 / number(&arm["joint_stiffness_nm_per_rad"][place - 1]);
            }
            own
        });
        let arm = Arm {
            springs: springs.collect(),
            check: arm["check"].clone(),
        };
        (name.clone(), arm)
    };
    all["arms"].as_object().unwrap().iter().map(arm).collect()
}

impl Arm {
    /// Displacement of points under a force at a place, base axes.
    fn bent(
        &self,
        q: &[f64],
        force: &Vector3<f64>,
        at: &Vector3<f64>,
        points: &[Vector3<f64>],
    ) -> Vec<Vector3<f64>> {
        let mut out = vec![Vector3::zeros(); points.len()];
        for ((rotation, origin), spring) in frames(q).iter().zip(&self.springs) {
            let moment = rotation.tr_mul(&(at - origin).cross(force));
            let force = rotation.tr_mul(force);
            let wrench = Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z);
            let twist = spring * wrench;
            let shift: Vector3<f64> = rotation * twist.fixed_rows::<3>(0);
            let turn: Vector3<f64> = rotation * twist.fixed_rows::<3>(3);
            for (sum, p) in out.iter_mut().zip(points) {
                *sum += shift + turn.cross(&(p - origin));
            }
        }
        out
    }

    /// Displacements under the rope of the cell at random postures, with its noise.
    fn measured(&self, cell: &Cell, postures: usize, seed: u64) -> Vec<MeasuredPosture> {
        let group = random_group(cell, StartKind::Uniform, postures, seed, 0).unwrap();
        let mut dice = Dice::new(seed);
        let mut normal = || (0..12).map(|_| dice.between(0.0, 1.0)).sum::<f64>() - 6.0;
        let std = cell.noise.displacement_std();
        let each = numbered(group).into_iter().map(|posture| {
            let terms = PostureTerms::new(&cell.setup, &posture.q, None).unwrap();
            let points = terms.measuring_points();
            let bent = self.bent(
                &posture.q,
                &terms.wrench().force,
                terms.loading_point(),
                points,
            );
            let displacements = bent.into_iter().enumerate().map(|(a, value)| {
                let noise = Vector3::new(normal(), normal(), normal()) * std;
                Displacement::new(a, value + noise)
            });
            MeasuredPosture::new(posture, displacements.collect())
        });
        each.collect()
    }
}

/// The seven springs are the structure: the source has it bend by finite elements.
#[test]
fn seven_springs_are_the_structure() {
    let cell = default_cell();
    for (name, arm) in arms() {
        for check in arm.check.as_array().unwrap() {
            let numbers = |v: &Value| {
                v.as_array()
                    .unwrap()
                    .iter()
                    .map(|v| v.as_f64().unwrap())
                    .collect::<Vec<f64>>()
            };
            let q: Vec<f64> = numbers(&check["q_deg"])
                .iter()
                .map(|v| v.to_radians())
                .collect();
            let force = Vector3::from_vec(numbers(&check["force_n"]));
            let wrench = Wrench::force(force);
            let terms = PostureTerms::new(&cell.setup, &q, Some(&wrench)).unwrap();
            let points = terms.measuring_points();
            let bent = arm.bent(&q, &force, &points[0], points);
            for (ours, theirs) in bent
                .iter()
                .zip(check["displacement_mm"].as_array().unwrap())
            {
                let theirs = Vector3::from_vec(numbers(theirs)) * 1e-3;
                // The source's second order: some hundredths of a millimetre.
                assert!((ours - theirs).norm() < 8e-5, "{name}: {ours} {theirs}");
            }
        }
    }
}

/// Twelve postures under one rope: the default model predicts other loads several times better than the axes, inside its
/// bands, k is what reproduces the arm, and no sound posture is called outlying.
#[test]
fn other_loads_are_predicted_as_well_as_the_one_measured() {
    let cell = default_cell();
    let (mut square, mut of_axes, mut inside, mut count) = (0.0, 0.0, 0, 0);
    let (mut holds, mut joints, mut outlying) = (0, 0, 0);
    for (i, (name, arm)) in arms().into_iter().enumerate() {
        let measured = arm.measured(&cell, 12, 40 + i as u64);
        let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
        let mixed = MixedFit::new(&fit).unwrap();
        let found = mixed.compliance();
        let axes = fit.compliance().unwrap();
        let spread = found.spread.as_ref().unwrap();
        let (mut information, mut right) = (DMatrix::zeros(6, 6), DVector::zeros(6));
        let mut dice = Dice::new(i as u64);
        for q in random_group(&cell, StartKind::Uniform, 200, 9, 0).unwrap() {
            let force = dice.vector(600.0);
            let rope = PostureTerms::new(&cell.setup, &q, None).unwrap();
            let at = rope.measuring_points()[0];
            let moved = Wrench {
                force,
                moment: (at - rope.loading_point()).cross(&force),
            };
            let terms = PostureTerms::new(&cell.setup, &q, Some(&moved)).unwrap();
            let columns = terms
                .block_with(&cell.setup.robot, &found.extra)
                .rows(0, 3)
                .into_owned();
            let truth = arm.bent(&q, &force, &at, &[at])[0];
            let error = &columns * &found.values - truth;
            let variance = &columns * &spread.covariance * columns.transpose();
            square += error.norm_squared();
            of_axes += (columns.columns(0, 6) * axes.values.rows(0, 6) - truth).norm_squared();
            count += 3;
            // Two standard errors, and the doubt about the sizes.
            inside += (0..3)
                .filter(|i| error[*i].abs() < 2.3 * variance[(*i, *i)].sqrt())
                .count();
            let psi = rope.block(&cell.setup.robot);
            let bent = arm.bent(
                &q,
                &rope.wrench().force,
                rope.loading_point(),
                rope.measuring_points(),
            );
            let bent = DVector::from_iterator(12, bent.iter().flat_map(|p| p.data.0[0]));
            information += psi.tr_mul(&psi);
            right += psi.tr_mul(&bent);
        }
        let truth = information.try_inverse().unwrap() * right;
        let identified = Identified::new(&fit, &Wanted::default(), Control::default()).unwrap();
        for (joint, h) in identified
            .identification
            .estimates
            .joints
            .iter()
            .zip(truth.iter())
        {
            let [low, high] = joint.interval;
            let held =
                low.is_some_and(|low| low <= 1.0 / h) && high.is_none_or(|high| 1.0 / h <= high);
            holds += usize::from(held);
            joints += 1;
        }
        let said = &identified.diagnosis.unwrap().findings;
        outlying += said
            .iter()
            .filter(|f| f.code.starts_with("outlying"))
            .count();
        println!("{name}: {square:e} {of_axes:e}");
    }
    let rms = |square: f64| 1e3 * (square / (count as f64 / 3.0)).sqrt();
    println!(
        "{} {} {inside}/{count} {holds}/{joints} {outlying}",
        rms(square),
        rms(of_axes)
    );
    assert!(rms(square) < 0.06, "{}", rms(square));
    assert!(rms(square) < 0.25 * rms(of_axes), "{}", rms(of_axes));
    assert!(inside as f64 > 0.85 * count as f64, "{inside} of {count}");
    assert!(holds + 1 >= joints, "{holds} of {joints}");
    assert_eq!(outlying, 0);
}

/// A posture whose load was half as large again as stated, among those of arms that bend beyond their axes.
#[test]
fn a_wrong_load_is_named_on_an_arm_that_bends() {
    let cell = default_cell();
    for (i, (name, arm)) in arms().into_iter().enumerate() {
        let mut measured = arm.measured(&cell, 12, 60 + i as u64);
        measured[4]
            .displacements
            .iter_mut()
            .for_each(|d| d.value *= 1.5);
        let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
        let identified = Identified::new(&fit, &Wanted::default(), Control::default()).unwrap();
        let said = identified.diagnosis.unwrap().findings;
        let named: Vec<&str> = said
            .iter()
            .filter(|f| f.code == "outlying-posture")
            .map(|f| f.subject.as_str())
            .collect();
        assert_eq!(named, ["posture 5"], "{name}: {said:#?}");
    }
}
