//! How well an explanation accounts for the residuals.

use super::super::fit::{RigidFit, Sample};
use super::{CONTRADICTION, Explanation};
use crate::numerics::order::sort_by_number;
use nalgebra::Vector3;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};
use statrs::function::gamma::ln_gamma;
use std::f64::consts::PI;

/// ln of the likelihood of all pairs but `left_out`, with the transform
/// integrated out (flat prior) and σ known or integrated out too (prior 1/σ);
/// constants that all explanations share are left out.
pub(super) fn ln_evidence(
    explanation: &Explanation,
    samples: &[Sample],
    left_out: Option<usize>,
    std: Option<f64>,
) -> f64 {
    let freedom = explanation.degrees_of_freedom as f64;
    let rss = explanation.fit.rss_above_rounding();
    let residuals = match std {
        Some(std) => -rss / (2.0 * std.powi(2)) - freedom * std.ln() - freedom / 2.0 * (2.0 * PI).ln(),
        // ∫ of the same over σ with the prior 1/σ.
        None => ln_gamma(freedom / 2.0) - freedom / 2.0 * (PI * rss).ln() - 2f64.ln(),
    };
    let weights = samples.iter().enumerate().filter(|(i, _)| Some(*i) != left_out).map(|(_, s)| 1.5 * s.weight.ln());
    residuals + weights.sum::<f64>() + ln_volume_of_transforms(&explanation.fit)
}

/// ln of the volume of transforms that fit, but for powers of σ: (Σ AᵀA·weight)
/// to the power −1/2, and the whole circle of turns about points on a line.
fn ln_volume_of_transforms(fit: &RigidFit) -> f64 {
    let [a, b, c] = fit.spread.map(|s| s.powi(2));
    let shift = 3.0 * fit.weight.ln();
    match fit.rank() {
        6 => -0.5 * (shift + ((b + c) * (a + c) * (a + b)).ln()),
        _ => -0.5 * (shift + 2.0 * a.ln()) + (2.0 * PI).ln(),
    }
}

/// ln of the volume in which a wrong point may lie: a ball as wide as the set
/// \[m³\].
pub(super) fn ln_volume(samples: &[Sample]) -> f64 {
    let mean = samples.iter().map(|s| s.base).sum::<Vector3<f64>>() / samples.len() as f64;
    let mut far: Vec<(f64, Vector3<f64>)> = samples.iter().map(|s| ((s.base - mean).norm(), s.base)).collect();
    sort_by_number(&mut far, |a| -a.0);
    // No two points are farther apart than their distances from the mean together.
    let mut largest: f64 = 0.0;
    for (i, a) in far.iter().enumerate() {
        if a.0 + far[0].0 <= largest {
            break;
        }
        for b in &far[..i] {
            if a.0 + b.0 <= largest {
                break;
            }
            largest = largest.max((a.1 - b.1).norm());
        }
    }
    (4.0 / 3.0 * PI).ln() + 3.0 * largest.ln()
}

/// Chance that noise alone makes the pair left out by `rest` fit the others as
/// badly as it does.
pub(super) fn tail(plain: &Explanation, rest: &Explanation, std: Option<f64>) -> f64 {
    let freedoms = [plain.degrees_of_freedom - rest.degrees_of_freedom, rest.degrees_of_freedom];
    let rest = rest.fit.rss_above_rounding();
    let drop = (plain.fit.rss_above_rounding() - rest).max(0.0);
    let credible_std = std.filter(|s| chi_squared_tail(rest / s.powi(2), freedoms[1]) > CONTRADICTION);
    match credible_std {
        Some(std) => chi_squared_tail(drop / std.powi(2), freedoms[0]),
        None => f_tail([drop, rest], freedoms),
    }
}

/// Chance of a larger ratio of mean squares, from two sums of squares with
/// their degrees of freedom.
pub(in super::super) fn f_tail(sums: [f64; 2], freedoms: [usize; 2]) -> f64 {
    let [a, b] = freedoms.map(|f| f as f64);
    let ratio = (sums[0] / a) / (sums[1] / b);
    FisherSnedecor::new(a, b).map_or(1.0, |f| f.sf(ratio))
}

/// Chance of a larger χ².
pub(in super::super) fn chi_squared_tail(value: f64, freedom: usize) -> f64 {
    ChiSquared::new(freedom as f64).map_or(1.0, |chi| chi.sf(value))
}
