//! Commands that work on paths of the tool tip.

use super::Page;
use clap::{Args, ValueEnum, ValueHint};
use stiffarm::ask::path::PathOptions;
use stiffarm::ask::predict::PredictOptions;
use stiffarm::ask::values::{choice, number};
use stiffarm_files::program::Language;
use stiffarm_files::tool_path::{LANGUAGES, PathLanguage};

/// How the path is read.
#[derive(Debug, Clone, Args)]
pub struct Path {
    /// Language of the path, where its name and text do not tell it
    #[arg(long, value_name = "LANGUAGE", value_parser = choice(LANGUAGES))]
    pub language: Option<PathLanguage>,
    /// Recorded load along the path: a table of along_mm or time_s, from the path's first point, and forces (with
    /// --axes) or power_w of the spindle
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "log.csv", requires = "path", conflicts_with = "force_n")]
    pub log: Option<String>,
}

#[derive(Debug, Args)]
pub struct Predict {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Result of `identify`, {"stiffness_nm_per_rad": [k1, …]}, or `prior` for the cell's
    #[arg(value_hint = ValueHint::FilePath, value_name = "STIFFNESS.json")]
    pub stiffness: String,
    /// Path or postures: a table, CL data (.cls, .apt), G-code (.nc) or a robot's program
    /// [default: the tasks of the cell]
    #[arg(value_hint = ValueHint::FilePath, value_name = "PATH.csv")]
    pub path: Option<String>,
    /// How the path is read.
    #[command(flatten)]
    pub along: Path,
    /// What is asked.
    #[command(flatten)]
    pub options: PredictOptions,
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
    pub page: Page,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct Compensate {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Result of `identify`, {"stiffness_nm_per_rad": [k1, …]}, or `prior` for the cell's
    #[arg(value_hint = ValueHint::FilePath, value_name = "STIFFNESS.json")]
    pub stiffness: String,
    /// Path that the loaded tool should follow: a table, CL data (.cls, .apt), G-code (.nc) or a robot's program
    #[arg(value_hint = ValueHint::FilePath, value_name = "PATH.csv")]
    pub path: String,
    /// How the path is read.
    #[command(flatten)]
    pub along: Path,
    /// What is asked.
    #[command(flatten)]
    pub options: PathOptions,
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
    pub page: Page,
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
