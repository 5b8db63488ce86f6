//! What the robot works with: the tool tip, the workpiece and the process.

use crate::findings::{Finding, Severity};
use crate::model::process::Process;
use crate::model::tool::Tool;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

/// Tip, workpiece and process of a cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Work {
    /// Tip frame in flange axes \[m\]; `None` is measuring point 1 with the flange's axes.
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

    /// Name of the measuring point that stands for the tip; `None` where the tip is given.
    pub fn tip_point(&self, tool: &Tool) -> Option<String> {
        let first = tool.measuring_points.first().filter(|_| self.tip.is_none());
        first.map(|point| point.name.clone())
    }

    /// Says that a measuring point stands for the tip.
    pub fn tip_assumed(&self, tool: &Tool) -> Option<Finding> {
        let sentence = format!(
            "The tip is measuring point {}, with the flange's axes: the cell says no other. Where the tool works \
             elsewhere, say so with tip_mm in [work].",
            self.tip_point(tool)?
        );
        Some(Finding::new(
            "tip-assumed",
            Severity::Note,
            "work",
            sentence,
        ))
    }
}
