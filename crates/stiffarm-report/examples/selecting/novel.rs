//! What the paper's index does when it is minimised: from random groups by the
//! local search of the paper's procedure, and globally.

use crate::plans::{Plan, quantiles};
use serde::Serialize;
use stiffarm::Control;
use stiffarm::Result;
use stiffarm::internals::optimise::Options;
use stiffarm::model::cell::Cell;
use stiffarm::plan::index::Index;
use stiffarm::plan::select::{StartKind, random_group, select_from};

/// Initial groups of each kind for the local search.
const STARTS: u64 = 30;
/// Seeds of the global search.
const SEEDS: u64 = 5;
/// Random groups to compare with.
const RANDOM: u64 = 200;

/// One group in the picture.
#[derive(Debug, Clone, Serialize)]
pub struct Point {
    pub novel: f64,
    /// Mean expected deviation (fraction).
    pub mean_expected_deviation: f64,
}

/// Where one global search stands after some rounds.
#[derive(Debug, Clone, Serialize)]
pub struct Stage {
    pub seed: u64,
    pub rounds: u64,
    pub novel: f64,
    pub classical: f64,
    pub condition: f64,
    pub mean_expected_deviation: f64,
}

/// Everything the section on the paper's index says about one cell.
#[derive(Debug, Serialize)]
pub struct NovelIndex {
    pub cell: String,
    /// Group 1 itself.
    pub group1: Plan,
    /// Group 1 improved locally, the paper's Group 3.
    pub from_group1: Plan,
    /// The best of all global searches.
    pub best: Plan,
    /// The smallest cond(Ψ), whatever k(J_N) is.
    pub smallest_condition: Plan,
    pub expected_error: Plan,
    /// Postures of `best` that violate the limits of the default cell.
    pub best_outside_default_limits: usize,
    /// Random groups, not improved, and the rank correlation of index and
    /// mean expected deviation among them.
    pub random: Vec<Point>,
    pub random_rank_correlation: f64,
    /// Local minima of the novel index from random groups and from groups with
    /// small wrist angles.
    pub local: Vec<Point>,
    pub local_rank_correlation: f64,
    /// Those of them that are better than the median of the random groups.
    pub local_better_than_random: usize,
    /// Global searches.
    pub global: Vec<Stage>,
}

impl NovelIndex {
    /// Looks at the global searches after each of `rounds`.
    pub fn new(cell: &Cell, group1: &[Vec<f64>], rounds: &[u64], default: &Cell) -> Result<Self> {
        let local_from = |start: &[Vec<f64>]| {
            let found = select_from(cell, Index::Novel, start, Options::default(), Control::default())?;
            Plan::new(cell, "novel, local", &found.group)
        };
        let count = group1.len();
        let mut random = Vec::new();
        let mut local = Vec::new();
        for kind in [StartKind::Uniform, StartKind::SmallWrist] {
            for stream in 0..STARTS {
                let start = random_group(cell, kind, count, 1, stream)?;
                local.push(point(&local_from(&start)?));
            }
        }
        for stream in 0..RANDOM {
            let group = random_group(cell, StartKind::Uniform, count, 1, stream)?;
            random.push(point(&Plan::new(cell, "random", &group)?));
        }
        let mut global = Vec::new();
        let mut best: Option<Plan> = None;
        for seed in 1..=SEEDS {
            for &rounds in rounds {
                let plan = Plan::select(cell, Index::Novel, count, seed, rounds)?;
                global.push(Stage {
                    seed,
                    rounds,
                    novel: plan.index(Index::Novel),
                    classical: plan.index(Index::Classical),
                    condition: plan.index(Index::Condition),
                    mean_expected_deviation: plan.mean_expected_deviation,
                });
                let value = |p: &Plan| p.index(Index::Novel);
                if best.as_ref().is_none_or(|b| value(&plan) < value(b)) {
                    best = Some(plan);
                }
            }
        }
        let best = best.expect("there are seeds and rounds");
        let deviations = random.iter().map(|p| p.mean_expected_deviation);
        let [_, median, _] = quantiles(deviations.collect());
        let better = local.iter().filter(|p| p.mean_expected_deviation < median);
        let mut outside = 0;
        for q in &best.group {
            let margin = stiffarm::plan::select::smallest_margin(default, std::slice::from_ref(q))?;
            outside += usize::from(margin.is_some_and(|m| m < -1e-9));
        }
        Ok(NovelIndex {
            cell: cell.name.clone(),
            group1: Plan::new(cell, "Group 1", group1)?,
            from_group1: local_from(group1)?,
            best,
            smallest_condition: Plan::select(cell, Index::Condition, count, 1, 8)?,
            expected_error: Plan::select(cell, Index::ExpectedError, count, 1, 8)?,
            best_outside_default_limits: outside,
            random_rank_correlation: rank_correlation(&random),
            random,
            local_rank_correlation: rank_correlation(&local),
            local_better_than_random: better.count(),
            local,
            global,
        })
    }
}

fn point(plan: &Plan) -> Point {
    Point { novel: plan.index(Index::Novel), mean_expected_deviation: plan.mean_expected_deviation }
}

/// Spearman's rank correlation of index and mean expected deviation.
fn rank_correlation(points: &[Point]) -> f64 {
    let ranks = |value: fn(&Point) -> f64| {
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|a, b| value(&points[*a]).total_cmp(&value(&points[*b])));
        let mut ranks = vec![0.0; points.len()];
        for (rank, at) in order.into_iter().enumerate() {
            ranks[at] = rank as f64 - 0.5 * (points.len() as f64 - 1.0);
        }
        ranks
    };
    let (a, b) = (ranks(|p| p.novel), ranks(|p| p.mean_expected_deviation));
    let products: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
    products / a.iter().map(|a| a * a).sum::<f64>()
}
