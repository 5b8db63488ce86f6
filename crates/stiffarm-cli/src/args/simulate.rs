//! Options of `stiffarm simulate`.

use super::Page;
use clap::{Args, ValueHint};
use std::time::Duration;
use stiffarm::ask::simulate::SimulateOptions;
use stiffarm::ask::values::pause;

#[derive(Debug, Args)]
pub struct Simulate {
    /// Cell file; its prior stiffness is the truth of the simulation
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Posture files, one group each
    #[arg(value_hint = ValueHint::FilePath, required = true, value_name = "POSTURES.csv")]
    pub postures: Vec<String>,
    /// What is asked.
    #[command(flatten)]
    pub options: SimulateOptions,
    /// Also write one simulated measurement of the first group (exact model), as input for `identify`
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
    pub page: Page,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}
