//! The kinds of limits, and what is said where one is violated.

use crate::units::rad_to_deg;
use serde::{Deserialize, Serialize};

/// Which limit a margin belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum LimitKind {
    /// Side of the tool box.
    ToolBox,
    /// Floor.
    Floor,
    /// Keep-out cylinder about axis 1.
    KeepOut,
    /// Height of the wrist centre.
    WristHeight,
    /// Length of the rope or cylinder.
    RopeLength,
    /// Distance between two shapes.
    Shapes,
    /// Distance between the rope or cylinder and a shape.
    RopeClearance,
    /// Cone in which the loading device of the rope or cylinder may act.
    RopeCone,
    /// Angle between a reflector's axis and the tracker's beam.
    Incidence,
    /// Distance between the tracker's beam and a shape.
    Sight,
    /// Torque of a joint under load and tool weight.
    Torque,
    /// Smallest displacement of the measuring points under the load, by the linear model.
    SmallestDisplacement,
    /// Largest displacement of the measuring points under the load, by the linear model.
    LargestDisplacement,
}

/// What a margin is measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarginUnit {
    /// Metres.
    Length,
    /// Radians.
    Angle,
    /// Share of the limit.
    Share,
    /// Metres that the load moves points by: hundredths of a millimetre matter.
    Displacement,
}

impl LimitKind {
    /// All of them.
    pub const ALL: [LimitKind; 13] = [
        LimitKind::ToolBox,
        LimitKind::Floor,
        LimitKind::KeepOut,
        LimitKind::WristHeight,
        LimitKind::RopeLength,
        LimitKind::Shapes,
        LimitKind::RopeClearance,
        LimitKind::RopeCone,
        LimitKind::Incidence,
        LimitKind::Sight,
        LimitKind::Torque,
        LimitKind::SmallestDisplacement,
        LimitKind::LargestDisplacement,
    ];

    /// Words for a message.
    pub fn describe(self) -> &'static str {
        match self {
            LimitKind::ToolBox => "the box for tool points and flange",
            LimitKind::Floor => "the floor",
            LimitKind::KeepOut => "the keep-out cylinder about axis 1",
            LimitKind::WristHeight => "the lowest height of the wrist centre",
            LimitKind::RopeLength => "the length of rope or cylinder",
            LimitKind::Shapes => "the distance between shapes",
            LimitKind::RopeClearance => "the distance between rope or cylinder and shapes",
            LimitKind::RopeCone => "the cone of the rope's or cylinder's loading device",
            LimitKind::Incidence => "the reflectors' acceptance angle",
            LimitKind::Sight => "the tracker's line of sight",
            LimitKind::Torque => "the joints' torque",
            LimitKind::SmallestDisplacement => "the smallest displacement under the load",
            LimitKind::LargestDisplacement => "the largest displacement under the load",
        }
    }

    /// Few words for a list or the heading of a column.
    pub fn short(self) -> &'static str {
        match self {
            LimitKind::ToolBox => "tool box",
            LimitKind::Floor => "floor",
            LimitKind::KeepOut => "keep-out cylinder",
            LimitKind::WristHeight => "lowest height of the wrist",
            LimitKind::RopeLength => "length of the rope",
            LimitKind::Shapes => "shapes",
            LimitKind::RopeClearance => "rope",
            LimitKind::RopeCone => "cone of the rope",
            LimitKind::Incidence => "acceptance angle",
            LimitKind::Sight => "line of sight",
            LimitKind::Torque => "torque",
            LimitKind::SmallestDisplacement => "smallest displacement",
            LimitKind::LargestDisplacement => "largest displacement",
        }
    }

    /// True where the margins depend on the load.
    pub fn is_of_load(self) -> bool {
        matches!(
            self,
            LimitKind::RopeLength
                | LimitKind::RopeClearance
                | LimitKind::RopeCone
                | LimitKind::Torque
                | LimitKind::SmallestDisplacement
                | LimitKind::LargestDisplacement
        )
    }

    /// True where the margins depend on where the arm is alone: neither on the load nor on what the
    /// tracker sees.
    pub fn is_of_place(self) -> bool {
        !self.is_of_load() && !matches!(self, LimitKind::Incidence | LimitKind::Sight)
    }

    /// What its margins are measured in.
    pub fn unit(self) -> MarginUnit {
        match self {
            LimitKind::RopeCone | LimitKind::Incidence => MarginUnit::Angle,
            LimitKind::Torque => MarginUnit::Share,
            LimitKind::SmallestDisplacement | LimitKind::LargestDisplacement => {
                MarginUnit::Displacement
            }
            _ => MarginUnit::Length,
        }
    }
}

/// Distance to one limit, positive inside.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitMargin {
    /// The limit.
    pub kind: LimitKind,
    /// What it is about: `loading point`, a measuring point's name, `flange`, `wrist centre`, `rope` or
    /// `cylinder`, two shapes, a joint, `measuring points`.
    pub point: String,
    /// Of several load cases the one under which it is so, where the limit depends on the load.
    pub load: Option<String>,
    /// Margin in the kind's [`unit`](LimitKind::unit) \[m, rad, share\], negative when violated.
    pub margin: f64,
}

/// A margin that is below zero by no more than this counts as met: searches end on limits, and
/// rounding puts them on either side \[m, rad, share\].
pub(crate) const ROUNDING: f64 = 1e-9;

impl LimitMargin {
    /// True where the limit is violated, by more than rounding.
    pub fn is_violated(&self) -> bool {
        self.margin < -ROUNDING
    }

    /// What is wrong where the margin is negative, as the end of a sentence about a posture: `has its flange 12 mm
    /// beyond the floor`.
    pub fn violation(&self) -> String {
        let amount = self.amount(-self.margin);
        let said = match self.kind {
            LimitKind::Shapes => format!("has {amount} too little room between {}", self.point),
            LimitKind::RopeClearance => {
                format!("has {amount} too little room between {}", self.point)
            }
            LimitKind::RopeLength => {
                format!("has its {0} {amount} beyond the {0}'s length", self.point)
            }
            LimitKind::RopeCone => format!(
                "turns the {} {amount} beyond its loading device's cone",
                self.point
            ),
            LimitKind::Incidence => {
                format!("turns {} {amount} beyond its acceptance angle", self.point)
            }
            LimitKind::Sight => format!(
                "hides {}: a shape reaches {amount} too far into its beam",
                self.point
            ),
            LimitKind::SmallestDisplacement => {
                format!(
                    "moves its {} {amount} too little under the load",
                    self.point
                )
            }
            LimitKind::LargestDisplacement => {
                format!("moves its {} {amount} too far under the load", self.point)
            }
            LimitKind::Torque => format!("loads {} {amount} beyond its largest torque", self.point),
            _ => format!(
                "has its {} {amount} beyond {}",
                self.point,
                self.kind.describe()
            ),
        };
        match &self.load {
            Some(load) => format!("{said} (load case {load})"),
            None => said,
        }
    }

    /// The margin itself in words: `12 mm`, `3.1°`, `4 %`, `0.125 mm` of a displacement.
    pub fn words(&self) -> String {
        // A limit that is met to rounding has no negative room.
        self.amount(if self.is_violated() {
            self.margin
        } else {
            self.margin.max(0.0)
        })
    }

    fn amount(&self, value: f64) -> String {
        match self.kind.unit() {
            MarginUnit::Displacement => format!("{:.3} mm", value * 1e3),
            MarginUnit::Length if value.abs() < 0.00995 => format!("{:.1} mm", value * 1e3),
            MarginUnit::Length => format!("{:.0} mm", value * 1e3),
            MarginUnit::Angle => format!("{:.1}°", rad_to_deg(value)),
            MarginUnit::Share => format!("{:.0} %", value * 1e2),
        }
    }
}
