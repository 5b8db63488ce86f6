//! Options of `init`.

use clap::{Args, ValueHint};
use std::path::PathBuf;
use stiffarm::ask::values::{Choice, choice};
use stiffarm::model::robot::DhConvention;

#[derive(Debug, Args)]
pub struct Init {
    /// Robot of the catalogue (`stiffarm robots` lists it)
    #[arg(
        long,
        value_name = "NAME",
        default_value = "comau-nj165-3.0",
        conflicts_with_all = ["urdf", "dh"]
    )]
    pub robot: String,
    /// Robot of a URDF; a .xacro file is expanded where the program xacro is found
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "FILE", conflicts_with = "dh")]
    pub urdf: Option<String>,
    /// Link whose frame is the base frame [default: the root of the tree]
    #[arg(long, value_name = "LINK", requires = "urdf")]
    pub base: Option<String>,
    /// Link whose frame is the flange [default: the only end of the tree that is not a gripper, else tool0
    /// or flange]
    #[arg(long, value_name = "LINK", requires = "urdf")]
    pub tip: Option<String>,
    /// Package of meshes or of xacro files, or a folder that holds it; may be given several times. A relative
    /// path of a mesh may begin here where it does not begin beside the URDF
    #[arg(long, value_name = "DIR", requires = "urdf")]
    pub package_dir: Vec<PathBuf>,
    /// Take no collision geometry from the URDF, and look for no meshes
    #[arg(long, requires = "urdf")]
    pub no_shapes: bool,
    /// Robot of your own Denavit-Hartenberg rows, a table: joint, alpha_deg, a_mm, d_mm, offset_deg, and if you like
    /// low_deg, high_deg and sign (1 or -1)
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "ROWS.csv")]
    pub dh: Option<String>,
    /// Convention of these rows
    #[arg(long, value_name = "NAME", default_value = "modified", value_parser = choice(DH), requires = "dh")]
    pub dh_convention: DhConvention,
    /// Folder to write to; it is made if missing
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub output_dir: PathBuf,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// Conventions of Denavit–Hartenberg rows.
const DH: &[Choice<DhConvention>] = &[
    ("modified", "Craig: turn about x, shift along x, turn about z, shift along z", DhConvention::Modified),
    ("standard", "Turn about z, shift along z, shift along x, turn about x", DhConvention::Standard),
];
