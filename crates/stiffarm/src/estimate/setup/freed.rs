//! Quantities freed: where the readings want them, and how much likelier they are with them there.

use crate::error::Result;
use crate::estimate::elastic::carried_near;
use crate::estimate::identify::{Fit, Response};
use crate::estimate::mixed::{MixedFit, Sizes};
use crate::estimate::quantity::answer::Answers;
use crate::estimate::quantity::stated::StatedExperiment;
use crate::estimate::quantity::value::QuantityAtValue;
use crate::numerics::information::Factor;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Most steps of Gauss and Newton, and how often one is tried, each time shorter: of the axes alone, and of the dearer
/// model with springs beyond them, which begins where the axes end.
const AXES: (usize, usize) = (15, 4);
const MIXED: (usize, usize) = (1, 2);
/// Change of −2 ln L that ends a search.
pub(super) const SETTLED_LIKELIHOOD: f64 = 1e-2;

/// The experiment fitted with quantities at some values.
#[derive(Clone)]
pub(super) struct QuantityFit {
    pub values: Vec<QuantityAtValue>,
    pub fit: Fit,
    /// Springs beyond the axes, where they are granted, until [`forget`](Self::forget).
    pub mixed: Option<Arc<MixedFit>>,
    /// Their sizes.
    pub sizes: Option<Sizes>,
    /// −2 ln L, restricted, with them or of the axes alone.
    pub value: f64,
}

/// −2 ln L, restricted, of a fit or of the mixed model that goes on from it. That no joint yields against its torque is
/// known beforehand: each compliance below zero adds the square of how far, in standard errors.
pub(super) fn value(fit: &Fit, mixed: Option<&MixedFit>) -> f64 {
    let ratio = mixed.map_or(0.0, MixedFit::likelihood_ratio);
    // In units of the cell's noise, so that fits which determine more joints or fewer can be compared.
    let free = fit.solution().degrees_of_freedom as f64;
    let unit = free * ((free * fit.cell().noise.displacement_variance()).ln() - 1.0);
    fit.restricted_value() - unit - ratio + below_zero(fit, mixed)
}

/// The squares of the compliances below zero in their standard errors.
pub(super) fn below_zero(fit: &Fit, mixed: Option<&MixedFit>) -> f64 {
    let solution = fit.solution();
    let spread = mixed.and_then(|mixed| mixed.compliance().spread.as_ref());
    let (values, covariance) = match (mixed, spread) {
        (Some(mixed), Some(spread)) => (&mixed.compliance().values, Some(&spread.covariance)),
        _ => (&solution.values, solution.covariance.as_ref()),
    };
    let springs = 0..fit.system().springs;
    let below = springs.filter(|j| values[*j] < 0.0 && !solution.undetermined.contains(j));
    let squares = below.filter_map(|j| Some(values[j].powi(2) / covariance?[(j, j)]));
    squares.filter(|square| square.is_finite()).sum()
}

/// One step of least squares with the quantities among the unknowns.
struct Step {
    change: DVector<f64>,
    errors: DVector<f64>,
    /// Sum of squares before, and what the step takes off.
    squares: [f64; 2],
}

impl Step {
    fn gain(&self, fit: &Fit) -> f64 {
        let [before, less] = self.squares;
        let rest = (1.0 - less / before).max(f64::MIN_POSITIVE);
        -(fit.solution().degrees_of_freedom as f64) * rest.ln()
    }
}

impl QuantityFit {
    /// How many numbers are free.
    pub(super) fn numbers(&self) -> usize {
        self.values.iter().map(|(_, place)| place.values.len()).sum()
    }

    /// The fit as it is, with springs beyond the axes where the readings carry these and `is_mixed` grants them, looked
    /// for near those of `near`.
    pub(super) fn new(values: Vec<QuantityAtValue>, fit: Fit, is_mixed: bool, near: Option<&Sizes>) -> Result<Self> {
        let mixed = match is_mixed {
            true => carried_near(&fit, near)?.ok(),
            false => None,
        };
        let sizes = mixed.as_ref().map(|mixed| mixed.sizes().clone());
        Ok(QuantityFit { values, value: value(&fit, mixed.as_ref()), mixed: mixed.map(Arc::new), sizes, fit })
    }

    /// The fit without the model that goes on from it: several of them would be many times the readings.
    pub(super) fn forget(self) -> Self {
        QuantityFit { mixed: None, ..self }
    }
}

/// A fit as it answers to small changes of what was measured.
pub(super) struct Linear<'a> {
    fit: &'a Fit,
    response: Arc<Response>,
    answers: Answers<'a>,
    /// σ, where springs beyond the axes leave it.
    sigma: Option<f64>,
    /// What it leaves, as it weighs the rows.
    rest: DVector<f64>,
}

impl<'a> Linear<'a> {
    /// Of the axes alone, or with springs beyond them.
    pub(super) fn new(stated: &'a StatedExperiment<'a>, fit: &'a Fit, mixed: Option<&'a MixedFit>) -> Option<Self> {
        let (response, values) = match mixed {
            Some(mixed) => (mixed.response().ok()?, &mixed.compliance().values),
            None => (Arc::new(Response::new(fit).ok()?), &fit.solution().values),
        };
        let delta = response.delta();
        let rest = response.left(delta, &response.of(delta));
        let system = fit.system();
        let values = values.rows(0, system.psi.ncols()).into_owned();
        Some(Linear {
            fit,
            response,
            sigma: mixed.and_then(|mixed| Some(mixed.compliance().spread.as_ref()?.sigma)),
            answers: Answers::new(stated, &system.extra, values).ok()?,
            rest,
        })
    }
}

impl StatedExperiment<'_> {
    /// The fit with quantities at these values; `None` where it cannot be had.
    pub(super) fn at(&self, values: Vec<QuantityAtValue>, is_mixed: bool, near: Option<&Sizes>) -> Option<QuantityFit> {
        let (cell, measured) = self.changed(&values).ok()?;
        let fit = Fit::new(&cell, measured, self.fit.options()).ok()?;
        let at = QuantityFit::new(values, fit, is_mixed, near).ok()?;
        at.value.is_finite().then_some(at)
    }

    /// One step of least squares from `values`, where the fit is `linear`.
    fn step(&self, values: &[QuantityAtValue], linear: &Linear<'_>) -> Option<Step> {
        let response = &linear.response;
        let mut columns = Vec::new();
        for (which, (_, place)) in values.iter().enumerate() {
            for k in 0..place.values.len() {
                let slope = linear.answers.slope(values, which, k).ok()?;
                let weighed = response.weighed(&slope);
                columns.push(response.left(&weighed, &response.of(&weighed)));
            }
        }
        if columns.is_empty() {
            return None;
        }
        let (jacobian, count) = (DMatrix::from_columns(&columns), columns.len());
        let (rest, solution) = (&linear.rest, linear.fit.solution());
        let factor = Factor::new(&jacobian).ok()?;
        let change = factor.solve(rest);
        let after = (rest - &jacobian * &change).norm_squared();
        let before = rest.norm_squared();
        let unknowns = linear.fit.system().psi.ncols();
        let free = rest.len().saturating_sub(unknowns + count).max(1);
        let sigma = linear.sigma.or(solution.sigma);
        let sigma = sigma.unwrap_or((after / free as f64).sqrt());
        let errors = factor.standard_errors().into_iter();
        let errors = errors.map(|e| e.map_or(f64::INFINITY, |e| e * sigma));
        Some(Step { errors: DVector::from_iterator(count, errors), change, squares: [before, before - after] })
    }

    fn step_of(&self, at: &QuantityFit) -> Option<Step> {
        let linear = Linear::new(self, &at.fit, at.mixed.as_deref())?;
        self.step(&at.values, &linear)
    }

    /// By how much −2 ln L of a fit with everything as stated would fall with the quantity freed, by the derivatives
    /// there.
    pub(super) fn score(&self, stated: &QuantityAtValue, linear: &Linear<'_>) -> f64 {
        let step = self.step(std::slice::from_ref(stated), linear);
        step.map_or(0.0, |step| step.gain(linear.fit))
    }

    /// By how much it would fall with one more step from `at`.
    pub(super) fn gain(&self, at: &QuantityFit) -> f64 {
        self.step_of(at).map_or(0.0, |step| step.gain(&at.fit))
    }

    /// The values that suit the readings best near `start`.
    pub(super) fn refined(&self, start: QuantityFit) -> QuantityFit {
        let is_mixed = start.mixed.is_some();
        let (steps, shorter) = if is_mixed { MIXED } else { AXES };
        let mut at = start;
        for _ in 0..steps {
            let Some(step) = self.step_of(&at) else {
                return at;
            };
            let mut share = longest_share(&at.values, &step.change);
            let mut better = None;
            for _ in 0..shorter {
                let values = moved(&at.values, &step.change, share);
                let next = self.at(values, is_mixed, at.sizes.as_ref());
                better = next.filter(|next| next.value < at.value);
                if better.is_some() {
                    break;
                }
                share *= 0.25;
            }
            let Some(next) = better else { return at };
            let fall = at.value - next.value;
            at = next;
            if fall < SETTLED_LIKELIHOOD {
                break;
            }
        }
        at
    }

    /// Standard errors of the numbers of the quantities where they are, one after the other; `None` where the readings
    /// do not tell one.
    pub(super) fn errors(&self, at: &QuantityFit) -> Vec<Option<f64>> {
        let step = self.step_of(at);
        let errors = step.map(|step| step.errors);
        let one = |i: usize| Some(errors.as_ref()?[i]).filter(|error| error.is_finite());
        (0..at.numbers()).map(one).collect()
    }
}

/// The share of a step that no quantity takes farther than it may.
fn longest_share(values: &[QuantityAtValue], change: &DVector<f64>) -> f64 {
    let (mut share, mut from) = (1.0_f64, 0);
    for (quantity, place) in values {
        let count = place.values.len();
        share = share.min(quantity.farthest_step() / change.rows(from, count).norm());
        from += count;
    }
    share
}

fn moved(values: &[QuantityAtValue], change: &DVector<f64>, share: f64) -> Vec<QuantityAtValue> {
    let mut out = values.to_vec();
    let mut from = 0;
    for (_, place) in &mut out {
        let count = place.values.len();
        place.values += change.rows(from, count) * share;
        from += count;
    }
    out
}
