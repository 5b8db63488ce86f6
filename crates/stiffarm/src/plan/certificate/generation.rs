//! The steps of the column generation: weights on the points met so far, and
//! what a search of the space adds to them.

use super::criterion::{Criterion, Prepared, Tangent, trace_of_product};
use super::design::{ContinuousDesign, DesignOptions, DesignSpace, Effort, Verification};
use super::weights::{WeightProblem, near_optimal_weights, optimal_weights};
use crate::error::{Code, Error, Result};
use crate::findings::list;
use crate::numerics::control::Termination;
use crate::numerics::information::{GRAM_ROUNDING, symmetric_eigen};
use crate::numerics::order::{order_by_number, sort_by_number};
use nalgebra::DMatrix;

/// Points whose information differs by less than this share of the tolerance
/// are one point.
const SAME_POINT_SHARE: f64 = 1e-2;
/// Of points found by one round of searches and as near as this, the best is kept.
const CLOSE_POINTS: f64 = 2e-3;
/// Points this near are merged in the final design, if it stays as good.
const MERGED_POINTS: f64 = 2e-2;
/// Points of this weight and more count for [`Verification::rarest`], and
/// searches that end this near to them.
const HEAVY_WEIGHT: f64 = 0.01;
const AROUND: f64 = 0.2;
/// Most points that one round adds.
const MOST_ADDED: usize = 64;
/// Most starts that get weights before the first search; weights cost the cube
/// of their number.
const MOST_STARTS: usize = 128;
/// Weights below this share of the tolerance (of 1e-3 at most) are dropped.
const ZERO_WEIGHT: f64 = 0.02;
/// Weights below these shares of the tolerance are dropped from the final
/// design, the first that leaves it as good.
const SMALL_WEIGHTS: [f64; 2] = [10.0, 1.0];
/// Equivalence condition asked for on the points at hand.
const WEIGHT_TOLERANCE: f64 = 1e-9;
/// Unknowns for which a Hessian of the weights is worth it.
const FEW_UNKNOWNS: usize = 32;
/// With more, points of the design that the search goes on from: all would be hundreds.
const HEAVIEST: usize = 16;
/// Passes of taking back points that were dropped.
const RECALLS: usize = 8;
/// Unknowns whose column is below this share of the largest have no information.
const ZERO_COLUMN: f64 = 1e-10;
/// Share of a null vector above which an unknown is named.
const NULL_SHARE: f64 = 1e-3;

struct Point {
    x: Vec<f64>,
    information: DMatrix<f64>,
}

/// State of the column generation.
pub(super) struct Generation<'a, S> {
    space: &'a S,
    criterion: Prepared,
    /// B, n × n.
    prior_information: DMatrix<f64>,
    /// B + ε R: what M₀ holds besides the weighted points.
    constant: DMatrix<f64>,
    /// 1 − ε.
    share: f64,
    tolerance: f64,
    /// Every point met so far.
    pool: Vec<Point>,
    searches: usize,
}

impl<'a, S: DesignSpace> Generation<'a, S> {
    pub(super) fn new(
        space: &'a S,
        criterion: &Criterion,
        prior_information: Option<&DMatrix<f64>>,
        starts: &[Vec<f64>],
        options: DesignOptions,
    ) -> Result<Self> {
        let n = space.unknowns();
        if !(options.tolerance > 0.0 && options.tolerance < 1.0) || options.max_rounds == 0 {
            return Err(Error::invalid("A bound needs a tolerance between 0 and 1 and at least one round."));
        }
        if n == 0 || starts.is_empty() {
            return Err(Error::new(Code::TooFewData, "A bound needs unknowns, and points to start from."));
        }
        let prior_information = prior_information.cloned().unwrap_or_else(|| DMatrix::zeros(n, n));
        if prior_information.shape() != (n, n) {
            return Err(Error::new(Code::Dimension, "The information given beforehand has the wrong size."));
        }
        let finite = |m: &DMatrix<f64>| m.iter().all(|v| v.is_finite());
        if !finite(&prior_information) {
            return Err(Error::new(Code::NotFinite, "The information given beforehand is not finite."));
        }
        let mut generation = Generation {
            space,
            criterion: criterion.prepare(n)?,
            constant: prior_information.clone(),
            prior_information,
            share: 1.0,
            tolerance: options.tolerance,
            pool: Vec::new(),
            searches: 0,
        };
        for x in starts {
            let information = space.information(x);
            if !finite(&information) || information.shape() != (n, n) {
                return Err(Error::new(Code::NotFinite, "The information of a starting point is not finite."));
            }
            // Only exact duplicates are left out: a design made of the starts
            // is never better than the bound.
            if generation.pool.iter().all(|p| p.information != information) {
                let x = x.clone();
                generation.pool.push(Point { x, information });
            }
        }
        let mut mean = DMatrix::zeros(n, n);
        for point in &generation.pool {
            mean += &point.information;
        }
        mean /= generation.pool.len() as f64;
        let unknown = undetermined(&(&generation.prior_information + &mean));
        if !unknown.is_empty() {
            let names: Vec<String> = unknown.iter().map(|&i| space.unknown_name(i)).collect();
            return Err(Error::new(Code::NotIdentifiable, format!("No design can determine {}.", list(&names)))
                .hint("check shows which joints no posture determines, and why"));
        }
        if generation.criterion.singular {
            let share = 0.25 * options.tolerance;
            generation.constant += mean * share;
            generation.share = 1.0 - share;
        }
        Ok(generation)
    }

    /// The points a design starts from: some of the starts, spread over all of
    /// them, or all where some do not determine every unknown.
    pub(super) fn start(&self) -> Vec<usize> {
        let all = 0..self.pool.len();
        let some: Vec<usize> = all.clone().step_by(all.len().div_ceil(MOST_STARTS)).collect();
        let equal = vec![1.0 / some.len() as f64; some.len()];
        match self.tangent(&some, &equal) {
            Ok(_) => some,
            Err(_) => all.collect(),
        }
    }

    /// Searches so far.
    pub(super) fn searches(&self) -> usize {
        self.searches
    }

    /// Adds a point, unless one with the same information is there; its number.
    fn add(&mut self, x: Vec<f64>, information: DMatrix<f64>) -> usize {
        let same = SAME_POINT_SHARE * self.tolerance;
        let same = |p: &Point| distance(&p.information, &information) <= same;
        match self.pool.iter().position(same) {
            Some(at) => at,
            None => {
                self.pool.push(Point { x, information });
                self.pool.len() - 1
            }
        }
    }

    /// Optimal weights on the pool, starting from its `active` points. Leaves
    /// in `active` the points with a weight; their weights sum to 1.
    pub(super) fn solve(&self, active: &mut Vec<usize>) -> Result<Vec<f64>> {
        let mut weights = self.weigh(active)?;
        for _ in 0..RECALLS {
            // Points dropped in an earlier round may be wanted again.
            let tangent = self.tangent(active, &weights)?;
            let slope = |i: usize| trace_of_product(&tangent.adjoint, &self.pool[i].information);
            let highest = active.iter().map(|&i| slope(i)).fold(0.0, f64::max);
            let level = highest * (1.0 + 0.01 * self.tolerance);
            let mut recalled: Vec<usize> =
                (0..self.pool.len()).filter(|i| slope(*i) > level && !active.contains(i)).collect();
            sort_by_number(&mut recalled, |a| -slope(*a));
            recalled.truncate(MOST_ADDED);
            if recalled.is_empty() {
                break;
            }
            let before = active.clone();
            active.extend(recalled);
            weights = self.weigh(active)?;
            // Their weights were too small again, and would be in every further pass.
            if *active == before {
                break;
            }
        }
        Ok(weights)
    }

    /// Optimal weights on the `active` points; those without one are dropped.
    fn weigh(&self, active: &mut Vec<usize>) -> Result<Vec<f64>> {
        let points: Vec<DMatrix<f64>> = active.iter().map(|&i| &self.pool[i].information * self.share).collect();
        let problem = WeightProblem { criterion: &self.criterion, constant: &self.constant, points: &points };
        let all = if problem.constant.ncols() > FEW_UNKNOWNS {
            near_optimal_weights(&problem, 0.5 * self.tolerance)
        } else {
            optimal_weights(&problem, WEIGHT_TOLERANCE)
        };
        let all = all.ok_or_else(singular)?;
        let zero = ZERO_WEIGHT * self.tolerance.min(1e-3);
        let (support, mut weights): (Vec<usize>, Vec<f64>) =
            active.iter().copied().zip(all).filter(|(_, w)| *w > zero).unzip();
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|w| *w /= sum);
        *active = support;
        Ok(weights)
    }

    /// M₀ of weighted points of the pool.
    fn total(&self, active: &[usize], weights: &[f64]) -> DMatrix<f64> {
        let mut total = self.constant.clone();
        for (i, w) in active.iter().zip(weights) {
            total += &self.pool[*i].information * (self.share * w);
        }
        total
    }

    fn tangent(&self, active: &[usize], weights: &[f64]) -> Result<Tangent> {
        let total = self.total(active, weights);
        self.criterion.at(&total).ok_or_else(singular)
    }

    /// The design of the weighted points, with the largest tr(A·G(x)) over the
    /// whole space, and the points found that improve it.
    pub(super) fn search(&mut self, active: &[usize], weights: &[f64]) -> Result<(ContinuousDesign, Vec<usize>)> {
        let information = self.total(active, weights);
        let tangent = self.criterion.at(&information).ok_or_else(singular)?;
        let support: Vec<Vec<f64>> = active.iter().map(|&i| self.pool[i].x.clone()).collect();
        let order = order_by_number(active.len(), |i| -weights[i]);
        let mut from = support.clone();
        if self.prior_information.ncols() > FEW_UNKNOWNS {
            from = (order.iter().take(HEAVIEST).map(|i| support[*i].clone())).collect();
        }
        let maxima = self.space.maximise(&tangent.adjoint, &from, Effort::Improve);
        let mut design = ContinuousDesign {
            points: order.iter().map(|&i| support[i].clone()).collect(),
            weights: order.iter().map(|&i| weights[i]).collect(),
            value: tangent.value,
            level: tangent.level,
            largest: 0.0,
            residual: f64::INFINITY,
            bound: 0.0,
            rounds: 0,
            searches: 0,
            verification: Verification::default(),
            termination: Termination::Stalled,
            information,
            adjoint: tangent.adjoint,
        };
        // Points met before count as well: the bound never exceeds the value
        // of a design made of them.
        for point in &self.pool {
            let slope = trace_of_product(&design.adjoint, &point.information);
            design.largest = design.largest.max(slope);
        }
        let improving = self.take(&mut design, maxima);
        Ok((design, improving))
    }

    /// Searches as widely as the space can; the points found that improve the design.
    pub(super) fn verify(&mut self, design: &mut ContinuousDesign) -> Vec<usize> {
        let maxima = self.space.maximise(&design.adjoint, &[], Effort::Verify);
        let searches = maxima.len();
        let reached = maxima.clone();
        let improving = self.take(design, maxima);
        let near = design.largest * (1.0 - self.tolerance);
        let mut agreeing = 0;
        let support: Vec<DMatrix<f64>> = design
            .points
            .iter()
            .zip(&design.weights)
            .filter(|(_, weight)| **weight >= HEAVY_WEIGHT)
            .map(|(x, _)| self.space.information(x))
            .collect();
        let mut hits = vec![0; support.len()];
        for (x, _) in reached.iter().filter(|(_, value)| *value >= near) {
            agreeing += 1;
            let information = self.space.information(x);
            for (hits, at) in hits.iter_mut().zip(&support) {
                *hits += usize::from(distance(at, &information) <= AROUND);
            }
        }
        design.verification = Verification { searches, agreeing, rarest: hits.into_iter().min().unwrap_or(0) };
        improving
    }

    /// Counts found points in the design's bound, and adds those that improve
    /// the design to the pool; their numbers.
    fn take(&mut self, design: &mut ContinuousDesign, maxima: Vec<(Vec<f64>, f64)>) -> Vec<usize> {
        self.searches += maxima.len();
        let prior_slope = trace_of_product(&design.adjoint, &self.prior_information);
        let mut improving: Vec<usize> = Vec::new();
        for (x, value) in maxima {
            if !value.is_finite() {
                continue;
            }
            design.largest = design.largest.max(value);
            if value <= design.level - prior_slope || improving.len() == MOST_ADDED {
                continue;
            }
            let information = self.space.information(&x);
            let close = |&i: &usize| distance(&self.pool[i].information, &information) <= CLOSE_POINTS;
            if improving.iter().any(close) || information.iter().any(|v| !v.is_finite()) {
                continue;
            }
            let at = self.add(x, information);
            improving.push(at);
        }
        design.residual = (prior_slope + design.largest) / design.level - 1.0;
        design.bound = design.value / (1.0 + design.residual);
        improving
    }

    /// The design without near duplicates and small weights, and its points in
    /// the pool, if that is as good as the tolerance asks. `improving` are the
    /// local maxima that the search from the design found: where there is one
    /// near points of the design, it takes their place.
    pub(super) fn tidied(
        &mut self,
        active: &[usize],
        weights: &[f64],
        improving: &[usize],
    ) -> Result<Option<(ContinuousDesign, Vec<usize>)>> {
        let order = order_by_number(active.len(), |i| -weights[i]);
        for small in SMALL_WEIGHTS {
            let heavy =
                order.iter().filter(|at| weights[**at] > small * self.tolerance.min(1e-3)).map(|at| active[*at]);
            let merged = self.apart(heavy.clone());
            if merged.len() == active.len() {
                return Ok(None);
            }
            let mut distinct = self.apart(improving.iter().copied().chain(heavy));
            // Fewer points may leave an unknown undetermined.
            let Ok(weights) = self.weigh(&mut distinct) else {
                continue;
            };
            let (design, _) = self.search(&distinct, &weights)?;
            if design.residual <= self.tolerance {
                return Ok(Some((design, distinct)));
            }
        }
        Ok(None)
    }

    /// Points of the pool without those that are near an earlier one.
    fn apart(&self, points: impl Iterator<Item = usize>) -> Vec<usize> {
        let mut distinct: Vec<usize> = Vec::new();
        for i in points {
            let near = |&k: &usize| {
                let [a, b] = [k, i].map(|i| &self.pool[i].information);
                distance(a, b) <= MERGED_POINTS
            };
            if !distinct.iter().any(near) {
                distinct.push(i);
            }
        }
        distinct
    }
}

fn singular() -> Error {
    Error::new(Code::Numerical, "The information of the continuous design is singular to rounding.")
}

/// ‖a − b‖ relative to the larger of both.
fn distance(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    let scale = a.norm().max(b.norm());
    if scale == 0.0 { 0.0 } else { (a - b).norm() / scale }
}

/// Unknowns that an information matrix does not determine, ascending.
fn undetermined(information: &DMatrix<f64>) -> Vec<usize> {
    let n = information.nrows();
    let largest = information.diagonal().max();
    let scale: Vec<f64> = information.diagonal().iter().map(|d| if *d > 0.0 { d.sqrt() } else { 0.0 }).collect();
    let empty = |i: usize| scale[i] <= ZERO_COLUMN * largest.sqrt();
    let scaled =
        DMatrix::from_fn(
            n,
            n,
            |i, j| {
                if empty(i) || empty(j) { 0.0 } else { information[(i, j)] / (scale[i] * scale[j]) }
            },
        );
    let Some((values, vectors)) = symmetric_eigen(scaled) else {
        return (0..n).collect();
    };
    let zero = n as f64 * GRAM_ROUNDING * values[n - 1];
    (0..n).filter(|&i| empty(i) || (0..n).any(|v| values[v] <= zero && vectors[(i, v)].abs() > NULL_SHARE)).collect()
}
