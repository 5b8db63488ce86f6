//! Fits without some postures: how far the others predict them, and how much
//! each posture moves the estimates.

use super::assumptions::Assumptions;
use super::leave_out_solver::LeaveOutSolver;
use super::rms;
use super::solve::{Prepared, Solution};
use super::system::MeasuredSystem;
use crate::error::{Error, Result};
use crate::numerics::control::Control;
use crate::numerics::information::ZERO_COLUMN;
use crate::numerics::jobs::in_order_watched;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};

/// A fit without the postures of one fold.
#[derive(Debug, Clone)]
pub(crate) struct Fold {
    /// The postures left out (indices of blocks).
    pub(crate) left_out: Vec<usize>,
    /// The fit from the others.
    pub(crate) solution: Solution,
}

/// How well the other postures predict each posture, and what it does to the fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Influence {
    /// Posture.
    pub posture: String,
    /// RMS of its displacement components less their prediction from the other
    /// postures \[m\]; `None` where they do not determine what it shows.
    pub prediction_rms_m: Option<f64>,
    /// Change of each unknown when the posture is left out, in standard errors
    /// of the full fit; `None` where there is no standard error or the others
    /// do not determine it.
    pub shifts: Vec<Option<f64>>,
    /// Unknowns that the other postures do not determine.
    pub lost: Vec<String>,
}

/// Leave-one-posture-out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LeaveOneOut {
    /// RMS of all displacement components less their prediction from the other
    /// postures \[m\]; `None` where a posture's prediction lacks an unknown.
    pub rms_m: Option<f64>,
    /// Posture by posture.
    pub postures: Vec<Influence>,
}

/// Fits without each of `folds` folds of postures: posture i belongs to fold i
/// modulo `folds`, so that neighbours in the file go to different folds.
///
/// # Errors
/// Fewer than two folds, more folds than postures, stopped, or as [`Prepared::solve`].
pub(super) fn folds(
    prepared: &Prepared,
    white: &DVector<f64>,
    assumed: &Assumptions,
    folds: usize,
    control: Control<'_>,
) -> Result<Vec<Fold>> {
    let count = prepared.whitened().block_count();
    if folds < 2 || folds > count {
        return Err(Error::invalid(format!("{count} postures cannot be left out in {folds} folds."))
            .hint(format!("give a number of folds from 2 to the number of postures, {count}")));
    }
    let numbers: Vec<usize> = (0..folds).collect();
    let others = LeaveOutSolver::new(prepared, white, assumed);
    in_order_watched(&numbers, "leaving postures out", control, |(_, fold)| {
        let left_out: Vec<usize> = (*fold..count).step_by(folds).collect();
        if let Some(others) = &others
            && let Some(solution) = others.without(&left_out)?
        {
            return Ok(Fold { left_out, solution });
        }
        fold_without(left_out, count, prepared, white, assumed)
    })
}

/// The solutions without each of `count` folds; tests hold them against fits of
/// their own.
///
/// # Errors
/// Fewer than two folds, more folds than postures, or a fit that fails.
pub fn solutions_without(
    prepared: &Prepared,
    delta: &DVector<f64>,
    assumed: &Assumptions,
    count: usize,
) -> Result<Vec<Solution>> {
    let white = prepared.whitened().whiten(delta);
    let made = folds(prepared, &white, assumed, count, Control::default())?;
    Ok(made.into_iter().map(|fold| fold.solution).collect())
}

/// The fit to white displacements without the postures of `left_out`, of `count`.
///
/// # Errors
/// As [`Prepared::solve`].
pub(super) fn fold_without(
    left_out: Vec<usize>,
    count: usize,
    prepared: &Prepared,
    white: &DVector<f64>,
    assumed: &Assumptions,
) -> Result<Fold> {
    let others: Vec<usize> = (0..count).filter(|b| !left_out.contains(b)).collect();
    let (prepared, white) = prepared.select(&others, white)?;
    let solution = prepared.solve_white(&white, assumed)?;
    Ok(Fold { left_out, solution })
}

/// Residuals below this share of the displacements are rounding.
pub(crate) const RESIDUAL_ROUNDING: f64 = 1e-11;

/// Norm below which a column of Ψ is rounding.
pub(crate) fn rounding(system: &MeasuredSystem) -> f64 {
    let norms = system.psi.column_iter().map(|c| c.norm());
    ZERO_COLUMN * norms.fold(0.0, f64::max)
}

/// Measured minus predicted displacements of one posture, or `None` where the
/// fit lacks an unknown that the posture sees. A column below `rounding`
/// ([`rounding`]) sees nothing: a load through the joint's axis.
pub(crate) fn prediction_error(
    system: &MeasuredSystem,
    block: usize,
    solution: &Solution,
    rounding: f64,
) -> Option<DVector<f64>> {
    let seen = sees_only_known(system, block, &solution.undetermined, rounding);
    seen.then(|| missed(system, block, &solution.values))
}

/// True where a posture sees none of these unknowns.
pub(crate) fn sees_only_known(system: &MeasuredSystem, block: usize, undetermined: &[usize], rounding: f64) -> bool {
    let rows = &system.blocks[block].rows;
    let psi = system.psi.rows(rows.start, rows.len());
    let blind = |j: &usize| psi.column(*j).norm() <= rounding;
    undetermined.iter().all(blind)
}

/// Measured minus calculated displacements of one posture.
pub(crate) fn missed(system: &MeasuredSystem, block: usize, values: &DVector<f64>) -> DVector<f64> {
    let rows = &system.blocks[block].rows;
    let psi = system.psi.rows(rows.start, rows.len());
    system.delta.rows(rows.start, rows.len()) - psi * values
}

/// Each posture by the fold that leaves it out, against the fit `all`.
pub(super) fn influence(system: &MeasuredSystem, all: &Solution, folds: &[Fold]) -> LeaveOneOut {
    let mut errors = Vec::new();
    let mut complete = true;
    let rounding = rounding(system);
    let mut postures = Vec::with_capacity(system.blocks.len());
    for (b, fold) in folds.iter().enumerate() {
        let error = prediction_error(system, b, &fold.solution, rounding);
        complete &= error.is_some();
        errors.extend(error.iter().flat_map(|e| e.iter().copied()));
        let lost: Vec<usize> =
            fold.solution.undetermined.iter().copied().filter(|j| !all.undetermined.contains(j)).collect();
        let shift = |j: usize| {
            let is_determined = !all.undetermined.contains(&j) && !lost.contains(&j);
            let variance = all.covariance.as_ref().filter(|_| is_determined)?[(j, j)];
            (variance > 0.0).then(|| (fold.solution.values[j] - all.values[j]) / variance.sqrt())
        };
        postures.push(Influence {
            posture: system.blocks[b].posture.clone(),
            prediction_rms_m: error.map(|e| rms(e.as_slice())),
            shifts: (0..system.unknowns.len()).map(shift).collect(),
            lost: lost.iter().map(|j| system.unknowns[*j].clone()).collect(),
        });
    }
    LeaveOneOut { rms_m: complete.then(|| rms(&errors)), postures }
}
