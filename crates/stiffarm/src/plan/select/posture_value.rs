//! How much an index loses without a posture, and which ones to leave out.

use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::observation::PostureTerms;
use crate::numerics::arrangements::choose;
use crate::numerics::arrangements::next_subset;
use crate::numerics::control::Control;
use crate::numerics::order::sort_by_number;
use crate::plan::index::prediction::PredictionModel;
use crate::plan::index::{Index, evaluate_terms, posture_terms};
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Subsets up to which all ways of leaving postures out are compared.
const EXHAUSTIVE: u64 = 20_000;

/// What is lost without one posture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PostureValue {
    /// Position in the group, from 0.
    pub posture: usize,
    /// The index without it; `None` where the rest no longer has one (a joint
    /// is undetermined).
    pub value: Option<f64>,
    /// How much worse the index becomes without it (fraction of the index;
    /// negative where it improves).
    pub loss: Option<f64>,
}

/// A group with the postures least worth their measuring time left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Dropped {
    /// The index.
    pub index: Index,
    /// Its value for the whole group.
    pub before: f64,
    /// Its value without the postures left out.
    pub value: f64,
    /// Positions of the postures left out, from 0, ascending.
    pub dropped: Vec<usize>,
    /// Positions of those that stay.
    pub kept: Vec<usize>,
    /// True when every way of leaving out as many was compared; else one after
    /// the other was left out.
    pub exhaustive: bool,
    /// Every posture's worth in the whole group, least first.
    #[serde(rename = "worth")]
    pub values: Vec<PostureValue>,
}

/// Leaves out the `count` postures of a group (controller angles, rad) without
/// which `index` stays best.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
/// use stiffarm::plan::index::Index;
/// use stiffarm::plan::select::drop_postures;
///
/// let cell = builtin::cell("comau")?;
/// let group = builtin::postures("comau-group1", &cell.setup.robot)?;
/// let found = drop_postures(&cell, Index::ExpectedError, &group, 2, Control::default())?;
/// assert_eq!((found.dropped.len(), found.kept.len()), (2, group.len() - 2));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Not fewer postures to leave out than there are, a group or rest that cannot
/// determine all joints, or a cell without what the index needs; stopped.
pub fn drop_postures<Q: AsRef<[f64]>>(
    cell: &Cell,
    index: Index,
    postures: &[Q],
    count: usize,
    control: Control<'_>,
) -> Result<Dropped> {
    if count >= postures.len() {
        return Err(Error::new(
            Code::TooFewData,
            format!("{count} of {} postures cannot be left out: at least one must stay.", postures.len()),
        ));
    }
    // Missing tasks, prior or length are errors, not missing values.
    crate::plan::index::IndexFunction::new(cell, index, 1)?;
    let terms = posture_terms(cell, postures)?;
    let model = PredictionModel::for_index(cell, Some(index));
    let total = 1 + postures.len() + evaluations(postures.len(), count);
    let done = AtomicUsize::new(0);
    let value_of = |remaining: &[usize]| -> Result<Option<f64>> {
        control.check()?;
        let so_far = done.fetch_add(1, Ordering::Relaxed) + 1;
        control.report("leaving postures out", so_far.min(total), total);
        let group: Vec<&Vec<PostureTerms>> = remaining.iter().map(|p| &terms[*p]).collect();
        let evaluation = evaluate_terms(cell, index.as_str(), &group, model.as_ref())?;
        Ok(evaluation.indices.get(index))
    };
    let all: Vec<usize> = (0..postures.len()).collect();
    let before = value_of(&all)?.ok_or_else(|| {
        Error::new(Code::NotIdentifiable, format!("{} does not exist for the given postures.", index.as_str()))
            .hint("`stiffarm evaluate` names the joints they cannot determine")
    })?;
    // Smaller is better from here on.
    let sign = if index.larger_is_better() { -1.0 } else { 1.0 };
    let without =
        |from: &[usize], out: &[usize]| -> Vec<usize> { from.iter().copied().filter(|p| !out.contains(p)).collect() };
    let mut values = Vec::with_capacity(postures.len());
    for p in &all {
        let value = value_of(&without(&all, &[*p]))?;
        values.push(PostureValue { posture: *p, value, loss: value.map(|v| sign * (v - before) / before) });
    }
    let loss = |w: &PostureValue| w.loss.unwrap_or(f64::INFINITY);
    sort_by_number(&mut values, loss);

    let exhaustive = choose(postures.len() as u64, count as u64) <= EXHAUSTIVE;
    let mut best: Option<(f64, Vec<usize>)> = None;
    if exhaustive {
        let mut out: Vec<usize> = (0..count).collect();
        loop {
            if let Some(value) = value_of(&without(&all, &out))?
                && best.as_ref().is_none_or(|(b, _)| sign * value < sign * b)
            {
                best = Some((value, out.clone()));
            }
            if !next_subset(&mut out, postures.len()) {
                break;
            }
        }
    } else {
        let mut dropped = Vec::new();
        for _ in 0..count {
            best = None;
            for p in without(&all, &dropped) {
                let mut out = dropped.clone();
                out.push(p);
                if let Some(value) = value_of(&without(&all, &out))?
                    && best.as_ref().is_none_or(|(b, _)| sign * value < sign * b)
                {
                    best = Some((value, out));
                }
            }
            match &best {
                Some((_, out)) => dropped.clone_from(out),
                None => break,
            }
        }
    }
    let (value, mut dropped) = best.ok_or_else(|| {
        Error::new(
            Code::NotIdentifiable,
            format!(
                "Without {count} of these {} postures a joint is undetermined, whichever are left out.",
                postures.len()
            ),
        )
    })?;
    dropped.sort_unstable();
    Ok(Dropped { index, before, value, kept: without(&all, &dropped), dropped, exhaustive, values })
}

/// Groups that [`drop_postures`] evaluates to leave `count` of `of` postures out, beside
/// the whole group and those without one posture.
pub fn evaluations(of: usize, count: usize) -> usize {
    match choose(of as u64, count.min(of) as u64) {
        subsets @ ..=EXHAUSTIVE => subsets as usize,
        // One after the other.
        _ => (0..count).map(|dropped| of.saturating_sub(dropped)).sum(),
    }
}
