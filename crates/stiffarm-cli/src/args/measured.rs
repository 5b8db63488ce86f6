//! Commands that work on measurements.

use super::Page;
use clap::{Args, ValueHint};
use stiffarm::ask::identify::IdentifiedOptions;
use stiffarm::ask::register::PairOptions;
use stiffarm::ask::validate::ValidateOptions;

#[derive(Debug, Args)]
pub struct Register {
    /// Pairs of points: name, tracker_x_mm to tracker_z_mm, base_x_mm to base_z_mm
    #[arg(value_hint = ValueHint::FilePath, value_name = "PAIRS.csv")]
    pub pairs: String,
    /// What is asked.
    #[command(flatten)]
    pub options: PairOptions,
    /// Show all findings
    #[arg(long)]
    pub details: bool,
    /// Write the result as JSON to this file
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "registration.json")]
    pub output: Option<String>,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct Identify {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Measurements (.csv or .xlsx); several files are read as one table
    #[arg(value_hint = ValueHint::FilePath, value_name = "MEASUREMENTS.csv", required = true)]
    pub measurements: Vec<String>,
    /// Controller angles by posture name, where the measurements have none
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "POSTURES.csv")]
    pub postures: Option<String>,
    /// Result of `register`: places raw readings in the base frame
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "registration.json")]
    pub registration: Option<String>,
    /// What is asked.
    #[command(flatten)]
    pub options: IdentifiedOptions,
    /// Also show intervals, systematic errors by source, what each joint carries, extra terms,
    /// the largest residuals and the next posture
    #[arg(long)]
    pub details: bool,
    /// Write the result as JSON to this file, for `validate`
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "stiffness.json")]
    pub output: Option<String>,
    /// The page of the result.
    #[command(flatten)]
    pub page: Page,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
#[command(allow_missing_positional = true)]
pub struct Validate {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Result of `identify`, or {"stiffness_nm_per_rad": [k1, …]}; none with --folds
    #[arg(value_hint = ValueHint::FilePath, value_name = "STIFFNESS.json")]
    pub stiffness: Option<String>,
    /// Measurements (.csv or .xlsx); several files are read as one table
    #[arg(value_hint = ValueHint::FilePath, value_name = "MEASUREMENTS.csv", required = true)]
    pub measurements: Vec<String>,
    /// Controller angles by posture name, where the measurements have none
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "POSTURES.csv")]
    pub postures: Option<String>,
    /// Result of `register`: places raw readings in the base frame
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "registration.json")]
    pub registration: Option<String>,
    /// What is asked.
    #[command(flatten)]
    pub options: ValidateOptions,
    /// Also show every displacement, and what raw readings say of the day
    #[arg(long)]
    pub details: bool,
    /// The page of the result.
    #[command(flatten)]
    pub page: Page,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}
