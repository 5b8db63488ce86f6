//! Every index as a function of the postures with its closed-form gradient.
//!
//! A group index is `exp(smooth + max of components)`: a smooth part from the
//! information matrix and, for the minimax indices, components whose maximum
//! counts (k(J_N) per posture, one joint, one lost posture). Both parts are
//! logarithms, so that products become sums; O1 to O5 enter as reciprocals,
//! so that every index is minimised.
//!
//! `IndexFunction::evaluate` leaves the maximum to the optimiser, which
//! treats it as an epigraph and never differentiates a max().
//! [`IndexFunction::smoothed`] replaces it by a log-sum-exp, for searches that
//! want one smooth function. Neither allocates after the first call.

use super::criterion::{ACCURATE_CONDITION, Criterion, Value};
use super::inputs::{FixedPostures, Inputs, criterion, log_factor};
use super::kernel::{Kernel, LeftOut};
use super::kinds::Index;
use super::minimax::{Minimax, Smoothed, log_sum};
use super::prediction::PredictionFunction;
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::observation::check_angles;
use crate::numerics::information::small::packed;

/// An index of groups of a fixed number of postures, ready to be evaluated
/// many times at the flat vector of all controller angles \[rad\].
#[derive(Debug, Clone)]
pub struct IndexFunction {
    index: Index,
    kernel: Kernel,
    criterion: Criterion,
    fixed_postures: FixedPostures,
    /// Instead of the information, where the index is that of the mixed model.
    prediction: Option<Box<PredictionFunction>>,
    /// ln of what the value is multiplied by: σ, √m.
    log_factor: f64,
    total: Vec<f64>,
    /// Information of one posture left out.
    rest: Vec<f64>,
    components: Vec<f64>,
    weights: Vec<f64>,
    adjoint: Vec<f64>,
    /// Derivatives of the drop-one components of the fixed postures, one after the other.
    adjoints: Vec<f64>,
    /// The drop-one components of the free postures; empty under another index.
    left_out: LeftOut,
    row: Vec<f64>,
}

impl IndexFunction {
    /// Prepares `index` for groups of `posture_count` postures.
    ///
    /// # Errors
    /// The cell lacks what the index needs: a prior stiffness, tasks,
    /// the characteristic length, or a load that is known without a measurement.
    pub fn new(cell: &Cell, index: Index, posture_count: usize) -> Result<Self> {
        IndexFunction::with_given::<Vec<f64>>(cell, index, posture_count, &[])
    }

    /// Prepares `index` for groups of the postures `fixed_postures` (controller angles,
    /// rad), which stay as they are, and `posture_count` further ones.
    ///
    /// # Errors
    /// As [`new`](Self::new); given angles of the wrong number or not finite.
    pub fn with_given<Q: AsRef<[f64]>>(
        cell: &Cell,
        index: Index,
        posture_count: usize,
        fixed_postures: &[Q],
    ) -> Result<Self> {
        IndexFunction::build(cell, index, posture_count, fixed_postures, false)
    }

    /// As [`with_given`](Self::with_given), with the cell's limits as a penalty
    /// of [`smoothed`](Self::smoothed) where they are wanted.
    pub(crate) fn build<Q: AsRef<[f64]>>(
        cell: &Cell,
        index: Index,
        count: usize,
        fixed_postures: &[Q],
        limits: bool,
    ) -> Result<Self> {
        let setup = &cell.setup;
        let n = setup.robot.spring_count();
        let inputs = Inputs::new(cell, index)?;
        let outputs = inputs.kernel_outputs(limits);
        for q in fixed_postures {
            check_angles(&setup.robot, q.as_ref())?;
        }
        let prediction = match index {
            Index::Prediction => Some(Box::new(PredictionFunction::new(cell, count, fixed_postures)?)),
            _ => None,
        };
        let fixed_postures = FixedPostures::new(cell, outputs, fixed_postures)?;
        let kernel = Kernel::new(cell, outputs, count)?;
        let postures = count + fixed_postures.count;
        let std = cell.noise.displacement_std();
        let log_factor = log_factor(index, std, postures as f64);
        let (fixed_count, left_out_count) =
            if index == Index::DropOne { (fixed_postures.count, count) } else { (0, 0) };
        let mut function = IndexFunction {
            index,
            kernel,
            criterion: criterion(cell, index)?,
            fixed_postures,
            prediction,
            log_factor,
            total: vec![0.0; packed(n, 0)],
            rest: vec![0.0; packed(n, 0)],
            components: Vec::new(),
            weights: Vec::new(),
            adjoint: vec![0.0; n * n],
            adjoints: vec![0.0; n * n * fixed_count],
            left_out: LeftOut::new(n, left_out_count),
            row: vec![0.0; setup.robot.joint_count() * count],
        };
        function.components = vec![0.0; function.component_count()];
        function.weights = function.components.clone();
        Ok(function)
    }

    /// Smooths the largest and smallest singular value, whose gradients jump
    /// where singular values coalesce: λ_max → (Σ λᵖ)^(1/p) and λ_min →
    /// (Σ λ⁻ᵖ)^(−1/p) with p = `sharpness`, off by at most ln(n)/p in the
    /// logarithm. A gradient of the smoothed index is an element of the
    /// ε-subdifferential of the exact one. `None` differentiates one singular
    /// vector as if the singular value were simple.
    pub fn set_sharpness(&mut self, sharpness: Option<f64>) {
        self.criterion.sharpness = sharpness;
    }

    /// True when the index rests on the largest or smallest singular value.
    pub fn has_extreme_singular_values(&self) -> bool {
        self.index.has_extreme_singular_values()
    }

    /// The index.
    pub fn index(&self) -> Index {
        self.index
    }

    /// Number of postures that are free to move.
    pub fn posture_count(&self) -> usize {
        self.kernel.posture_count()
    }

    /// Number of components of the minimax part.
    pub fn component_count(&self) -> usize {
        let free = self.kernel.posture_count();
        match self.index {
            Index::Classical | Index::Novel | Index::Scaled => free + usize::from(self.fixed_postures.count > 0),
            Index::DropOne => free + self.fixed_postures.count,
            Index::WorstJoint => self.criterion.unknowns(),
            _ => 0,
        }
    }

    /// Value and gradients at all controller angles `q`, posture by posture
    /// \[rad\], with the maximum left to the caller: for this library's own
    /// searches, and its tests.
    ///
    /// # Panics
    /// If `q` does not have postures × joints entries.
    #[doc(hidden)]
    pub fn evaluate(&mut self, q: &[f64]) -> Minimax {
        let mut out = Minimax::default();
        self.evaluate_into(q, &mut out);
        out
    }

    /// [`evaluate`](Self::evaluate) into a result that is used again, without
    /// allocation once it has its size.
    ///
    /// # Panics
    /// If `q` does not have postures × joints entries.
    #[doc(hidden)]
    pub fn evaluate_into(&mut self, q: &[f64], out: &mut Minimax) {
        let size = q.len();
        let components = self.component_count();
        out.smooth_gradient.resize(size, 0.0);
        out.components.resize(components, 0.0);
        out.component_gradients.resize(components * size, 0.0);
        out.component_gradients.fill(0.0);
        out.smooth_gradient.fill(0.0);
        let value = self.forward(q);
        (out.smooth, out.exact) = (value.smooth, value.exact);
        out.components.copy_from_slice(&self.components);
        if !value.exact.is_finite() {
            return;
        }
        let n = self.kernel.joint_count();
        if self.index.uses_dexterity() {
            // Each k(J_N) depends on its own posture only: one sweep for all.
            self.adjoint.fill(0.0);
            self.kernel.set_adjoint(None, &self.adjoint);
            for p in 0..self.kernel.posture_count() {
                self.kernel.set_dexterity_weight(p, 1.0);
            }
            self.kernel.reverse(&mut self.row);
            for (p, row) in self.row.chunks_exact(n).enumerate() {
                let start = p * size + p * n;
                out.component_gradients[start..start + n].copy_from_slice(row);
                self.kernel.set_dexterity_weight(p, 0.0);
            }
        }
        match self.index {
            Index::Classical => {}
            Index::WorstJoint => {
                for (j, row) in out.component_gradients.chunks_exact_mut(size).enumerate() {
                    self.adjoint.fill(0.0);
                    self.criterion.add_joint_adjoint(j, 1.0, &mut self.adjoint);
                    self.kernel.set_adjoint(None, &self.adjoint);
                    self.kernel.reverse(row);
                }
            }
            Index::DropOne => {
                let square = self.adjoint.len();
                for (c, row) in out.component_gradients.chunks_exact_mut(size).enumerate() {
                    match c.checked_sub(self.fixed_postures.count) {
                        None => self.kernel.set_adjoint(None, &self.adjoints[c * square..(c + 1) * square]),
                        Some(p) => {
                            self.adjoint.iter_mut().zip(self.left_out.adjoint(p)).for_each(|(to, slope)| *to = slope);
                            self.kernel.set_adjoint(None, &self.adjoint);
                            self.adjoint.fill(0.0);
                            self.kernel.set_adjoint(Some(p), &self.adjoint);
                        }
                    }
                    self.kernel.reverse(row);
                }
            }
            Index::Prediction => {
                if let Some(prediction) = &self.prediction {
                    prediction.add_gradient(&mut out.smooth_gradient);
                }
            }
            _ => {
                self.kernel.set_adjoint(None, &self.criterion.adjoint);
                self.kernel.reverse(&mut out.smooth_gradient);
            }
        }
    }

    /// ln of the index alone (of its reciprocal for O1 to O5), infinite where
    /// it does not exist.
    ///
    /// # Panics
    /// If `q` does not have postures × joints entries.
    pub fn value(&mut self, q: &[f64]) -> f64 {
        if let Some(prediction) = &mut self.prediction {
            self.kernel.forward(q);
            return prediction.value(q);
        }
        let sharpness = self.criterion.sharpness.take();
        let value = self.forward(q).exact + self.largest_component();
        self.criterion.sharpness = sharpness;
        value
    }

    /// Whether the last value has nine digits: Gram matrices square condition numbers.
    pub(super) fn is_well_conditioned(&mut self) -> bool {
        let largest = self.largest_component();
        let of_part = (self.index == Index::DropOne).then_some(largest);
        let is_far = !self.index.uses_dexterity() || 2.0 * largest < ACCURATE_CONDITION.ln();
        is_far
            && (!self.index.uses_observation() || self.criterion.condition(&self.total, of_part) < ACCURATE_CONDITION)
    }

    /// ln of the index (of its reciprocal for O1 to O5) at `q` \[rad\] and its gradient \[1/rad\]: at kinks that
    /// of one side, zeros where the value is infinite. Panics as [`value`](Self::value).
    pub fn log_and_gradient(&mut self, q: &[f64]) -> (f64, Vec<f64>) {
        self.evaluate(q).value_and_gradient()
    }

    /// One smooth function with its gradient \[1/rad\]: the maximum of the
    /// components becomes ln(Σ exp(p·component))/p, off by at most ln(count)/p,
    /// and the extreme singular values as [`set_sharpness`](Self::set_sharpness)
    /// says, both with p = `sharpness`.
    ///
    /// # Panics
    /// If `q` does not have postures × joints entries, or `gradient` not as many.
    pub fn smoothed(&mut self, q: &[f64], sharpness: f64, gradient: &mut [f64]) -> Smoothed {
        assert_eq!(q.len(), gradient.len(), "one derivative per angle");
        self.criterion.sharpness = Some(sharpness);
        let value = self.forward(q);
        let largest = self.largest_component();
        let exact = value.exact + largest;
        if !exact.is_finite() {
            gradient.fill(0.0);
            return Smoothed { objective: f64::INFINITY, exact: f64::INFINITY };
        }
        let mut smooth = value.smooth;
        if !self.components.is_empty() {
            let above = log_sum(&self.components, largest, sharpness, &mut self.weights);
            smooth += largest + above;
        }
        self.set_smoothed_adjoints();
        self.kernel.reverse(gradient);
        if let Some(prediction) = &self.prediction {
            prediction.add_gradient(gradient);
        }
        Smoothed { objective: smooth + self.kernel.penalty(), exact }
    }

    /// Derivatives of the smoothed index by information and k(J_N).
    fn set_smoothed_adjoints(&mut self) {
        if self.index.uses_dexterity() {
            for p in 0..self.kernel.posture_count() {
                self.kernel.set_dexterity_weight(p, self.weights[p]);
            }
        }
        match self.index {
            Index::Classical | Index::Prediction => {}
            Index::WorstJoint => {
                self.adjoint.fill(0.0);
                for (j, weight) in self.weights.iter().enumerate() {
                    self.criterion.add_joint_adjoint(j, *weight, &mut self.adjoint);
                }
                self.kernel.set_adjoint(None, &self.adjoint);
            }
            Index::DropOne => {
                let square = self.adjoint.len();
                self.adjoint.fill(0.0);
                for (weight, part) in self.weights.iter().zip(self.adjoints.chunks_exact(square)) {
                    for (sum, v) in self.adjoint.iter_mut().zip(part) {
                        *sum += weight * v;
                    }
                }
                let weights = &self.weights[self.fixed_postures.count..];
                self.kernel.set_left_out_adjoints(&self.left_out, &mut self.adjoint, weights);
            }
            _ => self.kernel.set_adjoint(None, &self.criterion.adjoint),
        }
    }

    /// Everything but the reverse sweep: the smooth part, and the components.
    fn forward(&mut self, q: &[f64]) -> Value {
        let n = self.kernel.joint_count();
        let count = self.kernel.posture_count();
        assert_eq!(q.len(), n * count, "postures × joints angles");
        self.kernel.forward(q);
        if let Some(prediction) = &mut self.prediction {
            let value = prediction.evaluate(q);
            return Value::plain(value);
        }
        if self.index.uses_dexterity() {
            for p in 0..count {
                self.components[p] = self.kernel.log_dexterity(p);
            }
            if self.fixed_postures.count > 0 {
                self.components[count] = self.fixed_postures.log_dexterity;
            }
        }
        if !self.index.uses_observation() {
            return Value::plain(0.0);
        }
        let size = self.total.len();
        self.total.fill(0.0);
        self.fixed_postures.add_information(&mut self.total);
        self.kernel.add_information(&mut self.total);
        let constant = Value::plain(self.log_factor);
        match self.index {
            Index::WorstJoint => {
                if !self.criterion.invert(&self.total) {
                    return Value::INFINITE;
                }
                for (j, component) in self.components.iter_mut().enumerate() {
                    *component = self.criterion.joint(j);
                }
                constant
            }
            Index::DropOne => {
                let square = self.adjoint.len();
                for (c, information) in self.fixed_postures.each.chunks_exact(size).enumerate() {
                    self.rest.copy_from_slice(&self.total);
                    for (rest, v) in self.rest.iter_mut().zip(information) {
                        *rest -= v;
                    }
                    let value = self.criterion.evaluate(&self.rest);
                    if !value.exact.is_finite() {
                        return Value::INFINITE;
                    }
                    self.components[c] = value.exact;
                    self.adjoints[c * square..(c + 1) * square].copy_from_slice(&self.criterion.adjoint);
                }
                if !self.kernel.leave_each_out(&self.total, &mut self.left_out) {
                    return Value::INFINITE;
                }
                for p in 0..count {
                    let log_error = self.left_out.log_error(p);
                    if !log_error.is_finite() {
                        return Value::INFINITE;
                    }
                    self.components[self.fixed_postures.count + p] = log_error;
                }
                constant
            }
            _ => {
                let value = self.criterion.evaluate(&self.total);
                Value { smooth: value.smooth + self.log_factor, exact: value.exact + self.log_factor }
            }
        }
    }

    fn largest_component(&self) -> f64 {
        let largest = self.components.iter().copied().reduce(f64::max);
        largest.unwrap_or(0.0)
    }

    /// The index prediction.
    pub(crate) fn prediction(&self) -> Option<&PredictionFunction> {
        self.prediction.as_deref()
    }

    /// The index prediction, to hold other postures.
    pub(crate) fn prediction_mut(&mut self) -> Option<&mut PredictionFunction> {
        self.prediction.as_deref_mut()
    }

    /// The given postures.
    pub(crate) fn fixed_postures(&self) -> &FixedPostures {
        &self.fixed_postures
    }

    /// The kernel, for its limits and load.
    pub(crate) fn kernel(&self) -> &Kernel {
        &self.kernel
    }

    /// The kernel, to move limits' multipliers and load.
    pub(crate) fn kernel_mut(&mut self) -> &mut Kernel {
        &mut self.kernel
    }
}
