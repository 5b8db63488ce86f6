//! How the outcome depends on the initial group, and the classical group on q1.

use super::study_indices;
use crate::error::{Code, Result};
use crate::model::cell::Cell;
use crate::model::posture::PostureGroup;
use crate::numerics::control::Control;
use crate::numerics::jobs::in_order;
use crate::numerics::optimise::Options;
use crate::numerics::sample::quantile_of;
use crate::numerics::streams::run_rng;
use crate::plan::index::{Index, evaluate_for};
use crate::plan::select::{StartKind, random_group, select_from, smallest_margin};
use rand::RngExt;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// One index over all initial groups of one kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IndexOverStarts {
    /// The index; `None` for the initial groups themselves.
    pub index: Option<Index>,
    /// Mean over joints of the expected deviation at variance factor 1, start
    /// by start; `None` where a joint is undetermined or no group was found.
    pub mean_expected_deviation: Vec<Option<f64>>,
    /// Median over the starts that have a value.
    pub median: Option<f64>,
    /// Starts after which the expected deviation is smaller than before.
    pub improved: usize,
}

/// All initial groups of one kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StartsOfKind {
    /// `random` within the bounds, or `small wrist angles` (within ±30°).
    pub kind: String,
    /// Number of initial groups.
    pub count: usize,
    /// The start itself, then every index of the study.
    pub rows: Vec<IndexOverStarts>,
    /// Starts where the novel group is better than both its start and the
    /// classical group, as the paper reports for its own; `None` where the
    /// robot has no such indices.
    pub paper_order_held: Option<usize>,
}

/// What other initial groups lead to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StartsStudy {
    /// One entry per kind of initial group.
    pub kinds: Vec<StartsOfKind>,
}

/// The classical group with q1 drawn anew: its index does not change.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Q1Range {
    /// Draws of q1 for all postures that meet the cell's limits.
    pub draws: usize,
    /// Draws that leave a joint undetermined.
    pub undetermined: usize,
    /// Mean expected deviation of each determined draw, ascending.
    pub mean_expected_deviation: Vec<f64>,
    /// Smallest, 5 %, 50 %, 95 % quantile and largest of it.
    pub quantiles: Option<[f64; 5]>,
}

/// Runs every index of the study from `starts` further initial groups, half of
/// each kind.
pub(super) fn other_starts(
    cell: &Cell,
    postures: usize,
    starts: usize,
    seed: u64,
    options: Options,
    control: Control<'_>,
) -> Result<StartsStudy> {
    let per_kind = [starts.div_ceil(2), starts / 2];
    let kinds = [(StartKind::Uniform, "random"), (StartKind::SmallWrist, "small wrist angles")];
    let mut jobs = Vec::new();
    for (k, (kind, _)) in kinds.iter().enumerate() {
        for s in 0..per_kind[k] {
            // Streams of the two kinds never meet.
            jobs.push((*kind, (k as u64) << 32 | s as u64));
        }
    }
    let indices = study_indices(cell);
    let done = AtomicUsize::new(0);
    let total = jobs.len();
    let outcomes: Vec<Option<Vec<Option<f64>>>> = in_order(&jobs, |(_, (kind, stream))| {
        if control.stopped() {
            return Ok(None);
        }
        let initial = random_group(cell, *kind, postures, seed, *stream)?;
        let start = evaluate_for(cell, "start", &initial, None)?;
        let mut row = vec![start.mean_expected_deviation()];
        for (index, _) in &indices {
            let selected = select_from(cell, *index, &initial, options, control);
            if control.stopped() {
                // An unfinished initial group does not count.
                return Ok(None);
            }
            row.push(match selected {
                Ok(selection) => selection.evaluation.mean_expected_deviation(),
                // A start from which no determined group inside the limits is
                // reached counts as not improved.
                Err(error) if matches!(error.code(), Code::NotIdentifiable | Code::InvalidValue) => None,
                Err(error) => return Err(error),
            });
        }
        control.report("other initial groups", done.fetch_add(1, Ordering::Relaxed) + 1, total);
        Ok(Some(row))
    })?;
    let mut rest = outcomes.as_slice();
    let mut result = StartsStudy { kinds: Vec::new() };
    for (k, (_, name)) in kinds.iter().enumerate() {
        let (mine, others) = rest.split_at(per_kind[k]);
        rest = others;
        let finished: Vec<Vec<Option<f64>>> = mine.iter().flatten().cloned().collect();
        if !finished.is_empty() {
            result.kinds.push(summarise(name, &indices, &finished));
        }
    }
    Ok(result)
}

fn summarise(kind: &str, studied: &[(Index, &str)], outcomes: &[Vec<Option<f64>>]) -> StartsOfKind {
    // An undetermined group is worse than any determined one.
    let badness = |v: Option<f64>| v.unwrap_or(f64::INFINITY);
    let indices = std::iter::once(None).chain(studied.iter().map(|(i, _)| Some(*i)));
    let rows = indices
        .enumerate()
        .map(|(r, index)| {
            let values: Vec<Option<f64>> = outcomes.iter().map(|o| o[r]).collect();
            let determined: Vec<f64> = values.iter().flatten().copied().collect();
            IndexOverStarts {
                index,
                median: (!determined.is_empty()).then(|| quantile_of(&determined, 0.5)),
                improved: outcomes.iter().filter(|o| badness(o[r]) < badness(o[0])).count(),
                mean_expected_deviation: values,
            }
        })
        .collect();
    let position = |index: Index| studied.iter().position(|(i, _)| *i == index).map(|p| p + 1);
    let paper_order_held = position(Index::Classical).zip(position(Index::Novel)).map(|(classical, novel)| {
        let held =
            |o: &&Vec<Option<f64>>| badness(o[novel]) < badness(o[0]) && badness(o[novel]) < badness(o[classical]);
        outcomes.iter().filter(held).count()
    });
    StartsOfKind { kind: kind.to_string(), count: outcomes.len(), rows, paper_order_held }
}

impl Q1Range {
    /// True when q1 changes the outcome by more than a hundredth; it does not
    /// where the load turns with axis 1.
    pub fn matters(&self) -> bool {
        self.undetermined > 0 || self.quantiles.is_some_and(|q| q[4] > 1.01 * q[0])
    }
}

/// Draws of one posture's q1 before its feasible window counts as too narrow.
const Q1_TRIES: usize = 1000;

/// Redraws q1 of every posture of the classical group, uniform in its bounds.
pub(super) fn q1_range(
    cell: &Cell,
    group: &PostureGroup,
    draws: usize,
    seed: u64,
    control: Control<'_>,
) -> Result<Option<Q1Range>> {
    if draws == 0 {
        return Ok(None);
    }
    let bound = cell.bounds[0];
    let mut range = Q1Range { draws: 0, undetermined: 0, mean_expected_deviation: Vec::new(), quantiles: None };
    let mut rng = run_rng(seed, 1 << 17, 0, 0);
    let mut angles: Vec<Vec<f64>> = group.postures.iter().map(|p| p.q.clone()).collect();
    while range.draws < draws && !control.stopped() {
        for q in &mut angles {
            // Redraw one posture's q1 until it meets the limits on its own.
            let mut inside = false;
            for _ in 0..Q1_TRIES {
                q[0] = bound[0] + (bound[1] - bound[0]) * rng.random::<f64>();
                inside = smallest_margin(cell, std::slice::from_ref(q))?.is_none_or(|m| m >= -1e-9);
                if inside {
                    break;
                }
            }
            if !inside {
                // Its window of q1 is too narrow to say anything about a range.
                return Ok(None);
            }
        }
        range.draws += 1;
        match evaluate_for(cell, &group.name, &angles, None)?.mean_expected_deviation() {
            Some(deviation) => range.mean_expected_deviation.push(deviation),
            None => range.undetermined += 1,
        }
    }
    if range.draws == 0 {
        return Ok(None);
    }
    range.mean_expected_deviation.sort_by(f64::total_cmp);
    if !range.mean_expected_deviation.is_empty() {
        let at = |p| quantile_of(&range.mean_expected_deviation, p);
        range.quantiles = Some([at(0.0), at(0.05), at(0.5), at(0.95), at(1.0)]);
    }
    Ok(Some(range))
}
