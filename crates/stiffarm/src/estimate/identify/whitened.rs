//! A system whose rows have been made independent and equally exact, with the
//! directions in which a posture's rows share shifts.

use super::system::{Block, MeasuredSystem};
use crate::error::{Code, Error, Result};
use crate::numerics::information::{Factor, svd};
use crate::numerics::scalar::minimum;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;
use std::sync::Arc;

/// What whitening the rows of one posture takes: the shifts act along
/// orthonormal directions.
#[derive(Debug)]
struct Whitening {
    /// rows × k, orthonormal columns.
    directions: DMatrix<f64>,
    /// Squared size s² of a unit shift along each direction.
    sizes: DVector<f64>,
    /// Lower Cholesky factor of the rows' covariance, where it is not the identity.
    root: Option<DMatrix<f64>>,
    /// γs²/(1 + γs²) and ln(1 + γs²) of each direction at each γ of the grid: the
    /// same for every fit that has the posture.
    grid: Vec<Vec<[f64; 2]>>,
}

/// Sizes of γ at which the likelihood is looked at first: e^x for these x.
const GRID: std::ops::Range<i32> = -6..12;
/// Step of x.
const STEP: f64 = 2.0;

/// x of point `i` of the grid.
fn grid_place(i: usize) -> f64 {
    STEP * (f64::from(GRID.start) + i as f64)
}

/// γs²/(1 + γs²) and ln(1 + γs²).
fn share(gamma: f64, size: f64) -> [f64; 2] {
    [gamma * size / (1.0 + gamma * size), (gamma * size).ln_1p()]
}

impl Whitening {
    /// # Errors
    /// A covariance that is not positive definite or not finite.
    fn new(block: &Block) -> Result<Self> {
        let mut shared = block.shared.clone();
        let root = match &block.covariance {
            None => None,
            Some(covariance) => {
                let root = covariance.clone().cholesky().ok_or_else(not_positive)?;
                let root = root.unpack();
                if !root.solve_lower_triangular_mut(&mut shared) {
                    return Err(not_positive());
                }
                Some(root)
            }
        };
        let (count, columns) = (block.rows.len(), shared.ncols());
        if count < columns {
            // Zero rows let the decomposition see all columns.
            shared = shared.resize_vertically(columns, 0.0);
        }
        let parts = svd(shared)
            .ok_or_else(|| Error::new(Code::NotFinite, "A covariance is not a finite number."))?;
        let rank = parts.values.iter().filter(|v| **v > 0.0).count();
        let sizes = parts.values.rows(0, rank).map(|v| v * v);
        let at = |i: usize| sizes.iter().map(move |s| share(grid_place(i).exp(), *s));
        Ok(Whitening {
            directions: parts.u.view((0, 0), (count, rank)).into_owned(),
            grid: (0..GRID.len()).map(|i| at(i).collect()).collect(),
            sizes,
            root,
        })
    }
}

fn not_positive() -> Error {
    let message = "The covariance of a posture's readings is not positive definite.";
    Error::new(Code::InvalidValue, message)
}

/// Whitened rows of one posture.
#[derive(Debug, Clone)]
struct Shared {
    rows: Range<usize>,
    by: Arc<Whitening>,
}

/// A whitened system: without shifts its rows have covariance σ²I, with shifts
/// of variance γσ² they have σ²(I + γ Σ s² u uᵀ).
#[derive(Debug, Clone)]
pub struct Whitened {
    psi: DMatrix<f64>,
    blocks: Vec<Shared>,
    /// Factor of the whitened Ψ without shifts.
    factor: Factor,
    /// Orthonormal basis of its columns, rows × rank.
    basis: DMatrix<f64>,
    /// basisᵀ·U of each posture, rank × k.
    seen: Vec<DMatrix<f64>>,
    shifts: usize,
    separable: bool,
}

impl Whitened {
    /// Whitens a system by the covariance of its rows.
    ///
    /// # Errors
    /// A covariance that is not positive definite, or as [`Factor::new`].
    pub fn new(system: &MeasuredSystem) -> Result<Self> {
        let mut psi = system.psi.clone();
        let mut blocks = Vec::with_capacity(system.blocks.len());
        for block in &system.blocks {
            let by = Whitening::new(block)?;
            if let Some(root) = &by.root
                && !root.solve_lower_triangular_mut(
                    &mut psi.rows_mut(block.rows.start, block.rows.len()),
                )
            {
                return Err(not_positive());
            }
            blocks.push(Shared {
                rows: block.rows.clone(),
                by: Arc::new(by),
            });
        }
        Whitened::of(psi, blocks)
    }

    /// Rows that are white already.
    fn of(psi: DMatrix<f64>, blocks: Vec<Shared>) -> Result<Self> {
        let factor = Factor::new(&psi)?;
        let basis = factor.basis(psi.nrows());
        let seen = blocks
            .iter()
            .map(|b| {
                basis
                    .rows(b.rows.start, b.rows.len())
                    .tr_mul(&b.by.directions)
            })
            .collect();
        // Where every row is a shift of its own, shifts and noise are one thing.
        let separable = blocks
            .iter()
            .any(|b| b.by.directions.ncols() < b.rows.len());
        Ok(Whitened {
            shifts: blocks.iter().map(|b| b.by.directions.ncols()).sum(),
            psi,
            blocks,
            factor,
            basis,
            seen,
            separable,
        })
    }

    /// The postures `chosen` (indices of blocks, repeats allowed), and their rows
    /// of the white displacements `white`. Rows of one posture are whitened by
    /// themselves, so that nothing has to be whitened again.
    ///
    /// # Errors
    /// As [`Factor::new`].
    pub fn select(&self, chosen: &[usize], white: &DVector<f64>) -> Result<(Self, DVector<f64>)> {
        let count = chosen.iter().map(|b| self.blocks[*b].rows.len()).sum();
        let mut psi = DMatrix::zeros(count, self.psi.ncols());
        let mut delta = DVector::zeros(count);
        let mut blocks = Vec::with_capacity(chosen.len());
        let mut at = 0;
        for &b in chosen {
            let block = &self.blocks[b];
            let (from, count) = (block.rows.start, block.rows.len());
            psi.rows_mut(at, count)
                .copy_from(&self.psi.rows(from, count));
            delta
                .rows_mut(at, count)
                .copy_from(&white.rows(from, count));
            blocks.push(Shared {
                rows: at..at + count,
                by: block.by.clone(),
            });
            at += count;
        }
        Ok((Whitened::of(psi, blocks)?, delta))
    }

    /// The same rows with one further column, not yet white.
    ///
    /// # Errors
    /// As [`Factor::new`].
    pub fn extended(&self, column: &DVector<f64>) -> Result<Self> {
        let at = self.psi.ncols();
        let mut psi = self.psi.clone().insert_column(at, 0.0);
        psi.set_column(at, &self.whiten(column));
        Whitened::of(psi, self.blocks.clone())
    }

    /// The same rows without column `j`; a column of zeros stands for no columns.
    ///
    /// # Errors
    /// As [`Factor::new`].
    pub fn without_column(&self, j: usize) -> Result<Self> {
        let psi = match self.psi.ncols() {
            1 => DMatrix::zeros(self.psi.nrows(), 1),
            _ => self.psi.clone().remove_column(j),
        };
        Whitened::of(psi, self.blocks.clone())
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.psi.nrows()
    }

    /// Whitened Ψ.
    pub fn psi(&self) -> &DMatrix<f64> {
        &self.psi
    }

    /// Factor of the whitened Ψ without shifts.
    pub fn factor(&self) -> &Factor {
        &self.factor
    }

    /// Number of shifts, three for each posture and direction of load.
    pub fn shifts(&self) -> usize {
        self.shifts
    }

    /// True where the data can tell shifts from noise.
    pub fn is_separable(&self) -> bool {
        self.separable
    }

    /// Whitens displacements like the rows of Ψ.
    pub fn whiten(&self, delta: &DVector<f64>) -> DVector<f64> {
        let mut out = delta.clone();
        for block in &self.blocks {
            if let Some(root) = &block.by.root {
                let mut rows = out.rows_mut(block.rows.start, block.rows.len());
                root.solve_lower_triangular_mut(&mut rows);
            }
        }
        out
    }

    /// Orthonormal directions of the whitened rows of block `block` in which
    /// its shifts act, rows × k, and the squared size of a unit shift along each.
    pub(crate) fn directions(&self, block: usize) -> (&DMatrix<f64>, &DVector<f64>) {
        let by = &self.blocks[block].by;
        (&by.directions, &by.sizes)
    }

    /// What least squares without shifts leaves of whitened displacements.
    pub fn residual(&self, whitened: &DVector<f64>) -> DVector<f64> {
        whitened - &self.basis * self.basis.tr_mul(whitened)
    }

    /// Rows with shifts of variance `gamma`·σ² made independent as well.
    pub fn with_shifts(&self, rows: &DMatrix<f64>, gamma: f64) -> DMatrix<f64> {
        let mut out = rows.clone();
        if gamma <= 0.0 {
            return out;
        }
        for block in &self.blocks {
            let (from, count) = (block.rows.start, block.rows.len());
            let mut parts = block.by.directions.tr_mul(&rows.rows(from, count));
            for (k, size) in block.by.sizes.iter().enumerate() {
                parts
                    .row_mut(k)
                    .scale_mut(1.0 - 1.0 / (1.0 + gamma * size).sqrt());
            }
            let mut rows = out.rows_mut(from, count);
            rows -= &block.by.directions * parts;
        }
        out
    }

    /// The ratio γ = τ²/σ² that maximises the restricted likelihood (REML:
    /// Patterson & Thompson, Biometrika 58, 1971, 545–554,
    /// doi:10.1093/biomet/58.3.545); zero where it cannot be told.
    pub fn variance_ratio(&self, whitened: &DVector<f64>) -> f64 {
        let rank = self.factor.rank();
        if !self.separable || self.rows() <= rank {
            return 0.0;
        }
        let criterion = self.restricted(whitened);
        let Some(criterion) = criterion else {
            return 0.0;
        };
        criterion.best_ratio().0
    }

    /// −2 ln of the profiled restricted likelihood as a function of γ; `None`
    /// where the residuals are rounding.
    pub fn restricted(&self, whitened: &DVector<f64>) -> Option<Restricted<'_>> {
        let residual = self.residual(whitened);
        let size = residual.norm_squared();
        let rounding = (64.0 * f64::EPSILON).powi(2) * whitened.norm_squared();
        if size <= rounding || !size.is_finite() {
            return None;
        }
        let moved = self
            .blocks
            .iter()
            .map(|b| {
                b.by.directions
                    .tr_mul(&residual.rows(b.rows.start, b.rows.len()))
            })
            .collect();
        Some(Restricted {
            system: self,
            size,
            moved,
        })
    }
}

/// The restricted likelihood of one set of displacements.
#[derive(Debug)]
pub struct Restricted<'a> {
    system: &'a Whitened,
    /// eᵀe of the residual e without shifts.
    size: f64,
    /// Uᵀe of each posture.
    moved: Vec<DVector<f64>>,
}

impl Restricted<'_> {
    /// −2 ln L at γ, up to a constant, σ² profiled out.
    pub fn value(&self, gamma: f64) -> f64 {
        self.value_by(|by, k| share(gamma, by.sizes[k]))
    }

    /// [`value`](Restricted::value) at point `i` of the grid.
    fn value_on_grid(&self, i: usize) -> f64 {
        self.value_by(|by, k| by.grid[i][k])
    }

    fn value_by(&self, share: impl Fn(&Whitening, usize) -> [f64; 2]) -> f64 {
        let rank = self.system.factor.rank();
        let mut information = DMatrix::zeros(rank, rank);
        let mut moment = DVector::zeros(rank);
        let sums = (information.as_mut_slice(), moment.as_mut_slice());
        // Loops of known length are faster: the joints of an arm, and one term more.
        let [size, logarithms] = match rank {
            6 => self.sums(6, sums, share),
            7 => self.sums(7, sums, share),
            _ => self.sums(rank, sums, share),
        };
        for j in 0..rank {
            information[(j, j)] += 1.0;
        }
        let Some(cholesky) = information.cholesky() else {
            return f64::INFINITY;
        };
        let root = cholesky.l_dirty();
        let determinant: f64 = (0..rank).map(|i| 2.0 * root[(i, i)].ln()).sum();
        let rest = size - moment.dot(&cholesky.solve(&moment));
        let free = (self.system.rows() - rank) as f64;
        if rest <= 0.0 {
            return f64::INFINITY;
        }
        free * rest.ln() + logarithms + determinant
    }

    /// Adds up XᵀV⁻¹X − I and XᵀV⁻¹e in the orthonormal basis of `rank` columns,
    /// where Xᵀe = 0; returns eᵀV⁻¹e and the logarithms of the shifts.
    #[inline(always)]
    fn sums(
        &self,
        rank: usize,
        (information, moment): (&mut [f64], &mut [f64]),
        share: impl Fn(&Whitening, usize) -> [f64; 2],
    ) -> [f64; 2] {
        let (information, moment) = (&mut information[..rank * rank], &mut moment[..rank]);
        let mut size = self.size;
        let mut logarithms = 0.0;
        let seen = self.system.seen.iter();
        for ((block, seen), moved) in self.system.blocks.iter().zip(seen).zip(&self.moved) {
            for (k, moved) in moved.iter().enumerate() {
                let [part, logarithm] = share(&block.by, k);
                let row = &seen.as_slice()[k * rank..(k + 1) * rank];
                size -= part * moved * moved;
                logarithms += logarithm;
                for j in 0..rank {
                    moment[j] -= part * row[j] * moved;
                    let scale = part * row[j];
                    for i in 0..rank {
                        information[j * rank + i] -= scale * row[i];
                    }
                }
            }
        }
        [size, logarithms]
    }

    /// The γ ≥ 0 with the smallest value, and that value: a grid over all sizes,
    /// then Brent's method about its best point.
    pub(super) fn best_ratio(&self) -> (f64, f64) {
        const TOLERANCE: f64 = 1e-8;
        let none = (0.0, self.value(0.0));
        let best = (0..GRID.len())
            .map(|i| (grid_place(i), self.value_on_grid(i)))
            .reduce(|best, next| if next.1 < best.1 { next } else { best });
        let Some(best) = best.filter(|best| best.1.is_finite()) else {
            return none;
        };
        let ends = [best.0 - STEP, best.0 + STEP];
        let (place, value) = minimum(|x| self.value(x.exp()), ends, best, TOLERANCE);
        match value < none.1 {
            true => (place.exp(), value),
            false => none,
        }
    }
}
