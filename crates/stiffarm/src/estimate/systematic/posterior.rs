//! How large the parts of the common errors may be once the readings are there.
//!
//! Part i shifts the displacements by S_i for each standard uncertainty, so with
//! c ~ N(0, I) and noise as the fit found it
//!
//! ```text
//! Δ = Ψ h + S c + ε,   Cov ε = σ²V.
//! ```
//!
//! With the residual projector Q = V⁻¹ − V⁻¹Ψ(ΨᵀV⁻¹Ψ)⁻¹ΨᵀV⁻¹, A = SᵀQS/σ² and
//! b = SᵀQΔ/σ² the readings leave c with covariance (I + A)⁻¹ and mean (I + A)⁻¹b.
//! What the estimates can follow, a force scale say, has QS = 0 and keeps its size.
//!
//! The parts of some sources are alike: the gaps of an arm's joints are of one
//! size, known no better than the statement of it. Theirs is ω times the
//! statement, one ω for all of them, uniform and of mean square one before the
//! readings. Its likelihood given the residuals, |I + A_ω|^(−1/2) exp(bωᵀ(I + A_ω)⁻¹bω/2),
//! weighs the moments. Where the residuals say nothing, they are those of the
//! statement again.
//!
//! The ways to a preload, which no fit against it has, are more rows of QS and QΔ with the unknowns as they are
//! (`preload.rs`). The readings under the preload are in both, and count as if they were not: the errors of the way and
//! of the unknowns partly cancel where all of it acts, so that bands at work are rather too wide.
//!
//! σ is an estimate from the same residuals: σ̂²/σ² = w is χ² over its degrees of freedom ν.
//! Given w, A and b are w times as large, and the likelihood above times the density of w
//! weighs once more. What is the common errors' and what is noise is so found together.

use super::predicting_model::PredictingModel;
use super::preload;
use super::sources::Source;
use crate::error::Result;
use nalgebra::{DMatrix, DVector};

/// Sizes ω that are looked at.
const SIZES: usize = 40;
/// Ratios of σ̂² to σ² on each side of one that are looked at.
const NOISES: i32 = 6;
/// How far they reach in standard deviations of ln σ².
const NOISE_WIDTH: f64 = 3.0;
/// No displacement is exact beyond this fraction of all of them: the residuals
/// of readings without noise are rounding, and say nothing.
const EXACT_SHARE: f64 = 1e-9;

/// All parts of all sources in one order.
pub(super) struct Parts {
    /// Change of the unknowns by each, unknowns × parts.
    pub response: DMatrix<f64>,
    /// Change of the joints' compliance by each, joints × parts.
    pub joints: DMatrix<f64>,
    /// Mean of c.
    pub mean: DVector<f64>,
    /// Covariance of c.
    pub covariance: DMatrix<f64>,
}

/// What one standard uncertainty of each part does, and what the readings say
/// of its size.
///
/// Without an estimate of σ nothing is learned. Huber's weights and the
/// compliances that the non-negative fit holds at zero count as given; a prior
/// of the stiffness takes part in Q.
///
/// # Errors
/// A decomposition that fails; stopped.
pub(super) fn parts(believed: &PredictingModel<'_>, sources: &[Source]) -> Result<Parts> {
    let (fit, response) = (believed.fit, &believed.response);
    let shifts = sources.iter().flat_map(|source| &source.parts);
    let (mut changes, mut left) = (Vec::new(), Vec::new());
    for part in shifts {
        fit.control().check()?;
        let weighed = response.weighed(&part.shift);
        let (change, remainder) = match &part.change {
            Some(change) => (change.clone(), weighed),
            None => {
                let change = response.of(&weighed);
                let remainder = response.left(&weighed, &change);
                (change, remainder)
            }
        };
        left.push(remainder);
        changes.push(change);
    }
    let count = changes.len();
    let unknowns = believed.values.len();
    let joints: Vec<DVector<f64>> = changes.iter().map(|c| believed.joint_change(c)).collect();
    let mut out = Parts {
        joints: DMatrix::from_fn(believed.joints.len(), count, |j, i| joints[i][j]),
        response: DMatrix::from_fn(unknowns, count, |j, i| changes[i][j]),
        mean: DVector::zeros(count),
        covariance: DMatrix::identity(count, count),
    };
    let delta = &fit.system().delta;
    let exact = EXACT_SHARE * delta.norm() / (delta.len().max(1) as f64).sqrt();
    let Some(sigma) = believed.sigma.map(|s| s.max(exact)) else {
        return Ok(out);
    };
    if count == 0 || sigma <= 0.0 {
        return Ok(out);
    }
    let misfit = match believed.expected {
        Some(expected) => response.weighed(expected),
        None => response.left(response.delta(), believed.values),
    };
    // What is left of S̃ times itself is SᵀQS, the rows of a prior or of random effects
    // included.
    let variance = sigma * sigma;
    let mut seen = DMatrix::from_fn(count, count, |i, k| left[i].dot(&left[k]) / variance);
    let mut said = DVector::from_fn(count, |i, _| left[i].dot(&misfit) / variance);
    if let Some((shifts, misfit)) = preload::rows(believed, sources, &changes)? {
        seen += shifts.tr_mul(&shifts) / variance;
        said += shifts.tr_mul(&misfit) / variance;
    }
    let alike: Vec<bool> = sources.iter().flat_map(|source| source.parts.iter().map(|_| source.alike)).collect();
    if let Some((mean, covariance)) = moments(&seen, &said, &alike, &noise(believed.degrees_of_freedom)) {
        out.mean = mean;
        out.covariance = covariance;
    }
    Ok(out)
}

/// Mean and covariance of c given A and b; parts that are `alike` share one unknown size,
/// and σ² is one of `noise`: ratios of σ̂² to it, with weights. `None` where a number is
/// not finite.
pub fn moments(
    seen: &DMatrix<f64>,
    said: &DVector<f64>,
    alike: &[bool],
    noise: &[(f64, f64)],
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let count = said.len();
    let at = |size: f64, ratio: f64| -> Option<(f64, DVector<f64>, DMatrix<f64>)> {
        let scale = DVector::from_fn(count, |i, _| if alike[i] { size } else { 1.0 });
        let information = DMatrix::from_fn(count, count, |i, k| {
            f64::from(u8::from(i == k)) + scale[i] * ratio * seen[(i, k)] * scale[k]
        });
        let factor = information.cholesky()?;
        let towards = said.component_mul(&scale) * ratio;
        let solved = factor.solve(&towards);
        let ln_determinant: f64 = factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum();
        let likelihood = 0.5 * towards.dot(&solved) - ln_determinant;
        let mean = solved.component_mul(&scale);
        let inverse = factor.inverse();
        let covariance = DMatrix::from_fn(count, count, |i, k| scale[i] * inverse[(i, k)] * scale[k]);
        let numbers = mean.iter().chain(&covariance);
        let finite = likelihood.is_finite() && numbers.into_iter().all(|v| v.is_finite());
        finite.then_some((likelihood, mean, covariance))
    };
    let sizes = if alike.contains(&true) { sizes() } else { vec![(1.0, 1.0)] };
    let mut looked = Vec::with_capacity(sizes.len() * noise.len());
    for (size, weight) in &sizes {
        for (ratio, part) in noise {
            let (likelihood, mean, covariance) = at(*size, *ratio)?;
            looked.push((likelihood + (weight * part).ln(), mean, covariance));
        }
    }
    let best = looked.iter().map(|l| l.0).fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = looked.iter().map(|l| (l.0 - best).exp()).sum();
    let weight = |likelihood: f64| (likelihood - best).exp() / total;
    let mut mean = DVector::zeros(count);
    for (likelihood, conditional, _) in &looked {
        mean += conditional * weight(*likelihood);
    }
    let mut covariance = DMatrix::zeros(count, count);
    for (likelihood, conditional, within) in looked {
        let between = conditional - &mean;
        covariance += (within + &between * between.transpose()) * weight(likelihood);
    }
    Some((mean, covariance))
}

/// Ratios σ̂²/σ² with their weights: χ² over its degrees of freedom, as the residuals leave
/// it; one where σ is known.
pub fn noise(degrees_of_freedom: Option<usize>) -> Vec<(f64, f64)> {
    let Some(n) = degrees_of_freedom else {
        return vec![(1.0, 1.0)];
    };
    let n = n as f64;
    // Over ln w the density is w^(n/2) e^(−nw/2); its width is √(2/n).
    let step = NOISE_WIDTH * (2.0 / n).sqrt() / NOISES as f64;
    let of = |k: i32| {
        let ln = step * f64::from(k);
        (ln.exp(), (0.5 * n * (ln - ln.exp_m1())).exp())
    };
    let all: Vec<(f64, f64)> = (-NOISES..=NOISES).map(of).collect();
    let sum: f64 = all.iter().map(|(_, weight)| weight).sum();
    all.iter().map(|(w, weight)| (*w, weight / sum)).collect()
}

/// Sizes ω with their weights before the readings: uniform, close together near
/// zero, weights of sum one and mean square one.
pub fn sizes() -> Vec<(f64, f64)> {
    let steps = || (0..SIZES).map(|k| (k as f64 + 0.5) / SIZES as f64);
    // ω ~ u² makes dω ~ u du.
    let sum: f64 = steps().sum();
    let square: f64 = steps().map(|u| u.powi(5) / sum).sum();
    steps().map(|u| (u * u / square.sqrt(), u / sum)).collect()
}
