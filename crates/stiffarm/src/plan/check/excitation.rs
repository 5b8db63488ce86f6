//! Joints that the load or the measuring points leave in the dark, with the reason.

use super::prepared::determinable;
use super::reason::{ROUNDING, drop_rounding, reach, reason};
use crate::error::Result;
use crate::findings::{Finding, Severity, codes};
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::model::observation::PostureTerms;
use crate::numerics::information::Factor;
use crate::units::m_to_mm;
use nalgebra::DMatrix;
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

/// A joint should move a reflector by this many standard deviations of the noise.
const VISIBLE: f64 = 3.0;

/// Names what the sampled postures cannot tell about each joint.
pub(super) fn check(cell: &Cell, terms: &[&PostureTerms], findings: &mut Vec<Finding>) -> Result<Vec<JointExcitation>> {
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
    let mut moved = cell.prior.as_ref().filter(|_| !measured).map(|prior| largest_displacements(&psi, prior));
    moved.iter_mut().for_each(|moved| drop_rounding(moved));
    let names = robot.spring_names();
    let (_, left_out) = determinable(cell.clone());
    for &j in &undetermined {
        let alone = left_out.iter().find(|f| f.subject == names[j]);
        let dark = || dark_joint(cell, terms, j, &names[j], &undetermined);
        findings.push(alone.cloned().unwrap_or_else(dark));
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

/// The finding about a joint that no posture can determine.
fn dark_joint(cell: &Cell, terms: &[&PostureTerms], j: usize, name: &str, undetermined: &[usize]) -> Finding {
    let because = reason(cell, terms, j, undetermined);
    // A measured moment may still reach a joint that forces cannot.
    let (severity, may) = match cell.setup.load {
        Load::Measured => (Severity::Caution, "no force at the loading point determines"),
        _ => (Severity::Serious, "no posture within the bounds determines"),
    };
    let sentence = format!("With this cell {may} {name}: {because}.");
    Finding::new("undetermined-joint", severity, name, sentence)
}

/// Measuring points on the axis of a joint that other points do see.
fn blind_points(cell: &Cell, terms: &[&PostureTerms], undetermined: &[usize], findings: &mut Vec<Finding>) {
    let n = cell.setup.robot.joint_count();
    let near = ROUNDING * reach(cell);
    for (a, point) in cell.setup.tool.measuring_points.iter().enumerate() {
        for (j, joint) in cell.setup.robot.joints().iter().enumerate() {
            let blind = terms.iter().all(|t| t.columns[a * n + j].norm() <= near);
            if blind && !undetermined.contains(&j) {
                findings.push(Finding::note(
                    "blind-point",
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
fn weak_joints(cell: &Cell, moved: &[f64], undetermined: &[usize], names: &[String], findings: &mut Vec<Finding>) {
    let std = cell.noise.displacement_std();
    for (j, moved) in moved.iter().enumerate() {
        if undetermined.contains(&j) || *moved >= VISIBLE * std {
            continue;
        }
        findings.push(Finding::caution(
            codes::WEAK_JOINT,
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
