//! The estimators: from a whitened system and its displacements to values of
//! the unknowns with their covariance. All by QR and SVD.

use super::huber::{self, Huber};
use super::non_negative::non_negative;
use super::system::MeasuredSystem;
use super::whitened::Whitened;
use crate::error::{Code, Error, Result};
use crate::numerics::information::Factor;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::ops::Range;

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
        matches!(
            self,
            Estimator::TwoVariance | Estimator::Ordinary | Estimator::Weighted
        )
    }

    /// True where both variances are estimated.
    pub(super) fn has_shifts(self) -> bool {
        matches!(
            self,
            Estimator::TwoVariance | Estimator::NonNegative | Estimator::Prior
        )
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

/// Values of the unknowns with what is known about them.
#[derive(Debug, Clone)]
pub struct Solution {
    /// The unknowns.
    pub values: DVector<f64>,
    /// Their covariance, where the size of the noise is known or estimated.
    pub covariance: Option<DMatrix<f64>>,
    /// Unknowns that are not determined.
    pub undetermined: Vec<usize>,
    /// rows − rank.
    pub degrees_of_freedom: usize,
    /// Degrees of freedom of Student's t; `None` for normal quantiles.
    pub t_degrees_of_freedom: Option<usize>,
    /// σ of a displacement component behind the covariance \[m\].
    pub sigma: Option<f64>,
    /// The same as the residuals alone give it \[m\]; `None` without degrees
    /// of freedom.
    pub residual_std: Option<f64>,
    /// γ = τ²/σ².
    pub gamma: f64,
    /// Factor behind the covariance.
    pub factor: Factor,
    /// Huber's weight of each displacement (of each label of the system).
    pub weights: Option<Vec<f64>>,
    /// Springs held at zero compliance by the non-negative fit.
    pub at_bound: Vec<usize>,
    /// True where shifts could not be estimated and rows count as independent.
    pub independent_rows: bool,
}

/// A system made ready for one estimator: what depends on Ψ only.
#[derive(Debug, Clone)]
pub struct Prepared {
    whitened: Whitened,
    springs: usize,
    /// Rows that Huber's estimator weighs together, posture by posture.
    groups: Vec<Vec<Range<usize>>>,
}

impl Prepared {
    /// Prepares a system.
    ///
    /// # Errors
    /// As [`Whitened::new`].
    pub fn new(system: &MeasuredSystem, estimator: Estimator) -> Result<Self> {
        let whitened = if estimator == Estimator::Ordinary {
            let mut plain = system.clone();
            for block in &mut plain.blocks {
                block.covariance = None;
            }
            Whitened::new(&plain)?
        } else {
            Whitened::new(system)?
        };
        Ok(Prepared {
            whitened,
            springs: system.springs,
            groups: system
                .blocks
                .iter()
                .map(|b| system.labels_of(b).iter().map(|l| l.rows.clone()).collect())
                .collect(),
        })
    }

    /// The same for the postures `chosen` (indices of blocks, repeats allowed),
    /// and their rows of the white displacements `white`.
    ///
    /// # Errors
    /// As [`Whitened::select`].
    pub fn select(&self, chosen: &[usize], white: &DVector<f64>) -> Result<(Self, DVector<f64>)> {
        let (whitened, white) = self.whitened.select(chosen, white)?;
        let mut at = 0;
        let mut groups = Vec::with_capacity(chosen.len());
        for own in chosen.iter().map(|b| &self.groups[*b]) {
            let from = own.first().map_or(0, |g| g.start);
            let moved = own.iter().map(|g| at + g.start - from..at + g.end - from);
            groups.push(moved.collect());
            at += own.iter().map(Range::len).sum::<usize>();
        }
        let prepared = Prepared {
            whitened,
            springs: self.springs,
            groups,
        };
        Ok((prepared, white))
    }

    /// The same with one further unknown, its column of Ψ given.
    ///
    /// # Errors
    /// As [`Whitened::extended`].
    pub(super) fn extended(&self, column: &DVector<f64>) -> Result<Self> {
        Ok(Prepared {
            whitened: self.whitened.extended(column)?,
            springs: self.springs,
            groups: self.groups.clone(),
        })
    }

    /// The whitened system.
    pub fn whitened(&self) -> &Whitened {
        &self.whitened
    }

    /// Estimates the unknowns from displacements (rows as in the system).
    ///
    /// # Errors
    /// A decomposition that fails, or a prior estimate without prior knowledge.
    pub fn solve(&self, delta: &DVector<f64>, assumed: &Assumptions) -> Result<Solution> {
        self.solve_white(&self.whitened.whiten(delta), assumed)
    }

    /// [`solve`](Prepared::solve) for displacements that are white already.
    ///
    /// # Errors
    /// As [`solve`](Prepared::solve).
    pub fn solve_white(&self, white: &DVector<f64>, assumed: &Assumptions) -> Result<Solution> {
        if assumed.estimator == Estimator::Huber {
            return self.huber(white, assumed);
        }
        let base = self.least_squares(white, assumed)?;
        match assumed.estimator {
            Estimator::NonNegative => self.bounded(white, base),
            Estimator::Prior => self.with_prior(white, base, assumed),
            _ => Ok(base),
        }
    }

    /// Rows of Ψ and displacements with shifts of ratio γ made independent.
    pub(super) fn shifted(&self, white: &DVector<f64>, gamma: f64) -> (DMatrix<f64>, DVector<f64>) {
        let psi = self.whitened.with_shifts(self.whitened.psi(), gamma);
        (psi, self.shifted_delta(white, gamma))
    }

    /// The same of the displacements alone.
    pub(super) fn shifted_delta(&self, white: &DVector<f64>, gamma: f64) -> DVector<f64> {
        let column = DMatrix::from_columns(std::slice::from_ref(white));
        let delta = self.whitened.with_shifts(&column, gamma);
        delta.column(0).into_owned()
    }

    fn least_squares(&self, white: &DVector<f64>, assumed: &Assumptions) -> Result<Solution> {
        let system = &self.whitened;
        let rank = system.factor().rank();
        let free = system.rows() - rank.min(system.rows());
        let mut independent_rows = !assumed.estimator.has_shifts();
        let mut t_dof = free;
        let gamma = match (assumed.estimator, assumed.scale) {
            (Estimator::Ordinary, _) => 0.0,
            (Estimator::Weighted, _) => assumed.declared_ratio,
            (_, Scale::Known { gamma, .. }) => gamma,
            _ => {
                // t on 3·postures − n degrees of freedom.
                let postures = system.shifts().saturating_sub(rank);
                if system.is_separable() && postures > 0 {
                    t_dof = t_dof.min(postures);
                    system.variance_ratio(white)
                } else {
                    independent_rows = system.is_separable();
                    0.0
                }
            }
        };
        let (psi, delta) = self.shifted(white, gamma);
        let factor = match gamma > 0.0 {
            true => Factor::new(&psi)?,
            false => system.factor().clone(),
        };
        let values = factor.solve(&delta);
        let residual = &delta - &psi * &values;
        let estimated = (free > 0).then(|| (residual.norm_squared() / free as f64).sqrt());
        let (sigma, t_degrees_of_freedom) = match assumed.scale {
            Scale::Known { sigma, .. } => (Some(sigma), None),
            Scale::Repeats {
                sigma,
                degrees_of_freedom,
            } => (Some(sigma), Some(degrees_of_freedom)),
            Scale::Estimated => (estimated, Some(t_dof)),
        };
        Ok(Solution {
            values,
            covariance: sigma.map(|s| factor.inverse_information() * (s * s)),
            undetermined: factor.undetermined().to_vec(),
            degrees_of_freedom: free,
            t_degrees_of_freedom,
            sigma,
            residual_std: estimated,
            gamma,
            factor,
            weights: None,
            at_bound: Vec::new(),
            independent_rows,
        })
    }

    fn huber(&self, white: &DVector<f64>, assumed: &Assumptions) -> Result<Solution> {
        let psi = self.whitened.psi();
        let Huber {
            values,
            weights,
            covariance,
            sigma,
        } = huber::huber(psi, self.whitened.factor(), white, &self.groups.concat())?;
        let rank = self.whitened.factor().rank();
        let free = psi.nrows() - rank.min(psi.nrows());
        let (covariance, t_degrees_of_freedom) = match assumed.scale {
            Scale::Known { sigma: known, .. } if sigma > 0.0 => {
                (covariance.map(|c| c * (known / sigma).powi(2)), None)
            }
            _ => (covariance, Some(free)),
        };
        Ok(Solution {
            values,
            covariance,
            undetermined: self.whitened.factor().undetermined().to_vec(),
            degrees_of_freedom: free,
            t_degrees_of_freedom,
            sigma: Some(sigma),
            residual_std: (free > 0).then_some(sigma),
            gamma: 0.0,
            factor: self.whitened.factor().clone(),
            weights: Some(weights),
            at_bound: Vec::new(),
            independent_rows: true,
        })
    }

    /// The same fit with no spring compliance below zero.
    fn bounded(&self, white: &DVector<f64>, base: Solution) -> Result<Solution> {
        let (psi, delta) = self.shifted(white, base.gamma);
        let (values, free) = non_negative(&psi, &delta, self.springs)?;
        // What the data say nothing about is not held by them.
        let held = |j: &usize| !free.contains(j) && !base.undetermined.contains(j);
        let at_bound: Vec<usize> = (0..self.springs).filter(held).collect();
        Ok(Solution {
            values,
            at_bound,
            ..base
        })
    }

    /// The same fit with the prior compliance as further rows.
    fn with_prior(
        &self,
        white: &DVector<f64>,
        base: Solution,
        assumed: &Assumptions,
    ) -> Result<Solution> {
        let prior = assumed.prior.as_ref().ok_or_else(|| {
            Error::new(
                Code::MissingKey,
                "This estimate needs a prior joint stiffness, and the cell has none.",
            )
            .key("stiffness.prior_nm_per_rad")
        })?;
        let Some(sigma) = base.sigma.filter(|s| *s > 0.0) else {
            let message = "Weighing the prior against the data needs the size of the noise, and the data leave no \
                           degree of freedom to judge it.";
            return Err(Error::new(Code::TooFewData, message)
                .hint("take the size of the noise from the cell (noise known)"));
        };
        let (psi, delta) = self.shifted(white, base.gamma);
        let (rows, unknowns) = psi.shape();
        let mut psi = psi.resize_vertically(rows + self.springs, 0.0);
        let mut delta = delta.resize_vertically(rows + self.springs, 0.0);
        for (j, h) in prior.compliance.iter().enumerate().take(self.springs) {
            // In units of σ, as the rows of the data.
            let weight = sigma / (prior.relative_std * h);
            psi[(rows + j, j)] = weight;
            delta[rows + j] = weight * h;
        }
        debug_assert!(unknowns >= self.springs);
        let factor = Factor::new(&psi)?;
        Ok(Solution {
            values: factor.solve(&delta),
            covariance: Some(factor.inverse_information() * (sigma * sigma)),
            undetermined: factor.undetermined().to_vec(),
            factor,
            ..base
        })
    }
}
