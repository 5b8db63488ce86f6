//! The keys of a saved stiffness.

use super::{fault, suggested};
use crate::error::Result;
use serde_json::Value;

/// A list of stiffness values and nothing else.
pub(super) const BARE: &str = "stiffness_nm_per_rad";

/// A result with what made it.
pub(super) const ENVELOPE: &[&str] = &[
    "format",
    "stiffarm",
    "command",
    "arguments",
    "inputs",
    "seed",
    "options",
    "result",
];

/// What `identify` writes, with a free and with a clamped flange.
#[rustfmt::skip]
pub(super) const RESULT: &[&str] = &[
    // Estimates
    "joints", "extra_springs", "lost_motion", "extra", "estimator", "rows", "degrees_of_freedom",
    "interval_degrees_of_freedom", "independent_rows", "condition", "scaled_condition", "unknowns",
    "covariance", "correlation", "undetermined_joints", "combinations", "collinear", "noise",
    "confidence",
    // Identification
    "residual_rms_m", "displacement_rms_m", "residual_std_m", "posture_common_std_m",
    "total_std_m", "expected_std_m", "postures", "points", "weights",
    // what the command adds
    "readings", "profile", "bootstrap", "budget", "elastic", "diagnosis", "next_posture",
    "not_computed",
    "next_posture_missing", "measured_coverage", "interrupted",
    // ClampedIdentification
    "motor_rms_rad", "residual_rms_rad", "residual_std_rad", "expected_std_rad", "friction",
    "findings",
];

/// One joint, or one further spring.
pub(super) const JOINT: &[&str] = &[
    "name",
    "stiffness",
    "standard_error",
    "interval",
    "compliance",
    "compliance_standard_error",
    "determined",
    "verdict",
];

/// One lost motion.
pub(super) const ANGLE: &[&str] = &["name", "angle", "standard_error", "interval"];

/// The elastic model.
pub(super) const ELASTIC: &[&str] = &[
    "asked",
    "model",
    "reasons",
    "likelihood_ratio",
    "axes_rms_m",
    "mixed_rms_m",
    "mixed",
    "budget",
];

/// Values of the mixed model.
pub(super) const MIXED: &[&str] = &[
    "joints",
    "sizes",
    "residual_std_m",
    "posture_common_std_m",
    "interval_degrees_of_freedom",
    "size_covariance",
    "springs",
    "covariance",
];

/// The errors common to the experiment.
pub(super) const BUDGET: &[&str] = &[
    "joints",
    "sources",
    "combined",
    "statistical",
    "total",
    "confidence",
    "uncertainty",
    "posterior",
    "findings",
];

/// How sure the stiffness of one joint is with everything together.
pub(super) const UNCERTAINTY: &[&str] = &[
    "statistical",
    "systematic",
    "total",
    "interval_nm_per_rad",
    "largest_source",
];

/// What the readings leave of the sizes of the errors.
pub(super) const POSTERIOR: &[&str] = &["parts", "mean", "covariance"];

/// One part of it.
pub(super) const POSTERIOR_PART: &[&str] = &["source", "part", "response", "at_work", "size"];

/// One source of them.
pub(super) const SOURCE: &[&str] = &[
    "name",
    "size",
    "unit",
    "declared",
    "change",
    "worst",
    "remaining",
    "bounded",
    "parts",
];

/// One part of a source.
pub(super) const PART: &[&str] = &["name", "change"];

/// Refuses keys that nobody would read: `value` is an object with `known` keys
/// at most.
///
/// # Errors
/// No object, or an unknown key.
pub(super) fn check(value: &Value, key: &str, known: &[&str]) -> Result<()> {
    let Some(object) = value.as_object() else {
        let error = fault("This must be an object, { … }.".to_string());
        return Err(if key.is_empty() {
            error
        } else {
            error.key(key)
        });
    };
    let Some(unknown) = object.keys().find(|name| !known.contains(&name.as_str())) else {
        return Ok(());
    };
    let message = "No saved result has this key, and it would change nothing.";
    let error = fault(message.to_string()).key(below(key, unknown));
    Err(suggested(error, unknown, known))
}

/// As [`check`] for each object of the list `value[name]`, where there is one.
///
/// # Errors
/// As [`check`].
pub(super) fn check_each(value: &Value, key: &str, name: &str, known: &[&str]) -> Result<()> {
    let items = value[name].as_array().into_iter().flatten();
    for (i, item) in items.enumerate() {
        check(item, &format!("{}[{i}]", below(key, name)), known)?;
    }
    Ok(())
}

/// The path of a key inside another.
pub(super) fn below(key: &str, name: &str) -> String {
    match key.is_empty() {
        true => name.to_string(),
        false => format!("{key}.{name}"),
    }
}
