//! The stiffness with which joint axes alone best reproduce the arm of a mixed model over its cell.
//!
//! What a joint gives way about its own axis cannot be told from what links and bearings beside it do, by no posture
//! and no load. What can be told is h* = h + L u with L = (ΨᵀΨ)⁻¹ΨᵀZ over many postures of the cell, Ψ the columns of
//! the axes there and Z those of all that gives way besides: the projection of what the model predicts on the axes. It
//! is what a calculation with joint stiffnesses alone should use, and it depends on the cell and its load. A load that
//! is measured is known at the measured postures alone: these are the cell then, and with noise that is alike h* is
//! what least squares with the axes alone find.

use crate::error::Result;
use crate::estimate::compliance::Spread;
use crate::model::cell::Cell;
use crate::model::observation::{ExtraTerm, PostureTerms};
use crate::model::robot::Robot;
use crate::numerics::control::Control;
use crate::numerics::jobs::in_order_watched;
use crate::numerics::streams::spread;
use nalgebra::{DMatrix, DVector};
use std::borrow::Borrow;

/// Postures over which the arm is reproduced: other thousands move h* by up to a percent, these by half of it.
const POSTURES: usize = 4000;
/// Points of the bounds that are tried for each.
const TRIES: usize = 20;
/// With fewer postures inside the limits the bounds alone count.
const FEWEST: usize = 100;
/// Postures of one job.
const PORTION: usize = 50;

/// From what a mixed model has found to the compliance of joint axes that alone reproduce it.
#[derive(Debug, Clone)]
pub(crate) struct Reproduced {
    /// L, springs × terms; zero beside springs that the load of the cell never bends.
    projection: DMatrix<f64>,
}

impl Reproduced {
    /// Over postures of `cell` under its own load, with what `terms` give beside the axes.
    ///
    /// # Errors
    /// No postures to be looked at; interrupted.
    pub(crate) fn over_cell(cell: &Cell, terms: &[ExtraTerm], control: Control<'_>) -> Result<Self> {
        let (setups, postures) = (cell.setup.cases(), postures(cell)?);
        let each = postures.iter().flat_map(|q| setups.iter().map(move |setup| (setup, q)));
        // A rope without direction bends nothing.
        let all = each.filter_map(|(setup, q)| PostureTerms::new(setup, q, None).ok());
        Reproduced::over(&cell.setup.robot, &all.collect::<Vec<_>>(), terms, control)
    }

    /// Over the postures and loads of `all`.
    ///
    /// # Errors
    /// Interrupted.
    pub(crate) fn over<T: Borrow<PostureTerms> + Sync>(
        robot: &Robot,
        all: &[T],
        terms: &[ExtraTerm],
        control: Control<'_>,
    ) -> Result<Self> {
        let springs = robot.spring_count();
        let count = springs + terms.len();
        let portions: Vec<_> = all.chunks(PORTION).collect();
        let what = "the axes over the cell";
        let sums = in_order_watched(&portions, what, control, |(_, portion)| {
            let blocks =
                portion.iter().map(|posture_terms| posture_terms.borrow().block_with(robot, terms).transpose());
            // One product for all of them.
            let rows: Vec<f64> = blocks.flat_map(|block| Vec::from(block.data)).collect();
            let rows = DMatrix::from_vec(count, rows.len() / count, rows);
            Ok(rows.rows(0, springs) * rows.transpose())
        })?;
        let mut sum = DMatrix::zeros(springs, count);
        sums.iter().for_each(|partial| sum += partial);
        Ok(Reproduced { projection: solved(&sum, springs) })
    }

    /// h + L u of values, or of their change \[rad/(N·m)\].
    pub(crate) fn of(&self, values: &DVector<f64>) -> DVector<f64> {
        let springs = self.projection.nrows();
        let besides = values.rows(springs, values.len() - springs);
        values.rows(0, springs) + &self.projection * besides
    }

    /// Covariance of joint `j`'s compliance with all unknowns, and its variance.
    pub(crate) fn covariance(&self, spread: &Spread, j: usize) -> (DVector<f64>, f64) {
        let springs = self.projection.nrows();
        let mut row = DVector::zeros(spread.covariance.ncols());
        row[j] = 1.0;
        let besides = row.len() - springs;
        row.rows_mut(springs, besides).copy_from(&self.projection.row(j).transpose());
        let with = &spread.covariance * &row;
        let variance = row.dot(&with).max(0.0);
        (with, variance)
    }
}

/// (ΨᵀΨ)⁻¹ΨᵀZ from Ψᵀ\[Ψ Z\].
fn solved(sum: &DMatrix<f64>, springs: usize) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(springs, sum.ncols() - springs);
    let scale: Vec<f64> = (0..springs).map(|j| sum[(j, j)].sqrt()).collect();
    let most = scale.iter().copied().fold(0.0, f64::max);
    let bent: Vec<usize> = (0..springs).filter(|j| scale[*j] > 1e-9 * most).collect();
    let count = bent.len();
    let gram = DMatrix::from_fn(count, count, |a, b| sum[(bent[a], bent[b])] / (scale[bent[a]] * scale[bent[b]]));
    let right = DMatrix::from_fn(count, out.ncols(), |a, i| sum[(bent[a], springs + i)] / scale[bent[a]]);
    if let Some(factor) = gram.cholesky() {
        let solved = factor.solve(&right);
        for (a, j) in bent.iter().enumerate() {
            out.set_row(*j, &(solved.row(a) / scale[*j]));
        }
    }
    out
}

/// Postures spread evenly over the bounds, inside the limits where there are enough of them (controller angles, rad).
fn postures(cell: &Cell) -> Result<Vec<Vec<f64>>> {
    let mut margins = cell.posture_margins()?;
    let mut postures = Vec::with_capacity(POSTURES);
    for i in 0..(POSTURES * TRIES) as u32 {
        let q = spread(&cell.bounds, i);
        if margins.least(&q)? >= 0.0 {
            postures.push(q);
        }
        if postures.len() == POSTURES {
            break;
        }
    }
    if postures.len() < FEWEST {
        postures = (0..POSTURES as u32).map(|i| spread(&cell.bounds, i)).collect();
    }
    Ok(postures)
}
