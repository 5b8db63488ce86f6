//! What the readings gave, or are expected to give, against which the common errors are held.

use crate::error::Result;
use crate::estimate::identify::{Fit, Response, interval_quantile, quantile};
use crate::estimate::mixed::{MixedFit, Reproduced};
use crate::estimate::quantity::facts::Quantity;
use crate::model::elastic::ElasticClass;
use crate::model::observation::ExtraTerm;
use nalgebra::DVector;
use std::sync::Arc;

/// The result of a fit, or of the mixed model that goes on from it.
pub(super) struct PredictingModel<'a> {
    pub fit: &'a Fit,
    /// Compliance of each spring, then extra terms.
    pub values: &'a DVector<f64>,
    /// Compliance of each joint as it is printed \[rad/(N·m)\].
    pub joints: DVector<f64>,
    /// What makes them of the values, where the mixed model predicts.
    reproduced: Option<&'a Reproduced>,
    /// The extra terms.
    pub extra: &'a [ExtraTerm],
    /// How the values answer to a change of the displacements.
    pub response: Arc<Response>,
    /// σ of a displacement component, where anything is known of it \[m\].
    pub sigma: Option<f64>,
    /// Degrees of freedom behind σ; `None` where it is known.
    pub degrees_of_freedom: Option<usize>,
    /// Standard error of each joint's compliance \[rad/(N·m)\].
    pub errors: Vec<Option<f64>>,
    /// Half width of each joint's compliance by the scatter of the readings
    /// \[rad/(N·m)\].
    pub half_widths: Vec<Option<f64>>,
    /// True where springs of the base are among the values, and not of size zero.
    pub base_turns: bool,
    /// What the values change by where springs alone are expected, without bearings and beams; of the mixed model,
    /// where it matters.
    pub springs_alone: Option<DVector<f64>>,
    /// The quantity of the set-up that the readings want elsewhere, and by how much it may be off.
    pub off: Option<(Quantity, f64)>,
    /// What is left of the displacements \[m\], where they are not those of the fit: of those that are not there
    /// yet nothing.
    pub expected: Option<&'a DVector<f64>>,
}

/// Two models whose joints differ by less than this share are one.
const SAME_JOINTS_SHARE: f64 = 1e-6;

impl<'a> PredictingModel<'a> {
    /// # Errors
    /// A decomposition that fails, a quantile that cannot be computed.
    pub(super) fn of_fit(fit: &'a Fit) -> Result<Self> {
        let solution = fit.solution();
        let t = interval_quantile(solution, fit.options().confidence)?;
        let covariance = solution.covariance.as_ref();
        let error = |j: usize| Some(covariance?[(j, j)].max(0.0).sqrt());
        let errors: Vec<Option<f64>> = (0..fit.system().springs).map(error).collect();
        let has_freedom = solution.t_degrees_of_freedom != Some(0);
        Ok(PredictingModel {
            fit,
            values: &solution.values,
            joints: solution.values.rows(0, fit.system().springs).into_owned(),
            reproduced: None,
            extra: &fit.system().extra,
            response: Arc::new(Response::new(fit)?),
            sigma: solution.sigma.filter(|_| has_freedom),
            degrees_of_freedom: solution.t_degrees_of_freedom,
            half_widths: errors.iter().map(|e| Some(t? * (*e)?)).collect(),
            errors,
            base_turns: false,
            springs_alone: None,
            off: None,
            expected: None,
        })
    }

    /// What readings of the experiment behind `fit` are expected to give: `values` and what is `left` of the
    /// displacements, instead of those of the fit, and a scatter of the size that the fit takes as known, told as
    /// well as so many rows tell it.
    ///
    /// # Errors
    /// As [`of_fit`](Self::of_fit).
    pub(super) fn expected(fit: &'a Fit, values: &'a DVector<f64>, left: &'a DVector<f64>) -> Result<Self> {
        let prepared = fit.prepared();
        let degrees = prepared.interval_degrees_of_freedom(fit.options().estimator);
        let t = match degrees {
            0 => None,
            degrees => Some(quantile(Some(degrees), fit.options().confidence)?),
        };
        let fitted = PredictingModel::of_fit(fit)?;
        Ok(PredictingModel {
            values,
            joints: values.rows(0, fit.system().springs).into_owned(),
            sigma: fitted.sigma.filter(|_| degrees > 0),
            degrees_of_freedom: Some(degrees),
            half_widths: fitted.errors.iter().map(|e| Some(t? * (*e)?)).collect(),
            expected: Some(left),
            ..fitted
        })
    }

    /// # Errors
    /// As [`of_fit`](Self::of_fit).
    pub(super) fn of_mixed(mixed: &'a MixedFit) -> Result<Self> {
        let (compliance, reproduced) = (mixed.compliance(), mixed.reproduced()?);
        let springs = mixed.fit().system().springs;
        let (mut errors, mut half_widths) = (vec![None; springs], vec![None; springs]);
        if let Some(spread) = &compliance.spread {
            let quantiles = spread.quantiles()?;
            for j in (0..springs).filter(|j| !compliance.undetermined.contains(j)) {
                let (with, variance) = reproduced.covariance(spread, j);
                errors[j] = Some(variance.sqrt());
                half_widths[j] = Some(variance.sqrt() * quantiles.of(&with, variance, 0.0));
            }
        }
        let joints = reproduced.of(&compliance.values);
        let alone = mixed.springs_alone()?;
        let is_seen = reproduced.of(&alone).amax() > SAME_JOINTS_SHARE * joints.amax();
        Ok(PredictingModel {
            fit: mixed.fit(),
            values: &compliance.values,
            joints,
            reproduced: Some(reproduced),
            extra: &compliance.extra,
            response: mixed.response()?,
            sigma: compliance.spread.as_ref().map(|s| s.sigma),
            degrees_of_freedom: compliance.spread.as_ref().and_then(|s| s.degrees_of_freedom),
            errors,
            half_widths,
            base_turns: [ElasticClass::Turn, ElasticClass::Bearing].iter().any(|class| mixed.size(*class) > 0.0),
            springs_alone: is_seen.then_some(alone),
            off: None,
            expected: None,
        })
    }

    /// True where joint `j` has a positive stiffness.
    pub(super) fn has_stiffness(&self, j: usize) -> bool {
        !self.fit.solution().undetermined.contains(&j) && self.joints[j] > 0.0
    }

    /// What a change of the unknowns does to the joints' compliance.
    pub(super) fn joint_change(&self, change: &DVector<f64>) -> DVector<f64> {
        match self.reproduced {
            Some(reproduced) => reproduced.of(change),
            None => change.rows(0, self.joints.len()).into_owned(),
        }
    }

    /// True where the values account for `term` already. The springs of the mixed model
    /// hold every tilt of the base.
    pub(super) fn holds(&self, term: &ExtraTerm) -> bool {
        self.extra.contains(term) || (*term == ExtraTerm::BaseTilt && self.base_turns)
    }
}
