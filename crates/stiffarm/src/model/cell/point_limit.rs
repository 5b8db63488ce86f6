//! Limits on points as values: what holds for which points.

use crate::model::limit::LimitKind;

/// A limit on points in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointLimit {
    /// The limit.
    pub kind: LimitKind,
    /// The points that it holds for.
    pub of: LimitedPoints,
    /// What of them is bounded.
    pub measure: Measure,
    /// On which side of `at` it may be.
    pub side: Side,
    /// The bound \[m\].
    pub at: f64,
}

/// The points that a limit holds for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitedPoints {
    /// Loading point, measuring points and flange.
    Tool,
    /// The wrist centre.
    Wrist,
    /// All of these.
    All,
}

/// What of a point is bounded \[m\].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Its coordinate along this axis, counted from 0.
    Axis(usize),
    /// Its distance from axis 1.
    FromAxis1,
}

/// On which side of its bound it may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Not below it.
    AtLeast,
    /// Not above it.
    AtMost,
}

impl PointLimit {
    /// Whether it holds for the points of the tool, or else for the wrist centre.
    #[inline]
    pub(crate) fn holds_for(&self, is_tool_point: bool) -> bool {
        match self.of {
            LimitedPoints::Tool => is_tool_point,
            LimitedPoints::Wrist => !is_tool_point,
            LimitedPoints::All => true,
        }
    }

    /// The height below or above which points must not be \[m\]; `None` for a side of the box, and away from axis 1.
    pub fn level(&self) -> Option<f64> {
        let is_level = self.measure == Measure::Axis(2) && self.kind != LimitKind::ToolBox;
        is_level.then_some(self.at)
    }
}
