//! What the robot works with: the tool tip, the workpiece and the process.

use crate::model::process::Process;
use crate::model::tool::Tool;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

/// Tip, workpiece and process of a cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Work {
    /// Tip frame in flange axes \[m\]; `None` is the TCP with the flange's axes.
    pub tip: Option<Isometry3<f64>>,
    /// Workpiece frame in the base frame \[m\]; the identity where none is given.
    pub workpiece: Isometry3<f64>,
    /// The load where a path's rows do not give it.
    pub process: Option<Process>,
}

impl Work {
    /// The tip frame in flange axes \[m\]: z is the tool axis.
    pub fn tip(&self, tool: &Tool) -> Isometry3<f64> {
        self.tip.unwrap_or_else(|| {
            Isometry3::from_parts(Translation3::from(tool.tcp()), UnitQuaternion::identity())
        })
    }
}
