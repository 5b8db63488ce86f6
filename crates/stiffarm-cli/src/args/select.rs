//! The command line of `stiffarm select`.

use super::Page;
use clap::{ArgGroup, Args, ValueEnum, ValueHint};
use stiffarm::ask::select::SelectOptions;

#[derive(Debug, Args)]
pub struct Select {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Initial group to improve locally, as in the paper, instead of a global search
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "POSTURES.csv",
          help_heading = "Postures that are there already")]
    pub initial: Option<String>,
    /// Postures measured or planned already: they stay as they are, and --add or --drop says what to do
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "POSTURES.csv",
          help_heading = "Postures that are there already")]
    pub given: Option<String>,
    /// What is asked.
    #[command(flatten)]
    pub options: SelectOptions,
    /// Choose the best postures out of this list: a table of postures, or one of measurements,
    /// whose postures count under their measured wrenches
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "TABLE")]
    pub candidates: Option<String>,
    /// Also show all indices, correlations, the moves, the room that each limit leaves and what errors rest on
    #[arg(long)]
    pub details: bool,
    /// Files to write.
    #[command(flatten)]
    pub output: Output,
}

/// Files to write.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output",
          group = ArgGroup::new("readings").args(["sheet", "print"]).multiple(true))]
pub struct Output {
    /// Write the postures to this file; with --curve the curve as CSV
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "plan.csv")]
    pub output: Option<String>,
    /// Write a sheet for the readings, pre-filled per posture, load state and point: CSV, or
    /// a workbook with a page to print where the name ends in .xlsx
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "measurements.xlsx", conflicts_with = "curve")]
    pub sheet: Option<String>,
    /// Write a page to print on A4: each posture with its angles, its picture and boxes to tick
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "plan.html", conflicts_with = "curve")]
    pub print: Option<String>,
    /// Draw the cell at the postures, the one with the least room in full
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "FILE.svg", conflicts_with = "curve")]
    pub figure: Option<String>,
    /// Load states of the sheet, in the order in which they are taken, for example
    /// preload,up-250,up-500,down-250; an unloaded state comes first [default: loaded]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', requires = "readings")]
    pub states: Vec<String>,
    /// In the sheet, each posture ends unloaded once more, which shows the drift
    #[arg(long, requires = "readings")]
    pub drift: bool,
    /// In the sheet, a reflector on the robot's base is read in each state
    #[arg(long, requires = "readings")]
    pub base_reflector: bool,
    /// What the sheet is for [default: readings]
    #[arg(long, value_name = "KIND", requires = "readings")]
    pub sheet_of: Option<SheetChoice>,
    /// The page of the result.
    #[command(flatten)]
    pub page: Page,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// What a sheet is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SheetChoice {
    /// Positions as the tracker gives them
    Readings,
    /// Differences that are calculated elsewhere
    Displacements,
}
