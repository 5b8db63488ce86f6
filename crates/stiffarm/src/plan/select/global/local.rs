//! One local search over all postures of a group, and over the load where that
//! is free: smooth quasi-Newton steps with ever sharper smoothing of the
//! index's kinks, the cell's limits as an augmented Lagrangian.

use super::plan::Plan;
use crate::error::Result;
use crate::model::cell::Cell;
use crate::numerics::control::Control;
use crate::numerics::optimise::smooth::{SmoothOptions, minimise_smooth};
use crate::plan::index::inputs::FixedPostures;
use crate::plan::index::prediction::PredictionFunction;
use crate::plan::index::{Index, IndexFunction};
use crate::plan::select::accept::Accept;
use crate::plan::select::load_design::LoadDesign;
use crate::plan::select::predicting::alike;
use nalgebra::DMatrix;

/// Margin kept from every limit \[m\]: hundredths of a millimetre, so that the
/// penalty need not be driven to rounding errors.
const GUARD: f64 = 1e-5;
/// First quadratic weight of the limits \[1/m²\], and its growth by stage.
const FIRST_WEIGHT: f64 = 1e3;
const WEIGHT_GROWTH: f64 = 10.0;
/// Beyond it a quadratic weight only makes the problem stiff.
const LARGEST_WEIGHT: f64 = 1e5;
/// Stages after the smoothing's own until every limit is met.
const LIMIT_STAGES: usize = 6;
/// Smoothing p of the kinks, stage by stage.
const SHARPNESS: [f64; 3] = [10.0, 100.0, 1000.0];
/// Of an index without kinks.
const SMOOTH: [f64; 1] = [1.0];

/// How thorough a local search is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effort {
    /// To compare many.
    Rough,
    /// For those that come near the best.
    Fine,
    /// To the end.
    Full,
}

impl Effort {
    fn options(self) -> SmoothOptions {
        match self {
            Effort::Rough => SmoothOptions { max_iterations: 150, optimality: 1e-3, reduction: 1e-6 },
            Effort::Fine => SmoothOptions { max_iterations: 400, optimality: 1e-5, reduction: 1e-9 },
            Effort::Full => SmoothOptions { max_iterations: 3000, optimality: 1e-7, reduction: 1e-13 },
        }
    }
}

/// Searches over groups of a fixed number of postures beside those that are held.
#[derive(Debug, Clone)]
pub(super) struct Local {
    function: IndexFunction,
    stages: &'static [f64],
    has_limits: bool,
    design: LoadDesign,
    accept: Option<Accept>,
    /// Whether no two postures may be as good as the same.
    apart: bool,
    joints: usize,
    /// Angles of the postures that are not searched for: the fixed ones, or those that [`Self::hold`] named last.
    held_postures: Vec<Vec<f64>>,
    angles: usize,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// Quadratic weight of the limits now.
    weight: f64,
    /// Evaluations of the index with its gradient so far.
    pub evaluations: u64,
    /// Local searches so far.
    pub searches: u64,
}

impl Local {
    pub fn new<Q: AsRef<[f64]>>(
        cell: &Cell,
        index: Index,
        count: usize,
        fixed_postures: &[Q],
        design: &LoadDesign,
        accept: Option<&Accept>,
    ) -> Result<Self> {
        let function = IndexFunction::build(cell, index, count, fixed_postures, true)?;
        let n = cell.setup.robot.joint_count();
        let has_kinks = function.has_extreme_singular_values() || function.component_count() > 0;
        let bounds = |side: usize| -> Vec<f64> {
            let angles = cell.bounds.iter().map(|b| b[side]).cycle().take(n * count);
            angles.chain(design.bounds().iter().map(|b| b[side])).collect()
        };
        Ok(Local {
            stages: if has_kinks { &SHARPNESS } else { &SMOOTH },
            has_limits: function.kernel().limit_count() > 0,
            function,
            design: design.clone(),
            accept: accept.cloned(),
            apart: false,
            joints: n,
            held_postures: fixed_postures.iter().map(|q| q.as_ref().to_vec()).collect(),
            angles: n * count,
            lower: bounds(0),
            upper: bounds(1),
            weight: FIRST_WEIGHT,
            evaluations: 0,
            searches: 0,
        })
    }

    /// The same; with `apart` no two postures may be as good as the same.
    pub fn with_apart(mut self, apart: bool) -> Self {
        self.apart = apart;
        self
    }

    /// Angles of the postures that are not searched for \[rad\], from which others keep apart where they have to.
    pub fn keeps_from(&self) -> Option<&[Vec<f64>]> {
        self.apart.then_some(self.held_postures.as_slice())
    }

    /// Angles of the postures that are not searched for \[rad\].
    pub fn held_postures(&self) -> &[Vec<f64>] {
        &self.held_postures
    }

    /// The postures that are measured whatever the search does.
    pub fn fixed_postures(&self) -> &FixedPostures {
        self.function.fixed_postures()
    }

    /// Lower and upper bounds of all variables.
    pub fn bounds(&self) -> (&[f64], &[f64]) {
        (&self.lower, &self.upper)
    }

    /// Number of controller angles among the variables.
    pub fn angle_count(&self) -> usize {
        self.angles
    }

    /// ln of the index at `x`, infinite where it does not exist, a limit is violated or the caller's
    /// own constraint does not accept a posture.
    pub fn judge(&mut self, x: Vec<f64>) -> Plan {
        self.design.apply(&x[self.angles..], &mut self.function);
        let value = self.function.value(&x[..self.angles]);
        let met = !self.has_limits || self.function.kernel().violation() <= 0.0;
        let met = met && (!self.apart || self.are_apart(&x));
        // Asked last: it may be slow.
        let met = met && value.is_finite() && self.accepts(&x);
        Plan { x, value: if met { value } else { f64::INFINITY } }
    }

    /// True where no two postures of `x` are as good as the same.
    fn are_apart(&self, x: &[f64]) -> bool {
        let free = x[..self.angles].chunks_exact(self.joints);
        let held = self.held_postures.iter().map(Vec::as_slice);
        let postures: Vec<&[f64]> = held.chain(free).collect();
        let alike = |p: usize| postures[..p].iter().any(|other| alike(other, postures[p]));
        !(self.held_postures.len()..postures.len()).any(alike)
    }

    /// True where the caller's own constraint accepts all postures of `x`.
    pub fn accepts(&self, x: &[f64]) -> bool {
        let accept = self.accept.as_ref();
        accept.is_none_or(|accept| accept.accepts_all(&x[..self.angles], self.joints))
    }

    /// The index prediction.
    pub fn prediction(&self) -> Option<&PredictionFunction> {
        self.function.prediction()
    }

    /// Holds these readings beside the one posture that is searched for, which is to be none of `postures`.
    pub fn hold(&mut self, rows: [&DMatrix<f64>; 2], postures: &[&[f64]]) {
        self.held_postures = postures.iter().map(|q| q.to_vec()).collect();
        if let Some(function) = self.function.prediction_mut() {
            function.hold(rows);
        }
    }

    /// The local minimum near `start`, or `start` itself where that is better or a stop of `control` ends the search.
    pub fn improve(&mut self, start: Vec<f64>, effort: Effort, control: Control<'_>) -> Plan {
        self.searches += 1;
        let begin = self.judge(start);
        if self.has_limits {
            self.weight = FIRST_WEIGHT;
            self.function.kernel_mut().reset_penalty(FIRST_WEIGHT, GUARD);
        }
        self.descend(begin, 0, effort, control)
    }

    /// Goes on from the plan that [`improve`](Self::improve) returned last.
    pub fn refine(&mut self, plan: Plan, effort: Effort, control: Control<'_>) -> Plan {
        self.descend(plan, self.stages.len() - 1, effort, control)
    }

    /// The stages from `first` on, and then more until the limits are met.
    fn descend(&mut self, begin: Plan, first: usize, effort: Effort, control: Control<'_>) -> Plan {
        let mut x = begin.x.clone();
        let mut best = begin;
        let last = self.stages.len() - 1;
        for stage in first..self.stages.len() + LIMIT_STAGES {
            let end = self.minimise(x, self.stages[stage.min(last)], effort, control);
            let end = self.judge(end);
            x = end.x.clone();
            if end.value < best.value {
                best = end;
            }
            let met = !self.has_limits || self.function.kernel().violation() <= 0.0;
            if stage >= last && met || control.stopped() {
                break;
            }
            if self.has_limits {
                let kernel = self.function.kernel_mut();
                kernel.update_multipliers();
                self.weight = (self.weight * WEIGHT_GROWTH).min(LARGEST_WEIGHT);
                kernel.set_penalty_weight(self.weight);
            }
        }
        best
    }

    fn minimise(&mut self, x: Vec<f64>, sharpness: f64, effort: Effort, control: Control<'_>) -> Vec<f64> {
        let Local { function, design, angles, .. } = self;
        let angles = *angles;
        let solution = minimise_smooth(
            &mut |x, gradient| {
                let (q, load) = x.split_at(angles);
                let (by_q, by_load) = gradient.split_at_mut(angles);
                design.apply(load, function);
                let value = function.smoothed(q, sharpness, by_q);
                design.gradient(function, by_load);
                value.objective
            },
            &self.lower,
            &self.upper,
            &x,
            effort.options(),
            control,
        );
        self.evaluations += solution.evaluations;
        solution.x
    }
}
