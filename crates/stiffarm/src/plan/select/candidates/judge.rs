//! Groups from a list of candidates, judged by an index.

use super::tangent::Tangent;
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::dexterity;
use crate::model::observation::PostureTerms;
use crate::numerics::information::{posture_information, small::packed};
use crate::plan::index::Index;
use crate::plan::index::criterion::Criterion;
use crate::plan::index::inputs::{Inputs, criterion, log_factor};
use crate::plan::select::exchange::Judge;
use crate::plan::select::predicting::PredictionJudge;
use nalgebra::DMatrix;

/// What branch and bound needs beside the judgement.
pub(super) trait Bounded: Judge + Clone + Send + Sync {
    /// A bound on all groups from the weights of all candidates; `None` where the index
    /// is not convex or the weighted candidates do not determine every joint.
    fn tangent(&mut self, weights: &[f64]) -> Option<Tangent>;
    /// Groups that are compared in a few seconds.
    fn affordable(&self) -> u64;
}

/// An index of the information and of k(J_N).
#[derive(Clone)]
pub(super) struct InformationJudge {
    index: Index,
    criterion: Criterion,
    /// Information of each candidate, packed; empty where the index has none.
    each: Vec<Vec<f64>>,
    log_dexterity: Vec<f64>,
    held: Vec<usize>,
    rest: Vec<f64>,
    total: Vec<f64>,
    less: Vec<f64>,
    largest: f64,
    /// σ \[m\].
    std: f64,
    /// ln of what the value of those held and one more is multiplied by.
    log_factor: f64,
}

impl InformationJudge {
    /// # Errors
    /// The cell lacks what the index needs.
    pub(super) fn new(cell: &Cell, index: Index, terms: &[Vec<PostureTerms>]) -> Result<Self> {
        let inputs = Inputs::new(cell, index)?;
        let outputs = inputs.kernel_outputs(false);
        let robot = &cell.setup.robot;
        let n = robot.spring_count();
        let mut each = Vec::new();
        if let Some((compliance, weight)) = outputs.information {
            for states in terms {
                let mut full = DMatrix::zeros(n, n);
                for state in states {
                    let mut block = state.block(robot);
                    for (mut column, h) in block.column_iter_mut().zip(compliance) {
                        column *= *h;
                    }
                    full += posture_information(&block, weight);
                }
                each.push((0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|at| full[at]).collect());
            }
        }
        let log_dexterity = match outputs.dexterity {
            None => Vec::new(),
            Some(length) => terms
                .iter()
                .map(|states| {
                    let state = &states[0];
                    let point = &state.measuring_points()[0];
                    let k = dexterity::condition_number(state.frames(), point, length);
                    k.map_or(f64::INFINITY, f64::ln)
                })
                .collect(),
        };
        let size = if each.is_empty() { 0 } else { packed(n, 0) };
        Ok(InformationJudge {
            index,
            criterion: criterion(cell, index)?,
            each,
            log_dexterity,
            held: Vec::new(),
            rest: vec![0.0; size],
            total: vec![0.0; size],
            less: vec![0.0; size],
            largest: f64::NEG_INFINITY,
            std: cell.noise.displacement_std(),
            log_factor: 0.0,
        })
    }

    /// ln of the drop-one index of the group whose information is `total`.
    fn drop_one(&mut self, candidate: usize) -> f64 {
        let mut worst = f64::NEG_INFINITY;
        for p in self.held.iter().chain([&candidate]) {
            for ((less, total), v) in self.less.iter_mut().zip(&self.total).zip(&self.each[*p]) {
                *less = total - v;
            }
            worst = worst.max(self.criterion.value(&self.less));
        }
        worst
    }
}

impl Judge for InformationJudge {
    fn hold(&mut self, rest: &[usize]) {
        self.held.clear();
        self.held.extend_from_slice(rest);
        self.log_factor = log_factor(self.index, self.std, (rest.len() + 1) as f64);
        self.rest.fill(0.0);
        self.largest = f64::NEG_INFINITY;
        for p in rest {
            if let Some(information) = self.each.get(*p) {
                for (sum, v) in self.rest.iter_mut().zip(information) {
                    *sum += v;
                }
            }
            if let Some(k) = self.log_dexterity.get(*p) {
                self.largest = self.largest.max(*k);
            }
        }
    }

    fn with(&mut self, candidate: usize) -> f64 {
        let mut value = self.log_factor;
        if let Some(information) = self.each.get(candidate) {
            for ((total, rest), v) in self.total.iter_mut().zip(&self.rest).zip(information) {
                *total = rest + v;
            }
            value += match self.index {
                Index::DropOne => self.drop_one(candidate),
                _ => self.criterion.value(&self.total),
            };
        }
        if let Some(k) = self.log_dexterity.get(candidate) {
            value += self.largest.max(*k);
        }
        value
    }
}

impl Bounded for InformationJudge {
    fn tangent(&mut self, weights: &[f64]) -> Option<Tangent> {
        let n = self.criterion.unknowns();
        let logarithmic = match self.index {
            Index::ExpectedError | Index::Task => false,
            Index::D | Index::O1 => true,
            _ => return None,
        };
        self.total.fill(0.0);
        for (weight, information) in weights.iter().zip(&self.each) {
            for (sum, v) in self.total.iter_mut().zip(information) {
                *sum += weight * v;
            }
        }
        let log = self.criterion.evaluate(&self.total).exact;
        if !log.is_finite() {
            return None;
        }
        // f = index², or 2n ln(index): both convex in the information.
        let (value, factor) = if logarithmic {
            (2.0 * n as f64 * log, 2.0 * n as f64)
        } else {
            ((2.0 * log).exp(), 2.0 * (2.0 * log).exp())
        };
        let adjoint = &self.criterion.adjoint;
        let score = |information: &Vec<f64>| {
            let mut sum = 0.0;
            for i in 0..n {
                for j in 0..=i {
                    let twice = if i == j { 1.0 } else { 2.0 };
                    sum -= twice * adjoint[i * n + j] * information[packed(i, j)];
                }
            }
            sum * factor
        };
        let scores: Vec<f64> = self.each.iter().map(score).collect();
        Some(Tangent::new(
            value,
            weights,
            scores,
            logarithmic.then_some(n),
            log_factor(self.index, self.std, weights.iter().sum()),
        ))
    }

    fn affordable(&self) -> u64 {
        2_000_000
    }
}

impl Bounded for PredictionJudge {
    fn tangent(&mut self, weights: &[f64]) -> Option<Tangent> {
        let (value, scores) = self.weighted(weights)?;
        Some(Tangent::new(value, weights, scores, None, 0.0))
    }

    fn affordable(&self) -> u64 {
        20_000
    }
}
