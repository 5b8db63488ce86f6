//! Options of `capsules`.

use clap::{Args, ValueEnum, ValueHint};
use stiffarm::ask::values::within;

#[derive(Debug, Args)]
pub struct Capsules {
    /// Triangle meshes: .stl, .obj or .dae
    #[arg(value_hint = ValueHint::FilePath, required = true, value_name = "MESH")]
    pub meshes: Vec<String>,
    /// Unit of the meshes: m in robot descriptions, mm from most CAD systems
    #[arg(long, value_name = "UNIT", default_value = "m")]
    pub unit: MeshUnit,
    /// Most capsules around each mesh; one more is taken where it saves a quarter of a capsule
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = within::<usize>(1..=12))]
    pub most: usize,
    /// Print tables [[robot.shape]] of link I: 0 stands still, link 3 moves with joint 3. The
    /// meshes are in the frame that its Denavit-Hartenberg row ends in, of link 0 in the base frame
    #[arg(long, value_name = "I", conflicts_with = "tool", value_parser = within::<usize>(0..=100))]
    pub link: Option<usize>,
    /// Print tables [[tool.shape]]; the meshes are in the axes of the flange
    #[arg(long)]
    pub tool: bool,
}

/// Units of meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MeshUnit {
    /// Metres
    M,
    /// Millimetres
    Mm,
}

impl MeshUnit {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            MeshUnit::M => "m",
            MeshUnit::Mm => "mm",
        }
    }

    /// Its length \[m\].
    pub fn length(self) -> f64 {
        match self {
            MeshUnit::M => 1.0,
            MeshUnit::Mm => stiffarm::units::MM,
        }
    }
}
