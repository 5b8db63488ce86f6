//! One of several independent searches: local minima of a chain of changed
//! groups (iterated local search), with its own random numbers.

use super::exchange::{Base, PoolJudge};
use super::local::{Effort, Local};
use super::plan::Plan;
use super::pool::Pool;
use crate::numerics::control::Control;
use crate::plan::index::Index;
use crate::plan::index::criterion::Criterion;
use crate::plan::select::exchange::Exchange;
use crate::plan::select::predicting::PredictionJudge;
use nalgebra::DMatrix;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Candidates of one exchange.
const CANDIDATES: usize = 128;
/// Tries without improvement after which a chain starts afresh.
const PATIENCE: usize = 60;
/// A rough search that ends within this of ln(index) of the incumbent goes on.
const NEAR_INCUMBENT: f64 = 0.01;
/// Largest shift of an angle when postures are shaken \[rad\].
const SHAKE: f64 = 0.5;

/// Sweeps over the postures of a group, one after the other, and the gain in ln(index) for which there is another.
const SWEEPS: usize = 6;
const WORTH_A_SWEEP: f64 = 3e-3;

/// A few passes are enough for a start.
const ROUGH: Exchange<'_> = Exchange { passes: 4, least: 1e-6, repeats: true, stop: &|| false };

/// Under the index prediction they are the start.
const START: Exchange<'_> = Exchange { passes: 8, ..ROUGH };

/// What the index prediction needs.
#[derive(Debug, Clone)]
struct Predicting {
    judge: PredictionJudge,
    /// The search for one posture beside others.
    single: Local,
    /// Readings of the given postures.
    base_rows: DMatrix<f64>,
}

/// A chain with its incumbent.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    pub local: Local,
    criterion: Criterion,
    base: Base,
    /// Under the index prediction alone.
    predicting: Option<Predicting>,
    joints: usize,
    count: usize,
    /// Where the chain is now.
    current: Option<Plan>,
    /// The best it ever was.
    pub best: Option<Plan>,
    idle: usize,
}

impl Chain {
    pub fn new(
        local: Local,
        single: Option<Local>,
        criterion: Criterion,
        index: Index,
        joints: usize,
        pool: &Pool,
    ) -> Self {
        let base = Base::new(index, local.fixed_postures(), criterion.triangle());
        let predicting = local.prediction().zip(single);
        let predicting = predicting.map(|(prediction, single)| Predicting {
            judge: pool.judge(prediction, local.keeps_from()),
            base_rows: prediction.base_readings(),
            single,
        });
        let count = local.angle_count() / joints;
        Chain { local, criterion, base, predicting, joints, count, current: None, best: None, idle: 0 }
    }

    /// Local searches and evaluations of the index with its gradient so far.
    pub fn effort(&self) -> (u64, u64) {
        let single = self.predicting.as_ref().map(|predicting| &predicting.single);
        let all = [Some(&self.local), single];
        let all = all.into_iter().flatten();
        all.fold((0, 0), |sum, local| (sum.0 + local.searches, sum.1 + local.evaluations))
    }

    /// Puts the chain onto another plan.
    pub fn move_to(&mut self, plan: Plan) {
        self.current = Some(plan);
        self.idle = 0;
    }

    /// Leaves the minimum where the chain is for a fresh group.
    pub fn restart(&mut self) {
        self.current = None;
        self.idle = 0;
    }

    /// ln of the index where the chain is now, infinite where it starts afresh.
    pub fn value(&self) -> f64 {
        let current = self.current.as_ref();
        current.map_or(f64::INFINITY, |plan| plan.value)
    }

    /// `tries` local searches with the random numbers of this round; false
    /// when it was stopped before the last.
    pub fn work(&mut self, rng: &mut ChaCha8Rng, pool: &Pool, tries: usize, control: Control<'_>) -> bool {
        for attempt in 0..tries {
            if control.stopped() {
                return false;
            }
            let start = match &self.current {
                Some(_) if self.idle < PATIENCE => self.changed(rng, pool, control),
                _ => {
                    self.current = None;
                    self.fresh(rng, pool, attempt % 2 == 0, control)
                }
            };
            let plan = match self.predicting {
                Some(_) => self.each_in_turn(start, control),
                None => self.together(start, control),
            };
            if !plan.value.is_finite() {
                self.idle += 1;
                continue;
            }
            let better = |old: &Option<Plan>| old.as_ref().is_none_or(|old| plan.value < old.value - 1e-9);
            if better(&self.best) {
                self.best = Some(plan.clone());
            }
            if better(&self.current) {
                self.current = Some(plan);
                self.idle = 0;
            } else {
                self.idle += 1;
            }
            // A search that was stopped cannot be reproduced.
            if control.stopped() {
                return false;
            }
        }
        true
    }

    /// The local minimum near `start` over all postures.
    fn together(&mut self, start: Vec<f64>, control: Control<'_>) -> Plan {
        let plan = self.local.improve(start, Effort::Rough, control);
        // Compare the end of the valley, not where a rough search stops.
        let near = |old: &Option<Plan>| old.as_ref().is_none_or(|old| plan.value < old.value + NEAR_INCUMBENT);
        if plan.value.is_finite() && near(&self.current) {
            self.local.refine(plan, Effort::Fine, control)
        } else {
            plan
        }
    }

    /// Where no posture of a group near `start` can be moved alone to make the index prediction better: beside the
    /// others an evaluation costs no more with fifty postures than with six.
    fn each_in_turn(&mut self, start: Vec<f64>, control: Control<'_>) -> Plan {
        let n = self.joints;
        let mut plan = self.local.judge(start);
        for _ in 0..SWEEPS {
            let before = plan.value;
            for p in 0..self.count {
                if control.stopped() {
                    return plan;
                }
                let (others, Some(rows)) = beside(&self.local, &plan.x, n, p) else {
                    continue;
                };
                let Some(predicting) = &mut self.predicting else {
                    break;
                };
                let held_postures = self.local.held_postures().iter().map(Vec::as_slice);
                let held_postures: Vec<&[f64]> = others.into_iter().chain(held_postures).collect();
                predicting.single.hold([&predicting.base_rows, &rows], &held_postures);
                let improved = predicting.single.improve(plan.x[p * n..(p + 1) * n].to_vec(), Effort::Rough, control);
                let mut x = plan.x.clone();
                x[p * n..(p + 1) * n].copy_from_slice(&improved.x);
                let next = self.local.judge(x);
                if next.value < plan.value {
                    plan = next;
                }
            }
            if plan.value > before - WORTH_A_SWEEP {
                break;
            }
        }
        plan
    }

    /// A new group: random, or the best exchange among random candidates.
    fn fresh(&mut self, rng: &mut ChaCha8Rng, pool: &Pool, by_exchange: bool, control: Control<'_>) -> Vec<f64> {
        self.idle = 0;
        let judge = self.predicting.as_mut().map(|predicting| &mut predicting.judge);
        let of = judge.as_ref().map_or(pool.len(), |judge| judge.len());
        let mut chosen: Vec<usize> = (0..self.count).map(|_| rng.random_range(0..of)).collect();
        if let Some(judge) = judge {
            let candidates: Vec<usize> = (0..of).collect();
            let stop = || control.stopped();
            let exchange = Exchange { stop: &stop, repeats: self.local.keeps_from().is_none(), ..START };
            exchange.run(judge, &mut chosen, &candidates);
        } else if by_exchange && self.is_known(pool) {
            let candidates: Vec<usize> = (0..CANDIDATES).map(|_| rng.random_range(0..pool.len())).collect();
            let mut judge = PoolJudge::new(&mut self.criterion, &self.base, pool);
            ROUGH.run(&mut judge, &mut chosen, &candidates);
        }
        let mut x: Vec<f64> = chosen.iter().flat_map(|at| pool.angles(*at).iter().copied()).collect();
        self.add_load(rng, &mut x);
        x
    }

    /// Puts a candidate in the place of posture `p`: that which is worth most, or where that cannot be told any.
    fn exchange(&mut self, rng: &mut ChaCha8Rng, pool: &Pool, x: &mut [f64], p: usize) {
        let n = self.joints;
        let best = self.predicting.as_mut().and_then(|predicting| {
            let (others, rows) = beside(&self.local, x, n, p);
            predicting.judge.hold_rows(&rows?, &others);
            predicting.judge.best()
        });
        let at = best.unwrap_or_else(|| rng.random_range(0..pool.len()));
        x[p * n..(p + 1) * n].copy_from_slice(pool.angles(at));
    }

    /// True when the pool's information is that of the search: it is not where
    /// the load is free.
    fn is_known(&self, pool: &Pool) -> bool {
        let (lower, _) = self.local.bounds();
        lower.len() == self.local.angle_count() && (!pool.information(0).is_empty() || self.base.uses_dexterity)
    }

    /// Load variables at random within their boxes.
    fn add_load(&self, rng: &mut ChaCha8Rng, x: &mut Vec<f64>) {
        let (lower, upper) = self.local.bounds();
        for (low, high) in lower.iter().zip(upper).skip(self.local.angle_count()) {
            x.push(low + (high - low) * rng.random::<f64>());
        }
    }

    /// The incumbent with some postures replaced or shaken.
    fn changed(&mut self, rng: &mut ChaCha8Rng, pool: &Pool, control: Control<'_>) -> Vec<f64> {
        let Some(current) = &self.current else {
            return self.fresh(rng, pool, false, control);
        };
        let mut x = current.x.clone();
        let n = self.joints;
        let most = (self.count / 3).clamp(1, 6);
        let many = 1 + rng.random_range(0..most);
        let kind: u32 = rng.random_range(0..4);
        for _ in 0..many {
            let p = rng.random_range(0..self.count);
            let posture = &mut x[p * n..(p + 1) * n];
            match kind {
                0 => {
                    let (lower, upper) = self.local.bounds();
                    for (j, q) in posture.iter_mut().enumerate() {
                        let shift = SHAKE * (2.0 * rng.random::<f64>() - 1.0);
                        *q = (*q + shift).clamp(lower[j], upper[j]);
                    }
                }
                1 => {
                    // One joint of the posture anywhere.
                    let (lower, upper) = self.local.bounds();
                    let j = rng.random_range(0..n);
                    posture[j] = lower[j] + (upper[j] - lower[j]) * rng.random::<f64>();
                }
                _ => self.exchange(rng, pool, &mut x, p),
            }
        }
        if self.local.bounds().0.len() > self.local.angle_count() && rng.random::<f64>() < 0.3 {
            x.truncate(self.local.angle_count());
            self.add_load(rng, &mut x);
        }
        x
    }
}

/// The free postures of `x` but `p`, `joints` angles each, and their readings; `None` where a load has no direction.
fn beside<'a>(local: &Local, x: &'a [f64], joints: usize, p: usize) -> (Vec<&'a [f64]>, Option<DMatrix<f64>>) {
    let others = x[..local.angle_count()].chunks_exact(joints).enumerate();
    let others: Vec<&[f64]> = others.filter(|(i, _)| *i != p).map(|(_, q)| q).collect();
    let rows = local.prediction().and_then(|prediction| prediction.readings(&others));
    (others, rows)
}
