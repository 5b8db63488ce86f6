//! The interval of a saved stiffness against the stiffness itself.

use super::fault;
use crate::error::Result;
use crate::estimate::identify::JointEstimate;

/// Relative rounding of a text.
const ROUNDING: f64 = 1e-6;

/// Refuses an interval that is upside down, or does not hold its own stiffness; `key` is its place.
///
/// # Errors
/// Such an interval.
pub(super) fn check(spring: &JointEstimate, key: &str) -> Result<()> {
    if let [Some(low), Some(high)] = spring.interval
        && low > high
    {
        let message = format!("The interval ends at {high:e}, below its begin {low:e}.");
        return Err(fault(message).key(key));
    }
    let [low, high] = spring.interval;
    let is_outside = |k: f64| {
        low.is_some_and(|low| k < low * (1.0 - ROUNDING))
            || high.is_some_and(|high| k > high * (1.0 + ROUNDING))
    };
    match spring.stiffness.filter(|k| is_outside(*k)) {
        Some(k) => {
            let message = format!("The stiffness {k:e} lies outside its own interval.");
            Err(fault(message).key(key))
        }
        None => Ok(()),
    }
}
