//! Optimal weights of a design on finitely many points, by a primal-dual
//! interior-point method (Wright, *Primal-Dual Interior-Point Methods*, 1997).
//!
//! The multiplicative algorithm of the literature (Silvey, Titterington &
//! Torsney 1978) slows down to 1/iteration near the end; Newton steps do not,
//! and points with the same information (mirror images of a posture) do no harm.

use super::criterion::{Prepared, Tangent, trace_of_product};
use nalgebra::linalg::Cholesky;
use nalgebra::{DMatrix, DVector};

/// Newton steps after which the best weights so far are taken; 20 to 40 are usual.
const MAX_STEPS: usize = 120;
/// Share of the way to the boundary a step may go.
const BOUNDARY: f64 = 0.995;
/// Steps of the multiplicative algorithm, and the power of the slopes in one.
const MULTIPLICATIVE_STEPS: usize = 50;
const MULTIPLICATIVE_POWER: f64 = 0.7;
/// Reduction of the complementarity aimed at by each step.
const CENTRING: f64 = 0.15;
/// Decrease of the merit asked for, as a share of its slope along the step.
const ARMIJO: f64 = 1e-4;

/// minimise φ(C + Σ w_i G_i) over w ≥ 0, Σ w_i = 1.
pub struct WeightProblem<'a> {
    /// φ, made ready for n unknowns.
    pub criterion: &'a Prepared,
    /// C, n × n.
    pub constant: &'a DMatrix<f64>,
    /// G_i, n × n each.
    pub points: &'a [DMatrix<f64>],
}

/// A [`WeightProblem`] at some weights.
pub struct State {
    /// The criterion there.
    pub tangent: Tangent,
    /// tr(A G_i): minus the derivative of φ (of −ln det) by w_i.
    pub slopes: DVector<f64>,
}

impl WeightProblem<'_> {
    /// The problem at these weights; `None` where φ does not exist there.
    pub fn state(&self, weights: &DVector<f64>) -> Option<State> {
        let mut information = self.constant.clone();
        for (w, g) in weights.iter().zip(self.points) {
            information.zip_apply(g, |m, g| *m += w * g);
        }
        let tangent = self.criterion.at(&information)?;
        let slopes = DVector::from_iterator(
            self.points.len(),
            self.points.iter().map(|g| trace_of_product(&tangent.adjoint, g)),
        );
        Some(State { tangent, slopes })
    }

    /// What is minimised: tr(Q M⁻¹), or −ln det M.
    fn objective(&self, tangent: &Tangent) -> f64 {
        match self.criterion.root {
            None => tangent.level * tangent.value.ln(),
            Some(_) => tangent.value,
        }
    }

    /// Hessian with respect to the weights, k × k: 2 tr(Q X G_i X G_j X), or
    /// tr(X G_i X G_j), as UᵀU so that it is positive semidefinite to rounding.
    pub fn hessian(&self, tangent: &Tangent) -> DMatrix<f64> {
        let whitening = &tangent.whitening;
        let factor = match &self.criterion.root {
            None => whitening.clone(),
            Some(root) => root * whitening.transpose() * whitening * 2f64.sqrt(),
        };
        let right = whitening.transpose();
        let columns: Vec<DVector<f64>> = self
            .points
            .iter()
            .map(|g| {
                let image = &factor * g * &right;
                DVector::from_column_slice(image.as_slice())
            })
            .collect();
        let u = DMatrix::from_columns(&columns);
        u.tr_mul(&u)
    }
}

/// The same by the multiplicative algorithm, whose steps cost no Hessian: for many unknowns, where weights near the
/// best will do.
pub fn near_optimal_weights(problem: &WeightProblem<'_>, tolerance: f64) -> Option<Vec<f64>> {
    let k = problem.points.len();
    let mut weights = DVector::from_element(k, 1.0 / k as f64);
    let mut best: Option<(f64, DVector<f64>)> = None;
    for _ in 0..MULTIPLICATIVE_STEPS {
        let state = problem.state(&weights)?;
        let gap = (state.slopes.max() - state.slopes.dot(&weights)) / state.tangent.level;
        if best.as_ref().is_none_or(|(least_gap, _)| gap < *least_gap) {
            best = Some((gap, weights.clone()));
        }
        if gap <= tolerance {
            break;
        }
        weights.zip_apply(&state.slopes, |w, slope| *w *= slope.max(0.0).powf(MULTIPLICATIVE_POWER));
        let sum = weights.sum();
        weights /= sum;
    }
    best.map(|(_, weights)| weights.iter().copied().collect())
}

/// Weights whose largest slope exceeds the mean slope by at most `tolerance`
/// of the level t, or as near as rounding allows; `None` where the criterion
/// does not exist at equal weights.
pub fn optimal_weights(problem: &WeightProblem<'_>, tolerance: f64) -> Option<Vec<f64>> {
    let k = problem.points.len();
    let mut weights = DVector::from_element(k, 1.0 / k as f64);
    let mut state = problem.state(&weights)?;
    // Everything in units of the first level.
    let unit = state.tangent.level;
    let mut multipliers = DVector::from_element(k, 1.0);
    let mut best = (f64::INFINITY, weights.clone());
    for _ in 0..MAX_STEPS {
        let gap = (state.slopes.max() - state.slopes.dot(&weights)) / state.tangent.level;
        if gap < best.0 {
            best = (gap, weights.clone());
        }
        if gap <= tolerance {
            break;
        }
        let barrier = CENTRING * weights.dot(&multipliers) / k as f64;
        let Some((step, multiplier_step)) = newton_step(problem, &state, &weights, &multipliers, barrier, unit) else {
            break;
        };
        let slopes = &state.slopes / unit;
        let merit = |weights: &DVector<f64>, tangent: &Tangent| {
            let logs: f64 = weights.iter().map(|w| w.ln()).sum();
            problem.objective(tangent) / unit - barrier * logs
        };
        let here = merit(&weights, &state.tangent);
        let slope = -step.dot(&slopes) - barrier * step.component_div(&weights).sum();
        let mut length = to_boundary(&weights, &step);
        let next = loop {
            let trial = &weights + &step * length;
            let accepted = problem.state(&trial).filter(|s| {
                let rounding = 1e-14 * here.abs();
                merit(&trial, &s.tangent) <= here + ARMIJO * length * slope + rounding
            });
            match accepted {
                Some(accepted) => break Some((trial, accepted)),
                None if length < 1e-10 => break None,
                None => length *= 0.5,
            }
        };
        let Some((trial, accepted)) = next else { break };
        // Against drift of the sum by rounding.
        let sum = trial.sum();
        weights = trial / sum;
        state = accepted;
        multipliers += multiplier_step.scale(to_boundary(&multipliers, &multiplier_step));
    }
    Some(best.1.iter().copied().collect())
}

/// Steps of weights and multipliers towards w_i z_i = `barrier`, with
/// Σ dw_i = 0: (H + Z/W) dw = g + barrier/w − ν.
fn newton_step(
    problem: &WeightProblem<'_>,
    state: &State,
    weights: &DVector<f64>,
    multipliers: &DVector<f64>,
    barrier: f64,
    unit: f64,
) -> Option<(DVector<f64>, DVector<f64>)> {
    let k = weights.len();
    let mut matrix = problem.hessian(&state.tangent) / unit;
    for i in 0..k {
        matrix[(i, i)] += multipliers[i] / weights[i];
    }
    let right = DVector::from_fn(k, |i, _| state.slopes[i] / unit + barrier / weights[i]);
    let factor = Cholesky::new(matrix)?;
    let ones = factor.solve(&DVector::from_element(k, 1.0));
    let free = factor.solve(&right);
    let level = free.sum() / ones.sum();
    let step = free - ones * level;
    let multiplier_step =
        DVector::from_fn(k, |i, _| (barrier - multipliers[i] * step[i]) / weights[i] - multipliers[i]);
    let finite = step.iter().chain(multiplier_step.iter()).all(|v| v.is_finite());
    finite.then_some((step, multiplier_step))
}

/// Longest step up to 1 that keeps every entry positive.
fn to_boundary(values: &DVector<f64>, step: &DVector<f64>) -> f64 {
    values
        .iter()
        .zip(step.iter())
        .filter(|(_, s)| **s < 0.0)
        .fold(1.0, |length: f64, (v, s)| length.min(-BOUNDARY * v / s))
}
