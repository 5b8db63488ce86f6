//! Groups of candidates judged by the index `prediction`.

use crate::plan::index::prediction::{Equations, GroupCovariance, PredictionModel, Rows};
use crate::plan::select::exchange::Judge;
use nalgebra::DMatrix;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Postures that differ by less in every joint are one posture to a plan \[rad\].
const SAME_POSTURE_ANGLE: f64 = 15.0 / 180.0 * PI;

/// True where two postures are as good as the same, whole turns of a joint aside.
pub(super) fn alike(a: &[f64], b: &[f64]) -> bool {
    let off = |a: &f64, b: &f64| {
        let turned = (a - b).abs() % TAU;
        turned.min(TAU - turned)
    };
    a.iter().zip(b).all(|(a, b)| off(a, b) < SAME_POSTURE_ANGLE)
}

/// The readings of candidates, beside those that are taken in any case.
#[derive(Debug, Clone)]
pub(super) struct PredictionJudge {
    targets: Rows,
    /// Rows of all candidates, one below the other, and which are whose.
    all: DMatrix<f64>,
    of: Vec<Range<usize>>,
    base: Option<DMatrix<f64>>,
    /// Angles of the candidates \[rad\] where no two of a group may be alike; empty where they may.
    angles: Vec<Vec<f64>>,
    fixed_postures: Vec<Vec<f64>>,
    /// Candidates that are like one of those held or given.
    barred: Vec<bool>,
    /// What each candidate would take from the error, and the error without any.
    gains: Option<(Vec<f64>, f64)>,
}

impl PredictionJudge {
    /// Of candidates with these readings under `model`, beside readings that are taken in any case.
    pub(super) fn new(model: &PredictionModel, each: &[DMatrix<f64>], base: Option<DMatrix<f64>>) -> Self {
        let mut from = 0;
        let of = each.iter().map(|rows| {
            from += rows.nrows();
            from - rows.nrows()..from
        });
        PredictionJudge {
            of: of.collect(),
            all: model.stacked(each).all,
            targets: model.targets().clone(),
            base,
            angles: Vec::new(),
            fixed_postures: Vec::new(),
            barred: vec![false; each.len()],
            gains: None,
        }
    }

    /// Number of candidates.
    pub(super) fn len(&self) -> usize {
        self.of.len()
    }

    /// The same where no group holds two postures that are alike, or one like the `fixed_postures`.
    pub(super) fn apart(mut self, angles: Vec<Vec<f64>>, fixed_postures: &[Vec<f64>]) -> Self {
        self.angles = angles;
        self.fixed_postures = fixed_postures.to_vec();
        self
    }

    /// Holds readings instead of candidates, with the postures they belong to.
    pub(super) fn hold_rows(&mut self, rows: &DMatrix<f64>, postures: &[&[f64]]) {
        let mut equations = self.equations();
        equations.add(rows);
        self.barred = self.like(postures);
        self.count(&equations);
    }

    /// The best candidate beside what is held, `None` where none is.
    pub(super) fn best(&self) -> Option<usize> {
        let gains = &self.gains.as_ref()?.0;
        let free = (0..gains.len()).filter(|c| self.barred.get(*c) != Some(&true));
        free.max_by(|a, b| gains[*a].total_cmp(&gains[*b]))
    }

    /// The mean square error of a mixture of all candidates, and what more of each would take from it.
    pub(super) fn weighted(&self, weights: &[f64]) -> Option<(f64, Vec<f64>)> {
        let mut rows = self.all.clone();
        for (range, weight) in self.of.iter().zip(weights) {
            rows.rows_mut(range.start, range.len()).scale_mut(weight.sqrt());
        }
        let mut equations = self.equations();
        equations.add(&rows);
        let held = GroupCovariance::new(&equations, &self.targets)?;
        let seen = held.seen(&self.all);
        let score = |range: &Range<usize>| seen.rows(range.start, range.len()).norm_squared();
        Some((held.error, self.of.iter().map(score).collect()))
    }

    fn equations(&self) -> Equations {
        let mut equations = Equations::new(self.targets.all.ncols(), self.targets.fixed);
        self.base.iter().for_each(|rows| equations.add(rows));
        equations
    }

    /// Which candidates are like a posture that is held or given.
    fn like(&self, held: &[&[f64]]) -> Vec<bool> {
        let fixed = self.fixed_postures.iter().map(Vec::as_slice);
        let held: Vec<&[f64]> = held.iter().copied().chain(fixed).collect();
        let like_one = |q: &Vec<f64>| held.iter().any(|other| alike(other, q));
        self.angles.iter().map(like_one).collect()
    }

    fn count(&mut self, equations: &Equations) {
        let held = GroupCovariance::new(equations, &self.targets);
        self.gains = held.and_then(|held| Some((held.gains(&self.all, &self.of)?, held.error)));
    }
}

impl Judge for PredictionJudge {
    fn hold(&mut self, rest: &[usize]) {
        let mut equations = self.equations();
        for range in rest.iter().map(|c| &self.of[*c]) {
            equations.add(&self.all.rows(range.start, range.len()).into_owned());
        }
        let held = rest.iter().filter_map(|c| self.angles.get(*c));
        self.barred = self.like(&held.map(Vec::as_slice).collect::<Vec<_>>());
        self.count(&equations);
    }

    fn with(&mut self, candidate: usize) -> f64 {
        match &self.gains {
            Some((gains, error)) if self.barred.get(candidate) != Some(&true) => {
                0.5 * (error - gains[candidate]).max(0.0).ln()
            }
            _ => f64::INFINITY,
        }
    }
}
