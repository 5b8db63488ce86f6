//! Bounded minimisation of one smooth function with its gradient: limited-memory
//! quasi-Newton steps within a box (Byrd, Lu, Nocedal & Zhu 1995,
//! doi 10.1137/0916069). Needs no matrix of the size of the problem, so its
//! cost grows linearly with the number of postures.

use crate::numerics::control::Control;
use basin::{BoxBounds, ConstraintSet, CostFunction, Executor, FirstOrderState, Gradient, Lbfgsb};
use std::cell::{Cell, RefCell};

/// Budget and tolerances of one minimisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SmoothOptions {
    /// Iterations.
    pub max_iterations: u64,
    /// Largest ∞-norm of the projected gradient that counts as a minimum.
    pub optimality: f64,
    /// Relative reduction of the function by one iteration that counts as none.
    pub reduction: f64,
}

/// Where a minimisation ended.
#[derive(Debug, Clone)]
pub(crate) struct SmoothSolution {
    /// The last iterate, which has the lowest value.
    pub x: Vec<f64>,
    /// Evaluations of the function with its gradient.
    pub evaluations: u64,
}

/// The value, and the gradient written.
type Function<'f> = dyn FnMut(&[f64], &mut [f64]) -> f64 + 'f;

/// The caller stopped it.
struct Stopped;

struct Adapter<'a, 'f> {
    function: RefCell<&'a mut Function<'f>>,
    evaluations: &'a Cell<u64>,
    lower: &'a Vec<f64>,
    upper: &'a Vec<f64>,
    control: Control<'a>,
}

impl Adapter<'_, '_> {
    fn call(&self, x: &[f64], gradient: &mut [f64]) -> Result<f64, Stopped> {
        if self.control.stopped() {
            return Err(Stopped);
        }
        self.evaluations.set(self.evaluations.get() + 1);
        let value = (self.function.borrow_mut())(x, gradient);
        // The line search backs off from a large value, not from infinity.
        Ok(if value.is_finite() { value } else { 1e10 })
    }
}

impl basin::Constraints for Adapter<'_, '_> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;
    fn constraints(&self) -> <Self::Set as basin::ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(self.lower), Some(self.upper)))
    }
}

impl CostFunction for Adapter<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Stopped;
    fn cost(&self, x: &Vec<f64>) -> Result<f64, Stopped> {
        self.call(x, &mut vec![0.0; x.len()])
    }
}

impl Gradient for Adapter<'_, '_> {
    type Gradient = Vec<f64>;
    fn gradient(&self, x: &Vec<f64>) -> Result<Vec<f64>, Stopped> {
        let mut gradient = vec![0.0; x.len()];
        self.call(x, &mut gradient)?;
        Ok(gradient)
    }
    fn cost_and_gradient(&self, x: &Vec<f64>) -> Result<(f64, Vec<f64>), Stopped> {
        let mut gradient = vec![0.0; x.len()];
        Ok((self.call(x, &mut gradient)?, gradient))
    }
    fn cost_and_gradient_into(&self, x: &Vec<f64>, gradient: &mut Vec<f64>) -> Result<f64, Stopped> {
        self.call(x, gradient)
    }
}

/// Minimises `function` from `start`, where a stop leaves it.
pub(crate) fn minimise_smooth(
    function: &mut Function<'_>,
    lower: &Vec<f64>,
    upper: &Vec<f64>,
    start: &[f64],
    options: SmoothOptions,
    control: Control<'_>,
) -> SmoothSolution {
    let evaluations = Cell::new(0);
    let adapter = Adapter { function: RefCell::new(function), evaluations: &evaluations, lower, upper, control };
    let solver = Lbfgsb::new()
        .with_m_capacity(6)
        .with_absolute_projected_gradient_tolerance(options.optimality)
        .with_relative_cost_reduction_tolerance(options.reduction);
    let state = FirstOrderState::new(start.to_vec());
    let run = Executor::new(adapter, solver, state).max_iter(options.max_iterations).run();
    match run {
        Ok(result) => {
            SmoothSolution { x: basin::State::best_param(&result.state).clone(), evaluations: evaluations.get() }
        }
        Err(_) => SmoothSolution { x: start.to_vec(), evaluations: evaluations.get() },
    }
}
