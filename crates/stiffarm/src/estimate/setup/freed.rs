//! One quantity freed: where the readings want it, and how much likelier they are with it there.

use super::quantity::{Frame, Kind, Place, step};
use crate::error::Result;
use crate::estimate::elastic::carried_near;
use crate::estimate::identify::{Fit, Response};
use crate::estimate::mixed::MixedFit;
use crate::numerics::information::Factor;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Most steps of Gauss and Newton, and how often one is tried, each time shorter: of the axes alone, and of the dearer
/// model with springs beyond them, which begins where the axes end.
const AXES: (usize, usize) = (15, 4);
const MIXED: (usize, usize) = (1, 2);
/// Longest step \[m; rad\], and of a force \[N\].
const FAR: f64 = 0.5;
const FAR_FORCE: f64 = 200.0;
/// Change of −2 ln L that ends the search.
const STILL: f64 = 1e-2;

/// The experiment fitted with a quantity at some value.
#[derive(Clone)]
pub(super) struct At {
    pub place: Place,
    pub fit: Fit,
    /// Springs beyond the axes, where they are granted.
    pub mixed: Option<Arc<MixedFit>>,
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

/// One step of least squares with the quantity among the unknowns.
struct Step {
    change: DVector<f64>,
    errors: DVector<f64>,
    /// Sum of squares before, and what the step takes off.
    squares: [f64; 2],
}

impl At {
    /// The fit as it is, with springs beyond the axes where the readings carry these and `is_mixed` grants them, looked for
    /// near those of `near`.
    pub(super) fn new(
        place: Place,
        fit: Fit,
        is_mixed: bool,
        near: Option<&MixedFit>,
    ) -> Result<Self> {
        let mixed = match is_mixed {
            true => carried_near(&fit, near)?.ok(),
            false => None,
        };
        Ok(At {
            place,
            value: value(&fit, mixed.as_ref()),
            mixed: mixed.map(Arc::new),
            fit,
        })
    }
}

/// A fit as it answers to small changes of what was measured.
pub(super) struct Linear<'a> {
    fit: &'a Fit,
    response: Response<'a>,
    values: &'a DVector<f64>,
    /// What it leaves, as it weighs the rows.
    rest: DVector<f64>,
}

impl<'a> Linear<'a> {
    /// Of the axes alone, or with springs beyond them.
    pub(super) fn new(fit: &'a Fit, mixed: Option<&'a MixedFit>) -> Option<Self> {
        let (response, values) = match mixed {
            Some(mixed) => (mixed.response().ok()?, &mixed.compliance().values),
            None => (Response::new(fit).ok()?, &fit.solution().values),
        };
        let delta = response.delta();
        let rest = response.left(delta, &response.of(delta));
        Some(Linear {
            fit,
            response,
            values,
            rest,
        })
    }
}

impl Frame<'_> {
    /// The fit with the quantity at `place`; `None` where it cannot be had.
    pub(super) fn at(
        &self,
        kind: Kind,
        place: Place,
        is_mixed: bool,
        near: Option<&MixedFit>,
    ) -> Option<At> {
        let (cell, measured) = self.changed(kind, &place).ok()?;
        let fit = Fit::new(&cell, measured, self.fit.options()).ok()?;
        let found = At::new(place, fit, is_mixed, near).ok()?;
        found.value.is_finite().then_some(found)
    }

    /// One step of least squares from `place`, where the fit is `linear`.
    fn step(&self, kind: Kind, place: &Place, linear: &Linear<'_>) -> Option<Step> {
        let count = place.values.len();
        if count == 0 {
            return None;
        }
        let (response, system) = (&linear.response, linear.fit.system());
        let values = linear.values.rows(0, system.psi.ncols()).into_owned();
        let h = step(kind);
        let mut own = DMatrix::zeros(linear.rest.len(), count);
        for k in 0..count {
            let beside = |by: f64| {
                let mut place = place.clone();
                place.values[k] += by;
                self.missed(kind, &place, &values)
            };
            let slope = (beside(h).ok()? - beside(-h).ok()?) / (2.0 * h);
            let weighed = response.weighed(&slope);
            own.set_column(k, &response.left(&weighed, &response.of(&weighed)));
        }
        let (rest, solution) = (&linear.rest, linear.fit.solution());
        let factor = Factor::new(&own).ok()?;
        let change = factor.solve(rest);
        let after = (rest - &own * &change).norm_squared();
        let before = rest.norm_squared();
        let free = rest.len().saturating_sub(values.len() + count).max(1);
        let sigma = solution.sigma.unwrap_or((after / free as f64).sqrt());
        let errors = factor.standard_errors().into_iter();
        let errors = errors.map(|e| e.map_or(f64::INFINITY, |e| e * sigma));
        Some(Step {
            errors: DVector::from_iterator(count, errors),
            change,
            squares: [before, before - after],
        })
    }

    fn step_of(&self, kind: Kind, at: &At) -> Option<Step> {
        let linear = Linear::new(&at.fit, at.mixed.as_deref())?;
        self.step(kind, &at.place, &linear)
    }

    /// By how much −2 ln L of a fit with everything as stated would fall with the quantity freed, by the derivatives there.
    pub(super) fn score(&self, kind: Kind, stated: &Place, linear: &Linear<'_>) -> f64 {
        let Some(step) = self.step(kind, stated, linear) else {
            return 0.0;
        };
        let [before, less] = step.squares;
        let free = linear.fit.solution().degrees_of_freedom;
        let rest = (1.0 - less / before).max(f64::MIN_POSITIVE);
        -(free as f64) * rest.ln()
    }

    /// The value that suits the readings best near `start`.
    pub(super) fn refined(&self, kind: Kind, start: At) -> At {
        let is_mixed = start.mixed.is_some();
        let (steps, shorter) = if is_mixed { MIXED } else { AXES };
        let mut at = start;
        for _ in 0..steps {
            let Some(step) = self.step_of(kind, &at) else {
                return at;
            };
            let is_force = matches!(kind, Kind::Beside | Kind::Offset);
            let far = if is_force { FAR_FORCE } else { FAR };
            let mut share = (far / step.change.norm()).min(1.0);
            let mut better = None;
            for _ in 0..shorter {
                let place = Place {
                    turn: at.place.turn,
                    values: &at.place.values + &step.change * share,
                };
                let next = self.at(kind, place, is_mixed, at.mixed.as_deref());
                better = next.filter(|next| next.value < at.value);
                if better.is_some() {
                    break;
                }
                share *= 0.25;
            }
            let Some(next) = better else { return at };
            let fall = at.value - next.value;
            at = next;
            if fall < STILL {
                break;
            }
        }
        at
    }

    /// Standard errors of the numbers of a quantity where it is; `None` where the readings do not tell one.
    pub(super) fn errors(&self, kind: Kind, at: &At) -> Vec<Option<f64>> {
        let step = self.step_of(kind, at);
        let errors = step.map(|step| step.errors);
        let one = |i: usize| Some(errors.as_ref()?[i]).filter(|error| error.is_finite());
        (0..at.place.values.len()).map(one).collect()
    }
}
