//! The stiffness with which joint axes alone best reproduce the arm of a mixed model over its cell.
//!
//! What a joint gives way about its own axis cannot be told from what links and bearings beside it do, by no posture and
//! no load. What can be told is h* = h + L u with L = (ΨᵀΨ)⁻¹ΨᵀZ over many postures of the cell, Ψ the columns of
//! the axes there and Z those of all that gives way besides: the projection of what the model predicts on the axes. It is
//! what a calculation with joint stiffnesses alone should use, and it depends on the cell and its load.

use crate::error::Result;
use crate::estimate::identify::Fit;
use crate::model::cell::Cell;
use crate::model::load::{Load, Wrench};
use crate::model::observation::{ExtraTerm, PostureTerms};
use crate::numerics::jobs::in_order_watched;
use crate::numerics::streams::spread;
use nalgebra::DMatrix;

/// Postures over which the arm is reproduced: another thousand moves h* by less than a percent.
const POSTURES: usize = 1000;
/// Points of the bounds that are tried for each.
const TRIES: usize = 20;
/// With fewer postures inside the limits the bounds alone count.
const FEWEST: usize = 100;
/// Postures of one job.
const PORTION: usize = 50;

/// L, springs × terms; zero beside springs that the load of the cell never bends.
///
/// # Errors
/// As [`PostureTerms::new`]; interrupted.
pub(super) fn projection(fit: &Fit, terms: &[ExtraTerm]) -> Result<DMatrix<f64>> {
    let cell = fit.cell();
    let robot = &cell.setup.robot;
    let springs = robot.spring_count();
    let wrenches: Vec<Wrench> = match cell.setup.load {
        Load::Measured => fit
            .experiment()
            .with_terms()
            .map(|(_, terms)| *terms.wrench())
            .collect(),
        _ => Vec::new(),
    };
    let setups = cell.setup.cases();
    let postures: Vec<(usize, Vec<f64>)> = postures(cell)?.into_iter().enumerate().collect();
    let portions: Vec<_> = postures.chunks(PORTION).collect();
    let sums = in_order_watched(
        &portions,
        "the axes over the cell",
        fit.control(),
        |(_, portion)| {
            let mut sum = DMatrix::zeros(springs, springs + terms.len());
            for (i, q) in *portion {
                for setup in &setups {
                    // Measured forces in turn.
                    let wrench = wrenches.get(i % wrenches.len().max(1));
                    let Ok(own) = PostureTerms::new(setup, q, wrench) else {
                        continue;
                    };
                    let block = own.block_with(robot, terms);
                    sum += block.columns(0, springs).tr_mul(&block);
                }
            }
            Ok(sum)
        },
    )?;
    let mut sum = DMatrix::zeros(springs, springs + terms.len());
    sums.iter().for_each(|own| sum += own);
    Ok(solved(&sum, springs))
}

/// (ΨᵀΨ)⁻¹ΨᵀZ from Ψᵀ\[Ψ Z\].
fn solved(sum: &DMatrix<f64>, springs: usize) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(springs, sum.ncols() - springs);
    let scale: Vec<f64> = (0..springs).map(|j| sum[(j, j)].sqrt()).collect();
    let most = scale.iter().copied().fold(0.0, f64::max);
    let bent: Vec<usize> = (0..springs).filter(|j| scale[*j] > 1e-9 * most).collect();
    let count = bent.len();
    let gram = DMatrix::from_fn(count, count, |a, b| {
        sum[(bent[a], bent[b])] / (scale[bent[a]] * scale[bent[b]])
    });
    let right = DMatrix::from_fn(count, out.ncols(), |a, i| {
        sum[(bent[a], springs + i)] / scale[bent[a]]
    });
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
    let mut found = Vec::with_capacity(POSTURES);
    for i in 0..(POSTURES * TRIES) as u32 {
        let q = spread(&cell.bounds, i);
        if margins.least(&q)? >= 0.0 {
            found.push(q);
        }
        if found.len() == POSTURES {
            break;
        }
    }
    if found.len() < FEWEST {
        found = (0..POSTURES as u32)
            .map(|i| spread(&cell.bounds, i))
            .collect();
    }
    Ok(found)
}
