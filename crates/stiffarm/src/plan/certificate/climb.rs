//! One climb to a local maximum of tr(A·G(q)) over the postures of a cell.

use super::readings::Readings;
use crate::error::Result;
use crate::model::cell::Cell;
use crate::numerics::control::Control;
use crate::numerics::optimise::{Evaluation, Options, Problem};
use crate::plan::active_limits::{ActiveLimits, LimitedProblem, minimise_within_limits};
use nalgebra::DMatrix;

/// Violation of bounds \[rad\] or limits \[m\] that counts as met.
pub(super) const FEASIBILITY: f64 = 1e-9;
/// Limits nearer than this are constraints of a climb \[m\].
pub(super) const WATCH_DISTANCE: f64 = 0.3;
/// Rounds of adding crossed limits.
const WATCH_ROUNDS: usize = 6;
/// Iterations of each round.
const MAX_ITERATIONS: u64 = 200;

/// The search for one local maximum within bounds and limits.
pub(super) struct Climb<'a> {
    cell: &'a Cell,
    adjoint: &'a DMatrix<f64>,
    /// What makes the objective of order one.
    scale: f64,
    readings: Readings,
    limits: ActiveLimits<'a>,
}

impl<'a> Climb<'a> {
    /// A climb on tr(A·G(q)) with A = `adjoint`, n × n; `scale` is about its size.
    ///
    /// # Errors
    /// The cell's load is only known by measurement.
    pub(super) fn new(cell: &'a Cell, readings: &Readings, adjoint: &'a DMatrix<f64>, scale: f64) -> Result<Self> {
        Ok(Climb { cell, adjoint, scale, readings: readings.clone(), limits: ActiveLimits::new(cell, WATCH_DISTANCE)? })
    }

    /// The local maximum reached from `start`, or where a stop leaves it, with its value: minus infinity
    /// where no posture inside the limits was met.
    pub(super) fn run(mut self, start: &[f64], control: Control<'_>) -> Result<(Vec<f64>, f64)> {
        let start: Vec<f64> = start.iter().zip(&self.cell.bounds).map(|(x, b)| x.clamp(b[0], b[1])).collect();
        let options =
            Options { max_iterations: MAX_ITERATIONS, tolerance: 1e-9, feasibility: FEASIBILITY, ..Options::default() };
        let minimum = minimise_within_limits(&mut self, &start, None, WATCH_ROUNDS, |_| options, control)?;
        Ok((minimum.x, -minimum.merit * self.scale))
    }
}

impl<'a> LimitedProblem<'a> for Climb<'a> {
    fn limits(&mut self) -> (&mut ActiveLimits<'a>, usize) {
        (&mut self.limits, self.cell.bounds.len())
    }
}

impl Problem for Climb<'_> {
    fn bounds(&self) -> &[[f64; 2]] {
        &self.cell.bounds
    }

    fn margin_count(&self) -> usize {
        self.limits.count()
    }

    fn evaluate(&mut self, q: &[f64]) -> Evaluation {
        let adjoint = self.adjoint;
        let n = q.len();
        let margins = self.limits.count();
        let mut out = Evaluation {
            objective: f64::INFINITY,
            gradient: vec![0.0; n],
            margins: vec![0.0; margins],
            margin_gradients: vec![0.0; margins * n],
            merit: f64::INFINITY,
            violation: 0.0,
        };
        let value = self.readings.trace(q, adjoint, &mut out.gradient);
        if value.is_finite() {
            out.objective = -value / self.scale;
            out.merit = out.objective;
        }
        for g in &mut out.gradient {
            *g /= -self.scale;
        }
        self.limits.add_to(&mut out, q, 0, n);
        out
    }
}
