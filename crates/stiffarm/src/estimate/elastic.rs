//! Which elastic model the data call for, and what it gives.

use super::mixed::{MixedFit, MixedResult};
use super::validate::{Validation, cross_validate, cross_validate_mixed};
use crate::error::{Code, Result};
use crate::estimate::identify::Fit;
use crate::estimate::systematic::{SystematicErrors, mixed_systematic_errors};
use crate::findings::{length, percent};
use serde::{Deserialize, Serialize};

/// Twice the difference of the restricted log-likelihoods beyond which the axes alone
/// are rejected. Three variances at the edge of what they can be: chance goes beyond this
/// in fewer than 5 of 100 experiments (counted in docs/identifying.md).
const LIKELIHOOD_RATIO: f64 = 6.0;
/// Fewest postures from which leaving one out says anything.
const FEWEST_POSTURES: usize = 4;
/// Most folds: beyond as many postures several are left out together.
const MOST_FOLDS: usize = 60;

/// Differences of leave-one-outs below this share are not worth a number.
const WORTH_SAYING: f64 = 1e-3;

const NOTHING: &str =
    "The data show nothing that gives way beyond the joint axes: the mixed model is theirs.";
const QUOTE: &str = "The joint axes alone predict, and their stiffness can be quoted.";

/// Which elastic model to use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ElasticChoice {
    /// The joint axes alone give way: the paper's model.
    #[default]
    Axes,
    /// Joints and base give way in all directions, as far as the data show.
    Mixed,
    /// The one that the data call for.
    Auto,
}

impl ElasticChoice {
    /// Name in options and results.
    pub fn as_str(self) -> &'static str {
        match self {
            ElasticChoice::Axes => "axes",
            ElasticChoice::Mixed => "mixed",
            ElasticChoice::Auto => "auto",
        }
    }

    /// The model in sentences, tables and figures.
    pub fn in_words(self) -> &'static str {
        match self {
            ElasticChoice::Axes => "joint axes alone",
            ElasticChoice::Mixed => "mixed model",
            ElasticChoice::Auto => "model that the data call for",
        }
    }
}

/// The elastic model that predicts, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Elastic {
    /// What was asked for.
    pub asked: ElasticChoice,
    /// What predicts: `axes` or `mixed`.
    pub model: ElasticChoice,
    /// Why, and what to use for what, in sentences.
    pub reasons: Vec<String>,
    /// Twice the difference of the restricted log-likelihoods of mixed model and axes;
    /// `None` where the mixed model cannot be fitted.
    pub likelihood_ratio: Option<f64>,
    /// RMS of displacement components less their prediction from the other postures,
    /// joint axes alone \[m\].
    pub axes_rms_m: Option<f64>,
    /// The same with the mixed model, its sizes found anew without each posture \[m\].
    pub mixed_rms_m: Option<f64>,
    /// The mixed model, where it predicts.
    pub mixed: Option<MixedResult>,
    /// Errors common to the experiment as they move the mixed model, where it predicts.
    pub systematic_errors: Option<SystematicErrors>,
}

/// Fits and compares the elastic models that `asked` calls for. Where the data cannot
/// carry the mixed model, the axes predict, and the reasons say so.
///
/// # Errors
/// Options of `fit` that exclude the mixed model ([`MixedFit::new`]); interrupted.
pub fn elastic(fit: &Fit, asked: ElasticChoice) -> Result<(Elastic, Option<MixedFit>)> {
    let mut out = Elastic {
        asked,
        model: ElasticChoice::Axes,
        reasons: Vec::new(),
        likelihood_ratio: None,
        axes_rms_m: None,
        mixed_rms_m: None,
        mixed: None,
        systematic_errors: None,
    };
    if asked == ElasticChoice::Axes {
        return Ok((out, None));
    }
    let postures = fit.system().blocks.len();
    if postures < FEWEST_POSTURES {
        out.reasons.push(format!(
            "The joint axes alone predict: {postures} postures cannot show what gives way beyond them."
        ));
        return Ok((out, None));
    }
    let mixed = match MixedFit::new(fit) {
        Ok(mixed) => mixed,
        Err(error) if [Code::TooFewData, Code::NotIdentifiable].contains(&error.code()) => {
            out.reasons
                .push(format!("The joint axes alone predict. {}", error.message()));
            return Ok((out, None));
        }
        Err(error) => return Err(error),
    };
    let rms = |found: Result<Validation>| match found {
        Ok(found) => Ok(found
            .unpredicted
            .is_empty()
            .then_some(found.component_rms_m)),
        Err(error) if error.code() == Code::NotIdentifiable => Ok(None),
        Err(error) => Err(error),
    };
    out.likelihood_ratio = Some(mixed.likelihood_ratio());
    let folds = postures.min(MOST_FOLDS);
    out.axes_rms_m = rms(cross_validate(fit, folds, None))?;
    out.mixed_rms_m = rms(cross_validate_mixed(&mixed, folds, None))?;
    let rejected = mixed.likelihood_ratio() > LIKELIHOOD_RATIO;
    let better = match (out.axes_rms_m, out.mixed_rms_m) {
        (Some(axes), Some(mixed)) => mixed < axes,
        (None, Some(_)) => true,
        _ => false,
    };
    let is_mixed = asked == ElasticChoice::Mixed || (rejected && better);
    let nothing = mixed.likelihood_ratio() == 0.0;
    out.reasons = match nothing {
        true => vec![NOTHING.to_string(), QUOTE.to_string()],
        false => reasons(&out, rejected, is_mixed),
    };
    if is_mixed {
        out.model = ElasticChoice::Mixed;
        let (mut found, systematic) = (mixed.result()?, mixed_systematic_errors(&mixed)?);
        systematic.widen(&mut found.joints);
        out.mixed = Some(found);
        out.systematic_errors = Some(systematic);
    }
    Ok((out, Some(mixed)))
}

fn reasons(found: &Elastic, rejected: bool, is_mixed: bool) -> Vec<String> {
    let mut out = Vec::new();
    if let (Some(axes), Some(mixed)) = (found.axes_rms_m, found.mixed_rms_m) {
        let by = match 1.0 - mixed / axes {
            less if less >= WORTH_SAYING => format!("{} less than", percent(less)),
            _ => "no less than".to_string(),
        };
        out.push(format!(
            "With joints and base that give way in all directions, a posture that took no part is missed by {} (RMS), \
             {by} the {} of the joint axes alone{}.",
            length(mixed),
            length(axes),
            match rejected {
                true => ", and the data reject the axes alone",
                false => ", and the data do not need more than the axes",
            }
        ));
    }
    out.push(match is_mixed {
        true => "Predict and compensate with the mixed model; quote the joint stiffness of the axes alone, which depends on \
                 the model (the mixed one's is beside it)."
            .to_string(),
        false => QUOTE.to_string(),
    });
    out
}
