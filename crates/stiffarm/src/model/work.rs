//! What the robot works with: the tool tip, the workpiece and the process.

use crate::findings::{Finding, Severity};
use crate::model::process::Process;
use crate::model::tool::Tool;
use crate::units::deg_to_rad;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Tip, workpiece and process of a cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Work {
    /// Tip frame in flange axes \[m\]; `None` is measuring point 1 with the flange's axes.
    pub tip: Option<Isometry3<f64>>,
    /// Workpiece frame in the base frame \[m\]; the identity where none is given.
    pub workpiece: Isometry3<f64>,
    /// The load where a path's rows do not give it.
    pub process: Option<Process>,
    /// Rotary axes of the machine that G-code is for, from the workpiece to the tool.
    pub rotary: Vec<RotaryAxis>,
}

/// A rotary axis of a machine tool: A turns about x, B about y, C about z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RotaryAxis {
    letter: u8,
    backwards: bool,
}

impl RotaryAxis {
    /// The axis of a name, `A` to `C`; with a minus it turns the workpiece.
    pub fn of(name: &str) -> Option<Self> {
        let (backwards, letter) = match name.strip_prefix('-') {
            Some(letter) => (true, letter),
            None => (false, name),
        };
        match letter.as_bytes() {
            [letter @ b'A'..=b'C'] => Some(RotaryAxis {
                letter: *letter,
                backwards,
            }),
            _ => None,
        }
    }

    /// Its letter, `A` to `C`.
    pub fn letter(self) -> u8 {
        self.letter
    }

    /// The rotation of the tool in the workpiece at `angle` \[deg\].
    pub fn rotation(self, angle: f64) -> UnitQuaternion<f64> {
        let axis = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()]
            [usize::from(self.letter - b'A')];
        let angle = if self.backwards { -angle } else { angle };
        UnitQuaternion::from_axis_angle(&axis, deg_to_rad(angle))
    }
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
