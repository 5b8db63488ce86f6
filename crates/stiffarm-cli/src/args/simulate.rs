//! Options of `stiffarm simulate`.

use super::PageArgs;
use super::fit::ELASTIC;
use crate::numbers::to_usize;
use clap::{Args, ValueHint};
use std::time::Duration;
use stiffarm::ask::values::{choice, count, number, pause, seed};
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::estimate::simulated::{ErrorRequest, Request};

#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// Cell file; its prior stiffness is the truth of the simulation
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Posture files, one group each
    #[arg(value_hint = ValueHint::FilePath, required = true, value_name = "POSTURES.csv")]
    pub postures: Vec<String>,
    /// Runs per group and noise level [default: 200; 100 where the arm gives way beyond its axes]
    #[arg(long, value_parser = count())]
    pub runs: Option<u64>,
    /// Noise levels: factors on the cell's variance [default: 0.5,1,1.5,2,2.5,3; 1 where the arm
    /// gives way beyond its axes]
    #[arg(
        long,
        value_name = "F,…",
        value_delimiter = ',',
        value_parser = number("levels"),
        allow_hyphen_values = true
    )]
    pub levels: Vec<f64>,
    /// What gives way: the joint axes alone, or joints and base in all directions, with the
    /// cell's [elastic] or typical sizes; then each run is identified with the axes alone and
    /// with the mixed model [default: axes]
    #[arg(long, value_name = "MODEL", value_parser = choice(ELASTIC))]
    pub elastic: Option<ElasticChoice>,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 1, value_parser = seed())]
    pub seed: u64,
    /// Also write one simulated measurement of the first group (exact model), to try `identify` on
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "measurements.csv")]
    pub measurements: Option<String>,
    /// Also write the raw readings of one simulated experiment with the first group: tracker somewhere,
    /// loads going up and down, repeats, drift, a base reflector (exact model)
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "readings.csv")]
    pub readings: Option<String>,
    /// The readings come as on a day in the cell: one load state more after each pause, for `stiffarm measure`
    #[arg(long, value_name = "S", requires = "readings", value_parser = pause())]
    pub slowly: Option<Duration>,
    /// Also show every noise level, or each joint where the arm gives way beyond its axes
    #[arg(long)]
    pub details: bool,
    /// The page of the result.
    #[command(flatten)]
    pub page: PageArgs,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
    /// Errors of the model behind the readings.
    #[command(flatten)]
    pub errors: ErrorArgs,
}

impl SimulateArgs {
    /// What gives way.
    pub fn elastic(&self) -> ElasticChoice {
        self.elastic.unwrap_or(ElasticChoice::Axes)
    }

    /// What is asked for, as the library takes it.
    pub fn request(&self) -> Request {
        Request {
            levels: self.levels.clone(),
            runs: self.runs.map(to_usize),
            seed: self.seed,
            errors: ErrorRequest {
                force_scale_error_percent: self.errors.force_scale_error_percent,
                force_error_percent: self.errors.force_error_percent,
                joint_angle_error_deg: self.errors.joint_angle_error_deg,
                loading_point_error_mm: self.errors.loading_point_error_mm,
                anchor_error_mm: self.errors.anchor_error_mm,
            },
        }
    }
}

/// Standard deviations of model errors, all zero in the paper.
#[derive(Debug, Args)]
#[command(next_help_heading = "Errors of the model (standard deviations, zero in the paper)")]
pub struct ErrorArgs {
    /// Scale of the force reading, one error per run [%]
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = number("percent"))]
    pub force_scale_error_percent: f64,
    /// Force reading, a fresh error for each posture [%]
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = number("percent"))]
    pub force_error_percent: f64,
    /// Each joint angle of each posture [deg]
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = number("deg"))]
    pub joint_angle_error_deg: f64,
    /// Each coordinate of the loading point, one error per run [mm]
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = number("mm"))]
    pub loading_point_error_mm: f64,
    /// Each coordinate of the anchor of rope or cylinder, one error per run [mm]
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = number("mm"))]
    pub anchor_error_mm: f64,
}

impl ErrorArgs {
    /// The first option that makes an error.
    pub fn given(&self) -> Option<&'static str> {
        [
            (
                "--force-scale-error-percent",
                self.force_scale_error_percent,
            ),
            ("--force-error-percent", self.force_error_percent),
            ("--joint-angle-error-deg", self.joint_angle_error_deg),
            ("--loading-point-error-mm", self.loading_point_error_mm),
            ("--anchor-error-mm", self.anchor_error_mm),
        ]
        .into_iter()
        .find_map(|(name, size)| (size != 0.0).then_some(name))
    }
}
