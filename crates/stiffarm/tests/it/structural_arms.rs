//! Arms of a structural code, as seven compliances at the base and the frames of the robot's rows: what the mixed model
//! knows of them from twelve postures under one rope. `bench/structural_arms.py` counts it on all of them.

use crate::common::prelude::*;
use crate::set_up::days::{structural_at, structure};
use stiffarm::Control;
use stiffarm::estimate::identified::{Identified, Wanted};
use stiffarm::estimate::mixed::MixedFit;
use stiffarm::plan::select::random_group;

const ARMS: [&str; 3] = ["realistic", "links_half", "arm_0"];

/// An arm with the joints of the default cell's prior.
struct Arm {
    springs: Vec<Matrix6<f64>>,
    axes: DVector<f64>,
}

fn arms(cell: &Cell) -> impl Iterator<Item = (&'static str, Arm)> {
    let axes = compliance_of(cell.require_prior().unwrap());
    ARMS.into_iter().map(move |name| {
        let (springs, axes) = (structure(name), axes.clone());
        (name, Arm { springs, axes })
    })
}

impl Arm {
    /// Displacement of the measuring points at a posture under a load, base axes.
    fn bent(&self, cell: &Cell, terms: &PostureTerms) -> Vec<Vector3<f64>> {
        let joints = terms.block(&cell.setup.robot) * &self.axes;
        let beyond = structural_at(terms, &self.springs, 1.0).into_iter();
        beyond
            .enumerate()
            .map(|(a, beyond)| beyond + joints.fixed_rows::<3>(3 * a))
            .collect()
    }

    /// Displacements under the rope of the cell at random postures, with its noise.
    fn measured(&self, cell: &Cell, postures: usize, seed: u64) -> Vec<MeasuredPosture> {
        let group = random_group(cell, StartKind::Uniform, postures, seed, 0).unwrap();
        let mut dice = Dice::new(seed);
        let mut normal = || (0..12).map(|_| dice.between(0.0, 1.0)).sum::<f64>() - 6.0;
        let std = cell.noise.displacement_std();
        let each = numbered(group).into_iter().map(|posture| {
            let terms = PostureTerms::new(&cell.setup, &posture.q, None).unwrap();
            let displacements =
                self.bent(cell, &terms)
                    .into_iter()
                    .enumerate()
                    .map(|(a, value)| {
                        let noise = Vector3::new(normal(), normal(), normal()) * std;
                        Displacement::new(a, value + noise)
                    });
            MeasuredPosture::new(posture, displacements.collect())
        });
        each.collect()
    }
}

/// Twelve postures under one rope: the default model predicts other loads several times better than the axes, inside its
/// bands, k is what reproduces the arm, and no sound posture is called outlying.
#[test]
fn other_loads_are_predicted_as_well_as_the_one_measured() {
    let cell = default_cell();
    let (mut square, mut of_axes, mut inside, mut count) = (0.0, 0.0, 0, 0);
    let (mut holds, mut joints, mut outlying) = (0, 0, 0);
    for (i, (name, arm)) in arms(&cell).enumerate() {
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
            let truth = arm.bent(&cell, &terms)[0];
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
            let bent = arm.bent(&cell, &rope);
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
    for (i, (name, arm)) in arms(&cell).enumerate() {
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
