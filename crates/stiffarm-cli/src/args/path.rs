//! Commands that work on paths of the tool tip.

use super::PageArgs;
use super::measured::MODEL;
use super::work::{AXES, Triple};
use clap::{Args, ValueEnum, ValueHint};
use stiffarm::ask::values::{choice, number, triple, within};
use stiffarm::estimate::validate::Model;
use stiffarm::model::process::ForceAxes;
use stiffarm_files::program::Language;
use stiffarm_files::tool_path::{LANGUAGES, PathLanguage};

/// The path, its loads and its postures.
#[derive(Debug, Clone, Args)]
pub struct PathArgs {
    /// What the path is written in, where neither its name nor its text says it rightly
    #[arg(long, value_name = "LANGUAGE", value_parser = choice(LANGUAGES))]
    pub language: Option<PathLanguage>,
    /// Axes of the forces in the path, where it has no column axes, and of --force-n
    #[arg(long, value_name = "AXES", value_parser = choice(AXES))]
    pub axes: Option<ForceAxes>,
    /// Force on the robot's tip [N] where the path has none [default: the cell's [work]]
    #[arg(long, value_name = "X,Y,Z", value_parser = triple("force_n"), allow_hyphen_values = true)]
    pub force_n: Option<Triple>,
    /// Moment about the tip [N·m], with --force-n
    #[arg(long, value_name = "X,Y,Z", value_parser = triple("moment_nm"), allow_hyphen_values = true, requires = "force_n")]
    pub moment_nm: Option<Triple>,
    /// Recorded load along the path: a table of along_mm or time_s, from the path's first point, and forces (with --axes) or
    /// power_w of the spindle
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "log.csv", requires = "path", conflicts_with = "force_n")]
    pub log: Option<String>,
    /// Standard uncertainty of the load at work [%]
    #[arg(
        long,
        value_name = "X",
        default_value_t = 0.0,
        value_parser = number("percent"),
    )]
    pub load_uncertainty_percent: f64,
    /// Posture that the first one should be near [deg] [default: the branch that bends least]
    #[arg(
        long,
        value_name = "Q1,…",
        value_delimiter = ',',
        value_parser = number("deg"),
        allow_hyphen_values = true
    )]
    pub near_deg: Vec<f64>,
    /// Largest change of a joint from one point to the next [deg]; more is a jump
    #[arg(
        long,
        value_name = "X",
        default_value_t = 30.0,
        value_parser = number("step_deg"),
    )]
    pub max_step_deg: f64,
    /// How far features of the path that have no tolerance in the cell may come out beside where they should be [mm]: says
    /// of each whether it does
    #[arg(long, value_name = "X", value_parser = number("mm"))]
    pub tolerance_mm: Option<f64>,
    /// The turn about the tool axis is free: try N of them at each point and take the postures that
    /// bend least [default: 72]
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "72", require_equals = true,
          value_parser = within::<u16>(1..=3600))]
    pub free_turn: Option<u16>,
}

#[derive(Debug, Args)]
pub struct PredictArgs {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Result of `identify`, {"stiffness_nm_per_rad": [k1, …]}, or `prior` for the cell's
    #[arg(value_hint = ValueHint::FilePath, value_name = "STIFFNESS.json")]
    pub stiffness: String,
    /// Path or postures: a table, CL data (.cls, .apt), G-code (.nc) or a robot's program [default: the tasks of the cell]
    #[arg(value_hint = ValueHint::FilePath, value_name = "PATH.csv")]
    pub path: Option<String>,
    /// How the loads and postures of the path are found.
    #[command(flatten)]
    pub along: PathArgs,
    /// The cell's own [load], acting at its loading point, instead of a load at the tip; the deflection is that of the
    /// tip all the same
    #[arg(long, conflicts_with_all = ["force_n", "axes", "free_turn", "log"])]
    pub cell_load: bool,
    /// With --cell-load: which of several load cases
    #[arg(long, value_name = "NAME", requires = "cell_load")]
    pub load_case: Option<String>,
    /// How the deflection is calculated
    #[arg(long, default_value = "equilibrium", value_parser = choice(MODEL))]
    pub model: Model,
    /// Also the Cartesian stiffness matrix, with and without K_C, and its principal axes
    #[arg(long)]
    pub matrix: bool,
    /// Write the deflections of all points to this table
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "predicted.csv")]
    pub output: Option<String>,
    /// Draw the deflection along the path with its band
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "predicted.svg")]
    pub figure: Option<String>,
    /// Also show all points, what the ± is made of, and which way the tip gives way
    #[arg(long)]
    pub details: bool,
    /// The page of the result.
    #[command(flatten)]
    pub page: PageArgs,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct CompensateArgs {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Result of `identify`, {"stiffness_nm_per_rad": [k1, …]}, or `prior` for the cell's
    #[arg(value_hint = ValueHint::FilePath, value_name = "STIFFNESS.json")]
    pub stiffness: String,
    /// Path that the loaded tool should follow: a table, CL data (.cls, .apt), G-code (.nc) or a robot's program
    #[arg(value_hint = ValueHint::FilePath, value_name = "PATH.csv")]
    pub path: String,
    /// How the loads and postures of the path are found.
    #[command(flatten)]
    pub along: PathArgs,
    /// Write the path to command to this file: in the columns of the path, or the same program with other numbers
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "commanded.csv")]
    pub output: Option<String>,
    /// What is written [default: the path as it came, a program with other numbers]
    #[arg(long, value_name = "WHAT", requires = "output")]
    pub write: Option<WriteChoice>,
    /// With --write of a robot's language: speed of the linear moves [mm/s]
    #[arg(long, value_name = "X", default_value_t = 20.0, value_parser = number("speed_mm_s"))]
    pub speed_mm_s: f64,
    /// With it: name or number of the controller's tool, that of the tip [default: 1, tool1]
    #[arg(long, value_name = "TOOL", requires = "write")]
    pub tool: Option<String>,
    /// With it: name or number of the controller's base, that of the workpiece frame [default: 1, wobj1]
    #[arg(long, value_name = "BASE", requires = "write")]
    pub base: Option<String>,
    /// Draw the deflection along the path before and after
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "compensated.svg")]
    pub figure: Option<String>,
    /// Write also what goes beyond the identification's displacements and forces, or has a serious finding
    #[arg(long)]
    pub beyond_data: bool,
    /// Also show all points, what the ± is made of, and which way the tip gives way
    #[arg(long)]
    pub details: bool,
    /// The page of the result.
    #[command(flatten)]
    pub page: PageArgs,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// What a commanded path holds.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum WriteChoice {
    /// A table of controller angles
    Angles,
    /// A table of poses of the tip
    Poses,
    /// A new program of linear moves in KUKA KRL
    Krl,
    /// In ABB RAPID
    Rapid,
    /// In FANUC TP
    Ls,
    /// In URScript
    Urscript,
}

impl WriteChoice {
    /// The language of a new program.
    pub fn language(self) -> Option<Language> {
        match self {
            WriteChoice::Angles | WriteChoice::Poses => None,
            WriteChoice::Krl => Some(Language::Krl),
            WriteChoice::Rapid => Some(Language::Rapid),
            WriteChoice::Ls => Some(Language::Ls),
            WriteChoice::Urscript => Some(Language::Urscript),
        }
    }
}
