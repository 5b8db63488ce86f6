//! From a compliance with its standard error to a stiffness with its interval.

use super::solve::Solution;
use crate::error::{Code, Error, Result};
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use std::ops::Range;

/// Up to this half width (fraction of k) the stiffness of a joint is known well.
pub const WELL_KNOWN_HALF_WIDTH: f64 = 0.1;
/// From this half width on (fraction of k) there is no ±: 1/H is far from linear there.
pub const LARGEST_HALF_WIDTH: f64 = 0.5;

/// What an estimate says about its joint, by the errors that its interval holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The stiffness is known to 10 % or better.
    Determined,
    /// Its ± is above 10 %, and below half of it.
    Weak,
    /// Its interval has two ends, and is too wide for a ±.
    HardlyKnown,
    /// The interval is open above: the data give only a lower bound.
    LowerBoundOnly,
    /// The data tell it only together with other unknowns: its own value means nothing.
    NotByItself,
    /// Even the upper end of the compliance is negative: sign or model fault.
    SignOrModelFault,
    /// A stiffness without an interval: no degrees of freedom, or no deflection.
    NoInterval,
    /// The data carry no information about this joint.
    Undetermined,
}

/// Which errors an interval holds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum IntervalHolds {
    /// The scatter of the readings alone: all that a fit knows.
    #[default]
    Readings,
    /// Readings and systematic errors together.
    AllErrors,
}

/// Estimate of one joint. A fit alone knows the scatter of the readings; with the systematic errors, as
/// [`Identified`](crate::ask::identify::Identified) has them, ± and interval hold all errors, and
/// `interval_holds` says so.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointEstimate {
    /// Name of the joint.
    pub name: String,
    /// k = 1/H \[N·m/rad\]; negative where the compliance is beyond what noise
    /// explains; `None` when undetermined, or when only a lower bound is known
    /// and the compliance came out at or below zero.
    pub stiffness: Option<f64>,
    /// ± of k at the confidence of the fit (fraction of k): half width of H over H.
    pub half_width: Option<f64>,
    /// Standard uncertainty of k by the errors that the interval holds \[N·m/rad\]:
    /// k²·σ_H, first order.
    pub standard_error: Option<f64>,
    /// Interval of k \[N·m/rad\]: 1/(H ± half width of H); the upper end is
    /// `None` where the data give only a lower bound, both where there is none.
    pub interval: [Option<f64>; 2],
    /// Which errors `half_width`, `standard_error`, `interval` and `verdict` hold.
    pub interval_holds: IntervalHolds,
    /// Standard error by the scatter of the readings alone \[N·m/rad\].
    pub readings_standard_error: Option<f64>,
    /// Interval by the scatter of the readings alone \[N·m/rad\]:
    /// \[1/(H + tσ_H), 1/(H − tσ_H)\].
    pub readings_interval: [Option<f64>; 2],
    /// H \[rad/(N·m)\].
    pub compliance: Option<f64>,
    /// σ_H by the scatter of the readings \[rad/(N·m)\].
    pub compliance_standard_error: Option<f64>,
    /// True when the data carry information about this joint; how well they determine it says `verdict`.
    pub determined: bool,
    /// The estimate in one word.
    pub verdict: Verdict,
}

/// `joint 1: 2.31e6 N·m/rad (2.25e6 to 2.37e6)`.
impl std::fmt::Display for JointEstimate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.stiffness {
            Some(k) => write!(f, "{}: {k:.2e} N·m/rad", self.name)?,
            None => write!(f, "{}: not determined", self.name)?,
        }
        match self.interval {
            [Some(low), Some(high)] => write!(f, " ({low:.2e} to {high:.2e})"),
            [Some(low), None] => write!(f, " (above {low:.2e})"),
            _ => Ok(()),
        }
    }
}

impl JointEstimate {
    /// Interval and verdict from the ends of the interval of H by the scatter of the readings.
    pub(super) fn close(&mut self, low: f64, high: f64) {
        if high == 0.0 && low == 0.0 {
            self.verdict = Verdict::NoInterval;
        } else if high <= 0.0 {
            self.verdict = Verdict::SignOrModelFault;
        } else {
            self.interval = [Some(1.0 / high), (low > 0.0).then(|| 1.0 / low)];
            if low <= 0.0 && self.compliance.is_some_and(|h| h <= 0.0) {
                // Noise alone explains the sign: a negative stiffness would be
                // no estimate of anything. The compliance keeps its value.
                self.stiffness = None;
                self.standard_error = None;
            }
            self.judge();
        }
        self.readings_alone();
    }

    /// ± and verdict that stiffness and interval call for; a fault, and what is not told by itself, stay.
    pub(crate) fn judge(&mut self) {
        let k = self.stiffness.filter(|k| *k > 0.0);
        // The lower end of k is 1/(H + half width).
        self.half_width = k.zip(self.interval[0]).map(|(k, low)| k / low - 1.0);
        if matches!(self.verdict, Verdict::NotByItself | Verdict::SignOrModelFault) {
            return;
        }
        self.verdict = match (self.interval, self.half_width) {
            ([None, _], _) => self.verdict,
            ([_, None], _) => Verdict::LowerBoundOnly,
            (_, Some(half)) if half <= WELL_KNOWN_HALF_WIDTH => Verdict::Determined,
            (_, Some(half)) if half < LARGEST_HALF_WIDTH => Verdict::Weak,
            _ => Verdict::HardlyKnown,
        };
    }

    /// Standard error of k by the scatter of the readings alone (fraction of k).
    pub(crate) fn readings_error(&self) -> Option<f64> {
        Some(self.readings_standard_error? / self.stiffness?.abs())
    }

    /// Until systematic errors are known, the scatter of the readings is all.
    fn readings_alone(&mut self) {
        self.interval_holds = IntervalHolds::Readings;
        self.readings_interval = self.interval;
        self.readings_standard_error = self.standard_error;
    }

    /// The non-negative fit holds this compliance at zero: the joint is rigid
    /// as far as the data tell, and a value of k there is none.
    fn hold_at_bound(&mut self) {
        self.stiffness = None;
        self.standard_error = None;
        // The free fit's error, laid about zero.
        self.interval = [self.interval[0], None];
        self.verdict = Verdict::NoInterval;
        self.judge();
        self.readings_alone();
    }
}

/// Quantile of a solution's intervals; `None` where it cannot have any: the
/// size of the noise is unknown, or nothing is known of how well.
pub(crate) fn interval_quantile(solution: &Solution, confidence: f64) -> Result<Option<f64>> {
    match (&solution.covariance, solution.t_degrees_of_freedom) {
        (None, _) | (_, Some(0)) => Ok(None),
        (_, dof) => quantile(dof, confidence).map(Some),
    }
}

/// Estimates of the unknowns `which`, springs all of them, by a solution.
pub fn estimates(
    names: &[String],
    which: Range<usize>,
    solution: &Solution,
    quantile: Option<f64>,
) -> Vec<JointEstimate> {
    which
        .map(|j| {
            let is_determined = !solution.undetermined.contains(&j);
            let value = is_determined.then(|| solution.values[j]);
            let mut joint = estimate(&names[j], value, standard_error(solution, j), quantile);
            if solution.at_bound.contains(&j) {
                joint.hold_at_bound();
            }
            joint
        })
        .collect()
}

/// Standard error of unknown j, where it has one.
pub(super) fn standard_error(solution: &Solution, j: usize) -> Option<f64> {
    let covariance = solution.covariance.as_ref()?;
    (!solution.undetermined.contains(&j)).then(|| covariance[(j, j)].max(0.0).sqrt())
}

/// Beyond this Student's t is the normal distribution with corrections: the
/// inverse of the incomplete beta function loses digits and takes longer with
/// each degree, 1e9 of them longer than anybody waits.
const MANY_DEGREES: usize = 10_000;

/// Two-sided quantile of Student's t, or of the normal without degrees of freedom.
///
/// # Errors
/// A confidence outside (0, 1), or no degree of freedom.
pub fn quantile(degrees_of_freedom: Option<usize>, confidence: f64) -> Result<f64> {
    if !(confidence > 0.0 && confidence < 1.0) {
        let message = format!("The confidence is {confidence}; it must lie between 0 and 1.");
        return Err(Error::invalid(message));
    }
    let p = 0.5 + 0.5 * confidence;
    let failed = || Error::new(Code::Internal, "A quantile could not be computed.");
    let normal = || -> Result<f64> {
        let normal = Normal::new(0.0, 1.0).map_err(|_| failed())?;
        Ok(normal.inverse_cdf(p))
    };
    match degrees_of_freedom {
        Some(0) => {
            let message = "Without a degree of freedom there is no interval.";
            Err(Error::new(Code::TooFewData, message))
        }
        // Abramowitz and Stegun 26.7.5: the term left out is below 1e-11.
        Some(dof) if dof > MANY_DEGREES => {
            let (z, n) = (normal()?, dof as f64);
            let s = z * z;
            let terms = [
                z * (s + 1.0) / 4.0,
                z * ((5.0 * s + 16.0) * s + 3.0) / 96.0,
                z * (((3.0 * s + 19.0) * s + 17.0) * s - 15.0) / 384.0,
            ];
            Ok(z + ((terms[2] / n + terms[1]) / n + terms[0]) / n)
        }
        Some(dof) => {
            let student = StudentsT::new(0.0, 1.0, dof as f64).map_err(|_| failed())?;
            Ok(student.inverse_cdf(p))
        }
        None => normal(),
    }
}

/// Estimate of k = 1/H with its interval, asymmetric because k is not linear
/// in H (docs/method.md).
pub(crate) fn estimate(
    name: &str,
    compliance: Option<f64>,
    error: Option<f64>,
    quantile: Option<f64>,
) -> JointEstimate {
    let mut out = JointEstimate {
        name: name.to_string(),
        stiffness: None,
        half_width: None,
        standard_error: None,
        interval: [None, None],
        interval_holds: IntervalHolds::Readings,
        readings_standard_error: None,
        readings_interval: [None, None],
        compliance,
        compliance_standard_error: compliance.and(error),
        determined: compliance.is_some(),
        verdict: Verdict::Undetermined,
    };
    let Some(h) = compliance else { return out };
    out.verdict = Verdict::NoInterval;
    if h != 0.0 {
        out.stiffness = Some(1.0 / h);
        out.standard_error = error.map(|e| e / (h * h));
    }
    match error.zip(quantile).map(|(e, t)| e * t) {
        Some(half) => out.close(h - half, h + half),
        None => out.readings_alone(),
    }
    out
}
