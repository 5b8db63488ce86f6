//! Joints that the load or the measuring points leave in the dark, with the reason.

use crate::error::Result;
use crate::findings::{Finding, Severity};
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::model::observation::PostureTerms;
use crate::numerics::information::Factor;
use crate::units::m_to_mm;
use nalgebra::{DMatrix, Vector3};
use serde::{Deserialize, Serialize};

/// What a check found out about one joint, over all sampled postures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointExcitation {
    /// Name of the joint.
    pub name: String,
    /// False when no group of postures in the bounds can determine this joint.
    pub determined: bool,
    /// Largest |torque| of the load about it \[N·m\]; `None` for a measured load.
    pub largest_torque_nm: Option<f64>,
    /// Largest displacement of a measuring point that this joint alone causes,
    /// by the prior stiffness \[m\]; `None` without prior or for a measured load.
    pub largest_displacement_m: Option<f64>,
}

/// Lengths and torques below this, relative to the arm's, are rounding.
const ROUNDING: f64 = 1e-9;
/// A joint should move a reflector by this many standard deviations of the noise.
const VISIBLE: f64 = 3.0;

/// Names what the sampled postures cannot tell about each joint.
pub(super) fn check(
    cell: &Cell,
    terms: &[&PostureTerms],
    findings: &mut Vec<Finding>,
) -> Result<Vec<JointExcitation>> {
    let setup = &cell.setup;
    let robot = &setup.robot;
    let n = robot.spring_count();
    let rows = 3 * setup.tool.point_count();
    let measured = setup.load == Load::Measured;
    let mut psi = DMatrix::zeros(rows * terms.len(), n);
    let mut torque = vec![0.0_f64; n];
    for (p, terms) in terms.iter().enumerate() {
        psi.rows_mut(rows * p, rows).copy_from(&terms.block(robot));
        for (largest, load) in torque.iter_mut().zip(&terms.spring_loads(robot)) {
            *largest = largest.max(load.abs());
        }
    }
    drop_rounding(&mut torque);
    let undetermined = Factor::new(&psi)?.undetermined().to_vec();
    let mut moved = cell
        .prior
        .as_ref()
        .filter(|_| !measured)
        .map(|prior| largest_displacements(&psi, prior));
    moved.iter_mut().for_each(|moved| drop_rounding(moved));
    let names = robot.spring_names();
    for &j in &undetermined {
        findings.push(dark_joint(cell, terms, j, &names[j], &undetermined));
    }
    blind_points(cell, terms, &undetermined, findings);
    if let Some(moved) = &moved {
        weak_joints(cell, moved, &undetermined, &names, findings);
    }
    Ok((0..n)
        .map(|j| JointExcitation {
            name: names[j].clone(),
            determined: !undetermined.contains(&j),
            largest_torque_nm: (!measured).then_some(torque[j]),
            largest_displacement_m: moved.as_ref().map(|moved| moved[j]),
        })
        .collect())
}

/// Sets to zero what is rounding beside the largest.
fn drop_rounding(values: &mut [f64]) {
    let largest = values.iter().copied().fold(0.0, f64::max);
    for value in values.iter_mut().filter(|v| **v <= ROUNDING * largest) {
        *value = 0.0;
    }
}

/// Largest ‖Ψ_j‖/k_j over postures and points \[m\]: how far joint j alone
/// moves a measuring point.
fn largest_displacements(psi: &DMatrix<f64>, prior: &[f64]) -> Vec<f64> {
    psi.column_iter()
        .zip(prior)
        .map(|(column, k)| {
            let points = column.as_slice().chunks_exact(3);
            let square = |point: &[f64]| point.iter().map(|v| v * v).sum::<f64>();
            points.map(square).fold(0.0, f64::max).sqrt() / k
        })
        .collect()
}

/// Length of the arm, against which rounding is measured \[m\].
fn reach(cell: &Cell) -> f64 {
    cell.setup.robot.length() + cell.setup.tool.tcp().norm()
}

/// The finding about a joint that no posture can determine.
fn dark_joint(
    cell: &Cell,
    terms: &[&PostureTerms],
    j: usize,
    name: &str,
    undetermined: &[usize],
) -> Finding {
    let because = if cell.setup.robot.spring_mixing().is_some() {
        "the load or the measuring points leave its elastic coordinate out".to_string()
    } else {
        reason(cell, terms, j, undetermined)
    };
    // A measured moment may still reach a joint that forces cannot.
    let (severity, may) = match cell.setup.load {
        Load::Measured => (
            Severity::Caution,
            "no force at the loading point determines",
        ),
        _ => (Severity::Serious, "no posture within the bounds determines"),
    };
    let sentence = format!("With this cell {may} {name}: {because}.");
    Finding::new("undetermined-joint", severity, name, sentence)
}

/// Why joint j stays unknown, as a clause.
fn reason(cell: &Cell, terms: &[&PostureTerms], j: usize, undetermined: &[usize]) -> String {
    let n = cell.setup.robot.joint_count();
    let near = ROUNDING * reach(cell);
    let always = |test: &dyn Fn(&PostureTerms) -> bool| terms.iter().all(|t| test(t));
    let seen = |t: &PostureTerms| t.columns.chunks_exact(n).any(|c| c[j].norm() > near);
    if always(&|t| t.wrench.force.norm() == 0.0 && t.wrench.moment.norm() == 0.0) {
        return "the load is zero".to_string();
    }
    if always(&|t| t.loading_columns[j].norm() <= near && t.wrench.moment.norm() == 0.0) {
        return "the loading point lies on its axis, so that the load has no lever; move the loading point \
                off the axis"
            .to_string();
    }
    if always(&|t| !seen(t)) {
        return "every measuring point lies on its axis and stays where it is; put a reflector beside the axis"
            .to_string();
    }
    let along = |t: &PostureTerms| t.wrench.force.cross(&t.frames.axes()[j]).norm();
    if always(&|t| along(t) <= ROUNDING * t.wrench.force.norm() && t.wrench.moment.norm() == 0.0) {
        return "the load is parallel to its axis in every posture (a purely vertical load on a floor-mounted \
                robot does that to joint 1); pull sideways"
            .to_string();
    }
    let axis_passes = |anchor: &Vector3<f64>| {
        always(&|t| {
            let offset = anchor - t.frames.origins()[j];
            offset.cross(&t.frames.axes()[j]).norm() <= near
        })
    };
    let anchored = |load: &Load| matches!(load, Load::Rope { anchor, .. } if axis_passes(anchor));
    if cell.setup.load.each().all(anchored) {
        let line = cell.setup.load.line();
        return format!(
            "the {line}'s anchor lies on its axis, so that the force passes through the axis; move the anchor"
        );
    }
    if undetermined.len() > 1 {
        return "its share of the displacements cannot be told from that of other joints; add measuring points"
            .to_string();
    }
    "the load has no moment about its axis".to_string()
}

/// Measuring points on the axis of a joint that other points do see.
fn blind_points(
    cell: &Cell,
    terms: &[&PostureTerms],
    undetermined: &[usize],
    findings: &mut Vec<Finding>,
) {
    let n = cell.setup.robot.joint_count();
    let near = ROUNDING * reach(cell);
    for (a, point) in cell.setup.tool.measuring_points.iter().enumerate() {
        for (j, joint) in cell.setup.robot.joints().iter().enumerate() {
            let blind = terms.iter().all(|t| t.columns[a * n + j].norm() <= near);
            if blind && !undetermined.contains(&j) {
                findings.push(Finding::new(
                    "blind-point",
                    Severity::Note,
                    format!("tool.measuring_point[{}].position_mm", a + 1),
                    format!(
                        "Measuring point \"{}\" lies on the axis of {} and tells nothing about it; the other \
                         points do.",
                        point.name, joint.name
                    ),
                ));
            }
        }
    }
}

/// Joints whose share of a displacement drowns in the noise.
fn weak_joints(
    cell: &Cell,
    moved: &[f64],
    undetermined: &[usize],
    names: &[String],
    findings: &mut Vec<Finding>,
) {
    let std = cell.noise.displacement_std();
    for (j, moved) in moved.iter().enumerate() {
        if undetermined.contains(&j) || *moved >= VISIBLE * std {
            continue;
        }
        findings.push(Finding::new(
            "weak-joint",
            Severity::Caution,
            &names[j],
            format!(
                "By the prior stiffness {} moves no measuring point by more than {:.4} mm, and the noise of a \
                 displacement is {:.4} mm: its stiffness will be uncertain. Pull harder, or lengthen the lever.",
                names[j],
                m_to_mm(*moved),
                m_to_mm(std)
            ),
        ));
    }
}
