//! What the readings of one posture tell about the unknowns of an index.

use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::observation::PostureTerms;
use crate::model::robot::Robot;
use crate::numerics::information::{posture_information, scale_columns};
use crate::plan::index::kernel::{Kernel, KernelOutputs};
use crate::plan::index::prediction::PredictionFunction;
use nalgebra::DMatrix;

/// Information G of a posture.
#[derive(Clone)]
pub(super) enum Readings {
    /// About the relative joint stiffnesses: G = K⁻¹ΨᵀPΨK⁻¹, in units of 1/σ².
    Joints {
        /// 1/K.
        compliance: Vec<f64>,
        /// Weight of the posture-common shift.
        common_weight: f64,
        /// Of one posture.
        kernel: Box<Kernel>,
    },
    /// About all unknowns of the index prediction, of one free posture.
    Prediction(Box<PredictionFunction>),
}

impl Readings {
    /// About the joints.
    ///
    /// # Errors
    /// As [`Kernel::new`].
    pub(super) fn of_joints(cell: &Cell, compliance: Vec<f64>) -> Result<Self> {
        let common_weight = cell.noise.common_weight(cell.setup.tool.point_count());
        let outputs = KernelOutputs { dexterity: None, information: Some((&compliance, common_weight)), limits: false };
        Ok(Readings::Joints { kernel: Box::new(Kernel::new(cell, outputs, 1)?), compliance, common_weight })
    }

    /// Number of unknowns.
    pub(super) fn unknowns(&self) -> usize {
        match self {
            Readings::Joints { compliance, .. } => compliance.len(),
            Readings::Prediction(function) => function.model().unknowns(),
        }
    }

    /// G of a posture under all its loads.
    pub(super) fn information<'a>(&self, robot: &Robot, loads: impl Iterator<Item = &'a PostureTerms>) -> DMatrix<f64> {
        match self {
            Readings::Joints { compliance, common_weight, .. } => {
                let each = loads.map(|terms| {
                    let mut block = terms.block(robot);
                    scale_columns(&mut block, compliance.iter().copied());
                    posture_information(&block, *common_weight)
                });
                let nothing = || DMatrix::zeros(compliance.len(), compliance.len());
                each.reduce(|sum, information| sum + information).unwrap_or_else(nothing)
            }
            Readings::Prediction(function) => {
                let rows = function.model().readings(loads);
                rows.tr_mul(&rows)
            }
        }
    }

    /// tr(A·G) at the controller angles `q` \[rad\] with A = `adjoint`, and its derivatives in `gradient`; not finite
    /// where a load has no direction.
    pub(super) fn trace(&mut self, q: &[f64], adjoint: &DMatrix<f64>, gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        match self {
            Readings::Joints { kernel, .. } => {
                kernel.forward(q);
                // Off-diagonal entries twice.
                let mut value = 0.0;
                let mut information = kernel.information(0);
                for i in 0..adjoint.nrows() {
                    for j in 0..=i {
                        let times = if i == j { 1.0 } else { 2.0 };
                        value += times * adjoint[(i, j)] * information.next().unwrap_or(f64::NAN);
                    }
                }
                drop(information);
                kernel.set_adjoint(None, adjoint.as_slice());
                kernel.reverse(gradient);
                value
            }
            Readings::Prediction(function) => {
                let value = function.trace(q, adjoint);
                function.add_gradient(gradient);
                value
            }
        }
    }
}
