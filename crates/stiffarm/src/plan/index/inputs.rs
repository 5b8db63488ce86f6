//! What an index needs besides the postures that are free: units, weights,
//! tasks, and the postures that are given.

use super::criterion::Criterion;
use super::kernel::{Kernel, KernelOutputs};
use super::kinds::Index;
use crate::error::Result;
use crate::model::cell::{Cell, task_matrix};
use crate::model::dexterity::require_six_joints;

/// What an index asks of a posture: units, weights, characteristic length.
#[derive(Debug, Clone)]
pub(crate) struct Inputs {
    dexterity: Option<f64>,
    /// 1/k per spring, ones where the index has no prior, and the weight of
    /// the posture-common shift.
    information: Option<(Vec<f64>, f64)>,
}

impl Inputs {
    /// Collects what `index` needs.
    ///
    /// # Errors
    /// The cell lacks it: a prior stiffness, six joints, or the characteristic
    /// length.
    pub fn new(cell: &Cell, index: Index) -> Result<Self> {
        let robot = &cell.setup.robot;
        let dexterity = if index.uses_dexterity() {
            require_six_joints(robot).map_err(|error| {
                error.hint("choose an index without dexterity: expected_error, scaled_condition, d")
            })?;
            Some(cell.require_characteristic_length()?)
        } else {
            None
        };
        let compliance: Vec<f64> = if index.needs_prior() {
            let prior = index.prior_of(cell)?.iter();
            prior.map(|k| 1.0 / k).collect()
        } else {
            vec![1.0; robot.spring_count()]
        };
        let common_weight =
            if index.is_error() { cell.noise.common_weight(cell.setup.tool.point_count()) } else { 0.0 };
        Ok(Inputs {
            dexterity,
            information: (index.uses_observation() && index != Index::Prediction)
                .then_some((compliance, common_weight)),
        })
    }

    /// The same as the kernel wants it.
    pub fn kernel_outputs(&self, limits: bool) -> KernelOutputs<'_> {
        let information = self.information.as_ref();
        KernelOutputs {
            dexterity: self.dexterity,
            information: information.map(|(compliance, weight)| (compliance.as_slice(), *weight)),
            limits,
        }
    }
}

/// ln of what an index of `count` postures is multiplied by beside its information or k(J_N):
/// σ = `std` \[m\], √m.
pub(crate) fn log_factor(index: Index, std: f64, count: f64) -> f64 {
    match index {
        index if index.is_error() => std.max(f64::MIN_POSITIVE).ln(),
        // O1 has 1/√m with m postures.
        Index::O1 => 0.5 * count.ln(),
        _ => 0.0,
    }
}

/// Postures that are measured whatever the search does.
#[derive(Debug, Clone)]
pub(crate) struct FixedPostures {
    pub count: usize,
    /// Their information, packed, one after the other.
    pub each: Vec<f64>,
    /// Largest ln k(J_N) of them.
    pub log_dexterity: f64,
}

impl FixedPostures {
    /// Evaluates the given postures (controller angles, rad) once.
    ///
    /// # Errors
    /// As [`Kernel::new`].
    pub fn new<Q: AsRef<[f64]>>(cell: &Cell, outputs: KernelOutputs<'_>, fixed_postures: &[Q]) -> Result<Self> {
        let mut fixed =
            FixedPostures { count: fixed_postures.len(), each: Vec::new(), log_dexterity: f64::NEG_INFINITY };
        if fixed_postures.is_empty() {
            return Ok(fixed);
        }
        let mut kernel = Kernel::new(cell, KernelOutputs { limits: false, ..outputs }, fixed_postures.len())?;
        let q: Vec<f64> = fixed_postures.iter().flat_map(|q| q.as_ref().to_vec()).collect();
        kernel.forward(&q);
        for p in 0..fixed_postures.len() {
            if outputs.information.is_some() {
                fixed.each.extend(kernel.information(p));
            }
            if outputs.dexterity.is_some() {
                fixed.log_dexterity = fixed.log_dexterity.max(kernel.log_dexterity(p));
            }
        }
        Ok(fixed)
    }

    /// Adds the information of all given postures to `total`, packed.
    pub fn add_information(&self, total: &mut [f64]) {
        if self.each.is_empty() {
            return;
        }
        for each in self.each.chunks_exact(total.len()) {
            for (sum, v) in total.iter_mut().zip(each) {
                *sum += v;
            }
        }
    }
}

/// The index of an information matrix, with the cell's tasks where it needs them.
///
/// # Errors
/// The index needs tasks and the cell has none.
pub(crate) fn criterion(cell: &Cell, index: Index) -> Result<Criterion> {
    let task = if index.needs_tasks() {
        // Symmetric, so the order of rows and columns does not matter.
        Some(task_matrix(cell)?.as_slice().to_vec())
    } else {
        None
    };
    Ok(Criterion::new(index, cell.setup.robot.spring_count(), task))
}
