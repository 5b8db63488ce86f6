//! The index `prediction` as a function of the postures, with its gradient.

use super::motion::ArmMotion;
use super::posterior::{Equations, GroupCovariance, Posterior};
use super::{PredictionModel, Rows};
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::observation::{PostureTerms, Setup};
use nalgebra::DMatrix;

/// The index of given postures and of free ones.
#[derive(Debug, Clone)]
pub(crate) struct PredictionFunction {
    model: PredictionModel,
    /// Terms of each free posture under each load.
    terms: Vec<Vec<PostureTerms>>,
    arms: Vec<Vec<ArmMotion>>,
    /// Rows of the given postures, then of the free ones.
    rows: Rows,
    /// Rows of the given postures.
    base_row_count: usize,
    /// What is held beside one free posture, without given ones.
    held: Option<GroupCovariance>,
    /// Derivative of ln(index) by the rows, after an evaluation.
    adjoint: Option<DMatrix<f64>>,
}

impl PredictionFunction {
    /// # Errors
    /// As [`PredictionModel::of_cell`]; given angles of the wrong number or not finite.
    pub(crate) fn new<Q: AsRef<[f64]>>(cell: &Cell, count: usize, fixed_postures: &[Q]) -> Result<Self> {
        let model = PredictionModel::of_cell(cell)?.condensed(cell)?;
        let under_each = |q: &[f64]| -> Result<Vec<PostureTerms>> {
            let under = |setup: &Setup| PostureTerms::new(setup, q, None);
            model.cases.iter().map(under).collect()
        };
        let mut blocks = Vec::with_capacity(fixed_postures.len() + count);
        for q in fixed_postures {
            blocks.push(model.readings(&under_each(q.as_ref())?));
        }
        let terms = under_each(&vec![0.0; cell.setup.robot.joint_count()])?;
        let per = model.rows_per_posture();
        blocks.extend((0..count).map(|_| DMatrix::zeros(per, model.unknowns())));
        Ok(PredictionFunction {
            rows: model.stacked(&blocks),
            base_row_count: per * fixed_postures.len(),
            arms: vec![model.arms(&terms); count],
            terms: vec![terms; count],
            model,
            held: None,
            adjoint: None,
        })
    }

    /// The model.
    pub(crate) fn model(&self) -> &PredictionModel {
        &self.model
    }

    /// Readings at postures \[rad\] under each load, one below the other; `None` where a load has no direction.
    pub(crate) fn readings(&self, postures: &[&[f64]]) -> Option<DMatrix<f64>> {
        let under_each = |q: &&[f64]| {
            let under = |setup| PostureTerms::new(setup, q, None).ok();
            self.model.cases.iter().map(under).collect::<Option<Vec<_>>>()
        };
        let terms: Option<Vec<_>> = postures.iter().map(under_each).collect();
        let each: Vec<_> = terms?.iter().map(|states| self.model.readings(states)).collect();
        Some(self.model.stacked(&each).all)
    }

    /// Rows of the given postures.
    pub(crate) fn base_readings(&self) -> DMatrix<f64> {
        self.rows.all.rows(0, self.base_row_count).into_owned()
    }

    /// Holds these readings beside the one free posture.
    pub(crate) fn hold(&mut self, rows: [&DMatrix<f64>; 2]) {
        let mut equations = Equations::new(self.model.unknowns(), self.rows.fixed);
        rows.into_iter().for_each(|block| equations.add(block));
        self.held = GroupCovariance::new(&equations, self.model.targets());
    }

    /// ln of the index at the free postures `q` \[rad\], one after the other; infinite
    /// where it does not exist.
    pub(crate) fn value(&mut self, q: &[f64]) -> f64 {
        self.adjoint = None;
        if !self.place(q) {
            return f64::INFINITY;
        }
        let error = match &self.held {
            Some(held) => held.gain(&self.rows.all).map(|gain| held.error - gain),
            None => Posterior::new(&self.rows).and_then(|posterior| posterior.error(self.model.targets())),
        };
        error.map_or(f64::INFINITY, |error| 0.5 * error.ln())
    }

    /// The same, ready for [`add_gradient`](Self::add_gradient).
    pub(crate) fn evaluate(&mut self, q: &[f64]) -> f64 {
        self.adjoint = None;
        if !self.place(q) {
            return f64::INFINITY;
        }
        let error_and_gradient = match &self.held {
            Some(held) => {
                let gained = held.gain_and_gradient(&self.rows.all);
                gained.map(|(gain, by_rows)| (held.error - gain, -by_rows))
            }
            None => Posterior::new(&self.rows).and_then(|posterior| posterior.error_and_gradient(self.model.targets())),
        };
        let Some((error, by_rows)) = error_and_gradient else {
            return f64::INFINITY;
        };
        // ∂ ½ ln F = ∂F/(2F).
        self.adjoint = Some(by_rows * (0.5 / error));
        0.5 * error.ln()
    }

    /// tr(A·XᵀX) of the readings X at `q`, ready for [`add_gradient`](Self::add_gradient); not a number where a load
    /// has no direction.
    pub(crate) fn trace(&mut self, q: &[f64], a: &DMatrix<f64>) -> f64 {
        self.adjoint = None;
        if !self.place(q) {
            return f64::NAN;
        }
        let by_rows = &self.rows.all * a;
        let value = by_rows.dot(&self.rows.all);
        self.adjoint = Some(by_rows * 2.0);
        value
    }

    /// Adds the derivatives of ln(index), or of the trace, by the free angles \[1/rad\] at the last
    /// evaluation to `gradient`.
    pub(crate) fn add_gradient(&self, gradient: &mut [f64]) {
        let Some(adjoint) = &self.adjoint else {
            return;
        };
        let robot = &self.model.cases[0].robot;
        let n = robot.joint_count();
        let (mut by_theta, mut by_q) = (vec![0.0; n], vec![0.0; n]);
        let per = self.model.rows_per_load();
        let mut from = self.base_row_count;
        for (arms, out) in self.arms.iter().zip(gradient.chunks_exact_mut(n)) {
            by_theta.fill(0.0);
            for (arm, setup) in arms.iter().zip(&self.model.cases) {
                let by_rows = adjoint.rows(from, per).into_owned();
                self.model.add_gradient(arm, &setup.load, &by_rows, &mut by_theta);
                from += per;
            }
            robot.gradient_to_controller(&by_theta, &mut by_q);
            for (sum, slope) in out.iter_mut().zip(&by_q) {
                *sum += slope;
            }
        }
    }

    /// Moves the free postures; false where a load has no direction.
    fn place(&mut self, q: &[f64]) -> bool {
        let n = self.model.cases[0].robot.joint_count();
        let per = self.model.rows_per_load();
        let mut from = self.base_row_count;
        for (p, q) in q.chunks_exact(n).enumerate() {
            for (c, setup) in self.model.cases.iter().enumerate() {
                let terms = &mut self.terms[p][c];
                if terms.update(setup, q).is_err() {
                    return false;
                }
                let arm = ArmMotion::new(terms, &setup.load);
                self.rows.all.rows_mut(from, per).copy_from(&self.model.readings_of(&arm));
                self.arms[p][c] = arm;
                from += per;
            }
        }
        true
    }
}
