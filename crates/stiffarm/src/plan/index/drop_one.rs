//! What is left of a group when any one posture is lost.

use crate::error::Result;
use crate::model::cell::Cell;
use crate::numerics::information::{Factor, GRAM_ROUNDING, scale_columns, symmetric_eigen};
use nalgebra::DMatrix;
use std::ops::Range;

/// Groups up to this size have a decomposition for each posture left out.
const EXACT_DROP_ONE: usize = 60;

/// What each posture tells, for what is lost without it.
pub(super) enum DropTerms {
    /// Where its rows are among all.
    Rows(Vec<Range<usize>>),
    /// Its information about compliances over their prior, one after the other.
    Information(Vec<f64>, Vec<f64>),
    /// Nothing: there is no prior.
    Nothing,
}

impl DropTerms {
    /// No posture yet; `many` where not all rows are kept.
    pub fn new(cell: &Cell, many: bool) -> Self {
        match (&cell.prior, many) {
            (None, _) => DropTerms::Nothing,
            (_, false) => DropTerms::Rows(Vec::new()),
            (Some(prior), true) => DropTerms::Information(prior.iter().map(|k| 1.0 / k).collect(), Vec::new()),
        }
    }

    /// Adds a posture by its whitened rows.
    pub fn add(&mut self, rows: &DMatrix<f64>) {
        match self {
            DropTerms::Nothing => {}
            DropTerms::Rows(ranges) => {
                let start = ranges.last().map_or(0, |range| range.end);
                ranges.push(start..start + rows.nrows());
            }
            DropTerms::Information(units, all) => {
                let mut rows = rows.clone();
                scale_columns(&mut rows, units.iter().copied());
                all.extend(rows.tr_mul(&rows).iter());
            }
        }
    }

    /// Largest error of all but one posture.
    pub fn drop_one_error(&self, whitened: &DMatrix<f64>, prior: &[f64], std: f64) -> Result<Option<f64>> {
        let n = prior.len();
        let postures = match self {
            DropTerms::Nothing => return Ok(None),
            DropTerms::Information(_, all) => {
                let each = all.chunks_exact(n * n);
                let each = each.map(|information| DMatrix::from_column_slice(n, n, information));
                let total = each.clone().fold(DMatrix::zeros(n, n), |sum, information| sum + information);
                return Ok(drop_one_by_information(&total, each, std));
            }
            DropTerms::Rows(postures) => postures,
        };
        if postures.len() < 2 {
            return Ok(None);
        }
        if postures.len() > EXACT_DROP_ONE {
            let mut scaled = whitened.clone();
            scale_columns(&mut scaled, prior.iter().map(|k| 1.0 / k));
            let total = scaled.tr_mul(&scaled);
            let each = postures.iter().map(|rows| {
                let block = scaled.rows(rows.start, rows.len());
                block.tr_mul(&block)
            });
            return Ok(drop_one_by_information(&total, each, std));
        }
        let mut worst = Some(0.0_f64);
        for rows in postures {
            let rest = whitened.clone().remove_rows(rows.start, rows.len());
            let error = rms(&relative_errors(&Factor::new(&rest)?, prior, std));
            worst = worst.zip(error).map(|(a, b)| a.max(b));
        }
        Ok(worst)
    }
}

/// The same for large groups, where one posture more or less hardly
/// changes the information, from the information matrices.
fn drop_one_by_information(total: &DMatrix<f64>, each: impl Iterator<Item = DMatrix<f64>>, std: f64) -> Option<f64> {
    let mut worst = 0.0_f64;
    for information in each {
        let (values, _) = symmetric_eigen(total - information)?;
        let n = values.len();
        if values[0] <= n as f64 * GRAM_ROUNDING * values[n - 1] {
            return None;
        }
        let trace: f64 = values.iter().map(|v| 1.0 / v).sum();
        worst = worst.max((trace / n as f64).sqrt());
    }
    Some(std * worst)
}

/// σ k_j sqrt([(ΨᵀΨ)⁻¹]_jj) per joint.
pub(super) fn relative_errors(factor: &Factor, prior: &[f64], std: f64) -> Vec<Option<f64>> {
    factor.standard_errors().iter().zip(prior).map(|(e, k)| e.map(|e| std * k * e)).collect()
}

/// Root of the mean square; `None` where one is missing.
pub(super) fn rms(values: &[Option<f64>]) -> Option<f64> {
    let sum: Option<f64> = values.iter().map(|e| e.map(|e| e * e)).sum();
    sum.map(|s| (s / values.len() as f64).sqrt())
}
