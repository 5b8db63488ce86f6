//! The inner loop of every search: information, k(J_N) and margins of a group
//! of postures with their derivatives, four postures at a time, without
//! allocation. The modules `observation` and `dexterity` define what it computes;
//! tests hold it against them.
//!
//! One kernel for loops. Every search spends its time in value and gradient of
//! a group, so these are one fused sweep over four postures at a time (this
//! file) instead of calls of the modules below it; it repeats their formulas
//! and the tests hold it against them. It replaced four copies of the whitening
//! and two of the adjoint. Lanes are plain arrays; where the processor has AVX2
//! the same code is compiled for it (the one `unsafe` in the project: twice as
//! fast, and the same bytes because no fused operations are used).

mod batch;
mod dexterity;
mod forward;
pub(crate) mod lanes;
mod left_out;
mod limits;
mod model;
mod reverse;
mod scene;

pub(crate) use left_out::LeftOut;
pub use model::KernelOutputs;

use crate::error::Result;
use crate::model::cell::Cell;
use batch::Batch;
use lanes::{Lanes, WIDTH};
use model::{KernelLoad, Model};
use scene::SceneKernel;

/// A group of postures in lanes, under each load of the cell.
#[derive(Debug, Clone)]
pub struct Kernel {
    /// One per load; a posture counts with the sum over them.
    cases: Vec<LoadKernel>,
    count: usize,
}

/// All postures under one load.
#[derive(Debug, Clone)]
struct LoadKernel {
    model: Model,
    batches: Vec<Batch>,
    /// What shapes, beams and torques ask, where limits are wanted.
    scene: Option<Box<SceneKernel>>,
}

impl Kernel {
    /// A kernel for groups of `count` postures.
    ///
    /// # Errors
    /// A load that only a measurement gives; k(J_N) with fewer than six joints.
    pub fn new(cell: &Cell, outputs: KernelOutputs<'_>, count: usize) -> Result<Self> {
        let each = cell.limit_cases().into_iter().enumerate();
        let cases = each.map(|(number, case)| {
            let outputs = KernelOutputs {
                // k(J_N) is the posture's, whatever the load.
                dexterity: outputs.dexterity.filter(|_| number == 0),
                ..outputs
            };
            LoadKernel::new(&case, outputs, count)
        });
        let cases = cases.collect::<Result<_>>()?;
        Ok(Kernel { cases, count })
    }

    /// Number of postures.
    pub fn posture_count(&self) -> usize {
        self.count
    }

    /// Number of joints.
    pub fn joint_count(&self) -> usize {
        self.cases[0].model.joints
    }

    /// Computes everything at the controller angles `q`, posture by posture \[rad\].
    pub fn forward(&mut self, q: &[f64]) {
        let count = self.count;
        for case in &mut self.cases {
            case.forward(q, count);
        }
    }

    /// Adds the information of all postures to `total` (lower triangle, row by row).
    pub fn add_information(&self, total: &mut [f64]) {
        for case in &self.cases {
            for (b, batch) in case.batches.iter().enumerate() {
                let live = self.live(b);
                for (sum, entry) in total.iter_mut().zip(&batch.information) {
                    for lane in 0..live {
                        *sum += entry.0[lane];
                    }
                }
            }
        }
    }

    /// Information of one posture, lower triangle row by row.
    pub fn information(&self, posture: usize) -> impl Iterator<Item = f64> {
        let (at, lane) = (posture / WIDTH, posture % WIDTH);
        let (first, others) = (&self.cases[0], &self.cases[1..]);
        let entries = first.batches[at].information.iter().enumerate();
        entries.map(move |(entry, lanes)| {
            let rest = others.iter();
            let rest = rest.map(|case| case.batches[at].information[entry].0[lane]);
            rest.fold(lanes.0[lane], |sum, information| sum + information)
        })
    }

    /// ln k(J_N) of one posture.
    pub fn log_dexterity(&self, posture: usize) -> f64 {
        let (batch, lane) = (&self.cases[0].batches[posture / WIDTH], posture % WIDTH);
        0.5 * (batch.trace.0[lane] * batch.inverse_trace.0[lane]).ln() - 6f64.ln()
    }

    /// Sets the derivative of the index with respect to the information of one
    /// posture, or of all (n × n).
    pub fn set_adjoint(&mut self, posture: Option<usize>, adjoint: &[f64]) {
        for case in &mut self.cases {
            match posture {
                None => {
                    for batch in &mut case.batches {
                        for (lanes, value) in batch.adjoint.iter_mut().zip(adjoint) {
                            *lanes = Lanes::splat(*value);
                        }
                    }
                }
                Some(p) => {
                    let batch = &mut case.batches[p / WIDTH];
                    for (lanes, value) in batch.adjoint.iter_mut().zip(adjoint) {
                        lanes.0[p % WIDTH] = *value;
                    }
                }
            }
        }
    }

    /// Sets the derivative of the index with respect to ln k(J_N) of one posture.
    pub fn set_dexterity_weight(&mut self, posture: usize, weight: f64) {
        self.cases[0].batches[posture / WIDTH].dexterity_weight.0[posture % WIDTH] = weight;
    }

    /// Writes the gradient with respect to all controller angles.
    pub fn reverse(&mut self, gradient: &mut [f64]) {
        gradient.fill(0.0);
        let count = self.count;
        for case in &mut self.cases {
            case.reverse(gradient, count);
        }
    }

    /// Gradient of the last reverse sweep with respect to the rope's anchor
    /// (base axes) and the loading point (flange axes), where there is a single load.
    pub fn load_gradient(&self) -> ([f64; 3], [f64; 3]) {
        let (mut anchor, mut loading) = ([0.0; 3], [0.0; 3]);
        let LoadKernel { model, batches, .. } = &self.cases[0];
        for (b, batch) in batches.iter().enumerate() {
            for lane in 0..self.live(b) {
                let mut local = [0.0; 3];
                for i in 0..3 {
                    anchor[i] += batch.anchor_gradient[i].0[lane];
                    for r in 0..3 {
                        local[i] += batch.rotation[i][r].0[lane] * batch.loading_gradient[r].0[lane];
                    }
                }
                // From the axes of the last joint to those of the flange.
                for i in 0..3 {
                    for k in 0..3 {
                        loading[i] += model.flange_rotation[k][i] * local[k];
                    }
                }
            }
        }
        (anchor, loading)
    }

    /// Moves the rope's anchor \[m, base\], where the single load is a rope.
    pub fn set_anchor(&mut self, to: [f64; 3]) {
        let case = &mut self.cases[0];
        if let KernelLoad::Rope { anchor, .. } = &mut case.model.load {
            *anchor = to;
        }
        if let Some(scene) = &mut case.scene {
            scene.set_anchor(to);
        }
    }

    /// Moves the loading point \[m, flange axes\] of the single load.
    pub fn set_loading_point(&mut self, to: [f64; 3]) {
        let case = &mut self.cases[0];
        if let Some(scene) = &mut case.scene {
            scene.set_loading_point(to);
        }
        let model = &mut case.model;
        let r = &model.flange_rotation;
        for i in 0..3 {
            model.loading_point[i] = model.flange[i] + r[i][0] * to[0] + r[i][1] * to[1] + r[i][2] * to[2];
        }
    }

    /// Number of limits per posture.
    pub fn limit_count(&self) -> usize {
        let of = |case: &LoadKernel| case.batches.first().map_or(0, |batch| batch.margins.len());
        self.cases.iter().map(of).sum()
    }

    /// Penalty of the limits of all postures.
    pub fn penalty(&self) -> f64 {
        let each = self.per_posture(|batch| batch.penalty, |sum, penalty| sum + penalty);
        each.sum()
    }

    /// Largest violation of a limit \[m\], 0 when all are met.
    pub fn violation(&self) -> f64 {
        self.violations().fold(0.0, f64::max)
    }

    /// Violation of each posture's limits \[m\].
    pub fn violations(&self) -> impl Iterator<Item = f64> {
        self.per_posture(|batch| batch.violation, f64::max)
    }

    /// Starts the augmented Lagrangian of the limits afresh: multipliers zero,
    /// quadratic weight `weight` \[1/m²\], margins kept above `guard` \[m\].
    pub fn reset_penalty(&mut self, weight: f64, guard: f64) {
        for batch in self.cases.iter_mut().flat_map(|case| &mut case.batches) {
            batch.multipliers.fill(Lanes::splat(0.0));
            batch.penalty_guard = guard;
        }
        self.set_penalty_weight(weight);
    }

    /// Changes the quadratic weight of the limits \[1/m²\].
    pub fn set_penalty_weight(&mut self, weight: f64) {
        for batch in self.cases.iter_mut().flat_map(|case| &mut case.batches) {
            batch.penalty_weight = weight;
        }
    }

    /// Moves the multipliers after a minimisation; returns how far limits and
    /// multipliers are from optimal \[m\].
    pub fn update_multipliers(&mut self) -> f64 {
        let mut worst = 0.0_f64;
        let count = self.count;
        for case in &mut self.cases {
            for (b, batch) in case.batches.iter_mut().enumerate() {
                worst = worst.max(limits::update_multipliers(batch, live(count, b)));
            }
        }
        worst
    }

    /// A number of each posture, those of its loads put together.
    fn per_posture(
        &self,
        of: impl Fn(&Batch) -> Lanes,
        together: impl Fn(f64, f64) -> f64,
    ) -> impl Iterator<Item = f64> {
        (0..self.count).map(move |p| {
            let of_case = |case: &LoadKernel| of(&case.batches[p / WIDTH]).0[p % WIDTH];
            let (first, others) = (&self.cases[0], &self.cases[1..]);
            let others = others.iter().map(of_case);
            others.fold(of_case(first), &together)
        })
    }

    /// Lanes of batch `b` that hold a posture of their own.
    fn live(&self, b: usize) -> usize {
        live(self.count, b)
    }
}

/// Lanes of batch `b` of `count` postures that hold one of their own.
fn live(count: usize, b: usize) -> usize {
    (count - b * WIDTH).min(WIDTH)
}

impl LoadKernel {
    fn new(cell: &Cell, outputs: KernelOutputs<'_>, count: usize) -> Result<Self> {
        let model = Model::new(cell, outputs)?;
        let scene = if outputs.limits { SceneKernel::new(cell, count)?.map(Box::new) } else { None };
        let margins = model.limit_count + scene.as_ref().map_or(0, |scene| scene.count());
        let batches = vec![Batch::new(&model, margins); count.div_ceil(WIDTH)];
        Ok(LoadKernel { model, batches, scene })
    }

    fn forward(&mut self, q: &[f64], count: usize) {
        let n = self.model.joints;
        for (b, batch) in self.batches.iter_mut().enumerate() {
            for lane in 0..WIDTH {
                // Lanes without a posture of their own repeat the last one.
                let p = (b * WIDTH + lane).min(count - 1);
                for j in 0..n {
                    batch.q[j].0[lane] = q[p * n + j];
                }
            }
            run(Forward(&self.model, batch));
            if self.model.limit_count == 0 {
                batch.penalty = Lanes::splat(0.0);
                batch.violation = Lanes::splat(0.0);
            }
            if let Some(scene) = &mut self.scene {
                for lane in 0..live(count, b) {
                    scene.forward(batch, lane, b * WIDTH + lane, self.model.limit_count);
                }
            }
        }
    }

    fn reverse(&mut self, gradient: &mut [f64], count: usize) {
        let n = self.model.joints;
        for (b, batch) in self.batches.iter_mut().enumerate() {
            run(Reverse(&self.model, batch));
            if self.scene.is_some() {
                batch.add_scene();
            }
            for (row, by_theta) in self.model.coupling.iter().zip(&batch.gradient) {
                // Gradient with respect to q: Cᵀ g.
                for (j, factor) in row {
                    for lane in 0..live(count, b) {
                        gradient[(b * WIDTH + lane) * n + j] += by_theta.0[lane] * factor;
                    }
                }
            }
        }
    }
}

/// Work on four postures at a time.
trait Sweep {
    /// To be inlined always, so that it has the instructions of the function that it is called from.
    fn run(self);
}

/// Runs a sweep with four-wide instructions where the processor has them: the same sums in the same order (no fused
/// multiply-add), so the same bytes.
fn run(sweep: impl Sweep) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has what the function asks for.
        #[allow(unsafe_code)]
        return unsafe { run_avx2(sweep) };
    }
    sweep.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2(sweep: impl Sweep) {
    sweep.run();
}

struct Forward<'a>(&'a Model, &'a mut Batch);

impl Sweep for Forward<'_> {
    #[inline(always)]
    fn run(self) {
        // With a constant number of joints the compiler unrolls.
        match self.0.joints {
            6 => forward::forward(self.0, self.1, 6),
            n => forward::forward(self.0, self.1, n),
        }
    }
}

struct Reverse<'a>(&'a Model, &'a mut Batch);

impl Sweep for Reverse<'_> {
    #[inline(always)]
    fn run(self) {
        match self.0.joints {
            6 => reverse::reverse(self.0, self.1, 6),
            n => reverse::reverse(self.0, self.1, n),
        }
    }
}
