//! What the robot works with: the tool tip, the workpiece and the process.

use crate::error::Result;
use crate::findings::{Finding, list};
use crate::model::path::PathPoint;
use crate::model::process::Process;
use crate::model::tool::Tool;
use crate::units::deg_to_rad;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, UnitVector3, Vector3};

/// Tip, workpiece and process of a cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Work {
    /// Tip frame in flange axes \[m\]; `None` is measuring point 1 with the flange's axes.
    pub tip: Option<Isometry3<f64>>,
    /// Workpiece frame in the base frame \[m\]; the identity where none is given.
    pub workpiece: Isometry3<f64>,
    /// The load where a path's rows do not give it.
    pub process: Option<Process>,
    /// Features of the part with a load or a tolerance of their own.
    pub features: Vec<FeatureWork>,
    /// Rotary axes of the machine that G-code is for, from the workpiece to the tool.
    pub rotary: Vec<RotaryAxis>,
}

/// What differs at a feature of the part.
#[derive(Debug, Clone, PartialEq)]
pub struct FeatureWork {
    /// Its name as a path gives it.
    pub name: String,
    /// Its load; `None` is that of the whole path.
    pub process: Option<Process>,
    /// How far it may come out beside where it should be \[m\].
    pub tolerance: Option<f64>,
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
            [letter @ b'A'..=b'C'] => Some(RotaryAxis { letter: *letter, backwards }),
            _ => None,
        }
    }

    /// Its letter, `A` to `C`.
    pub fn letter(self) -> u8 {
        self.letter
    }

    /// The rotation of the tool in the workpiece at `angle` \[deg\].
    pub fn rotation(self, angle: f64) -> UnitQuaternion<f64> {
        let axis = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()][usize::from(self.letter - b'A')];
        let angle = if self.backwards { -angle } else { angle };
        UnitQuaternion::from_axis_angle(&axis, deg_to_rad(angle))
    }
}

impl Work {
    /// The tip frame in flange axes \[m\]: z is the tool axis.
    pub fn tip(&self, tool: &Tool) -> Isometry3<f64> {
        self.tip.unwrap_or_else(|| Isometry3::from_parts(Translation3::from(tool.tcp()), UnitQuaternion::identity()))
    }

    /// Name of the measuring point that stands for the tip; `None` where the tip is given.
    pub fn tip_point(&self, tool: &Tool) -> Option<String> {
        let first = tool.measuring_points.first().filter(|_| self.tip.is_none());
        first.map(|point| point.name.clone())
    }

    /// The tool axis in the workpiece, from the tip to the spindle, at these angles of A, B and C \[deg\].
    pub fn tool_axis(&self, angles: [f64; 3]) -> UnitVector3<f64> {
        let axes = self.rotary.iter().rev();
        let turned =
            axes.fold(Vector3::z(), |axis, rotary| rotary.rotation(angles[usize::from(rotary.letter() - b'A')]) * axis);
        UnitVector3::new_normalize(turned)
    }

    /// The tool axis at angles that tell every order and sense of the rotary axes apart, to be held against
    /// the machine; none without such axes.
    pub fn shown_tool_axis(&self) -> Option<Finding> {
        const ANGLES: [f64; 3] = [30.0, 40.0, 70.0];
        let letters = self.rotary.iter().map(|axis| usize::from(axis.letter() - b'A'));
        let words: Vec<String> = letters.map(|axis| format!("{}{}", ['A', 'B', 'C'][axis], ANGLES[axis])).collect();
        if words.is_empty() {
            return None;
        }
        let [x, y, z] = self.tool_axis(ANGLES).into_inner().into();
        let sentence = format!(
            "At {} of G-code the tool axis, from the tip to the spindle, is ({x:.3}, {y:.3}, {z:.3}) in the workpiece: \
             hold it against the machine.",
            words.join(" ")
        );
        Some(Finding::note("rotary-axes", "work.rotary_axes", sentence))
    }

    /// What differs at the feature `name`, if anything does.
    pub fn feature(&self, name: &str) -> Option<&FeatureWork> {
        let mut features = self.features.iter();
        features.find(|feature| feature.name == name)
    }

    /// Gives the points of a path that have no load the load of their feature, and says which features of the
    /// cell the path does not name.
    ///
    /// # Errors
    /// A load follows from the feed, and the feed is not known.
    pub fn put_on(&self, points: &mut [PathPoint]) -> Result<Option<Finding>> {
        let mut missing: Vec<String> = Vec::new();
        for feature in &self.features {
            let load = feature.process.as_ref().map(Process::load);
            let mut is_missing = true;
            let is_own = |point: &&mut PathPoint| point.feature.as_deref() == Some(&feature.name);
            for point in points.iter_mut().filter(is_own) {
                point.load = point.load_by(load.as_ref())?;
                is_missing = false;
            }
            if is_missing {
                missing.push(format!("\"{}\"", feature.name));
            }
        }
        let (first, are) = match missing.len() {
            0 => return Ok(None),
            1 => ("The feature", "is"),
            _ => ("The features", "are"),
        };
        let sentence = format!(
            "{first} {} of the cell {are} not in the path: no point has that load or tolerance.",
            list(&missing)
        );
        Ok(Some(Finding::caution("feature-not-in-path", "work.feature", sentence)))
    }

    /// The process at a point: that of its feature, else that of the whole path.
    pub fn process_at(&self, point: &PathPoint) -> Option<&Process> {
        let feature = point.feature.as_deref();
        let of_feature = feature.and_then(|name| self.feature(name)?.process.as_ref());
        of_feature.or(self.process.as_ref())
    }

    /// Says that a measuring point stands for the tip.
    pub fn tip_assumed(&self, tool: &Tool) -> Option<Finding> {
        let sentence = format!(
            "The tip is measuring point {}, with the flange's axes: the cell says no other. Where the tool works \
             elsewhere, say so with tip_mm in [work].",
            self.tip_point(tool)?
        );
        Some(Finding::note("tip-assumed", "work", sentence))
    }
}
