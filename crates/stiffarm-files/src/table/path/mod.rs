//! Paths: `point` and the angles, poses or tool axes of the tip, with the load there.
//!
//! A path goes out as it came in. `format` keeps the columns, units and frame
//! of a path (`PathFormat`) beside its points. Angles are written exactly;
//! poses are products of rotations, so their last digits are rounding and would
//! change at every reading. They are rounded where they are written, of roll as
//! much as the pitch lets it matter, so that a written path read and written
//! again is the same text.

mod contents;
mod format;
mod heading;
mod read;
mod size;
mod write;

pub use contents::PathKind;
pub(super) use contents::definitions as path_definitions;
pub use format::PathFormat;
pub use read::read_path;
pub use write::write_path;

use stiffarm::model::path::PathPoint;

/// A path as it was read, and how it was written there.
#[derive(Debug, Clone, PartialEq)]
pub struct PathTable {
    /// The points in the order of the rows, targets in the base frame.
    pub points: Vec<PathPoint>,
    /// The columns, for [`write_path`].
    pub format: PathFormat,
}
