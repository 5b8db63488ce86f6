//! The bound of Eq. (19) on the relative error of the compliance vector.

use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};

/// Eq. (19) evaluated: an upper bound, valid only while `validity` < 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ErrorBound {
    /// Upper bound of ‖δH‖/‖H‖; `None` where the bound does not hold.
    pub bound: Option<f64>,
    /// cond(Ω)·‖δΩ‖/‖Ω‖, which must stay below 1.
    pub validity: f64,
    /// cond(Ω) = cond(Ψ)².
    pub condition_omega: f64,
}

/// Eq. (19): ‖δH‖/‖H‖ ≤ cond(Ω)/(1 − cond(Ω)‖δΩ‖/‖Ω‖)·(‖δΛ‖/‖Λ‖ + ‖δΩ‖/‖Ω‖)
/// with Ω = ΨᵀΨ, Λ = ΨᵀΔ and cond(Ω) = cond(Ψ)². The first "=" of the printed
/// equation is "≤".
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::plan::index::error_bound;
///
/// // cond(Ψ) = 3, and readings off by 1 % of what the load does.
/// let found = error_bound(3.0, 0.0, 0.01)?;
/// assert_eq!(found.bound, Some(0.09));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// A negative or non-finite argument, or a condition number below 1.
pub fn error_bound(condition_psi: f64, relative_omega: f64, relative_lambda: f64) -> Result<ErrorBound> {
    let finite = [condition_psi, relative_omega, relative_lambda].iter().all(|v| v.is_finite());
    if !finite || condition_psi < 1.0 || relative_omega < 0.0 || relative_lambda < 0.0 {
        return Err(Error::invalid(
            "Eq. (19) needs a condition number of at least 1 and relative errors of at least 0.",
        ));
    }
    let condition_omega = condition_psi * condition_psi;
    let validity = condition_omega * relative_omega;
    // Eq. (19)
    let bound = (validity < 1.0).then(|| condition_omega / (1.0 - validity) * (relative_lambda + relative_omega));
    Ok(ErrorBound { bound, validity, condition_omega })
}
