//! The load at work: what the process puts on the tool tip, the contact point.

mod milling;

pub use milling::{CuttingCoefficients, Milling, MillingDirection};

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Axes in which a load at work is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ForceAxes {
    /// The robot's base.
    Base,
    /// The tip frame; its z is the tool axis.
    Tool,
    /// The workpiece frame of the cell.
    Workpiece,
    /// The path: z the tool axis, x the feed direction across it, y = z × x.
    Path,
}

impl ForceAxes {
    /// All of them, with the names that files and the command line use.
    pub const NAMES: [(&'static str, ForceAxes); 4] = [
        ("base", ForceAxes::Base),
        ("tool", ForceAxes::Tool),
        ("workpiece", ForceAxes::Workpiece),
        ("path", ForceAxes::Path),
    ];

    /// Name in files and messages.
    pub fn as_str(self) -> &'static str {
        match self {
            ForceAxes::Base => "base",
            ForceAxes::Tool => "tool",
            ForceAxes::Workpiece => "workpiece",
            ForceAxes::Path => "path",
        }
    }
}

/// Force and moment *on the robot* at the tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipLoad {
    /// Force \[N\].
    pub force: Vector3<f64>,
    /// Moment about the tip \[N·m\].
    pub moment: Vector3<f64>,
    /// Axes of both.
    pub axes: ForceAxes,
}

/// Where the loads of a path come from when its rows do not give them.
#[derive(Debug, Clone, PartialEq)]
pub enum Process {
    /// The same load all along.
    Constant(TipLoad),
    /// The mean load of a milling cut.
    Milling(Milling),
}

impl Process {
    /// The load it puts on the tip.
    pub fn load(&self) -> TipLoad {
        match self {
            Process::Constant(load) => *load,
            Process::Milling(milling) => milling.mean_load(),
        }
    }
}
