//! One local search over all postures of a group: the index with its epigraph
//! variable, and the limits of the cell that matter.
//!
//! Logarithms inside the search. ln(index) turns the product of the novel index
//! into a sum and makes tolerances relative.

use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::numerics::control::Control;
use crate::numerics::optimise::{Evaluation, Minimum, Options, Problem};
use crate::plan::active_limits::{ActiveLimits, LimitedProblem, minimise_within_limits};
use crate::plan::index::{Index, IndexFunction};

/// First size of the move off a singular start \[rad\], doubled each time.
const FIRST_NUDGE: f64 = 5e-3;
/// Moves off a singular start before it counts as hopeless.
const NUDGES: u32 = 5;
/// Range of the epigraph variable, the logarithm of an index part.
const EPIGRAPH_RANGE: [f64; 2] = [-200.0, 200.0];

/// Limits closer than this are constraints of a search round \[m\].
const WATCH_DISTANCE: f64 = 0.5;
/// Rounds of adding crossed limits.
const WATCH_ROUNDS: usize = 12;
/// Stages of the smoothing of coalescing singular values; the last is off by
/// at most ln(6)/p = 3·10⁻⁵ of the index.
pub(super) const SHARPNESS: &[Option<f64>] = &[Some(30.0), Some(300.0), Some(3e3), Some(3e4), Some(6e4)];
/// The last of them.
pub(super) const LAST: &[Option<f64>] = &[Some(3e3), Some(3e4), Some(6e4)];

/// The search's variables: the controller angles of all postures \[rad\], and
/// the epigraph variable where the index has components.
pub(super) struct Search<'a> {
    function: IndexFunction,
    bounds: Vec<[f64; 2]>,
    /// Number of controller angles of all postures.
    angles: usize,
    /// Number of components of the index; there is an epigraph variable if any.
    components: usize,
    limits: ActiveLimits<'a>,
}

impl<'a> Search<'a> {
    /// A search over groups of `count` postures beside the `fixed_postures`.
    ///
    /// # Errors
    /// The cell lacks what the index needs.
    pub(super) fn new<Q: AsRef<[f64]>>(
        cell: &'a Cell,
        index: Index,
        count: usize,
        fixed_postures: &[Q],
    ) -> Result<Self> {
        let function = IndexFunction::with_given(cell, index, count, fixed_postures)?;
        let components = function.component_count();
        let n = cell.setup.robot.joint_count();
        let mut bounds: Vec<[f64; 2]> = cell.bounds.iter().copied().cycle().take(n * count).collect();
        if components > 0 {
            bounds.push(EPIGRAPH_RANGE);
        }
        Ok(Search { function, bounds, angles: n * count, components, limits: ActiveLimits::new(cell, WATCH_DISTANCE)? })
    }

    /// Searches from the controller angles `start`, posture by posture \[rad\], through the stages [`SHARPNESS`], or
    /// through [`LAST`] where it is a local minimum of the index smoothed with p = 1000.
    ///
    /// # Errors
    /// A start that is not finite.
    pub(super) fn run(
        mut self,
        mut start: Vec<f64>,
        sharpness: &'static [Option<f64>],
        options: Options,
        control: Control<'_>,
    ) -> Result<Minimum> {
        self.leave_singularity(&mut start);
        if self.components > 0 {
            start.push(0.0);
        }
        // Where singular values coalesce the gradient of cond(Ψ) jumps, as that
        // of max k(J_N) does: the first is smoothed ever more sharply, the
        // second has its epigraph variable.
        let stages: &[Option<f64>] = if self.function.has_extreme_singular_values() { sharpness } else { &[None] };
        let mut solution: Option<Minimum> = None;
        for sharpness in stages {
            self.function.set_sharpness(*sharpness);
            let before = solution.clone();
            // The next stage is a restart, too.
            let mut options = options;
            if Some(sharpness) != stages.last() {
                options.restarts = 0;
            }
            let budget = |used: u64| Options { max_iterations: options.max_iterations.saturating_sub(used), ..options };
            let after = minimise_within_limits(&mut self, &start, solution, WATCH_ROUNDS, budget, control)?;
            solution = Some(after.or_as_optimal_as(before, options.optimality));
        }
        solution.ok_or_else(|| Error::new(Code::Internal, "A selection without a stage."))
    }

    /// Moves a start at which the index does not exist (a singular posture,
    /// equal postures) a little, always the same way, until it does. A start
    /// that stays without an index is left as it was.
    fn leave_singularity(&mut self, start: &mut [f64]) {
        if self.function.evaluate(start).value().is_finite() {
            return;
        }
        for attempt in 0..NUDGES {
            let size = FIRST_NUDGE * f64::from(1 << attempt);
            let moved: Vec<f64> = start
                .iter()
                .zip(&self.bounds)
                .enumerate()
                .map(|(i, (x, b))| {
                    let i = i as u32;
                    let shift = f64::from(sobol_burley::sample(attempt + 1, i % 256, i / 256));
                    (x + size * (2.0 * shift - 1.0)).clamp(b[0], b[1])
                })
                .collect();
            if self.function.evaluate(&moved).value().is_finite() {
                start.copy_from_slice(&moved);
                return;
            }
        }
    }
}

impl<'a> LimitedProblem<'a> for Search<'a> {
    fn limits(&mut self) -> (&mut ActiveLimits<'a>, usize) {
        (&mut self.limits, self.angles)
    }
}

impl Problem for Search<'_> {
    fn bounds(&self) -> &[[f64; 2]] {
        &self.bounds
    }

    fn margin_count(&self) -> usize {
        self.components + self.limits.count()
    }

    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        let (q, epigraph) = x.split_at(self.angles);
        let variables = self.bounds.len();
        let margins = self.margin_count();
        let minimax = self.function.evaluate(q);
        let merit = minimax.value();
        let mut out = Evaluation {
            objective: minimax.smooth,
            gradient: minimax.smooth_gradient,
            margins: vec![0.0; margins],
            margin_gradients: vec![0.0; margins * variables],
            merit,
            violation: 0.0,
        };
        if let [t] = epigraph {
            // Epigraph: minimise smooth + t with t ≥ every component.
            out.objective += t;
            out.gradient.push(1.0);
            let rows = out.margin_gradients.chunks_exact_mut(variables);
            let components = minimax.component_gradients.chunks_exact(self.angles);
            for (c, (row, component)) in rows.zip(components).enumerate() {
                out.margins[c] = t - minimax.components[c];
                for (g, d) in row.iter_mut().zip(component) {
                    *g = -d;
                }
                row[self.angles] = 1.0;
            }
        }
        self.limits.add_to(&mut out, q, self.components, variables);
        out
    }

    fn prepare(&mut self, x: &mut [f64]) {
        if self.components == 0 {
            return;
        }
        // The smallest feasible t at these postures.
        let (q, t) = x.split_at_mut(self.angles);
        let largest = self.function.evaluate(q).components.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        t[0] = if largest.is_finite() { largest } else { EPIGRAPH_RANGE[1] };
    }
}
