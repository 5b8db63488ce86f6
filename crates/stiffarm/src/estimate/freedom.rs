//! Degrees of freedom of combinations whose variance is itself an estimate.

use crate::error::Result;
use crate::estimate::identify::quantile;
use crate::numerics::lists;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// How well the sizes of a mixed model are known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SizeDoubt {
    /// Unknowns of each class, counted from 0.
    pub classes: Vec<Range<usize>>,
    /// Those of each class that scatter about a common mean, whose own variance is that of one of them.
    pub means: Vec<Range<usize>>,
    /// Variance of each unknown before the data; zero for those that are no random
    /// effects.
    #[serde(with = "lists::vector")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub prior: DVector<f64>,
    /// Covariance of ln σ² and of the logarithms of the ratios of the classes' variances
    /// to σ², 1 + classes: row i up to column i.
    #[serde(with = "lists::symmetric")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub covariance: DMatrix<f64>,
}

impl SizeDoubt {
    /// Degrees of freedom 2 f²/(gᵀWg) of f = `variance` + `noise`, where `variance` is that
    /// of the combination whose covariances with all unknowns are `with`, and `noise` is
    /// in proportion to σ².
    pub fn degrees_of_freedom(&self, with: &DVector<f64>, variance: f64, noise: f64) -> f64 {
        let f = variance + noise;
        let mut slope = DVector::zeros(1 + self.classes.len());
        slope[0] = f;
        for (c, (class, mean)) in self.classes.iter().zip(&self.means).enumerate() {
            // ∂(ℓᵀCℓ)/∂ln λ = ℓᵀC P⁻¹ Cℓ over the class, with P its prior covariance: diagonal in units of the prior's
            // roots but for the mean, which adds 1 to every entry of it.
            let part = |i: usize| match self.prior[i] {
                prior if prior > 0.0 => with[i] / prior.sqrt(),
                _ => 0.0,
            };
            let sum: f64 = mean.clone().map(part).sum();
            let squares: f64 = class.clone().map(|i| part(i).powi(2)).sum();
            slope[1 + c] = squares - sum * sum / (1 + mean.len()) as f64;
        }
        2.0 * f * f / slope.dot(&(&self.covariance * &slope))
    }

    /// The same, no more than `most`.
    pub(crate) fn bounded(&self, most: f64, with: &DVector<f64>, variance: f64, noise: f64) -> f64 {
        let n = self.degrees_of_freedom(with, variance, noise);
        if n.is_finite() { n.min(most) } else { most }
    }
}

/// Degrees of freedom that are looked up; beyond them the normal is near.
const LOOKED_UP: usize = 120;

/// Quantiles of Student's t for any degrees of freedom from one on.
#[derive(Debug, Clone)]
struct Quantiles {
    /// Of 1, 2, … degrees of freedom.
    whole: Vec<f64>,
    normal: f64,
}

impl Quantiles {
    fn new(confidence: f64) -> Result<Self> {
        let whole: Result<Vec<f64>> = (1..=LOOKED_UP).map(|n| quantile(Some(n), confidence)).collect();
        Ok(Quantiles { whole: whole?, normal: quantile(None, confidence)? })
    }

    /// Between whole numbers in proportion to 1/ν.
    fn at(&self, degrees_of_freedom: f64) -> f64 {
        let n = degrees_of_freedom.max(1.0);
        let low = (n.floor() as usize).min(LOOKED_UP);
        let [a, x] = [self.whole[low - 1], 1.0 / low as f64];
        let [b, y] = match self.whole.get(low) {
            Some(next) => [*next, 1.0 / (low + 1) as f64],
            None => [self.normal, 0.0],
        };
        b + (a - b) * (1.0 / n - y) / (x - y)
    }
}

/// Quantiles of the combinations of what a fit found.
#[derive(Debug, Clone)]
pub(crate) struct SpreadQuantiles {
    /// Where the sizes count as known.
    plain: f64,
    /// Where they do not: the most degrees of freedom, the table and the doubt.
    doubted: Option<(f64, Quantiles, SizeDoubt)>,
}

impl SpreadQuantiles {
    /// # Errors
    /// A confidence outside (0, 1); no degree of freedom.
    pub(crate) fn new(degrees_of_freedom: Option<usize>, confidence: f64, doubt: Option<&SizeDoubt>) -> Result<Self> {
        let most = degrees_of_freedom.map_or(f64::INFINITY, |n| n as f64);
        let doubted = match doubt {
            Some(doubt) => Some((most, Quantiles::new(confidence)?, doubt.clone())),
            None => None,
        };
        Ok(SpreadQuantiles { plain: quantile(degrees_of_freedom, confidence)?, doubted })
    }

    /// Of a combination of this variance whose covariances with all unknowns are `with`,
    /// with `noise` of its own.
    pub(crate) fn of(&self, with: &DVector<f64>, variance: f64, noise: f64) -> f64 {
        match &self.doubted {
            Some((most, table, doubt)) if variance + noise > 0.0 => {
                table.at(doubt.bounded(*most, with, variance, noise))
            }
            _ => self.plain,
        }
    }
}
