//! Commands about the robot at work.

use super::Page;
use clap::{Args, ValueHint};
use std::path::PathBuf;
use stiffarm::ask::map::MapOptions;
use stiffarm::ask::values::{AXES, choice};
use stiffarm::model::process::ForceAxes;
use stiffarm_files::tool_path::{LANGUAGES, PathLanguage};

#[derive(Debug, Args)]
pub struct Map {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Result of `identify`, {"stiffness_nm_per_rad": [k1, …]}, or `prior` for the cell's own
    #[arg(value_hint = ValueHint::FilePath, value_name = "STIFFNESS.json")]
    pub stiffness: String,
    /// What is asked.
    #[command(flatten)]
    pub options: MapOptions,
    /// The best place for a path.
    #[command(flatten)]
    pub place: Place,
    /// Folder for map.svg and map.csv, with --place for placement.svg and placement.csv
    #[arg(long, value_name = "DIR")]
    pub output_dir: Option<PathBuf>,
    /// Also show the postures, which way the tip gives way, and what the arm may reach
    #[arg(long)]
    pub details: bool,
    /// The page of the result.
    #[command(flatten)]
    pub page: Page,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// The best place for a path.
#[derive(Debug, Args)]
#[command(next_help_heading = "Best place of the workpiece")]
pub struct Place {
    /// Instead of a map, find where in the region the workpiece has to lie for this path to bend the arm least [region
    /// by default: the plane through the given place]
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "PATH.csv")]
    pub place: Option<String>,
    /// Language of the path, where its name and text do not tell it
    #[arg(long, value_name = "LANGUAGE", value_parser = choice(LANGUAGES), requires = "place")]
    pub language: Option<PathLanguage>,
    /// Axes of the path's forces, where its rows do not say
    #[arg(long, value_name = "AXES", value_parser = choice(AXES), requires = "place")]
    pub axes: Option<ForceAxes>,
}
