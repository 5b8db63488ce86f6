//! What is asked of an identification with the flange fixed, and of which postures.

use super::ClampedPosture;
use crate::error::Result;
use crate::estimate::identify::{Estimator, IdentifyOptions, NoiseSource};
use crate::measure::{all_excluded, check_names};
use crate::model::observation::ExtraTerm;
use serde::{Deserialize, Serialize};

/// Options of the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// How the stiffness is estimated.
    pub estimator: Estimator,
    /// Extra terms asked for.
    pub extra: Vec<ExtraTerm>,
    /// Where the size of the noise comes from.
    pub noise: NoiseSource,
    /// Standard deviation of a difference of two angles \[deg\].
    pub angle_noise_deg: Option<f64>,
    /// Confidence of the intervals.
    pub confidence: f64,
    /// Postures left out.
    pub exclude: Vec<String>,
}

impl Options {
    /// The options as the result holds them; `angle_noise_deg` is the standard deviation of a
    /// difference of two angles, where it is given \[deg\].
    pub fn new(fit: &IdentifyOptions, angle_noise_deg: Option<f64>, exclude: &[String]) -> Self {
        Options {
            estimator: fit.estimator,
            extra: fit.extra.clone(),
            noise: fit.noise,
            angle_noise_deg,
            confidence: fit.confidence,
            exclude: exclude.to_vec(),
        }
    }
}

/// The postures but those with the names `exclude`.
///
/// # Errors
/// A name that no posture has; nothing is left (key `exclude`).
pub fn without(
    mut clamped: Vec<ClampedPosture>,
    exclude: &[String],
) -> Result<Vec<ClampedPosture>> {
    let known = clamped.iter().map(|c| c.posture.name.as_str());
    check_names(exclude, known).map_err(|e| e.key("exclude"))?;
    clamped.retain(|c| !exclude.contains(&c.posture.name));
    if clamped.is_empty() {
        Err(all_excluded().key("exclude"))
    } else {
        Ok(clamped)
    }
}
