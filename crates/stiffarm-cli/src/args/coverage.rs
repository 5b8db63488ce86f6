//! Options of `stiffarm coverage`.

use super::Page;
use clap::{Args, ValueHint};
use stiffarm::ask::coverage::CoverageOptions;

#[derive(Debug, Args)]
pub struct Coverage {
    /// Cell file; its prior stiffness is the truth
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// The postures that are measured
    #[arg(value_hint = ValueHint::FilePath, value_name = "POSTURES.csv")]
    pub postures: String,
    /// What is asked.
    #[command(flatten)]
    pub options: CoverageOptions,
    /// The page of the result.
    #[command(flatten)]
    pub page: Page,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}
