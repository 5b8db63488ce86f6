//! Fits to all postures but some, from sums over all of them: what the postures
//! left out contribute is taken away again, in the orthonormal basis of Ψ's
//! columns, where that costs no accuracy unless they decide an unknown alone.

use super::assumptions::{Assumptions, Estimator, Scale};
use super::restricted::{Restricted, Root, Sums};
use super::solve::{Prepared, Rows, Shape, Solution, least_squares};
use crate::error::{Code, Error, Result};
use crate::numerics::information::Factor;
use nalgebra::{DMatrix, DVector};

/// Smallest eigenvalue of what is left of BᵀV⁻¹B, the identity for all postures
/// without shifts, that is far enough from rounding.
const DECISIVE: f64 = 1e-6;
/// Smallest sum of squared residuals of the others, relative to that of all.
const DOMINANT: f64 = 1e-6;

/// A fit to all postures, ready to lose some.
pub(super) struct LeaveOutSolver<'a> {
    prepared: &'a Prepared,
    assumed: &'a Assumptions,
    criterion: Restricted<'a>,
    /// Least squares without shifts.
    centre: DVector<f64>,
    /// Coordinates of the unknowns in the basis, rank × unknowns.
    seen: DMatrix<f64>,
    /// Postures that can tell shifts from noise, and how many they are.
    separable: Vec<bool>,
    separable_count: usize,
    /// Sums over all postures at the γ that is given.
    fixed_sums: Option<Sums>,
}

impl<'a> LeaveOutSolver<'a> {
    /// `None` for Huber's estimator, whose weights depend on every row, and where
    /// no unknown is determined.
    pub(super) fn new(prepared: &'a Prepared, white: &DVector<f64>, assumed: &'a Assumptions) -> Option<Self> {
        let system = prepared.whitened();
        if assumed.estimator == Estimator::Huber || system.factor().rank() == 0 {
            return None;
        }
        let criterion = Restricted::new(system, white);
        let ratio = match (assumed.estimator, assumed.scale) {
            (Estimator::Weighted, _) => Some(assumed.declared_ratio),
            (Estimator::Ordinary, _) => None,
            (_, Scale::Known { gamma, .. }) => Some(gamma),
            _ => None,
        };
        let is_separable = |b: usize| system.directions(b).0.ncols() < system.block_rows(b).len();
        let separable: Vec<bool> = (0..system.block_count()).map(is_separable).collect();
        Some(LeaveOutSolver {
            centre: system.factor().solve(white),
            seen: system.factor().seen(),
            separable_count: separable.iter().filter(|s| **s).count(),
            separable,
            fixed_sums: ratio.map(|gamma| criterion.at(gamma)),
            prepared,
            assumed,
            criterion,
        })
    }

    /// The fit without the postures `left_out` (indices of blocks); `None` where
    /// so much hangs on them that the others need a fit of their own.
    ///
    /// # Errors
    /// A decomposition that fails, or a prior estimate without prior knowledge.
    pub(super) fn without(&self, left_out: &[usize]) -> Result<Option<Solution>> {
        let system = self.prepared.whitened();
        let rank = system.factor().rank();
        let sum = |of: &dyn Fn(usize) -> usize| -> usize { left_out.iter().map(|b| of(*b)).sum() };
        let shape = Shape {
            rows: system.rows() - sum(&|b| system.block_rows(b).len()),
            rank,
            shifts: system.shifts() - sum(&|b| system.directions(b).0.ncols()),
            separable: self.separable_count > sum(&|b| usize::from(self.separable[b])),
        };
        let block_sums = self.criterion.block_sums(left_out);
        let without = |all: Sums, gamma: f64| self.criterion.without(left_out, &block_sums, all, gamma);
        let plain = without(self.criterion.plain().clone(), 0.0);
        if shape.rows <= rank || self.enough(&plain).is_none() {
            return Ok(None);
        }
        let ratio = || {
            if self.criterion.is_rounding() {
                0.0
            } else {
                self.criterion.best_without(left_out, &block_sums, shape.rows)
            }
        };
        let mut enough = true;
        let rows = |gamma: f64| {
            let sums = match (gamma > 0.0, &self.fixed_sums) {
                (false, _) => plain.clone(),
                (true, Some(sums)) => without(sums.clone(), gamma),
                (true, None) => without(self.criterion.between(gamma.ln()), gamma),
            };
            let root = self.enough(&sums);
            enough = root.is_some();
            root.map_or_else(|| Err(too_little()), |root| self.rows(root))
        };
        let solution = least_squares(shape, self.prepared.springs(), self.assumed, ratio, rows);
        if enough { solution.map(Some) } else { Ok(None) }
    }

    /// The factor of what is left, where it stands well above the rounding of
    /// the difference.
    fn enough(&self, sums: &Sums) -> Option<Root> {
        let squares = if self.criterion.is_rounding() { f64::NEG_INFINITY } else { DOMINANT * self.criterion.size() };
        let root = sums.root()?;
        (root.least() > DECISIVE && root.rest > squares).then_some(root)
    }

    /// As many independent rows as unknowns are determined that give the same
    /// least squares.
    fn rows(&self, root: Root) -> Result<Rows> {
        let psi = root.factor().tr_mul(&self.seen);
        Ok(Rows {
            factor: Factor::new(&psi)?,
            rest: root.rest.max(0.0),
            delta: DVector::from_vec(root.moved) + &psi * &self.centre,
            psi,
        })
    }
}

/// Ends an estimate whose rows say too little; the caller makes it anew.
fn too_little() -> Error {
    Error::new(Code::Numerical, "The postures left over decide too little.")
}
