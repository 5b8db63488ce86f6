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

/// Powers of the spindle \[W\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpindlePower {
    /// Under the load.
    pub loaded: f64,
    /// Without it, below the other.
    pub idle: f64,
}

impl SpindlePower {
    /// The share of the load at a power \[W\].
    pub fn share(&self, power: f64) -> f64 {
        (power - self.idle) / (self.loaded - self.idle)
    }
}

/// Where the loads of a path come from when its rows do not give them.
#[derive(Debug, Clone, PartialEq)]
pub enum Process {
    /// The same load all along, with the power of the spindle at which it acts where that is known.
    Constant(TipLoad, Option<SpindlePower>),
    /// The mean load of a milling cut.
    Milling(Milling),
    /// The same at a known speed of the spindle: its feed per tooth is that at a feed of 1 m/s, and the load of a
    /// point follows from its feed.
    MillingAtFeed(Milling),
}

/// The load of a process, linear in the feed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProcessLoad {
    /// Without what follows from the feed.
    pub load: TipLoad,
    /// Force \[N/(m/s)\] and moment \[N·m/(m/s)\] that a feed adds; `None` where the feed does not matter.
    pub per_feed: Option<[Vector3<f64>; 2]>,
}

impl From<TipLoad> for ProcessLoad {
    fn from(load: TipLoad) -> Self {
        ProcessLoad { load, per_feed: None }
    }
}

impl ProcessLoad {
    /// The load at a feed \[m/s\]; `None` where it is needed and not known.
    pub fn at(&self, feed: Option<f64>) -> Option<TipLoad> {
        let Some([force, moment]) = &self.per_feed else {
            return Some(self.load);
        };
        let feed = feed?;
        Some(TipLoad { force: self.load.force + force * feed, moment: self.load.moment + moment * feed, ..self.load })
    }
}

impl Process {
    /// The load it puts on the tip.
    pub fn load(&self) -> ProcessLoad {
        match self {
            Process::Constant(load, _) => (*load).into(),
            Process::Milling(milling) => milling.mean_load().into(),
            Process::MillingAtFeed(milling) => {
                let feed_per_tooth = 0.0;
                let edges = Milling { feed_per_tooth, ..*milling };
                let (load, moving) = (edges.mean_load(), milling.mean_load());
                ProcessLoad { load, per_feed: Some([moving.force - load.force, moving.moment - load.moment]) }
            }
        }
    }
}
