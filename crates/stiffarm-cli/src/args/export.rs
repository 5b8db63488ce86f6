//! Options of `export`.

use clap::builder::PossibleValue;
use clap::{Args, ValueHint};
use std::path::PathBuf;
use stiffarm::ask::values::{one_of, within};
use stiffarm::model::robot::Controller;
use stiffarm_files::program::Language;

#[derive(Debug, Args)]
pub struct Export {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// The plan: postures in the order in which they are measured
    #[arg(value_hint = ValueHint::FilePath, value_name = "POSTURES.csv")]
    pub plan: String,
    /// Language of the robot's controller [default: that of the cell's controller]
    #[arg(long, value_name = "LANGUAGE", value_parser = one_of(&Language::ALL, shown))]
    pub language: Option<Language>,
    /// Folder for the program
    #[arg(long, value_name = "DIR", required_unless_present = "compare", conflicts_with = "compare")]
    pub output_dir: Option<PathBuf>,
    /// Write nothing: read this program, as it is or changed at the pendant, and say where its
    /// postures differ from the plan (KRL: both files)
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "FILE", num_args = 1..=2)]
    pub compare: Vec<String>,
    /// Posture where the program begins and ends: a table with one row [default: the cell's
    /// route.start_deg, where it has one]
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "POSTURE.csv")]
    pub start: Option<String>,
    /// Speed of the moves in per cent; the first move has half of it, at most 5 [default: the cell's
    /// route.speed_percent, else 10]
    #[arg(long, value_name = "PERCENT", value_parser = within::<u8>(1..=100))]
    pub speed_percent: Option<u8>,
    /// Load states to measure at each posture, as texts of the program name them [default: unloaded
    /// and those of the cell's loads]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub states: Vec<String>,
    /// Name of the program on the controller [default: measure_ and the plan's name]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// What the language needs to know of the controller.
    #[command(flatten)]
    pub controller: ControllerChoice,
    /// Also write a plan that violates limits of its cell; never one beyond the robot's own limits
    #[arg(long, conflicts_with = "compare")]
    pub despite_limits: bool,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// What a language needs to know of the controller.
#[derive(Debug, Args)]
#[command(next_help_heading = "The controller")]
pub struct ControllerChoice {
    /// Maker of the controller whose pendant shows the angles of this cell, where the language belongs to another maker
    /// than the robot
    #[arg(long, value_name = "NAME", value_parser = one_of(&Controller::ALL, |controller| controller.as_str().into()))]
    pub controller: Option<Controller>,
    /// Tool of the controller: a number, in RAPID a name; pdl2 and urscript name none [default: rapid tool0, ls 1,
    /// inform 0, krl as it is on the controller]
    #[arg(long, value_name = "TOOL")]
    pub tool: Option<String>,
    /// For arms of seven joints: which axis of the controller each joint of the cell is; 1,2,7,3,4,5,6 where the third
    /// joint is axis 7
    #[arg(long, value_name = "N,…", value_delimiter = ',')]
    pub controller_axes: Vec<usize>,
    /// Encoder pulses per degree of each axis (inform only)
    #[arg(long, value_name = "X,…", value_delimiter = ',', allow_hyphen_values = true)]
    pub pulses_per_degree: Vec<f64>,
}

/// A language with what its programs are.
fn shown(language: Language) -> PossibleValue {
    PossibleValue::new(language.as_str()).help(language.files())
}
