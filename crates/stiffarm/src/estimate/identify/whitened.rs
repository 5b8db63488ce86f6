//! A system whose rows have been made independent and equally exact, with the
//! directions in which a posture's rows share shifts.

use super::covariance::Roots;
use super::system::{Block, MeasuredSystem};
use crate::error::{Code, Error, Result};
use crate::numerics::information::{Factor, tall_svd};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;
use std::sync::Arc;

/// What whitening the rows of one posture takes: the shifts act along
/// orthonormal directions.
#[derive(Debug)]
pub(super) struct Whitening {
    /// rows × k, orthonormal columns.
    directions: DMatrix<f64>,
    /// Squared size s² of a unit shift along each direction.
    sizes: DVector<f64>,
    /// What makes the rows independent but for shifts.
    roots: Roots,
    /// γs²/(1 + γs²) and ln(1 + γs²) of each direction at each γ of the grid: the
    /// same for every fit that has the posture.
    grid: Vec<Vec<[f64; 2]>>,
}

/// Sizes of γ at which the likelihood is looked at first: e^x for these x.
pub(super) const GRID: Range<i32> = -6..12;
/// Step of x.
pub(super) const STEP: f64 = 2.0;

/// x of point `i` of the grid.
pub(super) fn grid_place(i: usize) -> f64 {
    STEP * (f64::from(GRID.start) + i as f64)
}

/// γs²/(1 + γs²) and ln(1 + γs²).
pub(super) fn share(gamma: f64, size: f64) -> [f64; 2] {
    [gamma * size / (1.0 + gamma * size), (gamma * size).ln_1p()]
}

impl Whitening {
    /// Squared size s² of a unit shift along direction `k`.
    pub(super) fn size(&self, k: usize) -> f64 {
        self.sizes[k]
    }

    /// [`share`] of direction `k` at point `i` of the grid.
    pub(super) fn on_grid(&self, i: usize, k: usize) -> [f64; 2] {
        self.grid[i][k]
    }

    /// # Errors
    /// A covariance that is not positive definite or not finite.
    fn new(block: &Block) -> Result<Self> {
        let mut shared = block.shared.clone();
        let roots = block.covariance.roots().ok_or_else(not_positive)?;
        if !roots.whiten(&mut shared) {
            return Err(not_positive());
        }
        let (count, columns) = (block.rows.len(), shared.ncols());
        if count < columns {
            // Zero rows let the decomposition see all columns.
            shared = shared.resize_vertically(columns, 0.0);
        }
        let parts =
            tall_svd(shared).ok_or_else(|| Error::new(Code::NotFinite, "A covariance is not a finite number."))?;
        let rank = parts.values.iter().filter(|v| **v > 0.0).count();
        let sizes = parts.values.rows(0, rank).map(|v| v * v);
        let at = |i: usize| sizes.iter().map(move |s| share(grid_place(i).exp(), *s));
        Ok(Whitening {
            directions: parts.u.view((0, 0), (count, rank)).into_owned(),
            grid: (0..GRID.len()).map(|i| at(i).collect()).collect(),
            sizes,
            roots,
        })
    }
}

fn not_positive() -> Error {
    let message = "The covariance of a posture's readings is not positive definite.";
    Error::invalid(message)
}

/// Whitened rows of one posture.
#[derive(Debug, Clone)]
struct WhitenedBlock {
    rows: Range<usize>,
    by: Arc<Whitening>,
}

/// A whitened system: without shifts its rows have covariance σ²I, with shifts
/// of variance γσ² they have σ²(I + γ Σ s² u uᵀ).
#[derive(Debug, Clone)]
pub struct Whitened {
    psi: DMatrix<f64>,
    blocks: Vec<WhitenedBlock>,
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
            let (from, count) = (block.rows.start, block.rows.len());
            if !by.roots.is_identity() {
                let mut rows = psi.rows(from, count).into_owned();
                if !by.roots.whiten(&mut rows) {
                    return Err(not_positive());
                }
                psi.rows_mut(from, count).copy_from(&rows);
            }
            blocks.push(WhitenedBlock { rows: block.rows.clone(), by: Arc::new(by) });
        }
        Whitened::of(psi, blocks)
    }

    /// Rows that are white already.
    fn of(psi: DMatrix<f64>, blocks: Vec<WhitenedBlock>) -> Result<Self> {
        let factor = Factor::new(&psi)?;
        let basis = factor.basis(psi.nrows());
        let seen = blocks.iter().map(|b| basis.rows(b.rows.start, b.rows.len()).tr_mul(&b.by.directions)).collect();
        // Where every row is a shift of its own, shifts and noise are one thing.
        let separable = blocks.iter().any(|b| b.by.directions.ncols() < b.rows.len());
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
            psi.rows_mut(at, count).copy_from(&self.psi.rows(from, count));
            delta.rows_mut(at, count).copy_from(&white.rows(from, count));
            blocks.push(WhitenedBlock { rows: at..at + count, by: block.by.clone() });
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
        for (b, block) in self.blocks.iter().enumerate() {
            if !block.by.roots.is_identity() {
                let mut rows = out.rows_mut(block.rows.start, block.rows.len());
                let mut white = DMatrix::from_column_slice(rows.len(), 1, rows.as_slice());
                self.whiten_block(b, &mut white);
                rows.copy_from(&white.column(0));
            }
        }
        out
    }

    /// Whitens rows of posture `block`, in place.
    pub(crate) fn whiten_block(&self, block: usize, rows: &mut DMatrix<f64>) {
        self.blocks[block].by.roots.whiten(rows);
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
                parts.row_mut(k).scale_mut(1.0 - 1.0 / (1.0 + gamma * size).sqrt());
            }
            let mut rows = out.rows_mut(from, count);
            rows -= &block.by.directions * parts;
        }
        out
    }

    /// White displacements with shifts of variance `gamma`·σ² made independent as well.
    pub(crate) fn delta_with_shifts(&self, white: &DVector<f64>, gamma: f64) -> DVector<f64> {
        let column = DMatrix::from_columns(std::slice::from_ref(white));
        self.with_shifts(&column, gamma).column(0).into_owned()
    }

    /// Number of postures.
    pub(crate) fn block_count(&self) -> usize {
        self.blocks.len()
    }

    /// Rows of posture `block`.
    pub(crate) fn block_rows(&self, block: usize) -> Range<usize> {
        self.blocks[block].rows.clone()
    }

    /// How posture `block` was whitened, and basisᵀ·U of it, rank × k.
    pub(super) fn seen(&self, block: usize) -> (&Whitening, &DMatrix<f64>) {
        (&self.blocks[block].by, &self.seen[block])
    }

    /// Orthonormal basis of the columns of the whitened Ψ, rows × rank.
    pub(super) fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }
}
