//! What a fit sees of its displacements, in coordinates in which readings and shifts are independent and alike.

use super::MixedFit;
use crate::error::{Code, Error, Result};
use crate::estimate::identify::Fit;
use nalgebra::{DMatrix, DVector};

/// I − B Bᵀ takes displacements to what the fit leaves of them, P Δ.
pub(crate) struct ResidualMaker {
    /// B, rows × unknowns: a basis of Ψ, or Ψ and the random effects times the root of the inverse of their equations.
    pub(crate) basis: DMatrix<f64>,
    /// P Δ.
    pub(crate) residual: DVector<f64>,
    /// Δᵀ P Δ.
    pub(crate) size: f64,
    /// Degrees of freedom behind it.
    pub(crate) free: usize,
    /// γ = τ²/σ².
    pub(crate) gamma: f64,
}

impl ResidualMaker {
    /// What the axes alone see.
    pub(crate) fn of(fit: &Fit) -> ResidualMaker {
        let solution = fit.solution();
        let rows = fit.system().delta.len();
        let basis = solution.factor.basis(rows);
        let (free, gamma) = (solution.degrees_of_freedom, solution.gamma);
        ResidualMaker::with(fit, fit.white(), basis, free, gamma)
    }

    fn with(fit: &Fit, white: &DVector<f64>, basis: DMatrix<f64>, free: usize, gamma: f64) -> ResidualMaker {
        let both = fit.prepared().whitened().delta_with_shifts(white, gamma);
        let residual = &both - &basis * basis.tr_mul(&both);
        ResidualMaker { size: both.dot(&residual), basis, residual, free, gamma }
    }
}

impl MixedFit {
    /// What the mixed model sees, its sizes held.
    ///
    /// # Errors
    /// Equations that cannot be solved.
    pub(crate) fn seen(&self) -> Result<ResidualMaker> {
        let whitened = self.fit.prepared().whitened();
        let rows = &self.rows;
        let (fixed, mut random) = (rows.fixed, rows.random_columns());
        let mut prior_rows = rows.prior().rows.clone();
        for (class, size) in rows.classes.iter().zip(&self.sizes.classes) {
            for columns in [&mut random, &mut prior_rows] {
                let mut class_columns = columns.columns_mut(class.start, class.len());
                class_columns *= size.sqrt();
            }
        }
        // With what is known of them the effects scatter less, and not about zero: v with this precision about this
        // mean.
        let count = prior_rows.ncols();
        let precision = prior_rows.tr_mul(&prior_rows) + DMatrix::identity(count, count);
        let mean = precision.clone().cholesky();
        let mean = mean.map_or_else(|| DVector::zeros(count), |f| f.solve(&prior_rows.tr_mul(&rows.prior().read)));
        let white = self.fit.white() - &random * mean;
        let mut all = whitened.psi().clone().resize_horizontally(fixed + random.ncols(), 0.0);
        all.columns_mut(fixed, random.ncols()).copy_from(&random);
        let all = whitened.with_shifts(&all, self.sizes.gamma);
        let mut matrix = all.tr_mul(&all);
        let mut random_block = matrix.view_mut((fixed, fixed), precision.shape());
        random_block += precision;
        rows.idle.iter().for_each(|j| matrix[(*j, *j)] += 1.0);
        let basis = matrix.cholesky().and_then(|factor| factor.l().solve_lower_triangular(&all.transpose()));
        let basis =
            basis.ok_or_else(|| Error::new(Code::Numerical, "The equations of the mixed model are singular."))?;
        let free = self.fit.system().delta.len() + rows.idle.len() - fixed;
        Ok(ResidualMaker::with(&self.fit, &white, basis.transpose(), free, self.sizes.gamma))
    }
}
