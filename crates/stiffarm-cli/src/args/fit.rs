//! How the joint stiffness is estimated.

use clap::Args;
use stiffarm::ask::values::{Choice, choice, number, one_of};
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::estimate::identify::{CONFIDENCE, Estimator, IdentifyOptions, NoiseSource, Weights};
use stiffarm::model::observation::ExtraTerm;
use stiffarm::model::robot::Robot;
use stiffarm::{Code, Error, Result};

/// Options of a fit; what is not given stays at its default.
#[derive(Debug, Args)]
#[command(next_help_heading = "Estimator")]
pub struct FitArgs {
    /// How the joint stiffness is estimated [default: two-variance]
    #[arg(long, value_name = "NAME", value_parser = one_of(&Estimator::ALL, |own| own.as_str().into()))]
    pub estimator: Option<Estimator>,
    /// Extra terms: tilt (of all joints), tilt1, …, base, lost (motion of all joints), lost1, …
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub extra: Vec<String>,
    /// What gives way: joints and base in all directions as far as the data show, or the joint
    /// axes alone [default: mixed, axes with another estimator, noise or extra terms]
    #[arg(long, value_name = "MODEL", value_parser = choice(ELASTIC))]
    pub elastic: Option<ElasticChoice>,
    /// Relative weight of single displacements [default: readings]
    #[arg(long, value_name = "FROM", value_parser = choice(WEIGHTS))]
    pub weights: Option<Weights>,
    /// Standard deviation of the cell's prior stiffness, for --estimator prior [%] [default: 30]
    #[arg(long, value_name = "X", value_parser = number("percent"))]
    pub prior_std_percent: Option<f64>,
    /// Size of the noise: from the residuals, the cell, or repeated readings [default: estimated]
    #[arg(long, value_name = "SOURCE", value_parser = choice(NOISE))]
    pub noise: Option<NoiseSource>,
    /// Confidence of the bands [default: 0.95]
    #[arg(long, value_name = "P")]
    pub confidence: Option<f64>,
}

impl FitArgs {
    /// The first option that is given.
    pub fn given(&self) -> Option<&'static str> {
        [
            ("--estimator", self.estimator.is_some()),
            ("--extra", !self.extra.is_empty()),
            ("--elastic", self.elastic.is_some()),
            ("--weights", self.weights.is_some()),
            ("--prior-std-percent", self.prior_std_percent.is_some()),
            ("--noise", self.noise.is_some()),
            ("--confidence", self.confidence.is_some()),
        ]
        .into_iter()
        .find_map(|(name, given)| given.then_some(name))
    }

    /// The options for this robot.
    ///
    /// # Errors
    /// A term or a confidence that does not exist.
    pub fn options(&self, robot: &Robot) -> Result<IdentifyOptions> {
        let default = IdentifyOptions::default();
        let mut extra = Vec::new();
        for word in &self.extra {
            extra.extend(ExtraTerm::parse(word, robot).map_err(|e| e.key("--extra"))?);
        }
        let confidence = self.confidence.unwrap_or(default.confidence);
        check_confidence(confidence)?;
        let prior_std = match self.prior_std_percent {
            Some(percent) if percent.is_finite() && percent > 0.0 => percent / 100.0,
            Some(percent) => {
                return Err(Error::new(
                    Code::Usage,
                    format!("The standard deviation must be above 0 %, got {percent} %."),
                )
                .key("--prior-std-percent")
                .hint("give 30 where the prior may be wrong by about 30 %"));
            }
            None => default.prior_std,
        };
        let mut options = IdentifyOptions::default();
        options.estimator = self.estimator.unwrap_or(default.estimator);
        options.weights = self.weights.unwrap_or(default.weights);
        options.prior_std = prior_std;
        options.noise = self.noise.unwrap_or(default.noise);
        options.confidence = confidence;
        options.extra = extra;
        Ok(options)
    }
}

/// Refuses what cannot be a confidence.
///
/// # Errors
/// It does not lie between 0 and 1.
fn check_confidence(confidence: f64) -> Result<()> {
    if (CONFIDENCE[0]..=CONFIDENCE[1]).contains(&confidence) {
        Ok(())
    } else {
        Err(Error::new(
            Code::Usage,
            format!(
                "The confidence must lie between {} and {}, got {confidence:?}.",
                CONFIDENCE[0], CONFIDENCE[1]
            ),
        )
        .key("--confidence")
        .hint("give 0.95 for 95 %"))
    }
}

/// What gives way.
pub const ELASTIC: &[Choice<ElasticChoice>] = &[
    ("axes", "The joint axes alone", ElasticChoice::Axes),
    (
        "mixed",
        "Joints and base in all directions, as far as the data show",
        ElasticChoice::Mixed,
    ),
];

/// Where the size of the noise comes from.
const NOISE: &[Choice<NoiseSource>] = &[
    ("estimated", "From the residuals", NoiseSource::Estimated),
    ("known", "From the cell's [noise]", NoiseSource::Known),
    (
        "repeats",
        "From readings that were repeated",
        NoiseSource::Repeats,
    ),
];

/// Where the relative weight of single displacements comes from.
const WEIGHTS: &[Choice<Weights>] = &[
    (
        "readings",
        "All readings alike, each as often as it was taken",
        Weights::Readings,
    ),
    (
        "tracker",
        "The tracker's range and angle model, [tracker] of the cell",
        Weights::Tracker,
    ),
];
