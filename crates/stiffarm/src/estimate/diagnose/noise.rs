//! The residuals against the noise that the cell states: a χ² test in words.

use super::tails::{LEVEL, chi_squared_tails};
use crate::error::Result;
use crate::estimate::identify::{Estimator, Fit, IdentifyOptions, NoiseSource};
use crate::findings::{Finding, Severity, codes, length, probability};
use crate::model::cell::Cell;
use serde::{Deserialize, Serialize};

/// Residuals this many times the noise come from the model.
const MODEL_RATIO: f64 = 2.0;

/// Below this share of all residuals, what the points of a posture do not share
/// is worth a sentence of its own.
const SHARED: f64 = 0.7;

/// How residuals and noise compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Agreement {
    /// The noise explains the residuals.
    Agrees,
    /// The residuals are larger.
    Larger,
    /// The residuals are smaller.
    Smaller,
}

/// χ² test of the residuals against the cell's noise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NoiseTest {
    /// s of the residuals of least squares weighted by the cell's noise model \[m\].
    pub residual_std_m: f64,
    /// σ of a displacement component by the cell \[m\].
    pub expected_std_m: f64,
    /// Their ratio.
    pub ratio: f64,
    /// Degrees of freedom, rows − rank.
    pub degrees_of_freedom: usize,
    /// Probability of residuals at least as large if the noise were all.
    pub p_larger: f64,
    /// Probability of residuals at most as large if the noise were all.
    pub p_smaller: f64,
    /// The same ratio for what a posture's points do not share, where the two
    /// variances were estimated.
    pub within_ratio: Option<f64>,
    /// The outcome, each side at 0.5 %.
    pub agreement: Agreement,
}

/// Compares the residuals with the noise that the cell states, its part common
/// to a posture's points included. `None` where it states none, or no degree
/// of freedom is left.
///
/// # Errors
/// As [`identify`](crate::estimate::identify::identify()).
pub fn noise_test(fit: &Fit) -> Result<Option<NoiseTest>> {
    let expected = fit.cell().noise.displacement_std();
    let by = |estimator| IdentifyOptions { estimator, noise: NoiseSource::Estimated, ..fit.options().clone() };
    let weighted = fit.with(&by(Estimator::Weighted))?;
    let solution = weighted.solution();
    let (Some(residual), true) = (solution.residual_std, expected > 0.0) else {
        return Ok(None);
    };
    let ratio = residual / expected;
    let free = solution.degrees_of_freedom;
    let Some((p_larger, p_smaller)) = chi_squared_tails(free as f64 * ratio * ratio, free) else {
        return Ok(None);
    };
    let two = fit.with(&by(Estimator::TwoVariance))?;
    let two = two.solution();
    let within = two.residual_std.filter(|_| !two.independent_rows && two.gamma > 0.0);
    Ok(Some(NoiseTest {
        residual_std_m: residual,
        expected_std_m: expected,
        ratio,
        degrees_of_freedom: free,
        p_larger,
        p_smaller,
        within_ratio: within.map(|s| s / expected),
        agreement: match () {
            () if p_larger < 0.5 * LEVEL => Agreement::Larger,
            () if p_smaller < 0.5 * LEVEL => Agreement::Smaller,
            () => Agreement::Agrees,
        },
    }))
}

impl NoiseTest {
    /// The outcome in words, beside the same test without what does not fit,
    /// where something was set aside.
    pub fn finding(&self, without: Option<&NoiseTest>) -> Finding {
        let single = without.is_some_and(|test| test.agreement != Agreement::Larger);
        let sizes = format!("{} against {}", length(self.residual_std_m), length(self.expected_std_m));
        let times = match self.ratio {
            r if r >= 10.0 => format!("{r:.0}"),
            r if r >= 2.0 => format!("{r:.1}"),
            r => format!("{r:.2}"),
        };
        let (code, severity, mut message) = match self.agreement {
            Agreement::Agrees => {
                let p = probability((2.0 * self.p_larger.min(self.p_smaller)).min(1.0));
                let message = format!("The residuals agree with the cell's noise ({sizes}, {p}).");
                ("residuals-agree", Severity::Note, message)
            }
            Agreement::Larger => {
                let meaning = if single {
                    "the parts that do not fit make them so, the rest agrees with the noise"
                } else if self.ratio >= MODEL_RATIO {
                    "the model, not the tracker, limits the result"
                } else {
                    "something beyond the stated noise is in the data, or the noise is stated too small"
                };
                let p = probability(self.p_larger);
                let message = format!("The residuals are {times} times the cell's noise ({sizes}, {p}): {meaning}.");
                (codes::RESIDUALS_ABOVE_NOISE, Severity::Caution, message)
            }
            Agreement::Smaller => {
                let p = probability(self.p_smaller);
                let message = format!(
                    "The residuals are {times} times the cell's noise ({sizes}, {p}): the noise is stated too large."
                );
                ("residuals-below-noise", Severity::Caution, message)
            }
        };
        let within =
            self.within_ratio.filter(|w| self.agreement == Agreement::Larger && !single && *w < SHARED * self.ratio);
        if let Some(within) = within {
            message += &format!(
                " What the points of a posture do not share is {within:.1} times the noise: the rest moves all points \
                 alike (load, rope, drift, or the model of the arm)."
            );
        }
        Finding::new(code, severity, "residuals", message)
    }
}

/// Why there is no test.
pub(super) fn untested(cell: &Cell) -> Finding {
    let message = if cell.noise.displacement_std() > 0.0 {
        "There are as many unknowns as displacement components: no residual tells how good the fit is."
    } else {
        "The cell states no measurement noise, so the residuals cannot be compared with it."
    };
    Finding::caution(codes::RESIDUALS_UNTESTED, "residuals", message)
}
