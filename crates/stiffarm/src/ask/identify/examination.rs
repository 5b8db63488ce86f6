//! What the residuals and the errors common to the experiment say of an identification, as far as the user lets it
//! come.

use crate::error::{Code, Result};
use crate::estimate::diagnose::Diagnosis;
use crate::estimate::diagnosed::diagnosed;
use crate::estimate::identify::{Fit, JointEstimate, Profile, profile};
use crate::estimate::mixed::MixedFit;
use crate::estimate::systematic::{SystematicErrors, systematic_errors_with};

/// What the residuals and the errors common to the experiment say.
#[derive(Default)]
pub(super) struct Examination {
    pub profile: Option<Profile>,
    /// As they move the joints of what predicts.
    pub systematic_errors: Option<SystematicErrors>,
    /// As they move the joints of the axes alone, where the mixed model predicts.
    pub of_axes: Option<SystematicErrors>,
    pub diagnosis: Option<Diagnosis>,
}

impl Examination {
    /// What a stop leaves out is named in `left_out`.
    pub fn new(fit: &Fit, mixed: Option<&MixedFit>, profiles: bool, left_out: &mut Vec<String>) -> Result<Self> {
        let mut out = Examination::default();
        // A profile holds the set-up still.
        if profiles {
            out.profile = unless_stopped("profile", left_out, profile(fit))?.flatten();
        }
        // Before the diagnosis, which takes long and may be stopped; again where that finds a quantity of the set-up
        // off.
        let errors = systematic_errors_with(fit, mixed, None);
        out.systematic_errors = unless_stopped("systematic_errors", left_out, errors)?;
        let diagnosis = diagnosed(fit, mixed);
        out.diagnosis = unless_stopped("diagnosis", left_out, diagnosis)?;
        let off = out.diagnosis.as_ref().and_then(Diagnosis::off);
        let errors_of = |mixed: Option<&MixedFit>| {
            let errors = systematic_errors_with(fit, mixed, off);
            // What a stop leaves out is named already, or stands in `interval_holds` of the axes.
            unless_stopped("systematic_errors", &mut Vec::new(), errors)
        };
        if off.is_some()
            && let Some(errors) = errors_of(mixed)?
        {
            out.systematic_errors = Some(errors);
        }
        if mixed.is_some() {
            out.of_axes = errors_of(None)?;
        }
        Ok(out)
    }
}

/// Joints whose intervals hold all errors, where these are known.
pub(super) fn widened(mut joints: Vec<JointEstimate>, by: Option<&SystematicErrors>) -> Vec<JointEstimate> {
    by.iter().for_each(|errors| errors.widen(&mut joints));
    joints
}

/// What was found; `None`, with its name in `left_out`, where the user stopped it.
pub(super) fn unless_stopped<T>(name: &str, left_out: &mut Vec<String>, outcome: Result<T>) -> Result<Option<T>> {
    match outcome {
        Err(error) if error.code() == Code::Interrupted => {
            left_out.push(name.to_string());
            Ok(None)
        }
        outcome => outcome.map(Some),
    }
}
