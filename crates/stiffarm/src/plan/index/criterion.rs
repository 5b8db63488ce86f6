//! ln of an index of the information matrix M, with its derivative by M.
//! Works on packed lower triangles and allocates nothing once made.

use super::kinds::Index;
use crate::numerics::information::GRAM_ROUNDING;
use crate::numerics::information::small::{
    cholesky, eigen, inverse_from_lower, invert_lower, packed, symmetric_product,
};

/// Condition number of M up to which an index of it has nine digits.
pub(crate) const ACCURATE_CONDITION: f64 = 1e6;

/// ln of an index and of its smoothed form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Value {
    /// With coalescing singular values smoothed.
    pub smooth: f64,
    /// Without smoothing.
    pub exact: f64,
}

impl Value {
    pub(crate) const INFINITE: Value = Value::plain(f64::INFINITY);

    /// Without anything to smooth.
    pub(crate) const fn plain(value: f64) -> Self {
        Value { smooth: value, exact: value }
    }
}

/// An index of one information matrix: every index but the classical one, and
/// without the components of the minimax ones (see [`Criterion::joint`]).
#[derive(Debug, Clone)]
pub(crate) struct Criterion {
    index: Index,
    n: usize,
    /// T of tr(T M⁻¹) for the task index, n × n; the identity stands for it
    /// otherwise.
    task: Option<Vec<f64>>,
    /// p of the smoothed extreme eigenvalues.
    pub sharpness: Option<f64>,
    lower: Vec<f64>,
    inverse_lower: Vec<f64>,
    /// M⁻¹ after a Cholesky-based evaluation.
    inverse: Vec<f64>,
    scratch: Vec<f64>,
    values: Vec<f64>,
    slopes: Vec<f64>,
    off: Vec<f64>,
    /// Derivative of the smoothed value by M, n × n.
    pub adjoint: Vec<f64>,
}

impl Criterion {
    pub fn new(index: Index, n: usize, task: Option<Vec<f64>>) -> Self {
        let (square, triangle) = (vec![0.0; n * n], vec![0.0; packed(n, 0)]);
        Criterion {
            index,
            n,
            task,
            sharpness: None,
            lower: triangle.clone(),
            inverse_lower: triangle,
            inverse: square.clone(),
            scratch: square.clone(),
            values: vec![0.0; n],
            slopes: vec![0.0; n],
            off: vec![0.0; n],
            adjoint: square,
        }
    }

    /// n.
    pub fn unknowns(&self) -> usize {
        self.n
    }

    /// Number of entries of a packed M.
    pub fn triangle(&self) -> usize {
        self.lower.len()
    }

    /// Value at M (packed), without the derivative.
    pub fn value(&mut self, m: &[f64]) -> f64 {
        match self.index {
            Index::ExpectedError | Index::DropOne => {
                if self.factor(m) {
                    let trace: f64 = self.inverse_lower.iter().map(|v| v * v).sum();
                    0.5 * (trace / self.n as f64).ln()
                } else {
                    f64::INFINITY
                }
            }
            Index::D | Index::O1 => {
                if cholesky(self.n, m, &mut self.lower) {
                    self.log_root_determinant()
                } else {
                    f64::INFINITY
                }
            }
            Index::WorstJoint => {
                if self.factor(m) {
                    inverse_from_lower(self.n, &self.inverse_lower, &mut self.inverse);
                    let diagonal = self.inverse.iter().step_by(self.n + 1);
                    0.5 * diagonal.copied().fold(0.0, f64::max).ln()
                } else {
                    f64::INFINITY
                }
            }
            _ => self.evaluate(m).exact,
        }
    }

    /// tr(M) tr(M⁻¹) at M (packed), above its condition number; with the logarithm of the expected error of a part of M
    /// that of this part, at most.
    pub fn condition(&mut self, m: &[f64], of_part: Option<f64>) -> f64 {
        let trace: f64 = (0..self.n).map(|i| m[packed(i, i)]).sum();
        let inverse = match of_part {
            Some(log) => self.n as f64 * (2.0 * log).exp(),
            None if self.factor(m) => self.inverse_lower.iter().map(|v| v * v).sum(),
            None => f64::INFINITY,
        };
        trace * inverse
    }

    /// Value at M (packed) with the derivative in `self.adjoint`.
    pub fn evaluate(&mut self, m: &[f64]) -> Value {
        // A constant size lets the compiler unroll.
        match self.n {
            6 => self.evaluate_sized(m, 6),
            n => self.evaluate_sized(m, n),
        }
    }

    #[inline(always)]
    fn evaluate_sized(&mut self, m: &[f64], n: usize) -> Value {
        match self.index {
            Index::ExpectedError | Index::DropOne | Index::Task => self.trace(m, n),
            Index::D | Index::O1 => {
                if !self.factor(m) {
                    return Value::INFINITE;
                }
                inverse_from_lower(n, &self.inverse_lower, &mut self.inverse);
                let factor = -0.5 / n as f64;
                for (a, v) in self.adjoint.iter_mut().zip(&self.inverse) {
                    *a = v * factor;
                }
                let value = self.log_root_determinant();
                Value::plain(value)
            }
            _ => self.spectral(m, n),
        }
    }

    /// Cholesky factor and its inverse; false where M is singular.
    #[inline(always)]
    fn factor(&mut self, m: &[f64]) -> bool {
        let sound = cholesky(self.n, m, &mut self.lower);
        if sound {
            invert_lower(self.n, &self.lower, &mut self.inverse_lower);
        }
        sound
    }

    /// ln det(M)^(−1/(2n)) from the Cholesky factor.
    fn log_root_determinant(&self) -> f64 {
        let n = self.n;
        // Σ ln L_ii = ½ ln det M, by a product that cannot overflow for long.
        let sum: f64 = (0..n).map(|i| self.lower[packed(i, i)].ln()).sum();
        -sum / n as f64
    }

    /// ½ ln(tr(T M⁻¹)/n), T = 1 (RMS error), or ½ ln tr(T M⁻¹) (task);
    /// derivative −½ M⁻¹TM⁻¹/tr.
    #[inline(always)]
    fn trace(&mut self, m: &[f64], n: usize) -> Value {
        if !self.factor(m) {
            return Value::INFINITE;
        }
        inverse_from_lower(n, &self.inverse_lower, &mut self.inverse);
        let (trace, count) = match &self.task {
            None => {
                symmetric_product(n, &self.inverse, &self.inverse, &mut self.adjoint);
                let trace: f64 = (0..n).map(|i| self.inverse[i * n + i]).sum();
                (trace, n as f64)
            }
            Some(task) => {
                // scratch = M⁻¹ T, not symmetric.
                let mut trace = 0.0;
                for i in 0..n {
                    for j in 0..n {
                        let mut sum = 0.0;
                        for k in 0..n {
                            sum += self.inverse[i * n + k] * task[k * n + j];
                        }
                        self.scratch[i * n + j] = sum;
                    }
                    trace += self.scratch[i * n + i];
                }
                for i in 0..n {
                    for j in 0..n {
                        let mut sum = 0.0;
                        for k in 0..n {
                            sum += self.scratch[i * n + k] * self.inverse[k * n + j];
                        }
                        self.adjoint[i * n + j] = sum;
                    }
                }
                (trace, 1.0)
            }
        };
        let factor = -0.5 / trace;
        for a in &mut self.adjoint {
            *a *= factor;
        }
        let value = 0.5 * (trace / count).ln();
        Value::plain(value)
    }

    /// Indices of the singular values σ = √λ.
    #[inline(always)]
    fn spectral(&mut self, m: &[f64], n: usize) -> Value {
        for i in 0..n {
            for j in 0..=i {
                let value = m[packed(i, j)];
                self.scratch[i * n + j] = value;
                self.scratch[j * n + i] = value;
            }
        }
        if !eigen(n, &mut self.scratch, &mut self.values, &mut self.off) {
            return Value::INFINITE;
        }
        let values = &self.values[..n];
        let (mut least, mut most) = (f64::INFINITY, 0.0);
        for v in values {
            least = if *v < least { *v } else { least };
            most = if *v > most { *v } else { most };
        }
        if least.partial_cmp(&(n as f64 * GRAM_ROUNDING * most)) != Some(std::cmp::Ordering::Greater) {
            return Value::INFINITE;
        }
        let slopes = &mut self.slopes[..n];
        // (share of ln λ_max, share of ln λ_min) of the extreme-value indices.
        let shares = match self.index {
            Index::O3 => (0.0, -0.5),
            Index::O4 => (0.5, -1.0),
            _ => (0.5, -0.5),
        };
        let value = if self.index == Index::O5 {
            // ln Σ 1/σ.
            let sum: f64 = values.iter().map(|v| 1.0 / v.sqrt()).sum();
            for (slope, v) in slopes.iter_mut().zip(values) {
                *slope = -0.5 / (v * v.sqrt() * sum);
            }
            let value = sum.ln();
            Value::plain(value)
        } else {
            slopes.fill(0.0);
            let high = add_extreme(values, most, 1.0, self.sharpness, shares.0, slopes, &mut self.off);
            let low = add_extreme(values, least, -1.0, self.sharpness, shares.1, slopes, &mut self.off);
            Value { smooth: high.smooth + low.smooth, exact: high.exact + low.exact }
        };
        // Σ slope_i v_i v_iᵀ with the vectors in rows.
        let (vectors, adjoint) = (&self.scratch[..n * n], &mut self.adjoint[..n * n]);
        adjoint.fill(0.0);
        for (v, slope) in vectors.chunks_exact(n).zip(&*slopes) {
            if *slope == 0.0 {
                continue;
            }
            for i in 0..n {
                let factor = v[i] * slope;
                for j in 0..n {
                    adjoint[i * n + j] += factor * v[j];
                }
            }
        }
        value
    }

    /// Of the matrix evaluated last by Cholesky: ½ ln [M⁻¹]_jj.
    pub fn joint(&self, j: usize) -> f64 {
        0.5 * self.inverse[j * self.n + j].ln()
    }

    /// Prepares [`joint`](Self::joint) at M; false where M is singular.
    pub fn invert(&mut self, m: &[f64]) -> bool {
        let sound = self.factor(m);
        if sound {
            inverse_from_lower(self.n, &self.inverse_lower, &mut self.inverse);
        }
        sound
    }

    /// Adds to `adjoint` the derivative of `weight`·½ ln [M⁻¹]_jj:
    /// −½ w wᵀ/[M⁻¹]_jj with w = M⁻¹ e_j.
    pub fn add_joint_adjoint(&self, j: usize, weight: f64, adjoint: &mut [f64]) {
        let n = self.n;
        let w = &self.inverse[j * n..(j + 1) * n];
        let factor = -0.5 * weight / w[j];
        for i in 0..n {
            for k in 0..n {
                adjoint[i * n + k] += factor * w[i] * w[k];
            }
        }
    }
}

/// `share`·ln of the largest (`sign` = 1) or smallest (−1) eigenvalue λ, whose
/// slopes by the eigenvalues are added: sign/p · ln Σ (λ_i/λ)^(sign·p) + ln λ
/// with the smoothing p, which cannot overflow.
#[inline(always)]
fn add_extreme(
    values: &[f64],
    extreme: f64,
    sign: f64,
    sharpness: Option<f64>,
    share: f64,
    slopes: &mut [f64],
    weights: &mut [f64],
) -> Value {
    if share == 0.0 {
        return Value::plain(0.0);
    }
    let log = extreme.ln();
    let exact = share * log;
    let Some(p) = sharpness else {
        let at = values.iter().position(|v| *v == extreme).unwrap_or(0);
        slopes[at] += share / extreme;
        return Value { smooth: exact, exact };
    };
    // Weights of the eigenvalues; what lies below e⁻⁴⁰ changes nothing.
    let mut sum = 0.0;
    for (weight, v) in weights.iter_mut().zip(values) {
        let exponent = sign * p * (v / extreme).ln();
        *weight = if exponent < -40.0 { 0.0 } else { exponent.exp() };
        sum += *weight;
    }
    for ((slope, weight), v) in slopes.iter_mut().zip(&*weights).zip(values) {
        *slope += share * weight / (sum * v);
    }
    Value { smooth: exact + share * sign * sum.ln() / p, exact }
}
