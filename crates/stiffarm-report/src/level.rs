//! Confidence levels as people read them.

use stiffarm::units::rounded;

/// A confidence in percent, without the last bits of a binary fraction.
pub(crate) fn level(confidence: f64) -> f64 {
    rounded(100.0 * confidence, 4)
}
