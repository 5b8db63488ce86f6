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

use crate::numerics::information::Factor;
use nalgebra::linalg::Cholesky;
use nalgebra::{DMatrix, DMatrixView, Dyn};

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
        factor.undetermined().is_empty().then_some(Posterior {
            rows,
            covariance,
            axes,
            factor,
        })
    }

    /// What the group leaves open of `rows`; `None` where an entry is not finite.
    pub(crate) fn open<'b>(&self, rows: &'b Rows) -> Option<Open<'b>> {
        let c = self.rows.u() * rows.u().transpose();
        let c = self.covariance.l_dirty().solve_lower_triangular(&c)?;
        let d = (rows.h() - c.tr_mul(&self.axes)) * self.factor.right_inverse();
        Some(Open { rows, c, d })
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
        let Open { c, d, .. } = open;
        let e = d * self.factor.right_inverse().transpose();
        let mut b = c + &self.axes * e.transpose();
        if !self
            .covariance
            .l_dirty()
            .tr_solve_lower_triangular_mut(&mut b)
        {
            return None;
        }
        let fixed = self.rows.fixed;
        let mut out = DMatrix::zeros(self.rows.all.nrows(), self.rows.all.ncols());
        out.columns_mut(0, fixed).copy_from(&(&b * e * -2.0));
        let rest = b.tr_mul(&self.rows.u()) - targets.u();
        out.columns_mut(fixed, rest.ncols())
            .copy_from(&(b * rest * 2.0));
        Some((error, out))
    }

    /// What each candidate, `per` rows of `all`, would take from the mean square error of `targets`, and the error
    /// without any: with P the covariance of what its readings and the targets leave open, ‖(P_cc + I)^(−1/2) P_ct‖².
    pub(crate) fn gains(&self, all: &Rows, per: usize, targets: &Rows) -> Option<(Vec<f64>, f64)> {
        let predicted = self.open(targets)?;
        let open = self.open(all)?;
        let cross = open.covariance(&predicted);
        let gains = (0..all.all.nrows() / per).map(|c| {
            let own = open.own(per * c, per);
            let factor = Cholesky::new(own + DMatrix::identity(per, per))?;
            let mut seen = cross.rows(per * c, per).into_owned();
            factor
                .l_dirty()
                .solve_lower_triangular_mut(&mut seen)
                .then(|| seen.norm_squared())
        });
        Some((gains.collect::<Option<Vec<f64>>>()?, predicted.variance()))
    }
}

/// What the readings of a group leave open of further rows: their covariance is
/// U Uᵀ − cᵀc + d dᵀ.
pub(crate) struct Open<'b> {
    rows: &'b Rows,
    /// L⁻¹C.
    c: DMatrix<f64>,
    /// D (HᵀV⁻¹H)^(−1/2).
    d: DMatrix<f64>,
}

impl Open<'_> {
    /// Sum of all variances.
    pub(crate) fn variance(&self) -> f64 {
        let prior = self.rows.u().norm_squared();
        (prior - self.c.norm_squared()).max(0.0) + self.d.norm_squared()
    }

    /// Covariance with what is left open of other rows.
    pub(crate) fn covariance(&self, other: &Open<'_>) -> DMatrix<f64> {
        let prior = self.rows.u() * other.rows.u().transpose();
        prior - self.c.tr_mul(&other.c) + &self.d * other.d.transpose()
    }

    /// Covariance of `count` rows from `start` among themselves.
    pub(crate) fn own(&self, start: usize, count: usize) -> DMatrix<f64> {
        let all = self.rows.u();
        let u = all.rows(start, count);
        let c = self.c.columns(start, count);
        let d = self.d.rows(start, count);
        u * u.transpose() - c.tr_mul(&c) + d * d.transpose()
    }
}
