//! How the joint stiffness is estimated.

use crate::ask::rules::changed_options;
#[cfg(feature = "clap")]
use crate::ask::values::{Choice, ELASTIC, choice, number, one_of};
use crate::error::{Code, Error, Result};
use crate::estimate::elastic::ElasticChoice;
use crate::estimate::identify::{CONFIDENCE, Estimator, IdentifyOptions, NoiseSource, Weights};
use crate::model::observation::ExtraTerm;
use crate::model::robot::Robot;
use crate::units::percent_to_fraction;
use serde::{Deserialize, Serialize};

/// How the joint stiffness is estimated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "clap", derive(clap::Args), command(next_help_heading = "Estimator"))]
#[serde(default)]
pub struct FitOptions {
    /// How the joint stiffness is estimated
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME", default_value = "two-variance",
        value_parser = one_of(&Estimator::ALL, |estimator| estimator.as_str().into())))]
    pub estimator: Estimator,
    /// Extra terms: tilt (of all joints), tilt1, …, base, lost (motion of all joints), lost1, …
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME,…", value_delimiter = ','))]
    pub extra: Vec<String>,
    /// What gives way: joints and base in all directions as far as the data show, or the joint
    /// axes alone [default: mixed, axes with another estimator, noise or extra terms]
    #[cfg_attr(feature = "clap", arg(long, value_name = "MODEL", value_parser = choice(ELASTIC)))]
    pub elastic: Option<ElasticChoice>,
    /// Relative weight of single displacements
    #[cfg_attr(feature = "clap", arg(long, value_name = "FROM", default_value = "readings",
        value_parser = choice(WEIGHTS)))]
    pub weights: Weights,
    /// Standard deviation of the cell's prior stiffness, for --estimator prior [%]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", default_value_t = 30.0, value_parser = number("percent")))]
    pub prior_std_percent: f64,
    /// Size of the noise: from the residuals, the cell, or repeated readings
    #[cfg_attr(feature = "clap", arg(long, value_name = "SOURCE", default_value = "estimated",
        value_parser = choice(NOISE)))]
    pub noise: NoiseSource,
    /// Confidence of the bands
    #[cfg_attr(feature = "clap", arg(long, value_name = "P", default_value_t = 0.95))]
    pub confidence: f64,
}

impl Default for FitOptions {
    fn default() -> Self {
        FitOptions {
            estimator: Estimator::default(),
            extra: Vec::new(),
            elastic: None,
            weights: Weights::default(),
            prior_std_percent: 30.0,
            noise: NoiseSource::default(),
            confidence: 0.95,
        }
    }
}

impl FitOptions {
    /// The options for this robot.
    ///
    /// # Errors
    /// A term that does not exist (key `extra`), a confidence or a standard deviation of the prior that cannot be (its
    /// field is the key).
    pub fn options(&self, robot: &Robot) -> Result<IdentifyOptions> {
        let [low, high] = CONFIDENCE;
        if !(low..=high).contains(&self.confidence) {
            let message = format!("The confidence must lie between {low} and {high}, got {:?}.", self.confidence);
            let error = Error::invalid(message).key("confidence");
            return Err(error.hint("give 0.95 for 95 %"));
        }
        let percent = self.prior_std_percent;
        if !(percent.is_finite() && percent > 0.0) {
            let message = format!("The standard deviation must be above 0 %, got {percent} %.");
            let error = Error::invalid(message).key("prior_std_percent");
            return Err(error.hint("give 30 where the prior may be wrong by about 30 %"));
        }
        let mut extra = Vec::new();
        for word in &self.extra {
            extra.extend(ExtraTerm::parse(word, robot).map_err(|e| e.key("extra"))?);
        }
        Ok(IdentifyOptions {
            estimator: self.estimator,
            weights: self.weights,
            prior_std: percent_to_fraction(percent),
            noise: self.noise,
            confidence: self.confidence,
            extra,
            ..IdentifyOptions::default()
        })
    }

    /// Refuses options of a fit where there is none.
    ///
    /// # Errors
    /// One of them is not as it is by default (its field is the key).
    pub fn refuse(&self) -> Result<()> {
        match changed_options(self)?.into_iter().next() {
            Some(name) => Err(Error::new(Code::Usage, format!("`{name}` can be used only with `folds`."))
                .key(name)
                .hint("a saved stiffness brings its own estimator, terms and confidence")),
            None => Ok(()),
        }
    }
}

/// Where the size of the noise comes from.
#[cfg(feature = "clap")]
const NOISE: &[Choice<NoiseSource>] = &[
    ("estimated", "From the residuals", NoiseSource::Estimated),
    ("known", "From the cell's [noise]", NoiseSource::Known),
    ("repeats", "From readings that were repeated", NoiseSource::Repeats),
];

/// Where the relative weight of single displacements comes from.
#[cfg(feature = "clap")]
const WEIGHTS: &[Choice<Weights>] = &[
    ("readings", "All readings alike, each as often as it was taken", Weights::Readings),
    ("tracker", "The tracker's range and angle model, [tracker] of the cell", Weights::Tracker),
];
