//! Commands that work on measurements.

use super::PageArgs;
use super::fit::FitArgs;
use clap::{Args, ValueHint};
use stiffarm::ask::values::{Choice, above_zero, choice, count, number, seed};
use stiffarm::estimate::validate::Model;
use stiffarm::estimate::validated::Folds;

#[derive(Debug, Args)]
pub struct RegisterArgs {
    /// Pairs of points: name, tracker_x_mm to tracker_z_mm, base_x_mm to base_z_mm
    #[arg(value_hint = ValueHint::FilePath, value_name = "PAIRS.csv")]
    pub pairs: String,
    /// Standard deviation of each coordinate of a pair, both frames together [mm] [default: from
    /// the residuals]
    #[arg(long, value_name = "X", value_parser = above_zero("std_mm"))]
    pub std_mm: Option<f64>,
    /// Points to leave out
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub exclude: Vec<String>,
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
pub struct IdentifyArgs {
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
    /// Postures to leave out, for example those kept for validation
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub exclude: Vec<String>,
    /// The flange was fixed: the table has the controller's angles and the wrench of the fixture
    #[arg(long)]
    pub clamped: bool,
    /// Standard deviation of a difference of two angles, for --clamped [deg]
    #[arg(long, value_name = "X", requires = "clamped", value_parser = above_zero("noise_deg"))]
    pub angle_noise_deg: Option<f64>,
    /// How the stiffness is estimated, and what it rests on.
    #[command(flatten)]
    pub fit: FitArgs,
    /// Quantities of the set-up that are identified beside the stiffness, on purpose: anchor,
    /// loading-point, gravity, force-beside, common-shift, … (docs/set-up.md)
    #[arg(
        long,
        value_name = "NAME,…",
        value_delimiter = ',',
        help_heading = "Estimator"
    )]
    pub free: Vec<String>,
    /// Also resample the postures this often for a bootstrap interval
    #[arg(long, value_name = "N", value_parser = count())]
    pub bootstrap: Option<u64>,
    /// Seed of the resampling and of the search for the next posture
    #[arg(long, default_value_t = 1, value_parser = seed())]
    pub seed: u64,
    /// Estimates and residuals only: no leave-one-out, systematic errors,
    /// extra terms tried or next posture
    #[arg(long)]
    pub brief: bool,
    /// Also show intervals, systematic errors by source, what each joint carries, extra terms,
    /// the largest residuals and the next posture
    #[arg(long)]
    pub details: bool,
    /// Write the result as JSON to this file, for `validate`
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "stiffness.json")]
    pub output: Option<String>,
    /// The page of the result.
    #[command(flatten)]
    pub page: PageArgs,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
#[command(allow_missing_positional = true)]
pub struct ValidateArgs {
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
    /// How displacements are calculated
    #[arg(long, default_value = "linear", value_parser = choice(MODEL))]
    pub model: Model,
    /// Largest deviation allowed [mm]; beyond it the exit code is 1
    #[arg(long, value_name = "X", value_parser = number("tolerance_mm"))]
    pub tolerance_mm: Option<f64>,
    /// Only these postures
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Without a stiffness: leave out N folds of postures in turn, and predict each from the
    /// others; `all` leaves out one posture at a time
    #[arg(long, value_name = "N", value_parser = folds)]
    pub folds: Option<Folds>,
    /// Options of the fits.
    #[command(flatten)]
    pub fit: FitArgs,
    /// Also show every displacement, and what raw readings say of the day
    #[arg(long)]
    pub details: bool,
    /// The page of the result.
    #[command(flatten)]
    pub page: PageArgs,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}

fn folds(text: &str) -> Result<Folds, String> {
    if text.eq_ignore_ascii_case("all") {
        return Ok(Folds::All);
    }
    match text.parse() {
        Ok(count) if count >= 2 => Ok(Folds::Count(count)),
        _ => Err("a number from 2, or `all`, is needed".to_string()),
    }
}

/// How displacements are calculated.
pub const MODEL: &[Choice<Model>] = &[
    ("linear", "Linear in the load", Model::Linear),
    (
        "equilibrium",
        "Exact static equilibrium",
        Model::Equilibrium,
    ),
];
