//! Limits on points as values: what holds for which points.

use crate::model::limit::LimitKind;

/// A limit on points in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointLimit {
    /// The limit.
    pub kind: LimitKind,
    /// The points that it holds for.
    pub of: LimitedPoints,
    /// Where they may be.
    pub bound: PointBound,
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

/// Where a point may be \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PointBound {
    /// Its coordinate along this axis, counted from 0, is not below the value.
    Lowest(usize, f64),
    /// Nor above it.
    Highest(usize, f64),
    /// So far from axis 1.
    FromAxis1(f64),
}

impl PointLimit {
    pub(super) fn new(kind: LimitKind, of: LimitedPoints, bound: PointBound) -> Self {
        PointLimit { kind, of, bound }
    }

    /// Whether it holds for the points of the tool, or else for the wrist centre.
    pub(crate) fn holds_for(&self, is_tool_point: bool) -> bool {
        match self.of {
            LimitedPoints::Tool => is_tool_point,
            LimitedPoints::Wrist => !is_tool_point,
            LimitedPoints::All => true,
        }
    }

    /// The height below or above which points must not be \[m\]; `None` for a side of the box, and away from axis 1.
    pub fn level(&self) -> Option<f64> {
        match self.bound {
            PointBound::Lowest(2, z) | PointBound::Highest(2, z) => {
                (self.kind != LimitKind::ToolBox).then_some(z)
            }
            _ => None,
        }
    }
}
