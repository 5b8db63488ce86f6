//! What leaving a displacement or a measuring point out does to a fit.

use crate::error::Result;
use crate::estimate::diagnose::tails::f_tail;
use crate::estimate::identify::{Fit, Whitened};
use crate::estimate::mixed::ResidualMaker;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// A displacement with less than this share of its information left over is
/// fitted exactly and cannot be judged.
const FITTED_EXACTLY_SHARE: f64 = 1e-9;

/// One displacement against all others.
pub(super) struct DeletionResidual {
    /// Measured minus predicted \[m\].
    pub(super) deviation: Vector3<f64>,
    /// Its standard errors \[m\].
    pub(super) error: Vector3<f64>,
    /// Probability of a deviation as large.
    pub(super) p_value: f64,
}

/// What each part of the data does to the fit.
pub(super) struct Deletions {
    /// Each displacement; `None` for one that the fit meets exactly whatever it is.
    pub(super) displacements: Vec<Option<DeletionResidual>>,
    /// Probability of each measuring point's residuals by the fit to the others.
    pub(super) points: Vec<Option<f64>>,
}

impl Deletions {
    /// Every displacement and every point against the prediction from all other
    /// data, with the ratio of the two variances that all data have.
    ///
    /// With P = V⁻¹ − V⁻¹Ψ(ΨᵀV⁻¹Ψ)⁻¹ΨᵀV⁻¹, V with the random effects where there are any, and q = P Δ, leaving the rows
    /// S out takes q_Sᵀ P_SS⁻¹ q_S off the squares (Cook & Weisberg 1982, ch. 2.2 for V = I).
    pub(super) fn of(fit: &Fit, all: &ResidualMaker) -> Result<Self> {
        let system = fit.system();
        let ResidualMaker { basis, residual, size, free, gamma } = all;
        let (size, free, gamma) = (*size, *free, *gamma);
        let rows = system.delta.len();
        let whitened = fit.prepared().whitened();
        let mut displacements = Vec::with_capacity(rows / 3);
        let of_tool = fit.cell().setup.tool.point_count();
        let mut points = vec![PointDeletion::new(basis.ncols()); of_tool];
        for (b, block) in system.blocks.iter().enumerate() {
            fit.control().check()?;
            let (from, count) = (block.rows.start, block.rows.len());
            // Rows of V^(−1/2) of the readings for this block: P = Wᵀ(I − BBᵀ)W, q = P Δ.
            let w = root_inverse(whitened, b, count, gamma);
            let seen = w.tr_mul(&basis.rows(from, count));
            let q = w.tr_mul(&residual.rows(from, count));
            let mut at: Vec<Vec<usize>> = vec![Vec::new(); of_tool];
            for i in 0..count / 3 {
                let label = &system.labels[from / 3 + i];
                at[fit.experiment().behind(label).1].extend(3 * i..3 * i + 3);
                let seen = seen.fixed_rows::<3>(3 * i);
                let whole = w.columns(3 * i, 3);
                let full: Matrix3<f64> = whole.tr_mul(&whole).fixed_view::<3, 3>(0, 0).into_owned();
                let projection = full - seen * seen.transpose();
                let q: Vector3<f64> = q.fixed_rows::<3>(3 * i).into_owned();
                let judged = free > 3 && projection.symmetric_eigenvalues().min() > FITTED_EXACTLY_SHARE * full.trace();
                let inverse = projection.try_inverse().filter(|_| judged);
                displacements.push(inverse.and_then(|inverse| {
                    let deviation = inverse * q;
                    let explained = q.dot(&deviation);
                    let left = (size - explained).max(f64::EPSILON * size);
                    let variance = left / (free - 3) as f64;
                    Some(DeletionResidual {
                        deviation,
                        error: inverse.diagonal().map(|v| (v * variance).max(0.0).sqrt()),
                        p_value: f_tail(explained / 3.0 / variance, 3, free - 3)?,
                    })
                }));
            }
            for (point, at) in points.iter_mut().zip(&at) {
                point.add(&w.select_columns(at), &seen.select_rows(at), &q.select_rows(at));
            }
        }
        let points = points.iter().map(|point| point.p_value(size, free));
        Ok(Deletions { displacements, points: points.collect() })
    }
}

/// What leaving a measuring point out takes off the squares. Its P_SS is D − KKᵀ
/// with D posture by posture, so that
/// P_SS⁻¹ = D⁻¹ + D⁻¹K (I − KᵀD⁻¹K)⁻¹ KᵀD⁻¹.
#[derive(Clone)]
struct PointDeletion {
    /// Rows.
    rows: usize,
    /// KᵀD⁻¹K.
    seen: DMatrix<f64>,
    /// KᵀD⁻¹q.
    moved: DVector<f64>,
    /// qᵀD⁻¹q.
    size: f64,
    /// True where D has no inverse.
    singular: bool,
}

impl PointDeletion {
    fn new(rank: usize) -> Self {
        PointDeletion {
            rows: 0,
            seen: DMatrix::zeros(rank, rank),
            moved: DVector::zeros(rank),
            size: 0.0,
            singular: false,
        }
    }

    /// Adds a posture: the point's columns of V^(−1/2), its rows of K and of q.
    fn add(&mut self, w: &DMatrix<f64>, k: &DMatrix<f64>, q: &DVector<f64>) {
        if q.is_empty() {
            return;
        }
        self.rows += q.len();
        let Some(d) = w.tr_mul(w).cholesky() else {
            self.singular = true;
            return;
        };
        let l = d.l();
        let solved = (l.solve_lower_triangular(k), l.solve_lower_triangular(q));
        let (Some(k), Some(q)) = solved else {
            self.singular = true;
            return;
        };
        self.seen += k.tr_mul(&k);
        self.moved += k.tr_mul(&q);
        self.size += q.norm_squared();
    }

    /// Probability of residuals as large; `size` are the squares that the fit to all
    /// leaves, on `free` degrees of freedom. `None` where the others do not determine
    /// as many unknowns.
    fn p_value(&self, size: f64, free: usize) -> Option<f64> {
        let rank = self.moved.len();
        let left_over = DMatrix::identity(rank, rank) - &self.seen;
        if self.singular || self.rows == 0 || free <= self.rows {
            return None;
        }
        if rank > 0 && left_over.symmetric_eigenvalues().min() <= FITTED_EXACTLY_SHARE {
            return None;
        }
        let more = left_over.cholesky()?.solve(&self.moved);
        let explained = self.size + self.moved.dot(&more);
        let left = (size - explained).max(f64::EPSILON * size);
        let free = free - self.rows;
        f_tail(explained / self.rows as f64 / (left / free as f64), self.rows, free)
    }
}

/// What makes the rows of one block independent, as a matrix.
fn root_inverse(whitened: &Whitened, block: usize, count: usize, gamma: f64) -> DMatrix<f64> {
    let mut out = DMatrix::identity(count, count);
    whitened.whiten_block(block, &mut out);
    let (directions, sizes) = whitened.directions(block);
    let mut shared = directions.tr_mul(&out);
    for (k, size) in sizes.iter().enumerate() {
        let part = 1.0 - 1.0 / (1.0 + gamma * size).sqrt();
        shared.row_mut(k).scale_mut(part);
    }
    out - directions * shared
}
