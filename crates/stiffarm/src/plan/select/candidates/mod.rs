//! The best group out of a list of candidates, under any index and also under measured
//! wrenches: exchange from several starts, then branch and bound as far as that is
//! affordable.
//!
//! Each candidate is taken once at most. Where the index is convex in the information
//! (expected_error, d, task, prediction, o1), a weighted mixture of all candidates bounds
//! every group from below; the others are compared one by one where they are few.

mod exact;
mod judge;
mod tangent;

use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::measurement::Candidate;
use crate::model::observation::PostureTerms;
use crate::numerics::control::{Control, Termination};
use crate::numerics::jobs::in_order;
use crate::numerics::streams::list_rng;
use crate::plan::feasibility::forbidden;
use crate::plan::index::evaluate_terms;
use crate::plan::index::prediction::PredictionModel;
use crate::plan::index::{GroupEvaluation, Index};
use crate::plan::select::exchange::Exchange;
use crate::plan::select::predicting::PredictionJudge;
use exact::{BestGroup, branch_and_bound};
use judge::{Bounded, InformationJudge};
use rand::seq::index::sample;
use serde::{Deserialize, Serialize};
use tangent::{Tangent, moved};

/// Passes of an exchange; it ends when nothing improves.
const PASSES: usize = 30;
/// Groups must be better by this in ln(index) to count as better.
const LEAST_IMPROVEMENT: f64 = 1e-9;
/// Steps towards the best mixture.
const STEPS: usize = 200;

/// How to search a list.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CandidateOptions {
    /// Random groups from which the exchange starts.
    pub starts: usize,
    /// Seed of their draw.
    pub seed: u64,
    /// Most groups compared after the exchange, to prove the best one: `None` takes as
    /// many as a few seconds allow. With 0 there is the bound alone.
    pub groups: Option<u64>,
    /// False to stop after the exchange, without a bound.
    pub bound: bool,
    /// How many times as large as expected the index `prediction` takes what gives way beyond the axes.
    pub size_factor: f64,
    /// False to take candidates whatever the bounds and limits of the cell, for postures that
    /// were measured already.
    pub limits: bool,
}

impl Default for CandidateOptions {
    fn default() -> Self {
        CandidateOptions { starts: 16, seed: 1, groups: None, bound: true, size_factor: 1.0, limits: true }
    }
}

/// A candidate that the bounds or limits of the cell forbid.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForbiddenCandidate {
    /// Position in the list, from 0.
    pub candidate: usize,
    /// What forbids it, as the end of a sentence about it.
    pub because: String,
}

/// The best group found in a list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CandidateSelection {
    /// The index that was minimised (maximised for O1 to O5).
    pub index: Index,
    /// Its value for the chosen group.
    pub value: f64,
    /// Positions of the chosen postures in the list, from 0, ascending.
    pub chosen: Vec<usize>,
    /// Candidates that were left out because the cell forbids them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub forbidden: Vec<ForbiddenCandidate>,
    /// Every index of the chosen postures.
    pub evaluation: GroupEvaluation,
    /// True when no other group of as many candidates is better (by more than a part in
    /// a billion).
    pub exact: bool,
    /// No group of as many candidates has a better value than this; `None` where the
    /// index has no such bound and not all groups were compared.
    pub bound: Option<f64>,
    /// Bound over value, or value over bound for O1 to O5: 1 for the best possible group.
    pub efficiency: Option<f64>,
    /// Groups that were compared after the exchange.
    pub groups_compared: u64,
    /// Why the search ended.
    pub termination: Termination,
}

/// Chooses the `count` of `candidates` that make `index` best.
///
/// The index `prediction` predicts at the cell's tasks, or where it has none at all
/// candidates under their own wrenches.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
/// use stiffarm::model::measurement::Candidate;
/// use stiffarm::plan::index::Index;
/// use stiffarm::plan::select::{CandidateOptions, StartKind, random_group, select_candidates};
///
/// let cell = builtin::cell("comau")?;
/// let list: Vec<Candidate> = random_group(&cell, StartKind::Uniform, 20, 1, 0)?
///     .into_iter()
///     .enumerate()
///     .map(|(i, q)| Candidate::new(i.to_string(), q))
///     .collect();
/// let options = CandidateOptions::default();
/// let best = select_candidates(&cell, Index::ExpectedError, 4, &list, &options, Control::default())?;
/// assert!(best.exact && best.chosen.len() == 4);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Not more candidates than postures, a cell without what the index needs, a list of
/// which no group determines every joint, a posture of the wrong length, a load that only
/// a measurement gives.
pub fn select_candidates(
    cell: &Cell,
    index: Index,
    count: usize,
    candidates: &[Candidate],
    options: &CandidateOptions,
    control: Control<'_>,
) -> Result<CandidateSelection> {
    if count == 0 || count > candidates.len() {
        return Err(Error::new(
            Code::TooFewData,
            format!("{count} postures cannot be chosen from {} candidates.", candidates.len()),
        ));
    }
    let (allowed, forbidden) =
        if options.limits { sorted(cell, candidates)? } else { ((0..candidates.len()).collect(), Vec::new()) };
    if count > allowed.len() {
        return Err(too_few(count, candidates, &forbidden));
    }
    let listed = candidates;
    let candidates: Vec<Candidate> = allowed.iter().map(|c| listed[*c].clone()).collect();
    let terms = candidates.iter().map(|candidate| candidate.states(&cell.setup)).collect::<Result<Vec<_>>>()?;
    let model = match (index, PredictionModel::at_candidates(cell, options.size_factor, &terms)) {
        (Index::Prediction, model) => Some(model?),
        // Shown beside the others where the cell has what it needs.
        (_, model) => model.ok(),
    };
    let search = Search { count, of: candidates.len(), options, control };
    let incumbent = match &model {
        Some(model) if index == Index::Prediction => {
            let each: Vec<_> = terms.iter().map(|states| model.readings(states)).collect();
            search.run(PredictionJudge::new(model, &each, None))?
        }
        _ => search.run(InformationJudge::new(cell, index, &terms)?)?,
    };
    let group: Vec<&Vec<PostureTerms>> = incumbent.chosen.iter().map(|p| &terms[*p]).collect();
    let evaluation = evaluate_terms(cell, index.as_str(), &group, model.as_ref())?;
    let value = evaluation.indices.get(index).filter(|value| value.is_finite()).ok_or_else(|| {
        Error::new(
            Code::NotIdentifiable,
            format!(
                "No group of {count} of these {} candidates was found for which {} exists.",
                candidates.len(),
                index.as_str()
            ),
        )
        .hint("choose more postures, or give candidates that differ more")
    })?;
    let bound = if incumbent.exact { Some(value) } else { incumbent.bound.map(|log| index.of_log(log)) };
    let efficiency = bound.map(|bound| if index.larger_is_better() { value / bound } else { bound / value });
    Ok(CandidateSelection {
        index,
        value,
        chosen: incumbent.chosen.iter().map(|p| allowed[*p]).collect(),
        forbidden,
        evaluation,
        exact: incumbent.exact,
        bound,
        efficiency,
        groups_compared: incumbent.compared,
        termination: if control.stopped() { Termination::Interrupted } else { Termination::Converged },
    })
}

/// Positions of the candidates that the cell allows, and those that it forbids.
fn sorted(cell: &Cell, candidates: &[Candidate]) -> Result<(Vec<usize>, Vec<ForbiddenCandidate>)> {
    let mut allowed = Vec::new();
    let mut out = Vec::new();
    for (candidate, posture) in candidates.iter().enumerate() {
        match forbidden(cell, &posture.q)? {
            None => allowed.push(candidate),
            Some(because) => out.push(ForbiddenCandidate { candidate, because }),
        }
    }
    Ok((allowed, out))
}

fn too_few(count: usize, candidates: &[Candidate], forbidden: &[ForbiddenCandidate]) -> Error {
    let allowed = candidates.len() - forbidden.len();
    let mut message = format!(
        "{count} {} cannot be chosen: {allowed} of {} candidates meet the cell's bounds and limits.",
        if count == 1 { "posture" } else { "postures" },
        candidates.len()
    );
    if let Some(first) = forbidden.first() {
        let name = &candidates[first.candidate].name;
        message += &format!(" Candidate {name} {}.", first.because);
    }
    Error::new(Code::TooFewData, message)
        .hint("give more candidates, ask for fewer postures, or relax [bounds] and [limits]")
}

struct Search<'a> {
    count: usize,
    of: usize,
    options: &'a CandidateOptions,
    control: Control<'a>,
}

impl Search<'_> {
    fn run<J: Bounded>(&self, judge: J) -> Result<BestGroup> {
        let all: Vec<usize> = (0..self.of).collect();
        let stop = || self.control.stopped();
        let exchange = Exchange { passes: PASSES, least: LEAST_IMPROVEMENT, repeats: false, stop: &stop };
        let starts: Vec<u64> = (0..self.options.starts.max(1) as u64).collect();
        let ends = in_order(&starts, |(_, start)| {
            let mut judge = judge.clone();
            let mut rng = list_rng(self.options.seed, *start);
            let mut group = sample(&mut rng, self.of, self.count).into_vec();
            let value = exchange.run(&mut judge, &mut group, &all);
            group.sort_unstable();
            Ok((value, group))
        })?;
        let (value, chosen) = ends
            .into_iter()
            .reduce(|best, next| if next.0 < best.0 { next } else { best })
            .unwrap_or((f64::INFINITY, (0..self.count).collect()));
        let mut incumbent = BestGroup { value, chosen, exact: false, bound: None, compared: 0 };
        if self.options.bound && !self.control.stopped() {
            let mut judge = judge;
            let tangent = self.best_tangent(&mut judge);
            let most = self.options.groups.unwrap_or(judge.affordable());
            branch_and_bound(&mut judge, tangent, self.count, self.of, most, self.control, &mut incumbent);
        }
        Ok(incumbent)
    }

    /// The tangent with the highest bound on the way to the best mixture.
    fn best_tangent<J: Bounded>(&self, judge: &mut J) -> Option<Tangent> {
        let mut weights = vec![self.count as f64 / self.of as f64; self.of];
        let mut best: Option<(f64, Tangent)> = None;
        for _ in 0..STEPS {
            if self.control.stopped() {
                break;
            }
            let tangent = judge.tangent(&weights)?;
            let bound = tangent.bound_of(self.count);
            weights = moved(&weights, &tangent.scores, self.count);
            if best.as_ref().is_none_or(|(best_bound, _)| bound > *best_bound) {
                best = Some((bound, tangent));
            }
        }
        best.map(|(_, tangent)| tangent)
    }
}
