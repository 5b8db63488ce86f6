//! Options of `pose`.

use clap::{Args, ValueHint};
use stiffarm::ask::values::{Choice, choice};
use stiffarm::model::pose::Convention;
use stiffarm::plan::poses::{PoseFrame, PosePoint};

#[derive(Debug, Args)]
pub struct PoseArgs {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Postures whose poses are wanted
    #[arg(
        value_hint = ValueHint::FilePath,
        required_unless_present = "poses",
        conflicts_with = "poses",
        value_name = "POSTURES.csv"
    )]
    pub postures: Option<String>,
    /// Poses whose postures are wanted: x_mm, y_mm, z_mm and the convention's numbers
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "POSES.csv")]
    pub poses: Option<String>,
    /// How orientations are written [default: as the controller that the cell names does, else matrix]
    #[arg(long, value_name = "NAME", value_parser = choice(CONVENTION))]
    pub convention: Option<Convention>,
    /// Frame that poses are given in
    #[arg(long, value_name = "FRAME", default_value = "controller", value_parser = choice(FRAME))]
    pub frame: PoseFrame,
    /// What the poses that are read and written are of
    #[arg(long, value_name = "POINT", default_value = "flange", value_parser = choice(POINT))]
    pub point: PosePoint,
    /// Where to write the poses, or with --poses all postures, as a table
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "FILE")]
    pub output: Option<String>,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}

/// Conventions of orientations.
const CONVENTION: &[Choice<Convention>] = &[
    (
        "kuka",
        "A, B, C: turns about z, then y', then x'' (deg)",
        Convention::Kuka,
    ),
    (
        "abb",
        "Quaternion q1 to q4, the scalar first",
        Convention::Abb,
    ),
    (
        "fanuc",
        "W, P, R: turns about fixed x, then y, then z (deg)",
        Convention::Fanuc,
    ),
    (
        "comau",
        "A, E, R: turns about z, then y', then z'' (deg)",
        Convention::Comau,
    ),
    (
        "yaskawa",
        "Rx, Ry, Rz: turns about fixed x, then y, then z (deg)",
        Convention::Yaskawa,
    ),
    (
        "staubli",
        "Rx, Ry, Rz: turns about x, then y', then z'' (deg)",
        Convention::Staubli,
    ),
    ("ur", "Rotation vector (rad)", Convention::Ur),
    ("matrix", "Rotation matrix", Convention::Matrix),
];

/// Frames that poses are given in.
const FRAME: &[Choice<PoseFrame>] = &[
    (
        "controller",
        "The base frame of the robot's controller, as the pendant counts",
        PoseFrame::Controller,
    ),
    ("cell", "The cell's base frame", PoseFrame::Cell),
];

/// What a pose is of.
const POINT: &[Choice<PosePoint>] = &[
    ("flange", "The flange", PosePoint::Flange),
    (
        "tip",
        "The tip of [work], else the first measuring point in the flange's axes",
        PosePoint::Tip,
    ),
];
