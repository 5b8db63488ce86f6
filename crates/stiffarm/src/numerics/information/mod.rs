//! Information of postures about the joint compliances, and what it cannot tell.
//!
//! Loops work with ΨᵀΨ; every number that is shown comes from a column-scaled
//! QR and an SVD of Ψ, which do not square the condition number.

pub mod cholesky;
pub mod small;
mod stack;
pub mod svd;

pub(crate) use stack::{Stack, stacked};
pub(crate) use svd::{Svd, svd, tall_svd};

use crate::error::{Code, Error, Result};
use crate::numerics::order::ascending;
use nalgebra::linalg::SymmetricEigen;
use nalgebra::{DMatrix, DVector};

/// Columns smaller than this, relative to the largest, carry no information.
pub(crate) const ZERO_COLUMN: f64 = 1e-10;
/// Singular values of the column-scaled Ψ below this, relative to the largest, are zero.
const RANK_TOLERANCE: f64 = 1e-10;
/// Share of a joint in the null space above which it is called undetermined.
const NULL_SHARE: f64 = 1e-6;
/// Smallest eigenvalue of a Gram matrix, relative to the largest and per row,
/// that is more than its rounding error.
pub(crate) const GRAM_ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Iterations after which a decomposition counts as failed.
const MAX_ITERATIONS: usize = 1000;

/// Information ΨᵀPΨ of one posture's block, n × n, where P = I − ρ 11ᵀ ⊗ I₃
/// accounts for a shift common to the posture's points
/// ([`crate::model::cell::Noise::common_weight`]); in units of 1/σ².
pub fn posture_information(block: &DMatrix<f64>, common_weight: f64) -> DMatrix<f64> {
    let mut information = block.tr_mul(block);
    if common_weight > 0.0 {
        let sums = point_sums(block);
        information -= sums.tr_mul(&sums) * common_weight;
    }
    information
}

/// Sum of the rows x, y, z over the measuring points, 3 × n.
fn point_sums(block: &DMatrix<f64>) -> DMatrix<f64> {
    let mut sums = DMatrix::zeros(3, block.ncols());
    for a in 0..block.nrows() / 3 {
        sums += block.rows(3 * a, 3);
    }
    sums
}

/// Column j times factor j.
pub(crate) fn scale_columns(matrix: &mut DMatrix<f64>, factors: impl IntoIterator<Item = f64>) {
    for (mut column, factor) in matrix.column_iter_mut().zip(factors) {
        column *= factor;
    }
}

/// Whitens the rows of one posture against the shift common to its points, in
/// place: the result has the information of [`posture_information`].
pub fn whiten_posture(block: &mut DMatrix<f64>, common_weight: f64) {
    if common_weight <= 0.0 {
        return;
    }
    let points = block.nrows() / 3;
    let m = points as f64;
    // (I − β 11ᵀ)² = I − ρ 11ᵀ.
    let beta = (1.0 - (1.0 - m * common_weight).max(0.0).sqrt()) / m;
    let shift = point_sums(block) * beta;
    for a in 0..points {
        let mut rows = block.rows_mut(3 * a, 3);
        rows -= &shift;
    }
}

/// Column-scaled QR and SVD of Ψ: singular values, rank, covariance, least squares.
#[derive(Debug, Clone)]
pub struct Factor {
    /// Norms of the columns of Ψ (zero columns get 1).
    scale: DVector<f64>,
    /// Q of the thin QR of Ψ·diag(1/scale).
    q: DMatrix<f64>,
    /// Left singular vectors, values (descending) and right vectors of R.
    u: DMatrix<f64>,
    values: DVector<f64>,
    v: DMatrix<f64>,
    rank: usize,
    undetermined: Vec<usize>,
}

impl Factor {
    /// Factors Ψ (rows × n).
    ///
    /// # Errors
    /// An entry that is not finite, no columns, or a decomposition that does
    /// not converge.
    pub fn new(psi: &DMatrix<f64>) -> Result<Self> {
        if psi.iter().any(|v| !v.is_finite()) {
            return Err(Error::new(Code::NotFinite, "The observation matrix has an entry that is not finite."));
        }
        let n = psi.ncols();
        if n == 0 || psi.nrows() == 0 {
            return Err(Error::new(Code::TooFewData, "The observation matrix is empty."));
        }
        let norms = DVector::from_iterator(n, psi.column_iter().map(|c| c.norm()));
        let largest = norms.max();
        let empty: Vec<bool> = norms.iter().map(|c| *c <= ZERO_COLUMN * largest).collect();
        let mut scale = norms;
        let mut scaled = psi.clone();
        for j in 0..n {
            if empty[j] {
                // Exactly zero, so that rounding noise is not taken for information.
                scale[j] = 1.0;
                scaled.column_mut(j).fill(0.0);
            } else {
                let factor = 1.0 / scale[j];
                scaled.column_mut(j).scale_mut(factor);
            }
        }
        if scaled.nrows() < n {
            // Zero rows add nothing and give R its full size.
            scaled = scaled.resize_vertically(n, 0.0);
        }
        let qr = scaled.qr();
        let (q, r) = (qr.q(), qr.r());
        let Svd { u, values, v } = require_svd(r)?;
        let tolerance = RANK_TOLERANCE * values[0];
        let rank = values.iter().filter(|s| **s > tolerance && **s > 0.0).count();
        let undetermined = (0..n).filter(|&j| empty[j] || (rank..n).any(|i| v[(j, i)].abs() > NULL_SHARE)).collect();
        Ok(Factor { scale, q, u, values, v, rank, undetermined })
    }

    /// Number of unknowns n.
    pub fn unknowns(&self) -> usize {
        self.scale.len()
    }

    /// Numerical rank of Ψ.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Unknowns that Ψ does not determine, ascending.
    pub fn undetermined(&self) -> &[usize] {
        &self.undetermined
    }

    /// Condition number of the column-scaled Ψ, `None` when it loses rank.
    pub fn scaled_condition(&self) -> Option<f64> {
        (self.rank == self.unknowns()).then(|| self.values[0] / self.values[self.unknowns() - 1])
    }

    /// R of Ψ·diag(weights) = Q R', rebuilt from the factors, n × n.
    fn r_times(&self, weights: impl Fn(usize) -> f64) -> DMatrix<f64> {
        let mut r = &self.u * DMatrix::from_diagonal(&self.values) * self.v.transpose();
        scale_columns(&mut r, (0..self.unknowns()).map(|j| self.scale[j] * weights(j)));
        r
    }

    /// Singular values of Ψ·diag(weights), descending.
    ///
    /// # Errors
    /// The decomposition does not converge.
    pub fn singular_values(&self, weights: impl Fn(usize) -> f64) -> Result<DVector<f64>> {
        Ok(require_svd(self.r_times(weights))?.values)
    }

    /// (ΨᵀΨ)⁻¹ on the determined unknowns, n × n; rows and columns of
    /// undetermined ones are those of the pseudo-inverse and mean nothing.
    pub fn inverse_information(&self) -> DMatrix<f64> {
        let root = self.right_inverse();
        &root * root.transpose()
    }

    /// D⁻¹ V Σ⁺: takes coordinates in [`basis`](Factor::basis) to unknowns,
    /// unknowns × rank; its rows' norms are the standard errors per unit σ.
    pub(crate) fn right_inverse(&self) -> DMatrix<f64> {
        let n = self.unknowns();
        let mut root = self.v.columns(0, self.rank).into_owned();
        for i in 0..self.rank {
            root.column_mut(i).scale_mut(1.0 / self.values[i]);
        }
        for j in 0..n {
            root.row_mut(j).scale_mut(1.0 / self.scale[j]);
        }
        root
    }

    /// Least-squares solution of Ψ H = Δ, Eq. (13), minimum norm in scaled
    /// unknowns where Ψ loses rank.
    ///
    /// # Panics
    /// If `delta` does not have one entry per row of Ψ.
    pub fn solve(&self, delta: &DVector<f64>) -> DVector<f64> {
        let mut padded = delta.clone();
        if padded.len() < self.q.nrows() {
            padded = padded.resize_vertically(self.q.nrows(), 0.0);
        }
        let projected = self.u.tr_mul(&self.q.tr_mul(&padded));
        self.right_inverse() * projected.rows(0, self.rank)
    }

    /// Orthonormal basis of the columns of Ψ, rows × rank.
    pub fn basis(&self, rows: usize) -> DMatrix<f64> {
        let full = &self.q * self.u.columns(0, self.rank);
        full.rows(0, rows.min(full.nrows())).into_owned()
    }

    /// What Ψ sees of the unknowns, rank × n: each row c is a combination c·H
    /// that a displacement pattern of unit size determines alone; the
    /// information about it, in units of 1/σ², is the square of its length.
    pub fn seen(&self) -> DMatrix<f64> {
        let mut seen = self.v.columns(0, self.rank).transpose();
        for i in 0..self.rank {
            seen.row_mut(i).scale_mut(self.values[i]);
        }
        scale_columns(&mut seen, self.scale.iter().copied());
        seen
    }

    /// The matrix that takes Δ to H, n × rows: Ψ⁺ in factored form, Eq. (14)
    /// without the normal equations.
    pub fn pseudo_inverse(&self, rows: usize) -> DMatrix<f64> {
        let full = self.right_inverse() * (&self.q * self.u.columns(0, self.rank)).transpose();
        full.columns(0, rows.min(full.ncols())).into_owned()
    }

    /// sqrt(tr(A (ΨᵀΨ)⁻¹ Aᵀ)) of A = `map` (rows × n): per unit σ the root mean
    /// square of ‖A δH‖, δH the error of the estimated H. `None` where an
    /// unknown is undetermined.
    pub fn mapped_error(&self, map: &DMatrix<f64>) -> Option<f64> {
        self.undetermined.is_empty().then(|| (map * self.right_inverse()).norm())
    }

    /// Standard errors per unit σ: sqrt of the diagonal of (ΨᵀΨ)⁻¹, `None` for
    /// undetermined unknowns.
    pub fn standard_errors(&self) -> Vec<Option<f64>> {
        let root = self.right_inverse();
        (0..self.unknowns()).map(|j| (!self.undetermined.contains(&j)).then(|| root.row(j).norm())).collect()
    }
}

/// The decomposition, or an error where it fails.
fn require_svd(matrix: DMatrix<f64>) -> Result<Svd> {
    svd(matrix).ok_or_else(|| Error::new(Code::Numerical, "The singular value decomposition did not converge."))
}

/// Eigenvalues (ascending) and eigenvectors of a symmetric matrix, with an
/// iteration cap; `None` when an entry is not finite or it does not converge.
pub(crate) fn symmetric_eigen(matrix: DMatrix<f64>) -> Option<(DVector<f64>, DMatrix<f64>)> {
    if matrix.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let eigen = SymmetricEigen::try_new(matrix, f64::EPSILON, MAX_ITERATIONS)?;
    let order = ascending(eigen.eigenvalues.as_slice());
    let values = DVector::from_iterator(order.len(), order.iter().map(|i| eigen.eigenvalues[*i]));
    Some((values, eigen.eigenvectors.select_columns(&order)))
}
