//! The command line of `stiffarm measure`.

use clap::{Args, ValueHint};
use std::time::Duration;
use stiffarm::ask::measure::MeasureOptions;
use stiffarm::ask::values::pause;

#[derive(Debug, Args)]
pub struct Measure {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// The plan, in measuring order
    #[arg(value_hint = ValueHint::FilePath, value_name = "PLAN.csv")]
    pub plan: String,
    /// The files that tracker or engineer fill in; without --once they need not be there yet
    #[arg(value_hint = ValueHint::FilePath, value_name = "READINGS", required = true)]
    pub readings: Vec<String>,
    /// What is asked.
    #[command(flatten)]
    pub options: MeasureOptions,
    /// Judge what is there and end, instead of waiting for more
    #[arg(long)]
    pub once: bool,
    /// Seconds between two looks at the files
    #[arg(long, value_name = "S", default_value = "1", value_parser = pause(), conflicts_with = "once")]
    pub every: Duration,
    /// Result of `register`: places raw readings in the base frame
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "registration.json")]
    pub registration: Option<String>,
}
