//! The convex criteria and the inequality that turns any positive definite
//! matrix into a bound on every design.

use crate::error::{Code, Error, Result};
use crate::numerics::information::symmetric_eigen;
use nalgebra::DMatrix;
use nalgebra::linalg::Cholesky;

/// Eigenvalues of Q below this share of the largest count as zero.
const ZERO_SHARE: f64 = 1e-10;

/// A criterion φ of an n × n information matrix M that is to be small, convex
/// and homogeneous of degree −1: φ(N·M) = φ(M)/N.
#[derive(Debug, Clone, PartialEq)]
pub enum Criterion {
    /// φ(M) = det(M)^(−1/n): D-optimality.
    Determinant,
    /// φ(M) = tr(Q M⁻¹) with a symmetric positive semidefinite Q, n × n:
    /// A-optimality (Q = I), I-optimality (Q the moments of a task),
    /// c-optimality (Q = c cᵀ).
    Trace(DMatrix<f64>),
}

/// A [`Criterion`] made ready for n unknowns.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// R with RᵀR = Q, rank × n; `None` for the determinant.
    pub(super) root: Option<DMatrix<f64>>,
    /// True when Q is singular, so that the optimal M may be singular too.
    pub(super) singular: bool,
    unknowns: usize,
}

/// A criterion at one M₀, with what bounds it everywhere else.
///
/// With X = M₀⁻¹, A = X Q X and t = tr(A M₀) = tr(Q X), the Cauchy–Schwarz
/// inequality gives tr(Q M⁻¹) · tr(A M) ≥ t² for every M; with A = X and t = n,
/// the inequality of the means gives n det(X M)^(1/n) ≤ tr(A M). Both say
/// φ(M) ≥ φ(M₀) · t/tr(A M).
#[derive(Debug, Clone)]
pub struct Tangent {
    /// φ(M₀).
    pub value: f64,
    /// t = tr(A M₀).
    pub level: f64,
    /// A, n × n, symmetric positive semidefinite.
    pub adjoint: DMatrix<f64>,
    /// L⁻¹ with M₀ = L Lᵀ.
    pub(super) whitening: DMatrix<f64>,
}

impl Criterion {
    /// Checks the criterion and factors Q.
    pub fn prepare(&self, unknowns: usize) -> Result<Prepared> {
        let Criterion::Trace(q) = self else {
            return Ok(Prepared { root: None, singular: false, unknowns });
        };
        if q.shape() != (unknowns, unknowns) {
            return Err(Error::new(
                Code::Dimension,
                format!("The criterion's matrix is {} × {} for {unknowns} unknowns.", q.nrows(), q.ncols()),
            ));
        }
        if q.iter().any(|v| !v.is_finite()) {
            return Err(Error::new(Code::NotFinite, "The criterion's matrix has an entry that is not finite."));
        }
        if (q - q.transpose()).amax() > ZERO_SHARE * q.amax() {
            return Err(Error::invalid("The criterion's matrix is not symmetric.".to_string()));
        }
        let symmetric = (q + q.transpose()) * 0.5;
        let (values, vectors) = symmetric_eigen(symmetric).ok_or_else(|| {
            Error::new(Code::Numerical, "The eigenvalues of the criterion's matrix did not converge.")
        })?;
        let largest = values.amax();
        let zero = ZERO_SHARE * largest;
        if values.iter().any(|v| *v < -zero) || largest <= 0.0 {
            return Err(Error::invalid(
                "The criterion's matrix must be positive semidefinite and not zero.".to_string(),
            ));
        }
        let positive: Vec<usize> = (0..unknowns).filter(|&i| values[i] > zero).collect();
        let root =
            DMatrix::from_fn(positive.len(), unknowns, |i, j| values[positive[i]].sqrt() * vectors[(j, positive[i])]);
        Ok(Prepared { singular: positive.len() < unknowns, root: Some(root), unknowns })
    }
}

impl Prepared {
    /// The criterion at M₀; `None` where M₀ is not positive definite.
    pub fn at(&self, information: &DMatrix<f64>) -> Option<Tangent> {
        let n = self.unknowns;
        let lower = Cholesky::new(information.clone())?.unpack();
        let whitening = lower.solve_lower_triangular(&DMatrix::identity(n, n))?;
        let (value, level, adjoint) = match &self.root {
            None => {
                let log_det: f64 = whitening.diagonal().iter().map(|v| v.ln()).sum();
                let value = (2.0 * log_det / n as f64).exp();
                (value, n as f64, whitening.tr_mul(&whitening))
            }
            Some(root) => {
                // R X = (R L⁻ᵀ) L⁻¹; A = (R X)ᵀ(R X) is consistent with t to
                // rounding, so that the inequality holds however M₀ is conditioned.
                let half = root * whitening.transpose();
                let value = half.norm_squared();
                let full = half * &whitening;
                (value, value, full.tr_mul(&full))
            }
        };
        let finite = value.is_finite() && adjoint.iter().all(|v| v.is_finite());
        finite.then_some(Tangent { value, level, adjoint, whitening })
    }
}

/// tr(A G) of two symmetric matrices.
pub(super) fn trace_of_product(a: &DMatrix<f64>, g: &DMatrix<f64>) -> f64 {
    a.iter().zip(g.iter()).map(|(a, g)| a * g).sum()
}
