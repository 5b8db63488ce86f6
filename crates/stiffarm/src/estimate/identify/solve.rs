//! The estimators: from a whitened system and its displacements to values of
//! the unknowns with their covariance. All by QR and SVD.

use super::assumptions::{Assumptions, Estimator, PriorKnowledge, Scale};
use super::covariance::Covariance;
use super::huber::{self, Huber};
use super::non_negative::non_negative;
use super::system::MeasuredSystem;
use super::whitened::Whitened;
use crate::error::{Code, Error, Result};
use crate::numerics::information::Factor;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

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
                block.covariance = Covariance::default();
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
        for ranges in chosen.iter().map(|b| &self.groups[*b]) {
            let from = ranges.first().map_or(0, |g| g.start);
            let moved = ranges.iter().map(|g| at + g.start - from..at + g.end - from);
            groups.push(moved.collect());
            at += ranges.iter().map(Range::len).sum::<usize>();
        }
        let prepared = Prepared { whitened, springs: self.springs, groups };
        Ok((prepared, white))
    }

    /// The same with one further unknown, its column of Ψ given.
    ///
    /// # Errors
    /// As [`Whitened::extended`].
    pub(super) fn extended(&self, column: &DVector<f64>) -> Result<Self> {
        Ok(Prepared { whitened: self.whitened.extended(column)?, springs: self.springs, groups: self.groups.clone() })
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
        let system = &self.whitened;
        let shape = self.shape();
        let ratio = || system.variance_ratio(white);
        let rows = |gamma: f64| {
            let (psi, delta) = self.shifted(white, gamma);
            let factor = if gamma > 0.0 { Factor::new(&psi)? } else { system.factor().clone() };
            Ok(Rows { psi, delta, rest: 0.0, factor })
        };
        least_squares(shape, self.springs, assumed, ratio, rows)
    }

    fn shape(&self) -> Shape {
        let system = &self.whitened;
        Shape {
            rows: system.rows(),
            rank: system.factor().rank(),
            shifts: system.shifts(),
            separable: system.is_separable(),
        }
    }

    /// Degrees of freedom behind the intervals where readings alone tell their scatter.
    pub(crate) fn interval_degrees_of_freedom(&self, estimator: Estimator) -> usize {
        self.shape().interval_degrees_of_freedom(estimator)
    }

    /// Number of springs: the unknowns before the extra terms.
    pub(super) fn springs(&self) -> usize {
        self.springs
    }

    /// Rows of Ψ and displacements with shifts of ratio γ made independent.
    pub(super) fn shifted(&self, white: &DVector<f64>, gamma: f64) -> (DMatrix<f64>, DVector<f64>) {
        let psi = self.whitened.with_shifts(self.whitened.psi(), gamma);
        (psi, self.whitened.delta_with_shifts(white, gamma))
    }

    fn huber(&self, white: &DVector<f64>, assumed: &Assumptions) -> Result<Solution> {
        let psi = self.whitened.psi();
        let Huber { values, weights, covariance, sigma } =
            huber::huber(psi, self.whitened.factor(), white, &self.groups.concat())?;
        let rank = self.whitened.factor().rank();
        let free = psi.nrows() - rank.min(psi.nrows());
        let (covariance, t_degrees_of_freedom) = match assumed.scale {
            Scale::Known { sigma: known_sigma, .. } if sigma > 0.0 => {
                (covariance.map(|c| c * (known_sigma / sigma).powi(2)), None)
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
}

/// What the choice of γ and the degrees of freedom depend on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    pub rows: usize,
    /// Rank of Ψ.
    pub rank: usize,
    /// Number of shifts.
    pub shifts: usize,
    /// True where the data can tell shifts from noise.
    pub separable: bool,
}

impl Shape {
    fn degrees_of_freedom(self) -> usize {
        self.rows.saturating_sub(self.rank)
    }

    /// What shifts leave of them: 3·postures − n; `None` where the data cannot tell shifts from noise.
    fn free_shifts(self) -> Option<usize> {
        let free = self.shifts.saturating_sub(self.rank);
        (self.separable && free > 0).then_some(free)
    }

    fn interval_degrees_of_freedom(self, estimator: Estimator) -> usize {
        let free = self.degrees_of_freedom();
        let shifts = self.free_shifts().filter(|_| estimator.has_shifts());
        shifts.map_or(free, |shifts| free.min(shifts))
    }
}

/// Independent rows from which the unknowns follow by least squares.
#[derive(Debug)]
pub(super) struct Rows {
    pub psi: DMatrix<f64>,
    pub delta: DVector<f64>,
    /// Squares that no unknown explains, beyond those of these rows.
    pub rest: f64,
    pub factor: Factor,
}

/// Least squares by one of the linear estimators: `ratio` estimates γ, `rows`
/// gives the rows made independent at γ.
///
/// # Errors
/// Those of `rows`; a prior estimate without prior knowledge.
pub(super) fn least_squares(
    shape: Shape,
    springs: usize,
    assumed: &Assumptions,
    ratio: impl FnOnce() -> f64,
    rows: impl FnOnce(f64) -> Result<Rows>,
) -> Result<Solution> {
    let free = shape.degrees_of_freedom();
    let mut independent_rows = !assumed.estimator.has_shifts();
    let t_dof = shape.interval_degrees_of_freedom(assumed.estimator);
    let gamma = match (assumed.estimator, assumed.scale) {
        (Estimator::Ordinary, _) => 0.0,
        (Estimator::Weighted, _) => assumed.declared_ratio,
        (_, Scale::Known { gamma, .. }) => gamma,
        _ if shape.free_shifts().is_some() => ratio(),
        _ => {
            independent_rows = shape.separable;
            0.0
        }
    };
    let rows = rows(gamma)?;
    let values = rows.factor.solve(&rows.delta);
    let residual = &rows.delta - &rows.psi * &values;
    let size = residual.norm_squared() + rows.rest;
    let estimated = (free > 0).then(|| (size / free as f64).sqrt());
    let (sigma, t_degrees_of_freedom) = match assumed.scale {
        Scale::Known { sigma, .. } => (Some(sigma), None),
        Scale::Repeats { sigma, degrees_of_freedom } => (Some(sigma), Some(degrees_of_freedom)),
        Scale::Estimated => (estimated, Some(t_dof)),
    };
    let base = Solution {
        values,
        covariance: sigma.map(|s| rows.factor.inverse_information() * (s * s)),
        undetermined: rows.factor.undetermined().to_vec(),
        degrees_of_freedom: free,
        t_degrees_of_freedom,
        sigma,
        residual_std: estimated,
        gamma,
        factor: rows.factor,
        weights: None,
        at_bound: Vec::new(),
        independent_rows,
    };
    let (psi, delta) = (rows.psi, rows.delta);
    match assumed.estimator {
        Estimator::NonNegative => bounded(&psi, &delta, springs, base),
        Estimator::Prior => with_prior(psi, delta, springs, base, assumed),
        _ => Ok(base),
    }
}

/// The same fit with no spring compliance below zero.
fn bounded(psi: &DMatrix<f64>, delta: &DVector<f64>, springs: usize, base: Solution) -> Result<Solution> {
    let (values, free) = non_negative(psi, delta, springs)?;
    // What the data say nothing about is not held by them.
    let held = |j: &usize| !free.contains(j) && !base.undetermined.contains(j);
    let at_bound: Vec<usize> = (0..springs).filter(held).collect();
    Ok(Solution { values, at_bound, ..base })
}

/// Rows of the data with those of a prior below them, all in units of σ.
pub(super) fn with_prior_rows(
    psi: DMatrix<f64>,
    delta: DVector<f64>,
    springs: usize,
    prior: &PriorKnowledge,
    sigma: f64,
) -> (DMatrix<f64>, DVector<f64>) {
    let rows = psi.nrows();
    let mut psi = psi.resize_vertically(rows + springs, 0.0);
    let mut delta = delta.resize_vertically(rows + springs, 0.0);
    for (j, h) in prior.compliance.iter().enumerate().take(springs) {
        let weight = sigma / (prior.relative_std * h);
        psi[(rows + j, j)] = weight;
        delta[rows + j] = weight * h;
    }
    (psi, delta)
}

/// The same fit with the prior compliance as further rows.
fn with_prior(
    psi: DMatrix<f64>,
    delta: DVector<f64>,
    springs: usize,
    base: Solution,
    assumed: &Assumptions,
) -> Result<Solution> {
    let prior = assumed.prior.as_ref().ok_or_else(|| {
        Error::new(Code::MissingKey, "This estimate needs a prior joint stiffness, and the cell has none.")
            .key("stiffness.prior_nm_per_rad")
    })?;
    let Some(sigma) = base.sigma.filter(|s| *s > 0.0) else {
        let message = "Weighing the prior against the data needs the size of the noise, and the data leave no \
                       degree of freedom to judge it.";
        return Err(
            Error::new(Code::TooFewData, message).hint("take the size of the noise from the cell (noise known)")
        );
    };
    debug_assert!(psi.ncols() >= springs);
    let (psi, delta) = with_prior_rows(psi, delta, springs, prior, sigma);
    let factor = Factor::new(&psi)?;
    Ok(Solution {
        values: factor.solve(&delta),
        covariance: Some(factor.inverse_information() * (sigma * sigma)),
        undetermined: factor.undetermined().to_vec(),
        factor,
        ..base
    })
}
