//! What the columns of a path may hold.

use crate::table::beside::RowQuantity;
use crate::table::heading::ColumnDefinition;
use crate::table::quantity::Quantity;

/// What the rows of a path say of the tip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathKind {
    /// `q1_deg` to `qn_deg`: controller angles.
    Angles,
    /// `x_mm, y_mm, z_mm, roll_deg, pitch_deg, yaw_deg`: the pose of the tip frame.
    Poses,
    /// `x_mm, y_mm, z_mm, axis_x, axis_y, axis_z`: position of the tip and
    /// direction of the tool axis.
    ToolAxes,
}

/// What a column holds; components and joints count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Content {
    Name,
    Angle(usize),
    Position(usize),
    Turn(usize),
    Axis(usize),
    Force(usize),
    Moment(usize),
    Axes,
    Feature,
    Feed,
}

impl Content {
    /// True where it is part of what the rows of this kind say of the tip.
    pub(super) fn belongs_to(self, kind: PathKind) -> bool {
        match kind {
            PathKind::Angles => matches!(self, Content::Angle(_)),
            PathKind::Poses => matches!(self, Content::Position(_) | Content::Turn(_)),
            PathKind::ToolAxes => matches!(self, Content::Position(_) | Content::Axis(_)),
        }
    }

    pub(super) fn is_target(self) -> bool {
        let kinds = [PathKind::Angles, PathKind::Poses, PathKind::ToolAxes];
        kinds.into_iter().any(|kind| self.belongs_to(kind))
    }

    pub(super) fn is_load(self) -> bool {
        matches!(self, Content::Force(_) | Content::Moment(_) | Content::Axes)
    }
}

pub(super) fn position() -> [ColumnDefinition; 3] {
    ["x", "y", "z"].map(|stem| ColumnDefinition::of(stem, Quantity::Length, "position"))
}

pub(super) fn turns() -> [ColumnDefinition; 3] {
    ["roll", "pitch", "yaw"].map(|stem| ColumnDefinition::of(stem, Quantity::Angle, "orientation"))
}

pub(super) fn axis() -> [ColumnDefinition; 3] {
    ["axis_x", "axis_y", "axis_z"].map(|stem| ColumnDefinition::of(stem, Quantity::Number, "axis"))
}

/// The columns that a path may have, with what they hold.
pub(super) fn contents(joints: usize) -> Vec<(Content, ColumnDefinition)> {
    fn numbered(
        content: fn(usize) -> Content,
        definitions: impl IntoIterator<Item = ColumnDefinition>,
    ) -> impl Iterator<Item = (Content, ColumnDefinition)> {
        let definitions = definitions.into_iter().enumerate();
        definitions.map(move |(i, definition)| (content(i), definition))
    }
    let mut all = vec![(Content::Name, ColumnDefinition::name("point"))];
    let angles = ColumnDefinition::angles(joints).enumerate();
    all.extend(angles.map(|(j, definition)| (Content::Angle(j), definition)));
    all.extend(numbered(Content::Position, position()));
    all.extend(numbered(Content::Turn, turns()));
    all.extend(numbered(Content::Axis, axis()));
    all.extend(numbered(Content::Force, RowQuantity::Force.definitions()));
    all.extend(numbered(Content::Moment, RowQuantity::Moment.definitions()));
    all.push((Content::Axes, ColumnDefinition::name("axes")));
    all.push((Content::Feature, ColumnDefinition::name("feature")));
    all.push((Content::Feed, ColumnDefinition::of("feed", Quantity::Feed, "feed")));
    all
}

/// The columns that a path may have.
pub(in crate::table) fn definitions(joints: usize) -> Vec<ColumnDefinition> {
    let contents = contents(joints).into_iter();
    contents.map(|(_, definition)| definition).collect()
}
