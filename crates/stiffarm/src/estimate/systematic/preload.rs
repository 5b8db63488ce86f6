//! What the way from no load to a preload says of the common errors. A fit to displacements against the preload does
//! not have it: lost motion, which is nearly all of it, would be taken for compliance there.

use super::predicting_model::PredictingModel;
use super::sources::{Source, sources};
use crate::error::{Error, Result};
use crate::estimate::identify::Experiment;
use crate::measure::Measured;
use crate::model::measurement::{MeasuredPosture, Role, row_count};
use nalgebra::{DMatrix, DVector};

/// The displacements of the fit's postures from no load to their preload.
pub(super) fn ways(believed: &PredictingModel<'_>) -> Vec<MeasuredPosture> {
    let fit = believed.fit;
    let blocks = &fit.system().blocks;
    let all = fit.measured().against_unloaded.iter();
    let preloads = all.filter(|m| {
        let is_fitted = || blocks.iter().any(|b| b.posture == m.posture.name);
        Role::of(&m.state) == Role::Preload && is_fitted()
    });
    preloads.cloned().collect()
}

/// Independent rows in units of σ of the fit: what one standard uncertainty of each part of `named` does to the ways to
/// the preloads beside what it does through the unknowns, which change by `changes`, rows × parts, and what the fit
/// leaves of these ways. Nothing where none was read.
///
/// # Errors
/// As [`sources`]; a covariance that is not positive definite.
pub(super) fn rows(
    believed: &PredictingModel<'_>,
    named: &[Source],
    changes: &[DVector<f64>],
) -> Result<Option<(DMatrix<f64>, DVector<f64>)>> {
    let postures = ways(believed);
    if row_count(&postures) == 0 {
        return Ok(None);
    }
    let fit = believed.fit;
    let experiment = Experiment::of(fit.cell().clone(), Measured::from(postures))?;
    let system = experiment.system(believed.extra, fit.options().weights)?;
    let shifts = sources(believed, &experiment, &system)?;
    let parts = |of: &[Source]| -> Vec<(&'static str, String)> {
        let names = |source: &Source| {
            let named = |part: &super::Part| (source.facts.name, part.name.clone());
            source.parts.iter().map(named).collect::<Vec<_>>()
        };
        of.iter().flat_map(names).collect()
    };
    let shifted: Vec<&DVector<f64>> =
        shifts.iter().flat_map(|source| source.parts.iter().map(|part| &part.shift)).collect();
    let theirs = parts(&shifts);
    let mut white_rows = DMatrix::zeros(system.delta.len(), changes.len() + 1);
    for (i, (name, change)) in parts(named).iter().zip(changes).enumerate() {
        let mut column = -(&system.psi * change);
        if let Some(at) = theirs.iter().position(|other| other == name) {
            column += shifted[at];
        }
        white_rows.set_column(i, &column);
    }
    let left = &system.delta - &system.psi * believed.values;
    white_rows.set_column(changes.len(), &left);
    for block in &system.blocks {
        let shared = &block.shared * believed.response.gamma();
        let covariance = block.covariance.to_matrix(block.rows.len()) + shared * block.shared.transpose();
        let factor = covariance.cholesky();
        let factor =
            factor.ok_or_else(|| Error::invalid("The covariance of a preload's readings is not positive definite."))?;
        let mut part = white_rows.rows(block.rows.start, block.rows.len()).into_owned();
        factor.l_dirty().solve_lower_triangular_mut(&mut part);
        white_rows.rows_mut(block.rows.start, block.rows.len()).copy_from(&part);
    }
    let misfit = white_rows.column(changes.len()).into_owned();
    Ok(Some((white_rows.remove_column(changes.len()), misfit)))
}
