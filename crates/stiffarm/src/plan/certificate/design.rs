//! What a continuous design is: a space of points, and weights on some of them.

use crate::numerics::control::Termination;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// How hard to look for the largest tr(A·G(x)).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Points that improve a design are enough.
    Improve,
    /// The bound will rest on it: search as widely as the space can.
    Verify,
}

/// A set of points, each with its information about n unknowns.
pub trait DesignSpace {
    /// Number of unknowns n.
    fn unknowns(&self) -> usize;

    /// Information G(x) of one point, n × n, symmetric positive semidefinite.
    fn information(&self, point: &[f64]) -> DMatrix<f64>;

    /// Points of the space at which tr(A·G(x)) is locally largest, with that
    /// value, best first: one entry per search, the same each time. `adjoint`
    /// is A, n × n, symmetric positive semidefinite; `starts` are points to
    /// search from besides the space's own.
    fn maximise(&self, adjoint: &DMatrix<f64>, starts: &[Vec<f64>], effort: Effort) -> Vec<(Vec<f64>, f64)>;

    /// Name of an unknown for messages.
    fn unknown_name(&self, unknown: usize) -> String {
        format!("unknown {}", unknown + 1)
    }
}

/// Tolerance and budget of [`optimal_design`](super::continuous::optimal_design).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesignOptions {
    /// Residual of the equivalence condition at which a design counts as optimal.
    pub tolerance: f64,
    /// Rounds of weights and searches.
    pub max_rounds: usize,
}

impl Default for DesignOptions {
    fn default() -> Self {
        DesignOptions { tolerance: 1e-4, max_rounds: 40 }
    }
}

/// A continuous design with its bound: weights Σ w_i = 1 on points.
///
/// M₀ = B + Σ w_i G(x_i), with B the information given beforehand per further
/// point. The bound is a theorem once s is the true maximum of tr(A·G(x)) over
/// the space; that it is rests on the searches of the [`DesignSpace`].
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuousDesign {
    /// The points, largest weight first.
    pub points: Vec<Vec<f64>>,
    /// Their weights, Σ = 1.
    pub weights: Vec<f64>,
    /// M₀, n × n. Where the criterion's matrix is singular it holds a small
    /// share of a nonsingular design too.
    pub information: DMatrix<f64>,
    /// A = −∂φ/∂M at M₀ (for the determinant: of ln det), n × n.
    pub adjoint: DMatrix<f64>,
    /// φ(M₀).
    pub value: f64,
    /// t = tr(A M₀).
    pub level: f64,
    /// s, the largest tr(A·G(x)) found.
    pub largest: f64,
    /// (tr(A B) + s)/t − 1: zero at the optimum.
    pub residual: f64,
    /// φ(M₀)/(1 + residual): no N points have φ(N·B + Σ G(x_k)) below `bound`/N.
    pub bound: f64,
    /// Rounds of weights and searches.
    pub rounds: usize,
    /// Searches for the largest tr(A·G(x)) in all rounds.
    pub searches: usize,
    /// What the last, widest search found.
    pub verification: Verification,
    /// [`Termination::Converged`] where the residual met the tolerance.
    pub termination: Termination,
}

/// The searches from the space's own starts ([`Effort::Verify`]) that stand
/// behind a bound.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Verification {
    /// Number of searches.
    pub searches: usize,
    /// How many ended within the tolerance of the largest value; none ended above it.
    pub agreeing: usize,
    /// How many of these ended near the point of the design (with a weight of
    /// 1 % or more) that was met least often: a measure of how hard to find
    /// the points are that matter. A small number asks for more searches; on a
    /// ridge, where many points are equally good, it may be 0 all the same.
    pub rarest: usize,
}

impl Verification {
    /// What to think of a bound whose searches have not met every posture of its design, where that is so.
    pub fn doubt(&self) -> Option<&'static str> {
        (self.rarest == 0).then_some(
            "none of them met one of the postures that the bound itself rests on: others may be missed too, and then \
             the bound is too high",
        )
    }
}
