//! The one place that talks to the nonlinear programming library: sequential
//! least-squares programming (Kraft 1988, DFVLR-FB 88-28) with box bounds,
//! inequality constraints and closed-form derivatives.

use crate::numerics::control::{Control, Termination};
use basin::{
    BoxBounds, ConstraintSet, ConstraintSolveError, CostFunction, DenseMatrix, Executor, Gradient, NoLinearConstraints,
    NoNonlinearBlock, NonlinearBlock, NonlinearBlocks, SelectedFirstOrderState, Slsqp, TerminationCode,
};
use std::cell::RefCell;

/// A problem at one point: minimise `objective` with every `margins` ≥ 0.
#[derive(Debug, Clone, Default)]
pub struct Evaluation {
    /// Objective.
    pub objective: f64,
    /// Its gradient.
    pub gradient: Vec<f64>,
    /// Constraint margins, each to be ≥ 0.
    pub margins: Vec<f64>,
    /// Their gradients, row by row.
    pub margin_gradients: Vec<f64>,
    /// The value the search is judged by: the objective without its epigraph
    /// variable and without smoothing.
    pub merit: f64,
    /// Largest violation of a hard limit, in its own unit; 0 when all are met.
    pub violation: f64,
}

/// Something to minimise within bounds.
pub trait Problem {
    /// Lower and upper bound of each variable.
    fn bounds(&self) -> &[[f64; 2]];
    /// Number of margins of each evaluation.
    fn margin_count(&self) -> usize {
        0
    }
    /// Value, margins and derivatives at `x`.
    fn evaluate(&mut self, x: &[f64]) -> Evaluation;
    /// Resets dependent variables (an epigraph variable) before each restart.
    fn prepare(&mut self, _x: &mut [f64]) {}
}

/// Budget and tolerance of one minimisation.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// Iterations in all restarts together.
    pub max_iterations: u64,
    /// Restarts with a fresh curvature estimate at most; each must improve.
    pub restarts: usize,
    /// Tolerance on objective change and optimality (both are logarithms of
    /// the index here, so it is a relative one).
    pub tolerance: f64,
    /// Largest violation of a hard limit that counts as met.
    pub feasibility: f64,
    /// Largest ∞-norm of the projected gradient of the Lagrangian that counts
    /// as a local minimum.
    pub optimality: f64,
}

impl Default for Options {
    fn default() -> Self {
        Options { max_iterations: 2000, restarts: 11, tolerance: 1e-10, feasibility: 1e-9, optimality: 5e-3 }
    }
}

/// Result of a minimisation: the best point that meets the hard limits.
#[derive(Debug, Clone)]
pub struct Minimum {
    /// The point; the start where nothing feasible was found.
    pub x: Vec<f64>,
    /// Merit at the point, infinite where nothing feasible was found.
    pub merit: f64,
    /// The last iterate, which may violate limits that were not among the margins.
    pub last: Vec<f64>,
    /// Violation of hard limits at the last iterate.
    pub last_violation: f64,
    /// Why it ended.
    pub termination: Termination,
    /// Iterations used.
    pub iterations: u64,
    /// Evaluations of the problem.
    pub evaluations: u64,
    /// ∞-norm of the projected gradient of the Lagrangian at the last iterate
    /// (first-order optimality), where the solver reports it. When converged,
    /// that iterate is as good as the returned point to `Options::optimality`.
    pub stationarity: Option<f64>,
    /// Largest |multiplier × margin| there.
    pub complementarity: Option<f64>,
}

impl Minimum {
    /// This solution as the continuation of `previous`: the better point of
    /// both, the counts of both, the optimality of this one.
    #[must_use]
    pub fn after(self, previous: Minimum) -> Minimum {
        let keep = previous.merit < self.merit;
        Minimum {
            iterations: previous.iterations + self.iterations,
            evaluations: previous.evaluations + self.evaluations,
            x: if keep { previous.x } else { self.x },
            merit: previous.merit.min(self.merit),
            ..self
        }
    }
}

impl Minimum {
    /// This solution with the optimality of `previous`, where the search
    /// stalled at a point that is hardly better than a converged one: the
    /// sharpest smoothing gains millionths of the index and loses the digits
    /// that optimality is judged by.
    #[must_use]
    pub(crate) fn or_as_optimal_as(self, previous: Option<Minimum>, optimality: f64) -> Minimum {
        match previous {
            Some(before)
                if self.termination == Termination::Stalled
                    && before.termination == Termination::Converged
                    && before.merit - self.merit <= optimality =>
            {
                Minimum {
                    termination: Termination::Converged,
                    stationarity: before.stationarity,
                    complementarity: before.complementarity,
                    ..self
                }
            }
            _ => self,
        }
    }
}

struct Stopped;

struct Cache<'a> {
    problem: &'a mut dyn Problem,
    at: Vec<f64>,
    last: Evaluation,
    best: Option<(f64, Vec<f64>)>,
    evaluations: u64,
}

/// A problem as the library wants to see it.
struct Adapter<'a, 'p> {
    cache: &'a RefCell<Cache<'p>>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    margins: usize,
    feasibility: f64,
    control: Control<'a>,
}

impl Adapter<'_, '_> {
    fn with<T>(&self, x: &[f64], read: impl FnOnce(&Evaluation) -> T) -> Result<T, Stopped> {
        let mut cache = self.cache.borrow_mut();
        if cache.at != x {
            // The start is always evaluated: it is the best so far.
            if cache.evaluations > 0 && self.control.stopped() {
                return Err(Stopped);
            }
            cache.last = cache.problem.evaluate(x);
            cache.at = x.to_vec();
            cache.evaluations += 1;
            let (merit, violation) = (cache.last.merit, cache.last.violation);
            let better = cache.best.as_ref().is_none_or(|(best, _)| merit < *best);
            if violation <= self.feasibility && merit.is_finite() && better {
                cache.best = Some((merit, x.to_vec()));
            }
        }
        Ok(read(&cache.last))
    }
}

impl basin::Constraints for Adapter<'_, '_> {
    type Set =
        ConstraintSet<BoxBounds<Vec<f64>>, NoLinearConstraints, NonlinearBlocks<NoNonlinearBlock, NonlinearBlock>>;
    fn constraints(&self) -> <Self::Set as basin::ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new()
            .with_bounds(BoxBounds::new(Some(&self.lower), Some(&self.upper)))
            .with_nonlinear_inequalities(self.margins)
    }
}

impl CostFunction for Adapter<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Stopped;
    fn cost(&self, x: &Vec<f64>) -> Result<f64, Stopped> {
        self.with(x, |e| e.objective)
    }
}

impl Gradient for Adapter<'_, '_> {
    type Gradient = Vec<f64>;
    fn gradient(&self, x: &Vec<f64>) -> Result<Vec<f64>, Stopped> {
        self.with(x, |e| e.gradient.clone())
    }
}

impl basin::NonlinearInequalityValues for Adapter<'_, '_> {
    type Param = Vec<f64>;
    type Values = Vec<f64>;
    type Error = Stopped;
    fn nonlinear_inequalities(&self, x: &Vec<f64>) -> Result<Vec<f64>, ConstraintSolveError<Stopped>> {
        // The library wants c(x) ≤ 0.
        self.with(x, |e| e.margins.iter().map(|m| -m).collect()).map_err(ConstraintSolveError::Evaluation)
    }
}

impl basin::ConstraintJacobian for Adapter<'_, '_> {
    type Param = Vec<f64>;
    type Jacobian = DenseMatrix;
    type Error = Stopped;
    fn constraint_jacobian(&self, x: &Vec<f64>) -> Result<DenseMatrix, ConstraintSolveError<Stopped>> {
        let columns = x.len();
        self.with(x, |e| DenseMatrix::from_fn(self.margins, columns, |i, j| -e.margin_gradients[i * columns + j]))
            .map_err(ConstraintSolveError::Evaluation)
    }
}

/// Minimises `problem` from `start`, restarting with a fresh curvature estimate
/// while that still improves.
pub fn minimise(problem: &mut dyn Problem, start: &[f64], options: Options, control: Control<'_>) -> Minimum {
    let cache =
        RefCell::new(Cache { problem, at: Vec::new(), last: Evaluation::default(), best: None, evaluations: 0 });
    let mut x = start.to_vec();
    let mut solution = Minimum {
        x: start.to_vec(),
        merit: f64::INFINITY,
        last: start.to_vec(),
        last_violation: f64::INFINITY,
        termination: Termination::Stalled,
        iterations: 0,
        evaluations: 0,
        stationarity: None,
        complementarity: None,
    };
    for _ in 0..=options.restarts {
        let best_merit = || cache.borrow().best.as_ref().map_or(f64::INFINITY, |b| b.0);
        let before = best_merit();
        cache.borrow_mut().problem.prepare(&mut x);
        let left = options.max_iterations.saturating_sub(solution.iterations);
        let adapter = {
            let cached = cache.borrow();
            let bounds = cached.problem.bounds();
            Adapter {
                cache: &cache,
                lower: bounds.iter().map(|b| b[0]).collect(),
                upper: bounds.iter().map(|b| b[1]).collect(),
                margins: cached.problem.margin_count(),
                feasibility: options.feasibility,
                control,
            }
        };
        let solver = Slsqp::new().with_absolute_accuracy_tolerance(options.tolerance);
        let executor = Executor::new(adapter, solver, SelectedFirstOrderState::new(x.clone()));
        let run = executor.max_iter(left).run_with_solver();
        let mut last = None;
        match run {
            Ok(result) => {
                solution.iterations += basin::State::iter(&result.state);
                solution.stationarity = result.solver.stationarity();
                solution.complementarity = result.solver.complementarity();
                solution.termination = match result.report.code() {
                    TerminationCode::SolverConverged => Termination::Converged,
                    TerminationCode::MaxIter => Termination::IterationLimit,
                    _ => Termination::Stalled,
                };
                last = Some(basin::State::param(&result.state).clone());
            }
            Err(_) if control.stopped() => solution.termination = Termination::Interrupted,
            Err(_) => solution.termination = Termination::Stalled,
        }
        let after = best_merit();
        if let Some(last) = last {
            let evaluation = cache.borrow_mut().problem.evaluate(&last);
            solution.last_violation = evaluation.violation;
            // The library also stops on a small step or change; only a point
            // that is optimal to first order, and as good as the best seen, is
            // called converged.
            let optimal = solution.stationarity.is_some_and(|s| s <= options.optimality)
                && evaluation.violation <= options.feasibility
                && evaluation.merit - after <= options.optimality;
            if solution.termination == Termination::Converged && !optimal {
                solution.termination = Termination::Stalled;
            }
            solution.last = last;
        }
        let done = matches!(solution.termination, Termination::IterationLimit | Termination::Interrupted);
        // An iterate outside limits that were not among the margins is the
        // caller's to mend: it knows which margins to add.
        let outside = solution.last_violation > options.feasibility;
        if done || outside || after >= before - options.tolerance {
            break;
        }
        if let Some((_, best)) = &cache.borrow().best {
            x.clone_from(best);
        }
    }
    let cache = cache.into_inner();
    solution.evaluations = cache.evaluations;
    match cache.best {
        Some((merit, best)) => {
            solution.merit = merit;
            solution.x = best;
        }
        None if solution.termination != Termination::Interrupted => {
            solution.termination = Termination::Infeasible;
        }
        None => {}
    }
    solution
}
