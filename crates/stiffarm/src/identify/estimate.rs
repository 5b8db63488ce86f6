//! From a compliance with its standard error to a stiffness with its interval.

use crate::error::{Code, Error, Result};
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// What an estimate says about its joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// A stiffness with an interval.
    Determined,
    /// The interval is open above: the data give only a lower bound.
    LowerBoundOnly,
    /// Even the upper end of the compliance is negative: sign or model fault.
    SignOrModelFault,
    /// A stiffness without an interval: no degrees of freedom, or no deflection.
    NoInterval,
    /// The data carry no information about this joint.
    Undetermined,
}

/// Estimate of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointEstimate {
    /// Name of the joint.
    pub name: String,
    /// k = 1/H \[N·m/rad\]; negative where the compliance is beyond what noise
    /// explains; `None` when undetermined, or when only a lower bound is known
    /// and the compliance came out at or below zero.
    pub stiffness: Option<f64>,
    /// k²·σ_H \[N·m/rad\], first order.
    pub standard_error: Option<f64>,
    /// Interval of k \[N·m/rad\]: \[1/(H + tσ_H), 1/(H − tσ_H)\]; the upper end is
    /// `None` where the data give only a lower bound, both where there is none.
    pub interval: [Option<f64>; 2],
    /// H \[rad/(N·m)\].
    pub compliance: Option<f64>,
    /// σ_H \[rad/(N·m)\].
    pub compliance_standard_error: Option<f64>,
    /// True when the data determine this joint.
    pub determined: bool,
    /// The estimate in one word.
    pub verdict: Verdict,
}

impl JointEstimate {
    /// The non-negative fit holds this compliance at zero: the joint is rigid
    /// as far as the data tell, and a value of k there is none.
    pub(super) fn hold_at_bound(&mut self) {
        self.stiffness = None;
        self.standard_error = None;
        self.verdict = Verdict::LowerBoundOnly;
        // The free fit's error, laid about zero.
        self.interval = [self.interval[0], None];
    }
}

/// Two-sided quantile of Student's t, or of the normal without degrees of freedom.
pub(super) fn quantile(degrees_of_freedom: Option<usize>, confidence: f64) -> Result<f64> {
    let p = 0.5 + 0.5 * confidence;
    let failed = |_| Error::new(Code::Internal, "A quantile could not be computed.");
    Ok(match degrees_of_freedom {
        Some(dof) => StudentsT::new(0.0, 1.0, dof as f64)
            .map_err(|_| Error::new(Code::Internal, "A quantile could not be computed."))?
            .inverse_cdf(p),
        None => Normal::new(0.0, 1.0).map_err(failed)?.inverse_cdf(p),
    })
}

/// Estimate of k = 1/H with its interval, asymmetric because k is not linear
/// in H (docs/method.md).
pub(super) fn estimate(
    name: &str,
    compliance: Option<f64>,
    error: Option<f64>,
    quantile: Option<f64>,
) -> JointEstimate {
    let mut out = JointEstimate {
        name: name.to_string(),
        stiffness: None,
        standard_error: None,
        interval: [None, None],
        compliance,
        compliance_standard_error: compliance.and(error),
        determined: compliance.is_some(),
        verdict: Verdict::Undetermined,
    };
    let Some(h) = compliance else { return out };
    out.verdict = Verdict::Determined;
    if h != 0.0 {
        out.stiffness = Some(1.0 / h);
        out.standard_error = error.map(|e| e / (h * h));
    }
    let Some(half) = error.zip(quantile).map(|(e, t)| e * t) else {
        out.verdict = Verdict::NoInterval;
        return out;
    };
    let (low, high) = (h - half, h + half);
    if high == 0.0 && low == 0.0 {
        out.verdict = Verdict::NoInterval;
    } else if high < 0.0 {
        out.verdict = Verdict::SignOrModelFault;
    } else if low <= 0.0 {
        out.verdict = Verdict::LowerBoundOnly;
        out.interval = [Some(1.0 / high), None];
        if h <= 0.0 {
            // Noise alone explains the sign: a negative stiffness would be
            // no estimate of anything. The compliance keeps its value.
            out.stiffness = None;
            out.standard_error = None;
        }
    } else {
        out.interval = [Some(1.0 / high), Some(1.0 / low)];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interval_is_asymmetric_open_or_absent() {
        let t = Some(2.0);
        let closed = estimate("j", Some(1e-6), Some(1e-7), t);
        assert_eq!(closed.verdict, Verdict::Determined);
        let [low, high] = closed.interval.map(|v| v.unwrap_or(f64::NAN));
        assert!((low - 1.0 / 1.2e-6).abs() < 1e-3 && (high - 1.0 / 0.8e-6).abs() < 1e-3);
        let open = estimate("j", Some(1e-6), Some(1e-6), t);
        assert_eq!(
            (open.verdict, open.interval[1]),
            (Verdict::LowerBoundOnly, None)
        );
        let negative = estimate("j", Some(-1e-6), Some(1e-7), t);
        assert_eq!(
            (negative.verdict, negative.interval),
            (Verdict::SignOrModelFault, [None, None])
        );
        assert!(negative.stiffness.is_some_and(|k| k < 0.0));
    }

    #[test]
    fn quantiles_are_those_of_the_tables() {
        assert!((quantile(Some(66), 0.95).unwrap() - 1.996_564_4).abs() < 1e-6);
        assert!((quantile(None, 0.95).unwrap() - 1.959_964).abs() < 1e-6);
    }
}
