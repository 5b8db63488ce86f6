//! How far a normal quantity may lie from a value that is not its mean.

use crate::error::{Error, Result};
use statrs::distribution::{Continuous, ContinuousCDF, Normal};

/// Steps of Newton's method; a handful settle all digits.
const STEPS: usize = 50;
/// What is left of the confidence when the search ends.
const TOLERANCE: f64 = 1e-14;

/// A confidence with the quantiles of the normal that belong to it.
#[derive(Debug, Clone)]
pub struct Level {
    normal: Normal,
    confidence: f64,
    two_sided: f64,
    one_sided: f64,
}

impl Level {
    /// # Errors
    /// A confidence outside (0, 1).
    pub fn new(confidence: f64) -> Result<Self> {
        let inside = confidence > 0.0 && confidence < 1.0;
        let normal = Normal::new(0.0, 1.0).ok().filter(|_| inside);
        let Some(normal) = normal else {
            let message = format!("The confidence is {confidence}; it must lie between 0 and 1.");
            return Err(Error::invalid(message));
        };
        Ok(Level {
            confidence,
            two_sided: normal.inverse_cdf(0.5 + 0.5 * confidence),
            one_sided: normal.inverse_cdf(confidence),
            normal,
        })
    }

    /// Quantile of the normal, both sides.
    pub fn quantile(&self) -> f64 {
        self.two_sided
    }

    /// Half width about zero that holds a normal quantity of this mean and
    /// standard deviation with the confidence: P(|mean + std·Z| ≤ w).
    ///
    /// Newton's method between two widths that hold it: one sided and about zero from
    /// below, about the mean from above.
    pub fn half_width(&self, mean: f64, std: f64) -> f64 {
        let mean = mean.abs();
        let mut low = (self.two_sided * std).max(mean + self.one_sided * std);
        if mean == 0.0 || std == 0.0 || !(mean.is_finite() && std.is_finite()) {
            return low.max(0.0);
        }
        let mut high = mean + self.two_sided * std;
        let mut w = low;
        for _ in 0..STEPS {
            let [near, far] = [(w - mean) / std, (w + mean) / std];
            let missing = self.confidence - (self.normal.cdf(near) - self.normal.cdf(-far));
            let slope = (self.normal.pdf(near) + self.normal.pdf(far)) / std;
            if missing.abs() <= TOLERANCE {
                break;
            }
            if missing > 0.0 {
                low = w
            } else {
                high = w
            }
            let next = w + missing / slope;
            w = if low < next && next < high { next } else { 0.5 * (low + high) };
        }
        w
    }
}
