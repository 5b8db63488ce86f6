//! Displacements, postures and measuring points that the other data contradict.
//!
//! A displacement is compared with its prediction from all other data (its
//! deleted residual; Cook & Weisberg, Residuals and Influence in Regression,
//! 1982, for three rows at once): F on 3 and N − r − 3 degrees of
//! freedom. A posture is compared with the fit from the other postures, with
//! the two variances estimated without it: what its points share against the
//! variance of such shifts, the rest against that of the readings. A measuring
//! point is compared with the fit from the other points. What fits worst is set
//! aside and the rest is looked at again; all of this in the model that predicts, so that what the arm does beyond its
//! axes is no fault of a posture; when a displacement does not fit and
//! neither does the rest of its posture (or of its point), the posture (or the
//! point) is named instead.

mod deletions;
mod fitted_data;

use super::noise::{NoiseTest, noise_test};
use crate::error::Result;
use crate::estimate::identify::{Estimator, Fit, IdentifyOptions, NoiseSource};
use crate::estimate::mixed::MixedFit;
use crate::findings::{Finding, codes, length, length_with_error, list, probability};
use fitted_data::FittedData;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Outliers after which the search ends: beyond, the model is at fault.
const MOST_OUTLIERS: usize = 5;

/// What does not fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum OutlierKind {
    /// One displacement.
    Displacement,
    /// A posture as a whole.
    Posture,
    /// A measuring point in many postures.
    Point,
}

/// Something that does not fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Outlier {
    /// What it is.
    pub kind: OutlierKind,
    /// Posture, except for a point.
    pub posture: Option<String>,
    /// Load state of a displacement.
    pub state: Option<String>,
    /// Measuring point, except for a posture.
    pub point: Option<String>,
    /// Measured minus predicted displacement, base axes \[m\], for a
    /// displacement.
    pub deviation_m: Option<[f64; 3]>,
    /// Its standard errors \[m\].
    pub standard_error_m: Option<[f64; 3]>,
    /// Axis with the largest deviation: `x`, `y` or `z`.
    pub axis: Option<String>,
    /// Probability of a deviation as large anywhere in the data, if the rest
    /// is right.
    pub p_value: f64,
}

/// How a posture fits the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PostureFit {
    /// Posture.
    pub posture: String,
    /// RMS of its displacement components less their prediction from the
    /// others \[m\].
    pub prediction_rms_m: Option<f64>,
    /// Probability of a deviation as large (for this posture alone); `None`
    /// where the others cannot predict it.
    pub p_value: Option<f64>,
}

/// How a measuring point fits the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PointFit {
    /// Measuring point.
    pub point: String,
    /// Probability of residuals as large (for this point alone); `None` where
    /// the others do not determine what it does.
    pub p_value: Option<f64>,
}

/// What fits and what does not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Outliers {
    /// What does not fit, the worst first.
    pub found: Vec<Outlier>,
    /// True where the search ended before everything fitted.
    pub more: bool,
    /// Residuals against the cell's noise without what was found, where the
    /// search came to its end with something found.
    pub noise_without: Option<NoiseTest>,
    /// All postures, in the full data.
    pub postures: Vec<PostureFit>,
    /// All measuring points, in the full data.
    pub points: Vec<PointFit>,
}

/// Looks for displacements, postures and measuring points that do not fit.
/// The fit behind it is linear: two variances, or ordinary or weighted least squares
/// where `options` ask for these.
///
/// # Errors
/// As [`identify`](crate::estimate::identify::identify()).
pub fn outliers(fit: &Fit) -> Result<Outliers> {
    outliers_in(fit, None)
}

/// The same in the mixed model, where it predicts.
///
/// # Errors
/// As [`outliers`].
pub(super) fn outliers_in(fit: &Fit, mixed: Option<&MixedFit>) -> Result<Outliers> {
    let options = IdentifyOptions {
        estimator: match fit.options().estimator {
            Estimator::Ordinary => Estimator::Ordinary,
            Estimator::Weighted | Estimator::Huber => Estimator::Weighted,
            _ => Estimator::TwoVariance,
        },
        noise: NoiseSource::Estimated,
        ..fit.options().clone()
    };
    let mut rest = match mixed {
        Some(mixed) => FittedData::new(mixed.fit().clone(), Some(Cow::Borrowed(mixed))),
        None => FittedData::new(fit.with(&options)?, None),
    };
    let mut out = Outliers {
        found: Vec::new(),
        more: false,
        noise_without: None,
        postures: rest.posture_fits()?.to_vec(),
        points: rest.point_fits()?,
    };
    let mut nothing_left = false;
    while let Some(outlier) = rest.worst()? {
        if out.found.len() == MOST_OUTLIERS {
            out.more = true;
            break;
        }
        let left = rest.without(&outlier)?;
        out.found.push(outlier);
        match left {
            Some(left) => rest = left,
            None => {
                nothing_left = true;
                break;
            }
        }
    }
    if !nothing_left && !out.found.is_empty() && !out.more {
        out.noise_without = noise_test(rest.fit())?;
    }
    Ok(out)
}

impl Outliers {
    /// What does not fit, in sentences.
    pub fn findings(&self) -> Vec<Finding> {
        if !self.more {
            return self.found.iter().map(Outlier::finding).collect();
        }
        // Naming each would blame readings for what the model does.
        let worst: Vec<String> = self.found.iter().map(Outlier::subject).collect();
        let message = format!(
            "More than {MOST_OUTLIERS} parts of the data contradict the rest (first {}): the model or the set-up is at \
             fault rather than single readings.",
            list(&worst)
        );
        vec![Finding::serious(codes::MORE_OUTLIERS, "measurements", message)]
    }
}

impl Outlier {
    /// What it is.
    fn subject(&self) -> String {
        let part = |what: &str, name: &Option<String>| name.as_ref().map(|name| format!("{what} {name}"));
        let parts = [part("posture", &self.posture), part("point", &self.point)];
        parts.into_iter().flatten().collect::<Vec<_>>().join(" ")
    }

    /// What does not fit, in words.
    pub fn finding(&self) -> Finding {
        let name = |part: &Option<String>| part.clone().unwrap_or_default();
        let p = probability(self.p_value);
        let (code, message) = match self.kind {
            OutlierKind::Displacement => {
                let deviation = self.deviation_m.map_or(Vector3::zeros(), Vector3::from);
                let axis = deviation.abs().imax();
                let error = self.standard_error_m.map_or(0.0, |e| e[axis]);
                let message = format!(
                    "Point {} in posture {} ({}) does not fit: it is off by {}, most along {} ({}; {p}).",
                    name(&self.point),
                    name(&self.posture),
                    name(&self.state),
                    length(deviation.norm()),
                    name(&self.axis),
                    length_with_error(deviation[axis], error),
                );
                (codes::OUTLYING_DISPLACEMENT, message)
            }
            OutlierKind::Posture => {
                let message = format!(
                    "Posture {} does not fit the others ({p}): look for a wrong angle, load or reading of all its \
                     points.",
                    name(&self.posture)
                );
                (codes::OUTLYING_POSTURE, message)
            }
            OutlierKind::Point => {
                let message = format!(
                    "Point {} does not fit the others in many postures ({p}): look for a loose reflector or a wrong \
                     place in the tool.",
                    name(&self.point)
                );
                (codes::OUTLYING_POINT, message)
            }
        };
        Finding::caution(code, self.subject(), message)
    }
}
