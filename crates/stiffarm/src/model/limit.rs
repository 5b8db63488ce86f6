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

/// On what the margins of a limit depend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum DependsOn {
    /// Where the arm is, alone.
    Place,
    /// The load, too.
    Load,
    /// What the tracker sees, too.
    Sight,
}

/// What a limit asks of the arm on its way between two postures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum OnTheWay {
    /// To keep off something.
    KeepsOff,
    /// To get no worse: it says where a posture may be measured, and a safe start may lie outside.
    NoWorse,
}

/// All that is said of a limit.
struct Facts {
    kind: LimitKind,
    on_the_way: OnTheWay,
    describe: &'static str,
    short: &'static str,
    /// Before what it is about, in a narrow column.
    column: &'static str,
    unit: MarginUnit,
    depends_on: DependsOn,
    /// The end of a sentence about a posture: `{point}` is what it is about, `{amount}` by how much it is violated.
    violation: &'static str,
}

const fn facts(
    kind: LimitKind,
    on_the_way: OnTheWay,
    describe: &'static str,
    short: &'static str,
    column: &'static str,
    violation: &'static str,
) -> Facts {
    Facts {
        kind,
        on_the_way,
        describe,
        short,
        column,
        unit: MarginUnit::Length,
        depends_on: DependsOn::Place,
        violation,
    }
}

/// One row of each, in the order of the enum.
const FACTS: [Facts; 13] = [
    facts(
        LimitKind::ToolBox,
        OnTheWay::NoWorse,
        "the box for tool points and flange",
        "tool box",
        "tool box: ",
        "has its {point} {amount} beyond the box for tool points and flange",
    ),
    facts(
        LimitKind::Floor,
        OnTheWay::KeepsOff,
        "the floor",
        "floor",
        "floor: ",
        "has its {point} {amount} beyond the floor",
    ),
    facts(
        LimitKind::KeepOut,
        OnTheWay::KeepsOff,
        "the keep-out cylinder about axis 1",
        "keep-out cylinder",
        "keep-out cylinder: ",
        "has its {point} {amount} beyond the keep-out cylinder about axis 1",
    ),
    facts(
        LimitKind::WristHeight,
        OnTheWay::NoWorse,
        "the lowest height of the wrist centre",
        "lowest height of the wrist",
        "lowest height: ",
        "has its {point} {amount} beyond the lowest height of the wrist centre",
    ),
    Facts {
        depends_on: DependsOn::Load,
        ..facts(
            LimitKind::RopeLength,
            OnTheWay::NoWorse,
            "the length of rope or cylinder",
            "length of the rope",
            "length of ",
            "has its {point} {amount} beyond the {point}'s length",
        )
    },
    facts(
        LimitKind::Shapes,
        OnTheWay::KeepsOff,
        "the distance between shapes",
        "shapes",
        "",
        "has {amount} too little room between {point}",
    ),
    Facts {
        depends_on: DependsOn::Load,
        ..facts(
            LimitKind::RopeClearance,
            OnTheWay::KeepsOff,
            "the distance between rope or cylinder and shapes",
            "rope",
            "",
            "has {amount} too little room between {point}",
        )
    },
    Facts {
        unit: MarginUnit::Angle,
        depends_on: DependsOn::Load,
        ..facts(
            LimitKind::RopeCone,
            OnTheWay::KeepsOff,
            "the cone of the rope's or cylinder's loading device",
            "cone of the rope",
            "cone of the rope: ",
            "turns the {point} {amount} beyond its loading device's cone",
        )
    },
    Facts {
        unit: MarginUnit::Angle,
        depends_on: DependsOn::Sight,
        ..facts(
            LimitKind::Incidence,
            OnTheWay::KeepsOff,
            "the reflectors' acceptance angle",
            "acceptance angle",
            "acceptance angle: ",
            "turns {point} {amount} beyond its acceptance angle",
        )
    },
    Facts {
        depends_on: DependsOn::Sight,
        ..facts(
            LimitKind::Sight,
            OnTheWay::KeepsOff,
            "the tracker's line of sight",
            "line of sight",
            "line of sight: ",
            "hides {point}: a shape reaches {amount} too far into its beam",
        )
    },
    Facts {
        unit: MarginUnit::Share,
        depends_on: DependsOn::Load,
        ..facts(
            LimitKind::Torque,
            OnTheWay::KeepsOff,
            "the joints' torque",
            "torque",
            "torque: ",
            "loads {point} {amount} beyond its largest torque",
        )
    },
    Facts {
        unit: MarginUnit::Displacement,
        depends_on: DependsOn::Load,
        ..facts(
            LimitKind::SmallestDisplacement,
            OnTheWay::KeepsOff,
            "the smallest displacement under the load",
            "smallest displacement",
            "smallest displacement: ",
            "moves its {point} {amount} too little under the load",
        )
    },
    Facts {
        unit: MarginUnit::Displacement,
        depends_on: DependsOn::Load,
        ..facts(
            LimitKind::LargestDisplacement,
            OnTheWay::KeepsOff,
            "the largest displacement under the load",
            "largest displacement",
            "largest displacement: ",
            "moves its {point} {amount} too far under the load",
        )
    },
];

impl LimitKind {
    /// All of them.
    pub const ALL: [LimitKind; FACTS.len()] = {
        let mut all = [LimitKind::ToolBox; FACTS.len()];
        let mut i = 0;
        while i < FACTS.len() {
            all[i] = FACTS[i].kind;
            // Its row is found by its place.
            assert!(all[i] as usize == i);
            i += 1;
        }
        all
    };

    fn facts(self) -> &'static Facts {
        &FACTS[self as usize]
    }

    /// Words for a message.
    pub fn describe(self) -> &'static str {
        self.facts().describe
    }

    /// Few words for a list or the heading of a column.
    pub fn short(self) -> &'static str {
        self.facts().short
    }

    /// What stands before what a margin is about, in a narrow column.
    pub fn in_column(self) -> &'static str {
        self.facts().column
    }

    /// True where the margins depend on the load.
    pub fn is_of_load(self) -> bool {
        self.facts().depends_on == DependsOn::Load
    }

    /// True where the margins depend on where the arm is alone: neither on the load nor on what the
    /// tracker sees.
    pub fn is_of_place(self) -> bool {
        self.facts().depends_on == DependsOn::Place
    }

    /// Whether it keeps the arm off something, on the way as well.
    pub(crate) fn keeps_off(self) -> bool {
        self.facts().on_the_way == OnTheWay::KeepsOff
    }

    /// What its margins are measured in.
    pub fn unit(self) -> MarginUnit {
        self.facts().unit
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
        let said = self.kind.facts().violation;
        let said = said.replace("{amount}", &amount).replace("{point}", &self.point);
        match &self.load {
            Some(load) => format!("{said} (load case {load})"),
            None => said,
        }
    }

    /// The margin itself in words: `12 mm`, `3.1°`, `4 %`, `0.125 mm` of a displacement.
    pub fn words(&self) -> String {
        // A limit that is met to rounding has no negative room.
        self.amount(if self.is_violated() { self.margin } else { self.margin.max(0.0) })
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
