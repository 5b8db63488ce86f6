//! Options of `pose`.

use clap::{Args, ValueEnum, ValueHint};
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
    #[arg(long, value_name = "NAME")]
    pub convention: Option<ConventionChoice>,
    /// Frame that poses are given in
    #[arg(long, value_name = "FRAME", default_value = "controller")]
    pub frame: FrameChoice,
    /// What the poses that are read and written are of
    #[arg(long, value_name = "POINT", default_value = "flange")]
    pub point: PointChoice,
    /// Where to write the poses, or with --poses all postures, as a table
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "FILE")]
    pub output: Option<String>,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}

/// Conventions of orientations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ConventionChoice {
    /// A, B, C: turns about z, then y', then x'' (deg)
    Kuka,
    /// Quaternion q1 to q4, the scalar first
    Abb,
    /// W, P, R: turns about fixed x, then y, then z (deg)
    Fanuc,
    /// A, E, R: turns about z, then y', then z'' (deg)
    Comau,
    /// Rx, Ry, Rz: turns about fixed x, then y, then z (deg)
    Yaskawa,
    /// Rx, Ry, Rz: turns about x, then y', then z'' (deg)
    Staubli,
    /// Rotation vector (rad)
    Ur,
    /// Rotation matrix
    Matrix,
}

impl From<ConventionChoice> for Convention {
    fn from(choice: ConventionChoice) -> Self {
        match choice {
            ConventionChoice::Kuka => Convention::Kuka,
            ConventionChoice::Abb => Convention::Abb,
            ConventionChoice::Fanuc => Convention::Fanuc,
            ConventionChoice::Comau => Convention::Comau,
            ConventionChoice::Yaskawa => Convention::Yaskawa,
            ConventionChoice::Staubli => Convention::Staubli,
            ConventionChoice::Ur => Convention::Ur,
            ConventionChoice::Matrix => Convention::Matrix,
        }
    }
}

/// Frames that poses are given in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FrameChoice {
    /// The base frame of the robot's controller, as the pendant counts
    Controller,
    /// The cell's base frame
    Cell,
}

/// What a pose is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PointChoice {
    /// The flange
    Flange,
    /// The tip of [work], else the first measuring point in the flange's axes
    Tip,
}

impl From<FrameChoice> for PoseFrame {
    fn from(choice: FrameChoice) -> Self {
        match choice {
            FrameChoice::Controller => PoseFrame::Controller,
            FrameChoice::Cell => PoseFrame::Cell,
        }
    }
}

impl From<PointChoice> for PosePoint {
    fn from(choice: PointChoice) -> Self {
        match choice {
            PointChoice::Flange => PosePoint::Flange,
            PointChoice::Tip => PosePoint::Tip,
        }
    }
}
