//! The linear system Ψ x = Δ of an experiment, with what its rows share.
//!
//! Unknowns x: the compliance of each spring, then extra terms. Rows: posture
//! by posture (all load states of a posture together), displacement by
//! displacement, x, y, z.

use super::covariance::{Covariance, covariance, shared};
use super::labels::{RowLabel, Weights};
use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::measurement::{MeasuredPosture, row_count};
use crate::model::observation::{ExtraTerm, PostureTerms, Setup};
use crate::model::robot::Robot;
use nalgebra::{DMatrix, DVector};
use std::collections::HashMap;
use std::ops::Range;

/// A joint whose torque (RMS over postures and load states) is below this share of
/// the largest one carries no load: what its column holds is rounding, errors of
/// angles, and what the model leaves out.
pub(crate) const NO_LOAD: f64 = 1e-4;

/// Rows of one posture.
#[derive(Debug, Clone)]
pub struct Block {
    /// Name of the posture.
    pub posture: String,
    /// Its rows.
    pub rows: Range<usize>,
    /// Covariance of its rows in units of σ².
    pub covariance: Covariance,
    /// What shifts common to the posture's points do to its rows, rows × 3c:
    /// one shift x, y, z per direction of load, in proportion to the load.
    pub shared: DMatrix<f64>,
}

/// Ψ x = Δ with the covariance structure of its rows.
#[derive(Debug, Clone)]
pub struct MeasuredSystem {
    /// Ψ, rows × unknowns: springs, then extra terms.
    pub psi: DMatrix<f64>,
    /// Δ less the displacement that is known: of a series compliance, and of
    /// the controller giving way \[m\]; angles \[rad\] of a clamped end-effector.
    pub delta: DVector<f64>,
    /// Names of the unknowns.
    pub unknowns: Vec<String>,
    /// Number of springs: the unknowns before the extra terms.
    pub springs: usize,
    /// The extra terms.
    pub extra: Vec<ExtraTerm>,
    /// Its postures.
    pub blocks: Vec<Block>,
    /// What stands behind the rows, in their order.
    pub labels: Vec<RowLabel>,
}

impl MeasuredSystem {
    /// Number of shifts that the postures' points share: three for each
    /// posture and direction of load.
    pub fn shifts(&self) -> usize {
        self.blocks.iter().map(|b| b.shared.ncols()).sum()
    }

    /// What stands behind the rows of a block.
    pub fn labels_of(&self, block: &Block) -> &[RowLabel] {
        let first = |row: usize| self.labels.partition_point(|l| l.rows.start < row);
        &self.labels[first(block.rows.start)..first(block.rows.end)]
    }

    /// The system without the displacements for which `keep` fails; `None` where
    /// none is left. Postures that keep none are gone.
    pub(crate) fn filtered(&self, keep: impl Fn(&RowLabel) -> bool) -> Option<MeasuredSystem> {
        let mut rows = Vec::with_capacity(self.delta.len());
        let (mut blocks, mut labels) = (Vec::new(), Vec::new());
        for block in &self.blocks {
            let from = rows.len();
            for label in self.labels_of(block).iter().filter(|l| keep(l)) {
                let at = rows.len();
                rows.extend(label.rows.clone());
                labels.push(RowLabel { rows: at..rows.len(), ..*label });
            }
            if rows.len() == from {
                continue;
            }
            let block_rows: Vec<usize> = rows[from..].iter().map(|r| r - block.rows.start).collect();
            let covariance = block.covariance.select(&block_rows);
            blocks.push(Block {
                posture: block.posture.clone(),
                rows: from..rows.len(),
                covariance,
                shared: block.shared.select_rows(&block_rows),
            });
        }
        (!rows.is_empty()).then(|| MeasuredSystem {
            psi: self.psi.select_rows(&rows),
            delta: self.delta.select_rows(&rows),
            unknowns: self.unknowns.clone(),
            springs: self.springs,
            extra: self.extra.clone(),
            blocks,
            labels,
        })
    }

    /// The system with one further unknown, its column of Ψ given.
    pub(super) fn extended(&self, term: ExtraTerm, name: String, column: &DVector<f64>) -> Self {
        let mut out = self.clone();
        let at = out.psi.ncols();
        out.psi = out.psi.insert_column(at, 0.0);
        out.psi.set_column(at, column);
        out.unknowns.push(name);
        out.extra.push(term);
        out
    }
}

/// Builds Ψ x = Δ from measurements, Eq. (10), with the general form
/// Δ = J^m (Δq_m + K_θ⁻¹ Γ) where the controller's angles were read. The column of
/// a joint that carries no load is zero, so that the joint is undetermined. `postures`
/// has the measured postures of each posture, load state by load state, with
/// their terms.
///
/// # Errors
/// A term that stands twice or that the robot cannot have, a point the tool
/// does not have, a number that is not finite, or tracker weights without the
/// tracker's model.
pub(super) fn assemble<'a>(
    cell: &Cell,
    measured: &[MeasuredPosture],
    postures: impl Iterator<Item = Vec<(usize, &'a PostureTerms)>>,
    extra: &[ExtraTerm],
    weights: Weights,
) -> Result<MeasuredSystem> {
    let robot = &cell.setup.robot;
    let rows = row_count(measured);
    let springs = robot.spring_count();
    let unknowns = unknowns(robot, extra)?;
    let mut system = MeasuredSystem {
        psi: DMatrix::zeros(rows, unknowns.len()),
        delta: DVector::zeros(rows),
        unknowns,
        springs,
        extra: extra.to_vec(),
        blocks: Vec::new(),
        labels: Vec::with_capacity(rows / 3),
    };
    let mut at = 0;
    let mut loads = DVector::zeros(springs);
    for states in postures {
        let from = at;
        let first_label = system.labels.len();
        let mut torques = Vec::with_capacity(states.len());
        for &(m, terms) in &states {
            let posture = &measured[m];
            let columns = terms.block_with(&cell.setup.robot, extra);
            let offset = known_displacement(&cell.setup, terms, posture)?;
            for (d, displacement) in posture.displacements.iter().enumerate() {
                let row = 3 * displacement.point;
                if row + 3 > columns.nrows() {
                    return Err(Error::new(Code::UnknownName, "A displacement names a point the tool does not have."));
                }
                system.psi.rows_mut(at, 3).copy_from(&columns.rows(row, 3));
                system.delta.rows_mut(at, 3).copy_from(&(displacement.value - offset.fixed_rows::<3>(row)));
                system.labels.push(RowLabel { measured: m, displacement: d, rows: at..at + 3 });
                at += 3;
            }
            torques.push(DVector::from_column_slice(terms.torque()));
            loads += terms.spring_loads(robot).map(|torque| torque * torque);
        }
        let Some((first, _)) = states.first() else {
            continue;
        };
        let numbers: Vec<usize> = states.iter().map(|(m, _)| *m).collect();
        system.blocks.push(Block {
            posture: measured[*first].posture.name.clone(),
            rows: from..at,
            covariance: covariance(cell, measured, &system.labels[first_label..], weights)?,
            shared: shared(measured, &numbers, &torques),
        });
    }
    // Squares of torques.
    let least = NO_LOAD * NO_LOAD * loads.max();
    for (j, load) in loads.iter().enumerate() {
        if *load < least {
            system.psi.column_mut(j).fill(0.0);
        }
    }
    if system.delta.iter().any(|v| !v.is_finite()) {
        return Err(Error::new(Code::NotFinite, "A displacement is not a finite number."));
    }
    Ok(system)
}

/// Names of the springs and the extra terms.
///
/// # Errors
/// A term that appears twice, or names a joint that the robot does not have.
pub(crate) fn unknowns(robot: &Robot, extra: &[ExtraTerm]) -> Result<Vec<String>> {
    let mut unknowns = robot.spring_names();
    for (i, term) in extra.iter().enumerate() {
        if !term.fits(robot.joint_count()) {
            let message = format!("An extra term names a joint or an entry that {} does not have.", robot.name());
            return Err(Error::new(Code::UnknownName, message));
        }
        let name = term.name(robot);
        if extra[..i].contains(term) {
            let message = format!("The term \"{name}\" appears twice.");
            return Err(Error::new(Code::Duplicate, message));
        }
        unknowns.push(name);
    }
    Ok(unknowns)
}

/// Displacement of the measuring points that does not come from the unknowns,
/// 3m \[m\]: of a series compliance, and J^m C Δq_m of the controller.
pub(crate) fn known_displacement(
    setup: &Setup,
    terms: &PostureTerms,
    measured: &MeasuredPosture,
) -> Result<DVector<f64>> {
    let robot = &setup.robot;
    let mut offset = terms.known_displacement(&setup.tool);
    let Some(give) = &measured.servo_deflection else {
        return Ok(offset);
    };
    crate::model::observation::check_angles(robot, give)?;
    let theta = robot.coupling() * DVector::from_column_slice(give);
    for (a, point) in terms.measuring_points().iter().enumerate() {
        for (j, angle) in theta.iter().enumerate() {
            let mut rows = offset.fixed_rows_mut::<3>(3 * a);
            rows += terms.frames().column(j, point) * *angle;
        }
    }
    Ok(offset)
}

/// Indices of the measured postures by posture, in order of first appearance;
/// postures without any displacement are left out.
pub(super) fn states_by_posture(measured: &[MeasuredPosture]) -> Vec<Vec<usize>> {
    let mut order = by_name(measured.iter().map(|m| m.posture.name.as_str()));
    order.retain(|states| states.iter().any(|m| !measured[*m].displacements.is_empty()));
    order
}

/// Positions of each name, in order of first appearance.
pub(crate) fn by_name<'a>(names: impl Iterator<Item = &'a str>) -> Vec<Vec<usize>> {
    let mut order: Vec<Vec<usize>> = Vec::new();
    let mut seen: HashMap<&str, usize> = HashMap::new();
    for (m, name) in names.enumerate() {
        let next = order.len();
        let at = *seen.entry(name).or_insert(next);
        if at == next {
            order.push(Vec::new());
        }
        order[at].push(m);
    }
    order
}

pub(super) fn no_displacements() -> Error {
    Error::new(Code::TooFewData, "There are no displacements to identify from.")
}
