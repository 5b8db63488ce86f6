//! The command line of `stiffarm route`.

use super::PageArgs;
use clap::{Args, ValueHint};
use stiffarm::ask::values::{angle_step, seed};

#[derive(Debug, Args)]
pub struct RouteArgs {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// The plan
    #[arg(value_hint = ValueHint::FilePath, value_name = "POSTURES.csv")]
    pub plan: String,
    /// Keep the order of the plan
    #[arg(long)]
    pub keep_order: bool,
    /// Take equivalent postures where they are nearer: other turns, the wrist the other way round; a sheet
    /// written before then has other angles
    #[arg(long)]
    pub equivalents: bool,
    /// With it: other turns only. A wrist the other way round has the same joint axes, but an arm that gives way
    /// beyond them bends otherwise
    #[arg(long, requires = "equivalents")]
    pub keep_wrist: bool,
    /// Steps that angles are rounded to [deg]; 0 leaves them as they are
    #[arg(long, value_name = "DEG", default_value_t = 0.01, value_parser = angle_step())]
    pub angle_step_deg: f64,
    /// Seed of the random numbers, for ways around obstacles and for many postures
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = seed())]
    pub seed: u64,
    /// Also show each move
    #[arg(long)]
    pub details: bool,
    /// Write the postures in this order, as they are to be driven to
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "plan.csv", help_heading = "Output")]
    pub output: Option<String>,
    /// The page of the result.
    #[command(flatten)]
    pub page: PageArgs,
    /// Overwrite an existing file
    #[arg(long, help_heading = "Output")]
    pub force: bool,
}
