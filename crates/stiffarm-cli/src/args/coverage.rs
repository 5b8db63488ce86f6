//! Options of `stiffarm coverage`.

use super::PageArgs;
use clap::{Args, ValueHint};
use stiffarm::ask::fit::FitOptions;
use stiffarm::ask::values::{count, seed};

#[derive(Debug, Args)]
pub struct CoverageArgs {
    /// Cell file; its prior stiffness is the truth
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// The postures that are measured
    #[arg(value_hint = ValueHint::FilePath, value_name = "POSTURES.csv")]
    pub postures: String,
    /// Experiments to simulate
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = count())]
    pub runs: u64,
    /// Count the intervals of so many resamples of the postures instead
    #[arg(long, value_name = "N", value_parser = count())]
    pub bootstrap: Option<u64>,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 1, value_parser = seed())]
    pub seed: u64,
    /// How the stiffness is estimated.
    #[command(flatten)]
    pub fit: FitOptions,
    /// The page of the result.
    #[command(flatten)]
    pub page: PageArgs,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}
