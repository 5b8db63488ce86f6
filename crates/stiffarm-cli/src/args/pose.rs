//! Options of `pose`.

use clap::{Args, ValueHint};
use stiffarm::ask::pose::PoseOptions;

#[derive(Debug, Args)]
pub struct Pose {
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
    /// How the poses are meant.
    #[command(flatten)]
    pub options: PoseOptions,
    /// Table to write: the poses, or with --poses all postures
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "FILE")]
    pub output: Option<String>,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}
