//! Candidate postures inside bounds and limits, drawn once per selection, with
//! their information and k(J_N).

use crate::error::{Error, Result};
use crate::model::cell::Cell;
use crate::numerics::streams::{candidate_rng, uniform};
use crate::plan::feasibility::nothing_meets;
use crate::plan::index::kernel::{Kernel, KernelOutputs};
use crate::plan::index::prediction::PredictionFunction;
use crate::plan::select::accept::Accept;
use crate::plan::select::predicting::PredictionJudge;
use crate::plan::select::repair::repair;

/// Candidates wanted.
const SIZE: usize = 1024;
/// Of them, those that the index prediction chooses from: more gain nothing.
const PREDICTING: usize = 256;
/// Draws before the ones that were found must do.
const MAX_DRAWS: usize = 200_000;
/// With fewer candidates than this, random postures are moved inside the limits.
const TOO_FEW: usize = 64;
/// Attempts at that.
const REPAIRS: usize = 256;
/// Lanes are filled this many postures at a time.
const CHUNK: usize = 64;

/// Feasible candidates; information in packed lower triangles.
#[derive(Debug, Clone)]
pub(super) struct Pool {
    joints: usize,
    triangle: usize,
    angles: Vec<f64>,
    information: Vec<f64>,
    log_dexterity: Vec<f64>,
}

impl Pool {
    /// Draws the candidates of `seed`.
    ///
    /// # Errors
    /// No posture inside the limits was found.
    pub fn new(cell: &Cell, outputs: KernelOutputs<'_>, seed: u64, accept: Option<&Accept>) -> Result<Self> {
        let n = cell.setup.robot.joint_count();
        let springs = cell.setup.robot.spring_count();
        let mut kernel = Kernel::new(cell, outputs, CHUNK)?;
        let mut rng = candidate_rng(seed);
        let mut pool = Pool {
            joints: n,
            triangle: springs * (springs + 1) / 2,
            angles: Vec::new(),
            information: Vec::new(),
            log_dexterity: Vec::new(),
        };
        let (mut drawn, mut inside) = (0, 0);
        let mut outside = Vec::new();
        let mut draw = |q: &mut Vec<f64>| {
            q.clear();
            for _ in 0..CHUNK {
                q.extend(uniform(&cell.bounds, &mut rng));
            }
        };
        // Most postures are outside of limits that cost less than shapes: those never meet a shape.
        let mut margins = cell.posture_margins()?;
        let mut meets = |q: &[f64]| margins.least(q).is_ok_and(|least| least >= 0.0);
        let (mut q, mut ready) = (Vec::new(), Vec::new());
        while pool.len() < SIZE && drawn < MAX_DRAWS {
            draw(&mut q);
            drawn += CHUNK;
            let postures = q.chunks_exact(n);
            ready.extend(postures.filter(|q| cell.scene.is_empty() || meets(q)).flatten());
            if ready.len() >= CHUNK * n {
                let rest = ready.split_off(CHUNK * n);
                inside += pool.take(&mut kernel, &ready, outputs, accept);
                ready = rest;
            }
            if outside.len() < REPAIRS * n {
                outside.extend_from_slice(&q);
            }
        }
        inside += pool.take(&mut kernel, &ready, outputs, accept);
        if pool.len() < TOO_FEW {
            outside.truncate(REPAIRS * n);
            for chunk in repair(cell, &outside)?.chunks(CHUNK * n) {
                inside += pool.take(&mut kernel, chunk, outputs, accept);
            }
        }
        if pool.len() == 0 && inside > 0 {
            let message = format!(
                "None of {inside} random postures inside bounds and limits is accepted by your own constraint."
            );
            return Err(Error::invalid(message).key("accept"));
        }
        if pool.len() == 0 {
            return Err(nothing_meets(cell, drawn));
        }
        Ok(pool)
    }

    /// Number of candidates.
    pub fn len(&self) -> usize {
        self.angles.len() / self.joints
    }

    /// Controller angles of one candidate \[rad\].
    pub fn angles(&self, at: usize) -> &[f64] {
        &self.angles[at * self.joints..(at + 1) * self.joints]
    }

    /// Information of one candidate, packed; empty where the index has none.
    pub fn information(&self, at: usize) -> &[f64] {
        if self.information.is_empty() { &[] } else { &self.information[at * self.triangle..(at + 1) * self.triangle] }
    }

    /// ln k(J_N) of one candidate, 0 where the index does not use it.
    pub fn log_dexterity(&self, at: usize) -> f64 {
        self.log_dexterity.get(at).copied().unwrap_or(0.0)
    }

    /// The first candidates as the index prediction judges them, in their order; where `fixed_postures` are to be kept
    /// away from, no two of a group may be alike either.
    pub fn judge(&self, function: &PredictionFunction, fixed_postures: Option<&[Vec<f64>]>) -> PredictionJudge {
        let angles: Vec<Vec<f64>> = (0..self.len().min(PREDICTING)).map(|at| self.angles(at).to_vec()).collect();
        // A load without a direction shows nothing.
        let none = function.model().stacked(&[]).all;
        let readings = |q: &Vec<f64>| function.readings(&[q]).unwrap_or_else(|| none.clone());
        let each: Vec<_> = angles.iter().map(readings).collect();
        let judge = PredictionJudge::new(function.model(), &each, Some(function.base_readings()));
        match fixed_postures {
            Some(fixed_postures) => judge.apart(angles, fixed_postures),
            None => judge,
        }
    }

    /// Keeps those of a chunk of postures, or of fewer, that are inside the limits and accepted; how many are inside.
    fn take(&mut self, kernel: &mut Kernel, q: &[f64], outputs: KernelOutputs<'_>, accept: Option<&Accept>) -> usize {
        if q.is_empty() {
            return 0;
        }
        // Lanes without a posture of their own repeat the last one.
        let last = q[q.len() - self.joints..].iter().cycle();
        let filled: Vec<f64> = q.iter().chain(last).copied().take(CHUNK * self.joints).collect();
        kernel.forward(&filled);
        let postures = q.len() / self.joints;
        let inside = kernel.violations().map(|v| v <= 0.0);
        let inside: Vec<bool> = inside.take(postures).collect();
        for (p, q) in q.chunks_exact(self.joints).enumerate() {
            if !inside[p] || self.len() == SIZE || accept.is_some_and(|constraint| !constraint.accepts(q)) {
                continue;
            }
            self.angles.extend_from_slice(q);
            if outputs.information.is_some() {
                self.information.extend(kernel.information(p));
            }
            if outputs.dexterity.is_some() {
                self.log_dexterity.push(kernel.log_dexterity(p));
            }
        }
        inside.iter().filter(|inside| **inside).count()
    }
}
