//! Global selection: several chains of local searches, in rounds.
//!
//! Each round gives every chain the same number of local searches with random
//! numbers of its own, and the results are compared in the order of the
//! chains. So the rounds that were completed, not time or threads, decide the
//! result.
//!
//! Quasi-Newton to explore, quadratic programming to finish. A local search
//! costs milliseconds with L-BFGS-B on a smoothed index and a tenth of a second
//! or more with SLSQP, whose cost grows with the cube of the angles. The
//! corners of max() and of limits are found exactly by the latter, once, at the
//! end.
//!
//! Rounds, not seconds. A search is cut at the end of a round of equal work for
//! every chain; half a round is thrown away. So `--rounds` reproduces what
//! `--time-limit` or Ctrl-C left.

mod chain;
mod exchange;
mod local;
mod options;
mod plan;
mod polish;
mod pool;

use super::selection::{RoundReport, Selection, check_bounds, limits_of, no_result, smallest_length, too_near};
use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::observation::check_angles;
use crate::numerics::control::{Control, Termination};
use crate::numerics::order::ascending;
use crate::numerics::streams::chain_rng;
use crate::plan::index::inputs::{Inputs, criterion};
use crate::plan::index::{Index, evaluate};
use crate::plan::random::{StartKind, random_group};
use crate::plan::select::load_design::LoadDesign;
use chain::Chain;
use local::{Effort, Local};
pub use options::GlobalOptions;
use options::Schedule;
use plan::Plan;
use pool::Pool;
use rayon::prelude::*;
use std::time::Instant;

/// Chains that may share the best minimum.
const SHARING: usize = 4;
/// Rounds after which that many chains are put onto it, where minima are few.
const MIGRATION: u64 = 6;
/// Minima this near to each other in ln(index) count as one.
const SAME_MINIMUM: f64 = 1e-3;
/// Relative improvement that counts.
const LEAST_IMPROVEMENT: f64 = 1e-6;

/// Selects `count` postures that make `index` best, within the bounds and the
/// limits of the cell: the best of many local searches. Postures given in the
/// options stay as they are and count too.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
/// use stiffarm::plan::index::Index;
/// use stiffarm::plan::select::{GlobalOptions, select};
///
/// let cell = builtin::cell("comau")?;
/// let mut options = GlobalOptions::default();
/// options.rounds = Some(1); // more find better plans
/// let plan = select(&cell, Index::ExpectedError, 6, &options, Control::default())?;
/// assert_eq!(plan.group.len(), 6);
/// println!("expected error {:.2} %", 100.0 * plan.value);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// A cell without what the index needs, postures that cannot determine all
/// joints, or limits that no posture meets.
pub fn select(
    cell: &Cell,
    index: Index,
    count: usize,
    options: &GlobalOptions,
    control: Control<'_>,
) -> Result<Selection> {
    select_watched(cell, index, count, options, control, &mut |_| {})
}

/// [`select`], with a report after each round.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
/// use stiffarm::plan::index::Index;
/// use stiffarm::plan::select::{GlobalOptions, select_watched};
///
/// let cell = builtin::cell("comau")?;
/// let mut options = GlobalOptions::default();
/// options.rounds = Some(2);
/// let mut values = Vec::new();
/// let control = Control::default();
/// select_watched(&cell, Index::D, 3, &options, control, &mut |round| values.push(round.value))?;
/// assert_eq!(values.len(), 2);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// As [`select`].
pub fn select_watched(
    cell: &Cell,
    index: Index,
    count: usize,
    options: &GlobalOptions,
    control: Control<'_>,
    watch: &mut dyn FnMut(&RoundReport),
) -> Result<Selection> {
    if count == 0 {
        return Err(Error::new(Code::TooFewData, "The number of postures must be at least 1, got 0."));
    }
    check_bounds(cell)?;
    let fixed_postures = &options.given;
    for q in fixed_postures {
        check_angles(&cell.setup.robot, q)?;
    }
    if !options.load.is_empty() && !fixed_postures.is_empty() {
        return Err(Error::invalid(
            "Postures that were measured already fix the load: it cannot be designed any more.",
        )
        .hint("leave out the load's boxes, or the given postures"));
    }
    if !options.load.is_empty() && index == Index::Prediction {
        return Err(Error::new(
            Code::Unsupported,
            "The load cannot be chosen together with the postures under the index prediction.",
        )
        .hint("choose the load under task or expected_error, put it into the cell, then select by prediction"));
    }
    let prepared = options.load.prepare(cell)?;
    let mut search = Global::new(&prepared, index, count, options)?;
    let termination = search.rounds(control, watch)?;
    search.finish(termination, control)
}

struct Global<'a> {
    cell: &'a Cell,
    index: Index,
    count: usize,
    options: &'a GlobalOptions,
    schedule: Schedule,
    pool: Pool,
    chains: Vec<Chain>,
    best: Option<Plan>,
    completed: u64,
    improvements: Vec<RoundReport>,
}

impl<'a> Global<'a> {
    fn new(cell: &'a Cell, index: Index, count: usize, options: &'a GlobalOptions) -> Result<Self> {
        let local = Local::new(cell, index, count, &options.given, &options.load, options.accept.as_ref())?
            .with_apart(options.apart(index));
        let inputs = Inputs::new(cell, index)?;
        let outputs = inputs.kernel_outputs(true);
        let criterion = criterion(cell, index)?;
        let n = cell.setup.robot.joint_count();
        let accept = options.accept.as_ref();
        let single = match index {
            Index::Prediction => {
                let (none, design): ([Vec<f64>; 0], _) = ([], LoadDesign::default());
                let one = Local::new(cell, index, 1, &none, &design, accept)?;
                Some(one.with_apart(options.apart(index)))
            }
            _ => None,
        };
        let schedule = Schedule::new(index, count, !cell.scene.is_empty());
        let pool = Pool::new(cell, outputs, options.seed, options.accept.as_ref())?;
        let chain = Chain::new(local, single, criterion, index, n, &pool);
        Ok(Global {
            cell,
            index,
            count,
            options,
            schedule,
            pool,
            chains: vec![chain; schedule.chains],
            best: None,
            completed: 0,
            improvements: Vec::new(),
        })
    }

    /// Rounds until the budget is used up or nothing improves any more.
    fn rounds(&mut self, control: Control<'_>, watch: &mut dyn FnMut(&RoundReport)) -> Result<Termination> {
        let begin = Instant::now();
        let limit = self.options.time_limit;
        let over = || limit.is_some_and(|limit| begin.elapsed() >= limit);
        let fixed = self.options.rounds;
        // With a time limit alone the search goes on until it is over.
        let most = fixed.unwrap_or(match limit {
            Some(_) => u64::MAX,
            None => self.schedule.rounds,
        });
        let mut idle = 0;
        while self.completed < most {
            let before = self.best.as_ref().map(|plan| plan.value);
            let saved = self.chains.clone();
            // The first round is worth finishing: there is nothing else to show.
            let stop = || control.stopped() || (self.completed > 0 && over());
            let inner = Control { stop: Some(&stop), progress: None };
            let mut chains = std::mem::take(&mut self.chains);
            let complete = self.round(&mut chains, inner);
            self.chains = chains;
            if !complete {
                if self.completed > 0 {
                    // Half a round cannot be reproduced.
                    self.chains = saved;
                } else {
                    self.gather();
                }
                return Ok(if control.stopped() { Termination::Interrupted } else { Termination::TimeLimit });
            }
            self.gather();
            self.completed += 1;
            let now = self.best.as_ref().map(|plan| plan.value);
            let report = RoundReport {
                rounds: self.completed,
                evaluations: self.evaluations(),
                value: now.map(|value| self.index.of_log(value)),
            };
            watch(&report);
            if now != before {
                self.improvements.push(report);
            }
            control.report(
                &now.map_or("searching".to_string(), |v| {
                    format!("best {} {:.6}", self.index.as_str(), self.index.of_log(v))
                }),
                self.completed as usize,
                most.min(1 << 30) as usize,
            );
            let improved = match (before, now) {
                (Some(before), Some(now)) => now < before - LEAST_IMPROVEMENT,
                (_, now) => now.is_some(),
            };
            idle = if improved { 0 } else { idle + 1 };
            if over() {
                return Ok(Termination::TimeLimit);
            }
            if fixed.is_none() && limit.is_none() && idle >= self.schedule.patience {
                return Ok(Termination::Converged);
            }
        }
        Ok(Termination::IterationLimit)
    }

    /// One round on every chain, on all cores; false when it was stopped.
    fn round(&self, chains: &mut [Chain], control: Control<'_>) -> bool {
        let work = |(i, chain): (usize, &mut Chain)| {
            let mut rng = chain_rng(self.options.seed, self.completed, i);
            chain.work(&mut rng, &self.pool, self.schedule.tries, control)
        };
        chains
            .par_iter_mut()
            .with_max_len(1)
            .enumerate()
            .map(work)
            // Every chain works: no short cut after the first that was stopped.
            .reduce(|| true, |a, b| a && b)
    }

    /// Takes the best of all chains, and keeps them from doing the same work.
    fn gather(&mut self) {
        let values: Vec<f64> =
            self.chains.iter().map(|chain| chain.best.as_ref().map_or(f64::INFINITY, |p| p.value)).collect();
        let order = ascending(&values);
        if let Some(plan) = self.chains[order[0]].best.clone()
            && self.best.as_ref().is_none_or(|b| plan.value < b.value)
        {
            self.best = Some(plan);
        }
        if self.index.has_many_local_minima() {
            self.spread();
        } else if (self.completed + 1).is_multiple_of(MIGRATION)
            && let Some(best) = self.best.clone()
        {
            // Few minima: the best one is worth more than another look around.
            for chain in order.iter().rev().take(SHARING) {
                self.chains[*chain].move_to(best.clone());
            }
        }
    }

    /// Restarts chains that have come to the same minimum. Many local minima lie
    /// in a few wide valleys; left alone, one chain after the other ends in the
    /// widest, and none looks elsewhere any more. The best minimum keeps a few
    /// chains, which refine it, every other one a single chain.
    fn spread(&mut self) {
        let values: Vec<f64> = self.chains.iter().map(Chain::value).collect();
        let mut minimum = f64::NEG_INFINITY;
        let (mut most, mut there) = (0, 0);
        for chain in ascending(&values) {
            if !values[chain].is_finite() {
                continue;
            }
            if values[chain] - minimum > SAME_MINIMUM {
                most = if there == 0 { SHARING } else { 1 };
                (minimum, there) = (values[chain], 0);
            }
            there += 1;
            if there > most {
                self.chains[chain].restart();
            }
        }
    }

    /// The best plan searched to the end, with everything that is to be said of it.
    fn finish(mut self, termination: Termination, control: Control<'_>) -> Result<Selection> {
        let fixed_postures = &self.options.given;
        let n = self.cell.setup.robot.joint_count();
        let Some(best) = self.best.take() else {
            return Err(self.nothing(termination));
        };
        let local = &mut self.chains[0].local;
        // Under the index prediction no posture can be moved alone to any use, and together they take too long.
        let is_done = self.index == Index::Prediction;
        let mut plan = if is_done {
            best
        } else {
            // Part of what the completed rounds give; without any a stop ends it, too.
            let control = if self.completed == 0 { control } else { Control::default() };
            let plan = local.improve(best.x.clone(), Effort::Full, control);
            if best.value < plan.value { best } else { plan }
        };
        let mut iterations = 0;
        let mut stationarity = None;
        let mut evaluations = self.evaluations();
        // The polish takes a second at most and belongs to the result of the
        // completed rounds; without any there is nothing to reproduce.
        if self.options.load.is_empty() && self.completed > 0 && !is_done {
            let rough = plan.clone();
            let (polished, solution) = polish::polish(self.cell, self.index, plan, n, fixed_postures)?;
            plan = if self.chains[0].local.accepts(&polished.x) { polished } else { rough };
            if let Some(solution) = solution {
                evaluations += solution.evaluations;
                iterations = solution.iterations;
                stationarity = solution.stationarity;
            }
        }
        let (angles, load) = plan.x.split_at(n * self.count);
        let cell = self.options.load.applied(self.cell, load);
        let group: Vec<Vec<f64>> = angles.chunks_exact(n).map(<[f64]>::to_vec).collect();
        let all: Vec<&Vec<f64>> = fixed_postures.iter().chain(&group).collect();
        let evaluation = evaluate(&cell, self.index.as_str(), &all)?;
        let value =
            evaluation.indices.get(self.index).ok_or_else(|| no_result(&cell, self.index, &evaluation, termination))?;
        let limits = limits_of(&cell, &group)?;
        Ok(Selection {
            index: self.index,
            value,
            start_value: None,
            evaluation,
            given: fixed_postures.len(),
            termination,
            rounds: Some(self.completed),
            improvements: self.improvements,
            starts: self.chains.iter().map(|c| c.effort().0 as usize).sum(),
            evaluations,
            iterations,
            stationarity,
            smallest_margin_m: smallest_length(&limits),
            limits,
            load: (!self.options.load.is_empty()).then(|| cell.setup.clone().into()),
            group,
        })
    }

    /// Why nothing was found.
    fn nothing(&self, termination: Termination) -> Error {
        let random = random_group(self.cell, StartKind::Uniform, self.count, self.options.seed, 0);
        let random = match random {
            Ok(group) => group,
            Err(error) => return error,
        };
        let all: Vec<&Vec<f64>> = self.options.given.iter().chain(&random).collect();
        match evaluate(self.cell, "start", &all) {
            Ok(evaluation) => {
                let error = no_result(self.cell, self.index, &evaluation, termination);
                let apart = all.len() > 1 && self.options.apart(self.index);
                if apart && error.code() == Code::InvalidValue { too_near(all.len()) } else { error }
            }
            Err(error) => error,
        }
    }

    fn evaluations(&self) -> u64 {
        self.chains.iter().map(|c| c.effort().1).sum()
    }
}
