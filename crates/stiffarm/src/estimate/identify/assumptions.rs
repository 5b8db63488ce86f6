//! What an estimate assumes: the estimator, the size of the noise, prior knowledge.

use serde::{Deserialize, Serialize};

/// How the unknowns are estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Estimator {
    /// Generalised least squares with two variances, that of the readings and
    /// that of shifts common to a posture's points, by restricted maximum
    /// likelihood; Student's t on 3·postures − n degrees of freedom.
    #[default]
    TwoVariance,
    /// Least squares, all displacement components alike and independent.
    Ordinary,
    /// Least squares with the covariance of the readings: how often each was
    /// taken, unloaded readings that load states share, the tracker's model,
    /// the cell's declared common part.
    Weighted,
    /// Huber's estimator (Ann. Math. Statist. 35, 1964, 73–101,
    /// doi:10.1214/aoms/1177703732) on whole displacements: one that does not
    /// fit counts less.
    Huber,
    /// Two variances, no compliance below zero (Lawson & Hanson 1974, ch. 23).
    NonNegative,
    /// Two variances and the cell's prior stiffness as further knowledge
    /// (maximum a posteriori).
    Prior,
}

impl Estimator {
    /// All estimators.
    pub const ALL: [Estimator; 6] = [
        Estimator::TwoVariance,
        Estimator::Ordinary,
        Estimator::Weighted,
        Estimator::Huber,
        Estimator::NonNegative,
        Estimator::Prior,
    ];

    /// Name on the command line and in tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Estimator::TwoVariance => "two-variance",
            Estimator::Ordinary => "ordinary",
            Estimator::Weighted => "weighted",
            Estimator::Huber => "huber",
            Estimator::NonNegative => "non-negative",
            Estimator::Prior => "prior",
        }
    }

    /// True where the intervals are exact, or conservative, for normal errors:
    /// linear estimators with Student's t or normal quantiles.
    pub fn is_exact(self) -> bool {
        matches!(self, Estimator::TwoVariance | Estimator::Ordinary | Estimator::Weighted)
    }

    /// True where both variances are estimated.
    pub(super) fn has_shifts(self) -> bool {
        matches!(self, Estimator::TwoVariance | Estimator::NonNegative | Estimator::Prior)
    }
}

/// What is known about the size of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// Nothing: it is estimated from the residuals.
    Estimated,
    /// σ of a displacement component \[m\], and the ratio γ = τ²/σ² of shifts.
    Known {
        /// σ.
        sigma: f64,
        /// γ.
        gamma: f64,
    },
    /// σ from repeated readings, with its degrees of freedom \[m\].
    Repeats {
        /// σ.
        sigma: f64,
        /// Degrees of freedom behind it.
        degrees_of_freedom: usize,
    },
}

/// Knowledge about the springs before the measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct PriorKnowledge {
    /// Compliance of each spring \[rad/(N·m)\].
    pub compliance: Vec<f64>,
    /// Relative standard deviation of each.
    pub relative_std: f64,
}

/// What is assumed while estimating.
#[derive(Debug, Clone)]
pub struct Assumptions {
    /// The estimator.
    pub estimator: Estimator,
    /// The size of the noise.
    pub scale: Scale,
    /// γ that a weighted fit takes as given.
    pub declared_ratio: f64,
    /// Prior knowledge, for [`Estimator::Prior`].
    pub prior: Option<PriorKnowledge>,
}
