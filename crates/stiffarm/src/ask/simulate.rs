//! What is asked of a simulation: levels, runs, and errors of the model.

#[cfg(feature = "clap")]
use crate::ask::values::{ELASTIC, choice, count, number, seed};
use crate::error::{Code, Error, Result};
use crate::estimate::elastic::ElasticChoice;
use crate::estimate::simulate::{ElasticSimulationOptions, ModelErrors, SimulationOptions};
use crate::units::{deg_to_rad, mm_to_m};
use serde::{Deserialize, Serialize};

/// Options of the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// Factors on the cell's variance.
    pub levels: Vec<f64>,
    /// Runs per group and level.
    pub runs: usize,
    /// Standard deviations of errors of force, angles and geometry.
    pub model_errors: ModelErrors,
}

/// Standard deviations of [`ModelErrors`] in the units of files and screens, all zero in the paper.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(
    feature = "clap",
    derive(clap::Args),
    command(next_help_heading = "Errors of the model (standard deviations, zero in the paper)")
)]
pub struct ErrorOptions {
    /// Scale of the force reading, one error per run [%]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", default_value_t = 0.0, value_parser = number("percent")))]
    pub force_scale_error_percent: f64,
    /// Force reading, a fresh error for each posture [%]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", default_value_t = 0.0, value_parser = number("percent")))]
    pub force_error_percent: f64,
    /// Each joint angle of each posture [deg]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", default_value_t = 0.0, value_parser = number("deg")))]
    pub joint_angle_error_deg: f64,
    /// Each coordinate of the loading point, one error per run [mm]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", default_value_t = 0.0, value_parser = number("mm")))]
    pub loading_point_error_mm: f64,
    /// Each coordinate of the anchor of rope or cylinder, one error per run [mm]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", default_value_t = 0.0, value_parser = number("mm")))]
    pub anchor_error_mm: f64,
}

/// What is asked of a simulation.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct SimulateOptions {
    /// Runs per group and noise level [default: 200; 100 where the arm gives way beyond its axes]
    #[cfg_attr(feature = "clap", arg(long, value_parser = count::<usize>()))]
    pub runs: Option<usize>,
    /// Noise levels: factors on the cell's variance [default: 0.5,1,1.5,2,2.5,3; 1 where the arm
    /// gives way beyond its axes]
    #[cfg_attr(feature = "clap", arg(long, value_name = "F,…", value_delimiter = ',', value_parser = number("levels"),
        allow_hyphen_values = true))]
    pub levels: Vec<f64>,
    /// What gives way: the joint axes alone, or joints and base in all directions, with the
    /// cell's [elastic] or typical sizes; then each run is identified with the axes alone and
    /// with the mixed model [default: axes]
    #[cfg_attr(feature = "clap", arg(long, value_name = "MODEL", value_parser = choice(ELASTIC)))]
    pub elastic: Option<ElasticChoice>,
    /// Seed of the random numbers
    #[cfg_attr(feature = "clap", arg(long, default_value_t = 1, value_parser = seed()))]
    pub seed: u64,
    /// Errors of the model behind the readings.
    #[cfg_attr(feature = "clap", command(flatten))]
    pub errors: ErrorOptions,
}

impl Default for SimulateOptions {
    fn default() -> Self {
        SimulateOptions { runs: None, levels: Vec::new(), elastic: None, seed: 1, errors: ErrorOptions::default() }
    }
}

impl ErrorOptions {
    /// The first error that is asked for.
    fn first(&self) -> Option<&'static str> {
        [
            ("force_scale_error_percent", self.force_scale_error_percent),
            ("force_error_percent", self.force_error_percent),
            ("joint_angle_error_deg", self.joint_angle_error_deg),
            ("loading_point_error_mm", self.loading_point_error_mm),
            ("anchor_error_mm", self.anchor_error_mm),
        ]
        .into_iter()
        .find_map(|(name, size)| (size != 0.0).then_some(name))
    }

    /// The errors in SI units.
    ///
    /// # Errors
    /// A negative value, or one that is not finite (its field is the key).
    pub fn model_errors(&self) -> Result<ModelErrors> {
        check_not_negative("force_scale_error_percent", &[self.force_scale_error_percent])?;
        check_not_negative("force_error_percent", &[self.force_error_percent])?;
        check_not_negative("joint_angle_error_deg", &[self.joint_angle_error_deg])?;
        check_not_negative("loading_point_error_mm", &[self.loading_point_error_mm])?;
        check_not_negative("anchor_error_mm", &[self.anchor_error_mm])?;
        Ok(ModelErrors {
            force_scale: self.force_scale_error_percent / 100.0,
            force_per_posture: self.force_error_percent / 100.0,
            joint_angle_rad: deg_to_rad(self.joint_angle_error_deg),
            loading_point_m: mm_to_m(self.loading_point_error_mm),
            anchor_m: mm_to_m(self.anchor_error_mm),
        })
    }
}

impl SimulateOptions {
    /// What gives way.
    pub fn elastic(&self) -> ElasticChoice {
        self.elastic.unwrap_or(ElasticChoice::Axes)
    }

    /// Options of a simulation of an arm of which the joint axes alone give way.
    ///
    /// # Errors
    /// As [`ErrorOptions::model_errors`]; a negative level, or one that is not finite (key
    /// `levels`).
    pub fn simulation_options(&self) -> Result<SimulationOptions> {
        let default = SimulationOptions::default();
        let model_errors = self.errors.model_errors()?;
        Ok(SimulationOptions {
            variance_factors: self.levels(default.variance_factors)?,
            runs: self.runs.unwrap_or(default.runs),
            seed: self.seed,
            model_errors,
        })
    }

    /// Options of a simulation of an arm that gives way beyond its joint axes, identified with
    /// the axes alone and with the mixed model.
    ///
    /// # Errors
    /// A level as in [`SimulateOptions::simulation_options`]; errors of the model, which such a
    /// simulation does not draw (its field is the key).
    pub fn elastic_options(&self) -> Result<ElasticSimulationOptions> {
        if let Some(error) = self.errors.first() {
            let message = "Errors of the model are drawn only for an arm of which the joint axes alone give way.";
            return Err(Error::new(Code::Conflict, message)
                .key(error)
                .hint(format!("leave `{error}` out, or `elastic`")));
        }
        let default = ElasticSimulationOptions::default();
        Ok(ElasticSimulationOptions {
            variance_factors: self.levels(default.variance_factors.clone())?,
            runs: self.runs.unwrap_or(default.runs),
            seed: self.seed,
            elastic: self.elastic(),
            ..default
        })
    }

    fn levels(&self, default: Vec<f64>) -> Result<Vec<f64>> {
        let levels = if self.levels.is_empty() { default } else { self.levels.clone() };
        check_not_negative("levels", &levels)?;
        Ok(levels)
    }
}

impl From<&SimulationOptions> for Options {
    /// The options as the result holds them.
    fn from(options: &SimulationOptions) -> Self {
        Options { levels: options.variance_factors.clone(), runs: options.runs, model_errors: options.model_errors }
    }
}

fn check_not_negative(key: &str, values: &[f64]) -> Result<()> {
    match values.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
        Some(v) => {
            let message = format!("Each value must be 0 or more, got {v}.");
            Err(Error::invalid(message).key(key))
        }
        None => Ok(()),
    }
}
