//! Commands about the robot at work.

use super::PageArgs;
use clap::{Args, ValueHint};
use std::path::PathBuf;
use stiffarm::ask::values::{Choice, choice, number, triple, within};
use stiffarm::model::process::ForceAxes;
use stiffarm::work::map::MOST_TURNS;
use stiffarm::work::region::{Plane, RegionRequest, Steps};
use stiffarm_files::tool_path::{LANGUAGES, PathLanguage};

#[derive(Debug, Args)]
pub struct MapArgs {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Result of `identify`, {"stiffness_nm_per_rad": [k1, …]}, or `prior` for the cell's own
    #[arg(value_hint = ValueHint::FilePath, value_name = "STIFFNESS.json")]
    pub stiffness: String,
    /// Where to map.
    #[command(flatten)]
    pub region: RegionArgs,
    /// How the tool is held and loaded.
    #[command(flatten)]
    pub tool: ToolArgs,
    /// The best place for a path.
    #[command(flatten)]
    pub place: PlaceArgs,
    /// Folder for map.svg and map.csv, with --place for placement.svg and placement.csv
    #[arg(long, value_name = "DIR")]
    pub output_dir: Option<PathBuf>,
    /// Also show the postures, which way the tip gives way, and what the arm may reach
    #[arg(long)]
    pub details: bool,
    /// The page of the result.
    #[command(flatten)]
    pub page: PageArgs,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// Where to map.
#[derive(Debug, Args)]
#[command(next_help_heading = "Region (base frame)")]
pub struct RegionArgs {
    /// Map a plane: its coordinate, for example z=800 [mm]
    #[arg(long, value_name = "AXIS=MM", value_parser = plane)]
    pub plane: Option<Plane>,
    /// Lower corner [mm] [default: the cell's box, else what the arm may reach]
    #[arg(long, value_name = "X,Y,Z", value_parser = triple("mm"), allow_hyphen_values = true, requires = "to_mm")]
    pub from_mm: Option<Triple>,
    /// Upper corner [mm]
    #[arg(long, value_name = "X,Y,Z", value_parser = triple("mm"), allow_hyphen_values = true, requires = "from_mm")]
    pub to_mm: Option<Triple>,
    /// Nodes along the longest side, or along x, y and z [default: 61; 31 and six planes in z for a
    /// box; 11 with --place]
    #[arg(long, value_name = "N|NX,NY,NZ", value_parser = steps)]
    pub steps: Option<Steps>,
}

impl RegionArgs {
    /// The region as the library takes it.
    pub fn request(&self) -> RegionRequest {
        RegionRequest {
            plane: self.plane,
            from_mm: self.from_mm,
            to_mm: self.to_mm,
            steps: self.steps,
        }
    }
}

/// How the tool is held and loaded.
#[derive(Debug, Args)]
#[command(next_help_heading = "Tool and load")]
pub struct ToolArgs {
    /// Orientation of the tip frame: turns about the base's x, then y, then z [deg] [default:
    /// 180,0,0, the tool axis down]
    #[arg(long, value_name = "R,P,Y", value_parser = triple("deg"), allow_hyphen_values = true,
          conflicts_with = "place")]
    pub rpy_deg: Option<Triple>,
    /// The turn about the tool axis is free: try N of them and take the best [default: 24]
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "24", require_equals = true,
          value_parser = within::<usize>(1..=MOST_TURNS as u64))]
    pub free_turn: Option<usize>,
    /// Force on the robot at the tip, base axes [N] [default: the cell's [work] force, else 1 N
    /// along the direction]
    #[arg(long, value_name = "X,Y,Z", value_parser = triple("force_n"), allow_hyphen_values = true,
          conflicts_with = "place")]
    pub force_n: Option<Triple>,
    /// Moment about the tip, base axes [N·m]
    #[arg(long, value_name = "X,Y,Z", value_parser = triple("moment_nm"), allow_hyphen_values = true,
          requires = "force_n")]
    pub moment_nm: Option<Triple>,
    /// Direction of the stiffness, base axes [default: along the force, else against the tool axis]
    #[arg(long, value_name = "X,Y,Z", value_parser = triple("direction"), allow_hyphen_values = true,
          conflicts_with = "place")]
    pub direction: Option<Triple>,
}

/// The best place for a path.
#[derive(Debug, Args)]
#[command(next_help_heading = "Best place of the workpiece")]
pub struct PlaceArgs {
    /// Instead of a map: the place of the workpiece in the region where this path bends the arm
    /// least [region by default: the plane through the given place]
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "PATH.csv")]
    pub place: Option<String>,
    /// What the path is written in, where neither its name nor its text says it rightly
    #[arg(long, value_name = "LANGUAGE", value_parser = choice(LANGUAGES), requires = "place")]
    pub language: Option<PathLanguage>,
    /// Axes of the path's forces, where its rows do not say
    #[arg(long, value_name = "AXES", value_parser = choice(AXES), requires = "place")]
    pub axes: Option<ForceAxes>,
    /// Turns of the workpiece about the base's z to try [deg]
    #[arg(
        long,
        value_name = "A,…",
        value_delimiter = ',',
        value_parser = number("deg"),
        allow_hyphen_values = true,
        default_value = "0",
        requires = "place"
    )]
    pub yaw_deg: Vec<f64>,
    /// Finer grids, each about the best place so far
    #[arg(long, value_name = "N", default_value_t = 2, requires = "place",
          value_parser = within::<u8>(0..=8))]
    pub refine: u8,
}

/// Three numbers.
pub type Triple = [f64; 3];

/// Axes of a path's forces.
pub const AXES: &[Choice<ForceAxes>] = &[
    ("base", "The robot's base", ForceAxes::Base),
    (
        "tool",
        "The tip frame; its z is the tool axis",
        ForceAxes::Tool,
    ),
    (
        "workpiece",
        "The workpiece frame of the cell",
        ForceAxes::Workpiece,
    ),
    (
        "path",
        "The path: z the tool axis, x the feed direction across it",
        ForceAxes::Path,
    ),
];

fn plane(text: &str) -> Result<Plane, String> {
    let wanted = "x, y or z with a coordinate in mm is needed, as in z=800";
    let parts = text.split_once('=').and_then(|(axis, mm)| {
        let axis = ["x", "y", "z"].iter().position(|name| *name == axis.trim());
        Some((axis?, mm.trim().parse::<f64>().is_ok().then_some(mm)?))
    });
    let (axis, mm) = parts.ok_or(wanted)?;
    Ok(Plane {
        axis,
        mm: number("mm")(mm)?,
    })
}

fn steps(text: &str) -> Result<Steps, String> {
    let counts: Option<Vec<usize>> = text
        .split(',')
        .map(|v| {
            v.trim()
                .parse()
                .ok()
                .filter(|n| (1..=1_000_000).contains(n))
        })
        .collect();
    match counts.as_deref() {
        Some([longest]) => Ok(Steps::Longest(*longest)),
        Some([x, y, z]) => Ok(Steps::Each([*x, *y, *z])),
        _ => Err("a number from 1, or three with commas between them, is needed".to_string()),
    }
}
