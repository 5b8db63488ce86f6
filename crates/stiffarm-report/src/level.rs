//! Confidence levels as people read them.

/// A confidence in percent, without the last bits of a binary fraction.
pub(crate) fn level(confidence: f64) -> f64 {
    (1e6 * confidence).round() / 1e4
}
