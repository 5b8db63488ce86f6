//! Fits to all postures but some, from sums over all of them: what the postures
//! left out contribute is taken away again, in the orthonormal basis of Ψ's
//! columns, where that costs no accuracy unless they decide an unknown alone.

use super::assumptions::{Assumptions, Estimator, Scale};
use super::restricted::{Restricted, Sums};
use super::solve::{Prepared, Rows, Shape, Solution, least_squares};
use crate::error::Result;
use crate::numerics::information::{Factor, symmetric_eigen};
use nalgebra::{DMatrix, DVector};

/// Smallest eigenvalue of what is left of BᵀV⁻¹B, the identity for all postures
/// without shifts, that is far enough from rounding.
const DECISIVE: f64 = 1e-6;
/// Smallest sum of squared residuals of the others, relative to that of all.
const DOMINANT: f64 = 1e-6;

/// A fit to all postures, ready to lose some.
pub(super) struct Others<'a> {
    prepared: &'a Prepared,
    assumed: &'a Assumptions,
    criterion: Restricted<'a>,
    /// Least squares without shifts.
    centre: DVector<f64>,
    /// Coordinates of the unknowns in the basis, rank × unknowns.
    seen: DMatrix<f64>,
    /// Postures that can tell shifts from noise.
    separable: Vec<bool>,
    /// Sums over all postures at γ = 0, and at the γ that is given.
    plain: Sums,
    given: Option<Sums>,
}

impl<'a> Others<'a> {
    /// `None` for Huber's estimator, whose weights depend on every row, and where
    /// no unknown is determined.
    pub(super) fn new(
        prepared: &'a Prepared,
        white: &DVector<f64>,
        assumed: &'a Assumptions,
    ) -> Option<Self> {
        let system = prepared.whitened();
        if assumed.estimator == Estimator::Huber || system.factor().rank() == 0 {
            return None;
        }
        let criterion = Restricted::new(system, white);
        let given = match (assumed.estimator, assumed.scale) {
            (Estimator::Weighted, _) => Some(assumed.declared_ratio),
            (Estimator::Ordinary, _) => None,
            (_, Scale::Known { gamma, .. }) => Some(gamma),
            _ => None,
        };
        let is_separable = |b: usize| system.directions(b).0.ncols() < system.block_rows(b).len();
        Some(Others {
            centre: system.factor().solve(white),
            seen: system.factor().seen(),
            separable: (0..system.block_count()).map(is_separable).collect(),
            plain: criterion.at(0.0),
            given: given.map(|gamma| criterion.at(gamma)),
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
        let separable = self.separable.iter().filter(|s| **s).count();
        let shape = Shape {
            rows: system.rows() - sum(&|b| system.block_rows(b).len()),
            rank,
            shifts: system.shifts() - sum(&|b| system.directions(b).0.ncols()),
            separable: separable > sum(&|b| usize::from(self.separable[b])),
        };
        let own = self.criterion.own(left_out);
        let plain = self.plain.minus(&own);
        if shape.rows <= rank || !self.is_enough(&plain, rank) {
            return Ok(None);
        }
        let ratio = || match self.criterion.is_rounding() {
            true => 0.0,
            false => self.criterion.best_without(left_out, &own, shape.rows),
        };
        let mut enough = true;
        let rows = |gamma: f64| {
            let all;
            let sums = match (gamma > 0.0, &self.given) {
                (false, _) => plain.clone(),
                (true, Some(given)) => self.criterion.without(left_out, &own, given, gamma),
                (true, None) => {
                    all = self.criterion.between(gamma.ln());
                    self.criterion.without(left_out, &own, &all, gamma)
                }
            };
            enough = self.is_enough(&sums, rank);
            self.rows(&sums, rank)
        };
        let solution = least_squares(shape, self.prepared.springs(), self.assumed, ratio, rows)?;
        Ok(enough.then_some(solution))
    }

    /// True where what is left stands well above the rounding of the difference.
    fn is_enough(&self, sums: &Sums, rank: usize) -> bool {
        let (information, moment, size) = sums.parts(rank);
        let left = |information: DMatrix<f64>| {
            let best = information.cholesky()?.solve(&moment);
            Some(size - moment.dot(&best))
        };
        let spread =
            symmetric_eigen(information.clone()).is_some_and(|(values, _)| values[0] > DECISIVE);
        let is_rounding = self.criterion.is_rounding();
        spread
            && left(information)
                .is_some_and(|left| is_rounding || left > DOMINANT * self.criterion.size())
    }

    /// As many independent rows as unknowns are determined that give the same
    /// least squares.
    fn rows(&self, sums: &Sums, rank: usize) -> Result<Rows> {
        let (information, moment, size) = sums.parts(rank);
        // Not positive definite only where too little is left; the fit is then
        // made anew.
        let Some(cholesky) = information.cholesky() else {
            let psi = self.seen.clone();
            return Ok(Rows {
                factor: Factor::new(&psi)?,
                delta: DVector::zeros(rank),
                rest: 0.0,
                psi,
            });
        };
        let root = cholesky.l();
        let psi = root.tr_mul(&self.seen);
        let mut moved = moment;
        root.solve_lower_triangular_mut(&mut moved);
        Ok(Rows {
            factor: Factor::new(&psi)?,
            rest: (size - moved.norm_squared()).max(0.0),
            delta: moved + &psi * &self.centre,
            psi,
        })
    }
}
