//! What the limits say of a posture: how much room there is, what is violated and where.

use super::data::ScenePosture;
use stiffarm::model::cell::LimitKind::{
    Floor, Incidence, KeepOut, LargestDisplacement, RopeClearance, RopeCone, RopeLength, Shapes, Sight,
    SmallestDisplacement, ToolBox, WristHeight,
};
use stiffarm::model::cell::{Cell, LimitKind, LimitMargin, MarginUnit};

/// Most sentences about a posture.
const MOST: usize = 4;
/// Limits on the line between loading point and anchor.
pub(crate) const ROPE: [LimitKind; 3] = [RopeClearance, RopeCone, RopeLength];
/// Limits on the beams of the station that sees most.
pub(crate) const BEAMS: [LimitKind; 2] = [Sight, Incidence];
/// Limits on all measuring points together.
pub(crate) const DISPLACEMENT: [LimitKind; 2] = [SmallestDisplacement, LargestDisplacement];
/// Limits on single places.
pub(crate) const PLACES: [LimitKind; 6] = [ToolBox, Floor, KeepOut, WristHeight, Sight, Incidence];

impl ScenePosture {
    /// True where a limit is violated.
    pub(crate) fn is_outside(&self) -> bool {
        violations(&self.margins).next().is_some()
    }

    /// True where a limit of these kinds is violated.
    pub(crate) fn violates(&self, kinds: &[LimitKind]) -> bool {
        violations(&self.margins).any(|margin| kinds.contains(&margin.kind))
    }

    /// True where a limit of these kinds is violated at this place or joint.
    pub(crate) fn violates_at(&self, kinds: &[LimitKind], place: &str) -> bool {
        violations(&self.margins).any(|margin| kinds.contains(&margin.kind) && margin.point == place)
    }

    /// The smallest margin, whatever its unit.
    pub(crate) fn least(&self) -> f64 {
        self.margins.iter().map(|margin| margin.margin).fold(f64::INFINITY, f64::min)
    }
}

fn violations(margins: &[LimitMargin]) -> impl Iterator<Item = &LimitMargin> {
    margins.iter().filter(|margin| margin.is_violated())
}

/// Numbers of the cell's parts that a limit is violated at.
pub(super) fn violated_parts(cell: &Cell, margins: &[LimitMargin]) -> Vec<usize> {
    let mut names: Vec<&str> = Vec::new();
    for margin in violations(margins) {
        let subject = margin.point.as_str();
        if margin.kind == Shapes {
            // A name may have an "and" of its own.
            let pair = cell.scene.pairs().find(|(a, b)| format!("{a} and {b}") == subject);
            names.extend(pair.into_iter().flat_map(|(a, b)| [a, b]));
        } else if margin.kind == RopeClearance {
            names.push(subject.split_once(" and ").map_or(subject, |(_line, part)| part));
        }
    }
    let parts = cell.scene.parts().iter().enumerate();
    parts.filter(|(_, part)| names.contains(&part.name.as_str())).map(|(number, _)| number).collect()
}

/// A sentence for each violated limit, the first few of them.
pub(crate) fn sentences(subject: &str, margins: &[LimitMargin]) -> Vec<String> {
    let violated = violations(margins).count();
    let shown = if violated > MOST { MOST - 1 } else { violated };
    let mut sentences: Vec<String> =
        violations(margins).take(shown).map(|margin| format!("{subject} {}.", margin.violation())).collect();
    if shown < violated {
        sentences.push(format!("It violates {} other limits, too.", violated - shown));
    }
    sentences
}

/// How much room the limits leave, in each unit: `34 mm at the floor (flange)`; `None` without limits.
pub(super) fn least_room(margins: &[LimitMargin]) -> Option<String> {
    let units = [MarginUnit::Length, MarginUnit::Angle, MarginUnit::Share, MarginUnit::Displacement];
    let rooms: Vec<String> = units
        .iter()
        .filter_map(|unit| {
            let of_unit = margins.iter().filter(|m| m.kind.unit() == *unit);
            let least = of_unit.filter(|m| m.margin.is_finite()).min_by(|a, b| a.margin.total_cmp(&b.margin))?;
            Some(format!("{} at {} ({})", least.words(), least.kind.describe(), least.point))
        })
        .collect();
    (!rooms.is_empty()).then(|| rooms.join(", "))
}
