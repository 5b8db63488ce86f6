//! The index `prediction` as a function of the postures, with its gradient.

use super::motion::ArmMotion;
use super::posterior::Posterior;
use super::{PredictionModel, Rows};
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::observation::{PostureTerms, Setup};
use nalgebra::DMatrix;

/// The index of given postures and of free ones.
#[derive(Debug, Clone)]
pub(crate) struct PredictionFunction {
    model: PredictionModel,
    setup: Setup,
    /// Terms of each free posture.
    terms: Vec<PostureTerms>,
    arms: Vec<ArmMotion>,
    /// Rows of the given postures, then of the free ones.
    rows: Rows,
    /// Rows of the given postures.
    given: usize,
    /// Derivative of ln(index) by the rows, after an evaluation.
    adjoint: Option<DMatrix<f64>>,
}

impl PredictionFunction {
    /// # Errors
    /// As [`PredictionModel::new`]; given angles of the wrong number or not finite.
    pub(crate) fn new<Q: AsRef<[f64]>>(cell: &Cell, count: usize, given: &[Q]) -> Result<Self> {
        let model = PredictionModel::of_cell(cell)?;
        let setup = cell.setup.clone();
        let mut blocks = Vec::with_capacity(given.len() + count);
        for q in given {
            let terms = PostureTerms::new(&setup, q.as_ref(), None)?;
            blocks.push(model.readings(&terms));
        }
        let zero = vec![0.0; setup.robot.joint_count()];
        let terms = vec![PostureTerms::new(&setup, &zero, None)?; count];
        let arms: Vec<ArmMotion> = terms.iter().map(|terms| model.arm(terms)).collect();
        let per = model.rows_per_posture();
        blocks.extend((0..count).map(|_| DMatrix::zeros(per, model.unknowns())));
        Ok(PredictionFunction {
            rows: model.stacked(&blocks),
            given: per * given.len(),
            model,
            setup,
            terms,
            arms,
            adjoint: None,
        })
    }

    /// Of `candidates` the one that is worth most beside the free postures `q` \[rad\] but the one at `at`; `None`
    /// where the others do not determine every joint.
    pub(crate) fn best_instead(
        &mut self,
        q: &[f64],
        at: usize,
        candidates: &[&[f64]],
    ) -> Option<usize> {
        if !self.place(q) {
            return None;
        }
        let per = self.model.rows_per_posture();
        let others = Rows {
            all: self
                .rows
                .all
                .clone()
                .remove_rows(self.given + per * at, per),
            fixed: self.rows.fixed,
        };
        let mut terms = self.terms[at].clone();
        let readings = |q: &&[f64]| {
            terms.update(&self.setup, q).ok()?;
            Some(self.model.readings(&terms))
        };
        let blocks: Option<Vec<DMatrix<f64>>> = candidates.iter().map(readings).collect();
        let all = self.model.stacked(&blocks?);
        let (gains, _) = Posterior::new(&others)?.gains(&all, per, self.model.targets())?;
        (0..gains.len()).max_by(|a, b| gains[*a].total_cmp(&gains[*b]))
    }

    /// ln of the index at the free postures `q` \[rad\], one after the other; infinite
    /// where it does not exist.
    pub(crate) fn value(&mut self, q: &[f64]) -> f64 {
        self.adjoint = None;
        if !self.place(q) {
            return f64::INFINITY;
        }
        let error = Posterior::new(&self.rows).and_then(|found| found.error(self.model.targets()));
        error.map_or(f64::INFINITY, |error| 0.5 * error.ln())
    }

    /// The same, ready for [`add_gradient`](Self::add_gradient).
    pub(crate) fn evaluate(&mut self, q: &[f64]) -> f64 {
        self.adjoint = None;
        if !self.place(q) {
            return f64::INFINITY;
        }
        let found = Posterior::new(&self.rows)
            .and_then(|found| found.error_and_gradient(self.model.targets()));
        let Some((error, by_rows)) = found else {
            return f64::INFINITY;
        };
        // ∂ ½ ln F = ∂F/(2F).
        self.adjoint = Some(by_rows * (0.5 / error));
        0.5 * error.ln()
    }

    /// Adds the derivatives of ln(index) by the free angles \[1/rad\] at the last
    /// evaluation to `gradient`.
    pub(crate) fn add_gradient(&self, gradient: &mut [f64]) {
        let Some(adjoint) = &self.adjoint else {
            return;
        };
        let per = self.model.rows_per_posture();
        let n = self.setup.robot.joint_count();
        let (mut by_theta, mut by_q) = (vec![0.0; n], vec![0.0; n]);
        for (p, arm) in self.arms.iter().enumerate() {
            by_theta.fill(0.0);
            let own = adjoint.rows(self.given + per * p, per);
            self.model
                .add_gradient(arm, &own.into_owned(), &mut by_theta);
            self.setup
                .robot
                .gradient_to_controller(&by_theta, &mut by_q);
            for (sum, own) in gradient[p * n..(p + 1) * n].iter_mut().zip(&by_q) {
                *sum += own;
            }
        }
    }

    /// Moves the free postures; false where a load has no direction.
    fn place(&mut self, q: &[f64]) -> bool {
        let n = self.setup.robot.joint_count();
        let per = self.model.rows_per_posture();
        for (p, q) in q.chunks_exact(n).enumerate() {
            if self.terms[p].update(&self.setup, q).is_err() {
                return false;
            }
            self.arms[p] = self.model.arm(&self.terms[p]);
            let own = self.model.readings_of(&self.arms[p]);
            self.rows
                .all
                .rows_mut(self.given + per * p, per)
                .copy_from(&own);
        }
        true
    }
}
