//! Paths: `point` and the angles, poses or tool axes of the tip, with the load there.

mod contents;
mod format;
mod heading;
mod read;
mod size;
mod write;

pub use contents::PathKind;
pub(super) use contents::known as known_paths;
pub use format::PathFormat;
pub use read::read_path;
pub use write::write_path;

use crate::model::path::PathPoint;

/// A path as it was read, and how it was written there.
#[derive(Debug, Clone, PartialEq)]
pub struct PathTable {
    /// The points in the order of the rows, targets in the base frame.
    pub points: Vec<PathPoint>,
    /// The columns, for [`write_path`].
    pub format: PathFormat,
}
