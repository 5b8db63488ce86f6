//! Joints that carry no load, and those that the data tell apart only together, are named and get no interval: on a
//! light arm of seven joints.

use crate::common::cases::sentences;
use crate::common::prelude::*;
use stiffarm::estimate::identify::{CollinearSet, Identification, implausible_scale};

/// Alternating axes as a KUKA LBR iiwa 14 has them, one reflector, a weight that
/// hangs beside axis 7 by `beside` \[m\].
fn cell(beside: f64) -> Cell {
    let quarter = FRAC_PI_2;
    let turns = [-quarter, quarter, quarter, -quarter, -quarter, quarter, 0.0];
    let lengths = [0.36, 0.0, 0.42, 0.0, 0.4, 0.0, 0.126];
    let rows: Vec<[f64; 4]> = turns.iter().zip(lengths).map(|(alpha, d)| [*alpha, 0.0, d, 0.0]).collect();
    let mut cell = reference_cell();
    cell.setup.robot = chain("seven joints", DhConvention::Standard, &rows);
    cell.setup.load = hanging(120.0);
    cell.setup.tool.loading_point = Vector3::new(0.0, beside, 0.06);
    cell.setup.tool.measuring_points.truncate(1);
    cell.setup.tool.measuring_points[0].position = Vector3::new(0.03, 0.02, 0.08);
    cell.bounds = vec![[-2.9, 2.9]; 7];
    cell.limits = Limits::default();
    cell.prior = Some(vec![6e4, 5e4, 4e4, 4e4, 3e4, 2e4, 1.5e4]);
    cell.characteristic_length = None;
    cell.tasks.clear();
    cell.noise.reading_variance = 1e-10;
    cell
}

/// Three weights at postures that differ by `spread` \[rad\] in the joints that
/// bend the arm. The plane of the arm gives way sideways a little, which the
/// model does not know.
fn measured(cell: &Cell, spread: f64) -> Vec<MeasuredPosture> {
    let mut dice = Dice::new(3);
    let prior = cell.require_prior().unwrap();
    let compliance = compliance_of(prior);
    let sigma = cell.noise.displacement_std();
    let mut out = Vec::new();
    for p in 0..8 {
        let mut q = vec![0.3 * f64::from(p), 0.6, 0.0, -1.2, 0.0, 0.7, 0.0];
        for j in [1, 3, 5] {
            q[j] += dice.signed(0.0, spread);
        }
        for force in [40.0, 80.0, 120.0] {
            let wrench = Wrench::force(-Vector3::z() * force);
            let terms = PostureTerms::new(&cell.setup, &q, Some(&wrench)).unwrap();
            let moved = terms.block(&cell.setup.robot) * &compliance;
            // Out of the plane: along y of joint 2's axis.
            let across = terms.frames().axes()[1] * (3e-7 * force);
            let shift = moved.fixed_rows::<3>(0) + across + dice.noise(sigma);
            let posture = Posture { name: (p + 1).to_string(), q: q.clone() };
            out.push(MeasuredPosture {
                state: format!("{force} N"),
                wrench: Some(wrench),
                ..MeasuredPosture::new(posture, vec![Displacement::new(0, shift)])
            });
        }
    }
    out
}

fn identified(cell: &Cell, spread: f64) -> Identification {
    identify(cell, measured(cell, spread), &IdentifyOptions::default()).unwrap()
}

fn set(names: &[&str], determined: usize) -> CollinearSet {
    CollinearSet { unknowns: names.iter().map(|n| n.to_string()).collect(), determined }
}

#[test]
fn a_joint_without_load_has_no_interval_and_collinear_joints_are_named() {
    // 0.006 N·m on joints 3, 5 and 7, beside some 80 N·m on joint 2.
    let cell = cell(5e-5);
    let fit = Fit::new(&cell, measured(&cell, 0.008), &IdentifyOptions::default()).unwrap();
    let result = fit.identification().unwrap();
    for j in [0, 2, 4, 6] {
        let joint = &result.estimates.joints[j];
        assert_eq!(joint.verdict, Verdict::Undetermined, "{joint:?}");
        assert_eq!((joint.interval, joint.stiffness), ([None, None], None));
    }
    assert_eq!(result.estimates.undetermined_joints, ["joint 1", "joint 3", "joint 5", "joint 7"]);
    assert_eq!(result.estimates.collinear, [set(&["joint 2", "joint 4", "joint 6"], 2)]);
    // Nothing speaks of units.
    assert_eq!(implausible_scale(&cell, result), None);
    let diagnosis = diagnose(&fit).unwrap();
    let unloaded = diagnosis.findings.iter().filter(|f| f.code == "unloaded-joint");
    insta::assert_snapshot!(sentences(unloaded), @"
    [unloaded-joint] joint 1: The loads put no torque on joint 1, beside 64 N·m on joint 2: it carries no load here and is not determined, whatever the readings.
    [unloaded-joint] joint 3: The loads put 2.5e-3 N·m RMS on joint 3, beside 64 N·m on joint 2: it carries no load here and is not determined, whatever the readings.
    [unloaded-joint] joint 5: The loads put 4.2e-3 N·m RMS on joint 5, beside 64 N·m on joint 2: it carries no load here and is not determined, whatever the readings.
    [unloaded-joint] joint 7: The loads put 2.6e-3 N·m RMS on joint 7, beside 64 N·m on joint 2: it carries no load here and is not determined, whatever the readings.
    ");
}

#[test]
fn postures_that_differ_separate_the_same_joints() {
    let cell = cell(5e-5);
    let result = identified(&cell, 0.9);
    let collinear = &result.estimates.collinear;
    assert!(collinear.is_empty(), "{collinear:?}");
    let prior = cell.require_prior().unwrap();
    for j in [1, 3, 5] {
        let joint = &result.estimates.joints[j];
        assert!(joint.interval[1].is_some(), "{joint:?}");
        let error = (joint.stiffness.unwrap() - prior[j]) / joint.standard_error.unwrap();
        assert!(error.abs() < 4.0, "{joint:?}");
    }
}

#[test]
fn units_are_suspected_where_the_joints_are_known() {
    // The six-axis cell with displacements in micrometres taken for millimetres.
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let postures = PostureGroup::from_angles("", group1());
    let model = Model::Linear;
    let mut measured = simulate_measurements(&cell, &postures.postures, truth, model, 1, 0).unwrap();
    for displacement in measured.iter_mut().flat_map(|m| &mut m.displacements) {
        displacement.value *= 1e3;
    }
    let result = identify(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let finding = implausible_scale(&cell, &result).unwrap();
    insta::assert_snapshot!(finding.sentence, @"The joint stiffness is 999 times smaller than the cell's prior. Are the displacements in micrometres instead of millimetres, or the force in kilonewtons?");
}
