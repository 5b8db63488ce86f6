//! How a fit answers to a change of its displacements, with everything held
//! that it took from the data besides: the ratio of the two variances, Huber's
//! weights, the compliances held at zero. So the answer is linear.

use super::assumptions::Estimator;
use super::fit::Fit;
use super::solve::with_prior_rows;
use crate::error::Result;
use crate::numerics::information::Factor;
use nalgebra::{DMatrix, DVector};

/// The rows of a fit as it weighs them: independent and alike, √weight of Huber in
/// them, those of a prior below.
#[derive(Debug)]
pub(crate) struct Response {
    fit: Fit,
    /// γ = τ²/σ².
    gamma: f64,
    psi: DMatrix<f64>,
    /// The measured displacements.
    delta: DVector<f64>,
    /// Factor of the columns that are free, where it is not the fit's.
    factor: Option<Factor>,
    /// Unknowns that are not held.
    free: Vec<usize>,
}

impl Response {
    /// # Errors
    /// A decomposition that fails.
    pub(crate) fn new(fit: &Fit) -> Result<Self> {
        let (whitened, solution) = (fit.prepared().whitened(), fit.solution());
        let (assumed, springs) = (fit.assumed(), fit.system().springs);
        let mut psi = whitened.with_shifts(whitened.psi(), solution.gamma);
        weigh(fit, &mut psi);
        let mut delta = weighed(fit, &fit.system().delta, solution.gamma);
        let prior = assumed.prior.as_ref().zip(solution.sigma);
        if let (Estimator::Prior, Some((prior, sigma))) = (assumed.estimator, prior) {
            (psi, delta) = with_prior_rows(psi, delta, springs, prior, sigma);
        }
        let held = match assumed.estimator {
            Estimator::NonNegative => &solution.at_bound[..],
            _ => &[],
        };
        let free: Vec<usize> = (0..psi.ncols()).filter(|j| !held.contains(j)).collect();
        let needs_factor = solution.weights.is_some() || free.len() < psi.ncols();
        let factor =
            if needs_factor && !free.is_empty() { Some(Factor::new(&psi.select_columns(&free))?) } else { None };
        Ok(Response { fit: fit.clone(), gamma: solution.gamma, psi, delta, factor, free })
    }

    /// The fit with random effects u whose whitened columns are `random`, with the ratio `gamma`. The equations of a
    /// mixed model are those of least squares with the rows `roots` u = `below` more, which have the variance σ²; an
    /// effect whose own row there is zero is none.
    ///
    /// # Errors
    /// A decomposition that fails.
    pub(crate) fn with_random(
        fit: &Fit,
        random: &DMatrix<f64>,
        (roots, below): (&DMatrix<f64>, &DVector<f64>),
        gamma: f64,
    ) -> Result<Self> {
        let whitened = fit.prepared().whitened();
        let (rows, fixed) = whitened.psi().shape();
        let count = fixed + random.ncols();
        let mut psi = whitened.psi().clone().resize_horizontally(count, 0.0);
        psi.columns_mut(fixed, random.ncols()).copy_from(random);
        let mut psi = whitened.with_shifts(&psi, gamma).resize_vertically(rows + roots.nrows(), 0.0);
        psi.view_mut((rows, fixed), roots.shape()).copy_from(roots);
        let free: Vec<usize> = (0..count)
            .filter(|j| match j.checked_sub(fixed) {
                Some(random) => roots[(random, random)] != 0.0,
                None => !fit.solution().undetermined.contains(j),
            })
            .collect();
        let delta = weighed(fit, &fit.system().delta, gamma);
        let mut delta = delta.resize_vertically(psi.nrows(), 0.0);
        delta.rows_mut(rows, below.len()).copy_from(below);
        Ok(Response {
            fit: fit.clone(),
            gamma,
            delta,
            factor: Some(Factor::new(&psi.select_columns(&free))?),
            psi,
            free,
        })
    }

    /// The measured displacements as the fit weighs them.
    pub(crate) fn delta(&self) -> &DVector<f64> {
        &self.delta
    }

    /// γ = τ²/σ².
    pub(crate) fn gamma(&self) -> f64 {
        self.gamma
    }

    /// A change of the displacements (rows as in the system, m) as the fit weighs
    /// them; the rows of a prior and of random effects do not change.
    ///
    /// # Panics
    /// If there is not one entry per row of the system.
    pub(crate) fn weighed(&self, shift: &DVector<f64>) -> DVector<f64> {
        weighed(&self.fit, shift, self.gamma).resize_vertically(self.psi.nrows(), 0.0)
    }

    /// Change of the unknowns when the weighed displacements change by `weighed`.
    pub(crate) fn of(&self, weighed: &DVector<f64>) -> DVector<f64> {
        let mut out = DVector::zeros(self.psi.ncols());
        if self.free.is_empty() {
            return out;
        }
        let factor = self.factor.as_ref();
        let change = factor.unwrap_or(&self.fit.solution().factor).solve(weighed);
        for (j, value) in self.free.iter().zip(change.iter()) {
            out[*j] = *value;
        }
        out
    }

    /// What is left of weighed displacements when the unknowns are `values`.
    pub(crate) fn left(&self, weighed: &DVector<f64>, values: &DVector<f64>) -> DVector<f64> {
        weighed - &self.psi * values
    }
}

/// Displacements, or a change of them, as the fit weighs them.
fn weighed(fit: &Fit, shift: &DVector<f64>, gamma: f64) -> DVector<f64> {
    let whitened = fit.prepared().whitened();
    let white = whitened.delta_with_shifts(&whitened.whiten(shift), gamma);
    let mut out = DMatrix::from_columns(&[white]);
    weigh(fit, &mut out);
    out.column(0).into_owned()
}

/// Rows times the roots of Huber's weights, where there are any.
fn weigh(fit: &Fit, rows: &mut DMatrix<f64>) {
    for (d, weight) in fit.solution().weights.iter().flatten().enumerate() {
        rows.rows_mut(3 * d, 3).scale_mut(weight.sqrt());
    }
}
