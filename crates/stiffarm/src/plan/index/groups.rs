//! Indices of many groups at once, on all cores.
//!
//! What is wanted comes from the functions that searches go by, some fifty times faster than the decompositions of
//! [`evaluate`](super::evaluate()) and the same to nine digits: where a group's information is too badly conditioned
//! for that, it is evaluated as there.

use super::evaluate::{Indices, evaluate_terms, posture_terms};
use super::function::IndexFunction;
use super::kinds::Index;
use super::prediction::PredictionModel;
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::observation::check_angles;
use crate::numerics::jobs::in_order;

/// Groups that a job takes.
const PORTION: usize = 256;

/// The indices of each group of `groups` (controller angles, rad), in their order: those `wanted`; others may come with
/// them. The numbers are those of [`evaluate`](super::evaluate()) to nine digits; what all groups share is computed
/// once.
///
/// # Errors
/// As [`evaluate`](super::evaluate()), of the first group that has one.
pub fn evaluate_groups<G: AsRef<[Q]> + Sync, Q: AsRef<[f64]> + Sync>(
    cell: &Cell,
    groups: &[G],
    wanted: &[Index],
) -> Result<Vec<Indices>> {
    let predicts = wanted.contains(&Index::Prediction);
    let model = predicts.then(|| PredictionModel::of_cell(cell).ok());
    let model = model.flatten();
    let exactly = |number: usize, group: &[Q]| {
        let terms = posture_terms(cell, group)?;
        let name = (number + 1).to_string();
        Ok(evaluate_terms(cell, &name, &terms, model.as_ref())?.indices)
    };
    // Only the decompositions give this one, and the others with it: each group is a job of its own.
    if predicts {
        return in_order(groups, |(number, group)| exactly(number, group.as_ref()));
    }
    let Some(first) = groups.first().map(AsRef::as_ref) else {
        return Ok(Vec::new());
    };
    // What the cell lacks leaves an index out, or is said here.
    exactly(0, first)?;
    let functions: Vec<IndexFunction> =
        wanted.iter().filter_map(|index| IndexFunction::new(cell, *index, first.len()).ok()).collect();
    let fits = |group: &[Q]| {
        let robot = &cell.setup.robot;
        let mut angles = group.iter().map(|q| check_angles(robot, q.as_ref()));
        group.len() == first.len() && angles.all(|checked| checked.is_ok())
    };
    let portions: Vec<&[G]> = groups.chunks(PORTION).collect();
    let by_portion = in_order(&portions, |(portion, groups)| {
        let mut functions = functions.clone();
        let one = |(number, group): (usize, &G)| {
            let group = group.as_ref();
            let quick = fits(group).then(|| quickly(&mut functions, group));
            match quick.flatten() {
                Some(indices) => Ok(indices),
                None => exactly(portion * PORTION + number, group),
            }
        };
        groups.iter().enumerate().map(one).collect()
    });
    let by_portion: Vec<Vec<Indices>> = by_portion?;
    Ok(by_portion.into_iter().flatten().collect())
}

/// What the functions say of a group; `None` where they are not sure of nine digits.
fn quickly<Q: AsRef<[f64]>>(functions: &mut [IndexFunction], group: &[Q]) -> Option<Indices> {
    let q: Vec<f64> = group.iter().flat_map(|q| q.as_ref().to_vec()).collect();
    let mut out = Indices::default();
    for function in functions {
        let index = function.index();
        let log = function.value(&q);
        if !log.is_finite() || !function.is_well_conditioned() {
            return None;
        }
        *out.place(index) = Some(index.of_log(log));
    }
    Some(out)
}
