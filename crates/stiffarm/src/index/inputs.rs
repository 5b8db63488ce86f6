//! What an index needs besides the postures that are free: units, weights,
//! tasks, and the postures that are given.

use super::Index;
use super::criterion::Criterion;
use super::kernel::{Kernel, Wanted};
use crate::cell::{Cell, task_matrix};
use crate::error::Result;

/// Postures that are measured whatever the search does.
#[derive(Debug, Clone)]
pub(crate) struct Given {
    pub count: usize,
    /// Their information, packed, one after the other.
    pub each: Vec<f64>,
    /// Largest ln k(J_N) of them.
    pub log_dexterity: f64,
}

impl Given {
    /// Evaluates the given postures (controller angles, rad) once.
    ///
    /// # Errors
    /// As [`Kernel::new`].
    pub fn new<Q: AsRef<[f64]>>(cell: &Cell, wanted: Wanted<'_>, given: &[Q]) -> Result<Self> {
        let mut fixed = Given {
            count: given.len(),
            each: Vec::new(),
            log_dexterity: f64::NEG_INFINITY,
        };
        if given.is_empty() {
            return Ok(fixed);
        }
        let mut kernel = Kernel::new(
            cell,
            Wanted {
                limits: false,
                ..wanted
            },
            given.len(),
        )?;
        let q: Vec<f64> = given.iter().flat_map(|q| q.as_ref().to_vec()).collect();
        kernel.forward(&q);
        for p in 0..given.len() {
            if wanted.information.is_some() {
                fixed.each.extend(kernel.information(p));
            }
            if wanted.dexterity.is_some() {
                fixed.log_dexterity = fixed.log_dexterity.max(kernel.log_dexterity(p));
            }
        }
        Ok(fixed)
    }
}

/// Compliances that the information is measured in: 1/k per spring, ones where
/// the index has no prior.
pub(crate) fn relative_compliance(cell: &Cell, index: Index) -> Result<Vec<f64>> {
    if index.needs_prior() {
        Ok(cell.require_prior()?.iter().map(|k| 1.0 / k).collect())
    } else {
        Ok(vec![1.0; cell.setup.robot.spring_count()])
    }
}

/// The index of an information matrix, with the cell's tasks where it needs them.
///
/// # Errors
/// The index needs tasks and the cell has none.
pub(crate) fn criterion(cell: &Cell, index: Index) -> Result<Criterion> {
    let task = match index.needs_tasks() {
        // Symmetric, so the order of rows and columns does not matter.
        true => Some(task_matrix(cell)?.as_slice().to_vec()),
        false => None,
    };
    Ok(Criterion::new(index, cell.setup.robot.spring_count(), task))
}

/// Weight of the posture-common shift in the information of an index.
pub(crate) fn common_weight(cell: &Cell, index: Index) -> f64 {
    match index {
        Index::ExpectedError | Index::WorstJoint | Index::DropOne | Index::D | Index::Task => {
            cell.noise.common_weight(cell.setup.tool.point_count())
        }
        _ => 0.0,
    }
}
