//! What postures leave unknown of the deflections that are to be predicted.
//!
//! Rows of the readings X = \[H U\] and of the targets T = \[T_h T_u\], whitened, with
//! fixed effects h of which nothing is known and random effects u ~ N(0, I). The
//! covariance of the readings given h is V = I + U Uᵀ, and with C = U T_uᵀ,
//! D = T_h − CᵀV⁻¹H the mean square error of the best prediction is
//!
//! F = ‖T_u‖² − tr(CᵀV⁻¹C) + tr(D (HᵀV⁻¹H)⁻¹ Dᵀ)
//!
//! (universal kriging: Goldberger, Journal of the American Statistical Association 57,
//! 1962, 369–375, doi:10.1080/01621459.1962.10480665). It equals tr(T A⁻¹Tᵀ) with
//! A = XᵀX + diag(0, I), the matrix of the mixed-model equations.

use crate::numerics::information::{Factor, symmetric_eigen};
use nalgebra::linalg::Cholesky;
use nalgebra::{DMatrix, DMatrixView, Dyn};
use std::ops::Range;

/// Rows with their fixed effects first.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    /// Rows × (fixed + random).
    pub(crate) all: DMatrix<f64>,
    /// Number of fixed effects.
    pub(crate) fixed: usize,
}

impl Rows {
    fn h(&self) -> DMatrixView<'_, f64> {
        self.all.columns(0, self.fixed)
    }

    /// The same where random effects but the `last` are `factor` times as large.
    pub(super) fn times(&self, factor: f64, last: usize) -> Self {
        let mut out = self.clone();
        let random = out.all.ncols() - out.fixed - last;
        out.all.columns_mut(out.fixed, random).scale_mut(factor);
        out
    }

    fn u(&self) -> DMatrixView<'_, f64> {
        self.all.columns(self.fixed, self.all.ncols() - self.fixed)
    }
}

/// The readings of a group, factored.
pub(crate) struct Posterior<'a> {
    rows: &'a Rows,
    covariance: Cholesky<f64, Dyn>,
    /// L⁻¹H with its decomposition.
    axes: DMatrix<f64>,
    factor: Factor,
}

impl<'a> Posterior<'a> {
    /// `None` where the readings do not determine every fixed effect.
    pub(crate) fn new(rows: &'a Rows) -> Option<Self> {
        let u = rows.u();
        let mut v = u * u.transpose();
        for i in 0..v.nrows() {
            v[(i, i)] += 1.0;
        }
        let covariance = Cholesky::new(v)?;
        let axes = covariance.l_dirty().solve_lower_triangular(&rows.h())?;
        let factor = Factor::new(&axes).ok()?;
        factor.undetermined().is_empty().then_some(Posterior { rows, covariance, axes, factor })
    }

    /// What the group leaves open of `rows`; `None` where an entry is not finite.
    pub(crate) fn open<'b>(&self, rows: &'b Rows) -> Option<RemainingCovariance<'b>> {
        let c = self.rows.u() * rows.u().transpose();
        let c = self.covariance.l_dirty().solve_lower_triangular(&c)?;
        let d = (rows.h() - c.tr_mul(&self.axes)) * self.factor.right_inverse();
        Some(RemainingCovariance { rows, c, d })
    }

    /// F: the sum over the targets of the mean square error of their prediction.
    pub(crate) fn error(&self, targets: &Rows) -> Option<f64> {
        Some(self.open(targets)?.variance())
    }

    /// F with its derivative by all entries of the rows.
    ///
    /// With B = V⁻¹(C + H Eᵀ), E = D (HᵀV⁻¹H)⁻¹: ∂F/∂U = 2B(BᵀU − T_u), ∂F/∂H = −2BE.
    pub(crate) fn error_and_gradient(&self, targets: &Rows) -> Option<(f64, DMatrix<f64>)> {
        let open = self.open(targets)?;
        let error = open.variance();
        let RemainingCovariance { c, d, .. } = open;
        let e = d * self.factor.right_inverse().transpose();
        let mut b = c + &self.axes * e.transpose();
        if !self.covariance.l_dirty().tr_solve_lower_triangular_mut(&mut b) {
            return None;
        }
        let fixed = self.rows.fixed;
        let mut out = DMatrix::zeros(self.rows.all.nrows(), self.rows.all.ncols());
        out.columns_mut(0, fixed).copy_from(&(&b * e * -2.0));
        let rest = b.tr_mul(&self.rows.u()) - targets.u();
        out.columns_mut(fixed, rest.ncols()).copy_from(&(b * rest * 2.0));
        Some((error, out))
    }
}

/// What the readings of a group leave open of further rows: their covariance is
/// U Uᵀ − cᵀc + d dᵀ.
pub(crate) struct RemainingCovariance<'b> {
    rows: &'b Rows,
    /// L⁻¹C.
    c: DMatrix<f64>,
    /// D (HᵀV⁻¹H)^(−1/2).
    d: DMatrix<f64>,
}

impl RemainingCovariance<'_> {
    /// Sum of all variances.
    pub(crate) fn variance(&self) -> f64 {
        let prior = self.rows.u().norm_squared();
        (prior - self.c.norm_squared()).max(0.0) + self.d.norm_squared()
    }
}

/// The mixed-model equations of a group, of as many rows as there are unknowns, however many readings it has.
#[derive(Debug, Clone)]
pub(crate) struct Equations {
    /// A = XᵀX + diag(0, I).
    a: DMatrix<f64>,
    fixed: usize,
}

/// Relative standard deviation of a compliance of which nothing is known, where a group leaves some open.
const NOTHING_KNOWN: f64 = 100.0;
/// What the other unknowns leave of the information about a fixed effect, below which it is not determined.
const DETERMINED_SHARE: f64 = 1e-10;

impl Equations {
    /// Of no readings at all.
    pub(crate) fn new(unknowns: usize, fixed: usize) -> Self {
        let a = DMatrix::from_fn(unknowns, unknowns, |i, j| f64::from(u8::from(i == j && i >= fixed)));
        Equations { a, fixed }
    }

    /// Adds readings.
    pub(crate) fn add(&mut self, rows: &DMatrix<f64>) {
        self.a.gemm_tr(1.0, rows, rows, 1.0);
    }

    /// A⁻¹. Where the group does not determine every fixed effect, next to nothing stands in for what is known of them.
    fn inverse(&self) -> Option<DMatrix<f64>> {
        let fixed = self.fixed;
        let random = self.a.ncols() - fixed;
        let others = Cholesky::new(self.a.view((fixed, fixed), (random, random)).into_owned())?;
        let cross = self.a.view((fixed, 0), (random, fixed));
        let seen = others.l_dirty().solve_lower_triangular(&cross)?;
        let fixed_block = self.a.view((0, 0), (fixed, fixed));
        let left = fixed_block - seen.tr_mul(&seen);
        let scale = fixed_block.diagonal().map(|d| if d > 0.0 { d.sqrt() } else { 1.0 });
        let scaled = DMatrix::from_fn(fixed, fixed, |i, j| left[(i, j)] / (scale[i] * scale[j]));
        let least = symmetric_eigen(scaled)?.0.min();
        let mut a = self.a.clone();
        if least < DETERMINED_SHARE {
            for i in 0..fixed {
                a[(i, i)] += NOTHING_KNOWN.powi(-2);
            }
        }
        Some(Cholesky::new(a)?.inverse())
    }
}

/// What is open under a group, for the question what one more posture would take from it.
#[derive(Debug, Clone)]
pub(crate) struct GroupCovariance {
    /// A⁻¹.
    inverse: DMatrix<f64>,
    /// A⁻¹Tᵀ.
    with: DMatrix<f64>,
    /// tr(T A⁻¹Tᵀ), the mean square error.
    pub(crate) error: f64,
}

impl GroupCovariance {
    /// `None` where the equations have no solution.
    pub(crate) fn new(equations: &Equations, targets: &Rows) -> Option<Self> {
        let inverse = equations.inverse()?;
        let with = &inverse * targets.all.transpose();
        let error = targets.all.transpose().dot(&with);
        Some(GroupCovariance { inverse, with, error })
    }

    /// X A⁻¹Tᵀ of readings: the squares of a row are the derivative of the error by its weight, with the other sign.
    pub(crate) fn seen(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        x * &self.with
    }

    /// What the readings `x` would take: ‖(I + X A⁻¹Xᵀ)^(−1/2) Y‖² with Y = X A⁻¹Tᵀ.
    pub(crate) fn gain(&self, x: &DMatrix<f64>) -> Option<f64> {
        GroupCovariance::taken(&(x * &self.inverse), x, x * &self.with)
    }

    /// The same of each candidate, the rows of `all` in `of`.
    pub(crate) fn gains(&self, all: &DMatrix<f64>, of: &[Range<usize>]) -> Option<Vec<f64>> {
        let (moved, seen) = (all * &self.inverse, all * &self.with);
        let gain = |rows: &Range<usize>| {
            let (start, count) = (rows.start, rows.len());
            let moved_rows = moved.rows(start, count).into_owned();
            let seen = seen.rows(start, count).into_owned();
            GroupCovariance::taken(&moved_rows, &all.rows(start, count).into_owned(), seen)
        };
        of.iter().map(gain).collect()
    }

    /// From X A⁻¹, X and Y.
    fn taken(moved: &DMatrix<f64>, x: &DMatrix<f64>, mut seen: DMatrix<f64>) -> Option<f64> {
        let covariance = moved * x.transpose() + DMatrix::identity(x.nrows(), x.nrows());
        let solved = Cholesky::new(covariance)?.l_dirty().solve_lower_triangular_mut(&mut seen);
        solved.then(|| seen.norm_squared())
    }

    /// The gain with its derivative by x: with M = (I + X A⁻¹Xᵀ)⁻¹ it is 2 M Y (A⁻¹Tᵀ)ᵀ − 2 M Y YᵀM X A⁻¹.
    pub(crate) fn gain_and_gradient(&self, x: &DMatrix<f64>) -> Option<(f64, DMatrix<f64>)> {
        let (moved, seen) = (x * &self.inverse, x * &self.with);
        let covariance = &moved * x.transpose() + DMatrix::identity(x.nrows(), x.nrows());
        let solved = Cholesky::new(covariance)?.solve(&seen);
        let mut by = &solved * self.with.transpose();
        by -= (&solved * solved.transpose()) * moved;
        Some((solved.dot(&seen), by * 2.0))
    }
}
