//! The elastic model that predicts, and what it is worth beside the joint axes alone.

use super::mixed::{MixedFit, MixedResult, Sizes};
use super::validate::{Validation, cross_validate, cross_validate_mixed};
use crate::error::{Code, Result};
use crate::estimate::identify::{Fit, IdentifyOptions, JointEstimate};
use crate::findings::{length, percent};
use serde::{Deserialize, Serialize};

/// Twice the difference of the restricted log-likelihoods beyond which the axes alone
/// are rejected. Five variances at the edge of what they can be, the likelier of two sizings: chance goes beyond this
/// in fewer than 5 of 100 experiments (counted in docs/elastic.md).
const LIKELIHOOD_RATIO: f64 = 6.0;
/// Fewest postures that show what gives way beyond the joint axes.
pub(crate) const FEWEST_POSTURES: usize = 4;
/// Most folds: beyond as many postures several are left out together.
const MOST_FOLDS: usize = 60;

/// The mixed model is clearly better below this share of what the axes alone miss.
const CLEARLY_BETTER_SHARE: f64 = 0.95;
/// Differences of leave-one-outs below this share are not worth a number.
const WORTH_SAYING: f64 = 1e-3;

/// Which elastic model to use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ElasticChoice {
    /// The joint axes alone give way: the paper's model.
    Axes,
    /// Joints and base give way in all directions, as far as the data show.
    Mixed,
}

impl ElasticChoice {
    /// Name in options and results.
    pub fn as_str(self) -> &'static str {
        match self {
            ElasticChoice::Axes => "axes",
            ElasticChoice::Mixed => "mixed",
        }
    }

    /// What is asked for where nothing is said: the mixed model, unless these options exclude it.
    pub fn or_default(choice: Option<Self>, options: &IdentifyOptions) -> Self {
        let fits = match MixedFit::excluded_by(options) {
            Some(_) => ElasticChoice::Axes,
            None => ElasticChoice::Mixed,
        };
        choice.unwrap_or(fits)
    }

    /// The model in sentences, tables and figures.
    pub fn in_words(self) -> &'static str {
        match self {
            ElasticChoice::Axes => "joint axes alone",
            ElasticChoice::Mixed => "mixed model",
        }
    }
}

/// The mixed model beside the joint axes alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Elastic {
    /// What predicts: `mixed`, or `axes` where the data do not carry it.
    pub model: ElasticChoice,
    /// What the comparison says, or why the axes predict, in sentences.
    pub reasons: Vec<String>,
    /// Twice the difference of the restricted log-likelihoods of mixed model and axes;
    /// `None` where the mixed model cannot be fitted.
    pub likelihood_ratio: Option<f64>,
    /// RMS of displacement components less their prediction from the other postures,
    /// joint axes alone \[m\]; not with --brief.
    pub axes_rms_m: Option<f64>,
    /// The same with the mixed model, its sizes found anew without each posture \[m\].
    pub mixed_rms_m: Option<f64>,
    /// The joints as the axes alone have them, where the mixed model predicts.
    pub axes: Vec<JointEstimate>,
    /// What gives way beyond the axes, where it predicts.
    pub mixed: Option<MixedResult>,
}

impl Elastic {
    /// True where postures that took no part speak clearly for the mixed model.
    pub fn is_better(&self) -> bool {
        let both = self.axes_rms_m.zip(self.mixed_rms_m);
        both.is_some_and(|(axes, mixed)| mixed < CLEARLY_BETTER_SHARE * axes)
    }
}

/// The mixed model of the displacements of `fit`. Where the data cannot carry it, the axes
/// predict, and the reasons say so. With `compare` each posture is predicted from the others
/// by both.
///
/// # Errors
/// Options of `fit` that exclude the mixed model ([`MixedFit::new`]); interrupted.
pub fn elastic(fit: &Fit, compare: bool) -> Result<(Elastic, Option<MixedFit>)> {
    let mut out = Elastic {
        model: ElasticChoice::Axes,
        reasons: Vec::new(),
        likelihood_ratio: None,
        axes_rms_m: None,
        mixed_rms_m: None,
        axes: Vec::new(),
        mixed: None,
    };
    let mixed = match carried(fit)? {
        Ok(mixed) => mixed,
        Err(reason) => {
            out.reasons.push(format!("The joint axes alone predict. {reason}"));
            return Ok((out, None));
        }
    };
    out.model = ElasticChoice::Mixed;
    out.likelihood_ratio = Some(mixed.likelihood_ratio());
    out.mixed = Some(mixed.result());
    if compare {
        let rms = |validation: Result<Validation>| match validation {
            Ok(validation) => Ok(validation.unpredicted.is_empty().then_some(validation.component_rms_m)),
            Err(error) if error.code() == Code::NotIdentifiable => Ok(None),
            Err(error) => Err(error),
        };
        let folds = fit.system().blocks.len().min(MOST_FOLDS);
        out.axes_rms_m = rms(cross_validate(fit, folds, None))?;
        out.mixed_rms_m = rms(cross_validate_mixed(&mixed, folds, None))?;
    }
    out.reasons = reasons(&out);
    Ok((out, Some(mixed)))
}

/// The mixed model, or in a sentence why the data do not carry it.
///
/// # Errors
/// As [`elastic`].
pub(crate) fn carried(fit: &Fit) -> Result<std::result::Result<MixedFit, String>> {
    carried_near(fit, None)
}

/// The same, its sizes looked for near those of `other`.
///
/// # Errors
/// As [`elastic`].
pub(crate) fn carried_near(fit: &Fit, near: Option<&Sizes>) -> Result<std::result::Result<MixedFit, String>> {
    let postures = fit.system().blocks.len();
    if postures < FEWEST_POSTURES {
        return Ok(Err(format!("Fewer than {FEWEST_POSTURES} postures cannot show what gives way beyond them.")));
    }
    match MixedFit::near(fit, near) {
        Ok(mixed) => Ok(Ok(mixed)),
        Err(error) if [Code::TooFewData, Code::NotIdentifiable].contains(&error.code()) => {
            Ok(Err(error.message().to_string()))
        }
        Err(error) => Err(error),
    }
}

fn reasons(elastic: &Elastic) -> Vec<String> {
    let ratio = elastic.likelihood_ratio.unwrap_or(0.0);
    let mut out = Vec::new();
    if ratio == 0.0 {
        out.push("The data show nothing that gives way beyond the joint axes: the mixed model is theirs.".to_string());
    } else if let (Some(axes), Some(mixed)) = (elastic.axes_rms_m, elastic.mixed_rms_m) {
        let by = match 1.0 - mixed / axes {
            less if less >= WORTH_SAYING => format!("{} less than", percent(less)),
            _ => "no less than".to_string(),
        };
        out.push(format!(
            "With joints and base that give way in all directions, a posture that took no part is missed by {} (RMS), \
             {by} the {} of the joint axes alone{}.",
            length(mixed),
            length(axes),
            if ratio > LIKELIHOOD_RATIO {
                ", and the data reject the axes alone"
            } else {
                ", and the data do not need more than the axes"
            }
        ));
    }
    out
}
