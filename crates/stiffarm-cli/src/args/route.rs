//! The command line of `stiffarm route`.

use super::Page;
use clap::{Args, ValueHint};
use stiffarm::ask::route::DriveOptions;

#[derive(Debug, Args)]
pub struct Route {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// The plan
    #[arg(value_hint = ValueHint::FilePath, value_name = "POSTURES.csv")]
    pub plan: String,
    /// What is asked.
    #[command(flatten)]
    pub options: DriveOptions,
    /// Also show each move
    #[arg(long)]
    pub details: bool,
    /// Write the postures in this order, with the angles to drive to
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "plan.csv", help_heading = "Output")]
    pub output: Option<String>,
    /// The page of the result.
    #[command(flatten)]
    pub page: Page,
    /// Overwrite an existing file
    #[arg(long, help_heading = "Output")]
    pub force: bool,
}
