//! How a path stands in a table.

use super::contents::{Content, PathKind, contents};
use crate::table::quantity::Unit;
use nalgebra::Isometry3;
use stiffarm::model::cell::Cell;
use stiffarm::model::path::PathPoint;
use stiffarm::model::process::ForceAxes;

/// A column: its heading, what it holds and in which unit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FormatColumn {
    pub(super) heading: String,
    pub(super) content: Content,
    pub(super) unit: Option<Unit>,
}

impl FormatColumn {
    pub(super) fn new(heading: String, content: Content, unit: Option<Unit>) -> Self {
        FormatColumn { heading, content, unit }
    }
}

/// The columns of a path: their order, headings and units, and the frame of its
/// poses.
#[derive(Debug, Clone, PartialEq)]
pub struct PathFormat {
    pub(super) columns: Vec<FormatColumn>,
    pub(super) kind: PathKind,
    /// Frame of poses and tool axes in the base frame \[m\].
    pub(super) workpiece: Isometry3<f64>,
    /// Axes of loads in a table without the column `axes`.
    pub(super) axes: Option<ForceAxes>,
    /// What separates the columns.
    pub(super) separator: char,
    /// Whether decimals have a comma.
    pub(super) decimal_commas: bool,
}

impl PathFormat {
    /// The columns `point` and those of `kind` in the usual units; poses and
    /// tool axes in the workpiece frame of `cell`.
    pub fn new(kind: PathKind, cell: &Cell) -> Self {
        let columns = usual(cell).filter(|column| column.content == Content::Name || column.content.belongs_to(kind));
        PathFormat {
            columns: columns.collect(),
            kind,
            workpiece: cell.work.workpiece,
            axes: None,
            separator: ',',
            decimal_commas: false,
        }
    }

    /// The columns of `kind` in the usual units, where the columns of the tip
    /// stand now; names and loads stay as they are.
    #[must_use]
    pub fn with_kind(mut self, kind: PathKind, cell: &Cell) -> Self {
        if kind == self.kind {
            return self;
        }
        let is_target = |column: &FormatColumn| column.content.is_target();
        let at = self.columns.iter().position(is_target).unwrap_or(0);
        self.columns.retain(|column| !is_target(column));
        let new = usual(cell).filter(|column| column.content.belongs_to(kind));
        self.columns.splice(at..at, new);
        self.kind = kind;
        self.workpiece = cell.work.workpiece;
        self
    }

    /// The same path in joint angles `q1_deg` …: [`with_kind`](Self::with_kind).
    #[must_use]
    pub fn angles(self, cell: &Cell) -> Self {
        self.with_kind(PathKind::Angles, cell)
    }

    /// The same path in poses `x_mm` … `yaw_deg`: [`with_kind`](Self::with_kind).
    #[must_use]
    pub fn poses(self, cell: &Cell) -> Self {
        self.with_kind(PathKind::Poses, cell)
    }

    /// Columns of forces, moments and their axes in the usual units at the end,
    /// in place of those that are there.
    #[must_use]
    pub fn with_loads(mut self, cell: &Cell) -> Self {
        self.columns.retain(|column| !column.content.is_load());
        let loads = usual(cell).filter(|column| column.content.is_load());
        self.columns.extend(loads);
        self
    }

    /// Columns of features, feeds and loads in the usual units at the end, as far as `points` have them.
    #[must_use]
    pub fn holding(mut self, points: &[PathPoint], cell: &Cell) -> Self {
        let any = |has: fn(&PathPoint) -> bool| points.iter().any(has);
        let wanted = |content: Content| match content {
            Content::Feature => any(|point| point.feature.is_some()),
            Content::Feed => any(|point| point.feed.is_some()),
            content => content.is_load() && any(|point| point.load.is_some()),
        };
        let more = usual(cell).filter(|column| !self.has(column.content) && wanted(column.content));
        let more: Vec<FormatColumn> = more.collect();
        self.columns.extend(more);
        self
    }

    /// What the rows say of the tip.
    pub fn kind(&self) -> PathKind {
        self.kind
    }

    /// True where the table has columns of forces.
    pub fn has_loads(&self) -> bool {
        self.has(Content::Force(0))
    }

    pub(super) fn has(&self, content: Content) -> bool {
        self.columns.iter().any(|column| column.content == content)
    }
}

/// Every column in its usual unit.
fn usual(cell: &Cell) -> impl Iterator<Item = FormatColumn> {
    let contents = contents(cell.setup.robot.joint_count()).into_iter();
    contents.map(|(content, definition)| FormatColumn::new(definition.heading(), content, definition.usual_unit()))
}
