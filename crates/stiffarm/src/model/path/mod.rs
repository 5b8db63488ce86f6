//! A path of the tool tip: where it should be, point by point, and its load there.
//!
//! Poses are those of the tip frame: its origin is the contact point, its z the
//! tool axis, which points out of the tool into the workpiece.

mod frames;

pub(crate) use frames::tip_wrench;
pub use frames::{feed_axes, load_axes, tip_wrenches};

use crate::error::{Code, Error, Result};
use crate::model::load::Wrench;
use crate::model::process::{ForceAxes, ProcessLoad, TipLoad};
use nalgebra::{Isometry3, UnitVector3, Vector3};
use std::sync::Arc;

/// Feeds beyond this are none \[m/s\].
pub const FASTEST: f64 = 100.0;

/// Where the tip should be, base frame.
#[derive(Debug, Clone, PartialEq)]
pub enum PathTarget {
    /// Controller angles q \[rad\].
    Angles(Vec<f64>),
    /// Pose of the tip frame \[m\].
    Pose(Isometry3<f64>),
    /// Position of the tip \[m\] and direction of the tool axis; the turn about
    /// the axis is free.
    Axis {
        /// Position of the tip \[m\].
        position: Vector3<f64>,
        /// z of the tip frame.
        axis: UnitVector3<f64>,
    },
}

/// One point of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPoint {
    /// Name used in tables: that of the file, else its number from 1. Shared by
    /// all that is found for the point.
    pub name: Arc<str>,
    /// Line of the file, where there is one.
    pub line: Option<usize>,
    /// Where the tip should be.
    pub target: PathTarget,
    /// Load of this point; `None` takes that of the process.
    pub load: Option<TipLoad>,
    /// Name of the feature of the part that it belongs to: the operation, layer or tool path of a program.
    pub feature: Option<Arc<str>>,
    /// Feed at which the tip gets there \[m/s\], where it is known.
    pub feed: Option<f64>,
    /// Whether the arm gets there by a rapid move, on which its joints may turn far.
    pub rapid: bool,
}

impl PathPoint {
    /// Its own load, else that of `process` at its feed, if there is one.
    ///
    /// # Errors
    /// The load follows from the feed, and the feed is not known.
    pub fn load_by(&self, process: Option<&ProcessLoad>) -> Result<Option<TipLoad>> {
        let (None, Some(process)) = (self.load, process) else {
            return Ok(self.load);
        };
        let load = process.at(self.feed).ok_or_else(|| {
            let message = format!(
                "The cut has spindle_rpm, so its load follows from the feed, and the path gives no feed at point {}.",
                self.name
            );
            self.at(Error::new(Code::MissingKey, message).hint(
                "give the feed: FEDRAT, F or the speed of the move in a program, the column feed_mm_per_min in a \
                 table; or give feed_per_tooth_mm in place of spindle_rpm",
            ))
        })?;
        Ok(Some(load))
    }

    /// Whether its load, its own or else that of `process`, is in the axes of the path.
    pub(crate) fn is_loaded_along(&self, process: Option<&ProcessLoad>) -> bool {
        let load = self.load.as_ref().or(process.map(|process| &process.load));
        load.is_some_and(|load| load.axes == ForceAxes::Path)
    }

    /// `error` with the line of this point.
    pub(crate) fn at(&self, error: Error) -> Error {
        error.in_line(self.line)
    }
}

/// One posture of the arm under its load at the tip.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedPosture {
    /// Name used in tables.
    pub name: Arc<str>,
    /// Line of the file, where there is one.
    pub line: Option<usize>,
    /// Name of the feature of the part that it belongs to.
    pub feature: Option<Arc<str>>,
    /// Controller angles \[rad\].
    pub q: Vec<f64>,
    /// Wrench on the robot at the tip, base axes.
    pub wrench: Wrench,
}

impl LoadedPosture {
    /// A posture at controller angles `q` \[rad\] under a wrench on the robot at
    /// the tip, base axes.
    pub fn new(name: impl Into<Arc<str>>, q: Vec<f64>, wrench: Wrench) -> Self {
        LoadedPosture { name: name.into(), line: None, feature: None, q, wrench }
    }

    /// `error` with the line of this posture.
    pub(crate) fn at(&self, error: Error) -> Error {
        error.in_line(self.line)
    }
}
