//! Indices of many groups at once, on all cores.

use super::evaluate::{Indices, evaluate_terms, posture_terms};
use super::kinds::Index;
use super::prediction::PredictionModel;
use crate::error::Result;
use crate::model::cell::Cell;
use crate::numerics::jobs::in_order;

/// The indices of each group of `groups` (controller angles, rad), in their order: those `wanted`, and others that
/// come with them. The numbers are those of [`evaluate`](super::evaluate); what all groups share is computed once.
///
/// # Errors
/// As [`evaluate`](super::evaluate), of the first group that has one.
pub fn evaluate_groups<G: AsRef<[Q]> + Sync, Q: AsRef<[f64]>>(
    cell: &Cell,
    groups: &[G],
    wanted: &[Index],
) -> Result<Vec<Indices>> {
    let model = if wanted.contains(&Index::Prediction) {
        PredictionModel::of_cell(cell).ok()
    } else {
        None
    };
    in_order(groups, |(number, group)| {
        let terms = posture_terms(cell, group.as_ref())?;
        let name = (number + 1).to_string();
        Ok(evaluate_terms(cell, &name, &terms, model.as_ref())?.indices)
    })
}
