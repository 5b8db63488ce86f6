//! Which things of a posture a limit is violated at, and the sentences about it.

use stiffarm::model::cell::{Cell, LimitKind, LimitMargin, MarginUnit};

/// Most sentences below a picture.
const MOST: usize = 4;

/// What is drawn in red.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Cautions {
    /// Parts of the scene, by number.
    pub parts: Vec<bool>,
    /// Joints whose torque is too large, by number.
    pub joints: Vec<bool>,
    /// Measuring points, by number.
    pub measuring: Vec<bool>,
    pub loading_point: bool,
    pub flange: bool,
    pub wrist: bool,
    pub rope: bool,
    /// Beams of the station that sees most.
    pub beams: bool,
    kinds: Vec<LimitKind>,
}

impl Cautions {
    /// What these margins violate.
    pub(crate) fn of(cell: &Cell, margins: &[LimitMargin]) -> Self {
        let setup = &cell.setup;
        let mut cautions = Cautions {
            parts: vec![false; cell.scene.parts().len()],
            joints: vec![false; setup.robot.joint_count()],
            measuring: vec![false; setup.tool.point_count()],
            ..Cautions::default()
        };
        for margin in margins.iter().filter(|m| m.is_violated()) {
            cautions.kinds.push(margin.kind);
            cautions.add(cell, margin);
        }
        cautions
    }

    /// True where a limit of this kind is violated.
    pub(crate) fn has(&self, kind: LimitKind) -> bool {
        self.kinds.contains(&kind)
    }

    fn add(&mut self, cell: &Cell, margin: &LimitMargin) {
        let subject = margin.point.as_str();
        match margin.kind {
            LimitKind::Shapes => {
                let mut pairs = cell.scene.pairs();
                let pair = pairs.find(|(a, b)| format!("{a} and {b}") == subject);
                if let Some((a, b)) = pair {
                    self.part(cell, a);
                    self.part(cell, b);
                }
            }
            LimitKind::RopeClearance => {
                self.rope = true;
                let part = subject.split_once(" and ").map(|(_line, part)| part);
                self.part(cell, part.unwrap_or(subject));
            }
            LimitKind::RopeCone | LimitKind::RopeLength => self.rope = true,
            LimitKind::Sight | LimitKind::Incidence => {
                self.beams = true;
                self.place(cell, subject);
            }
            LimitKind::Torque => {
                let joints = cell.setup.robot.joints().iter();
                for (joint, red) in joints.zip(&mut self.joints) {
                    *red |= joint.name == subject;
                }
            }
            LimitKind::SmallestDisplacement | LimitKind::LargestDisplacement => {
                self.measuring.fill(true);
            }
            _ => self.place(cell, subject),
        }
    }

    fn part(&mut self, cell: &Cell, name: &str) {
        let parts = cell.scene.parts().iter();
        for (part, red) in parts.zip(&mut self.parts) {
            *red |= part.name == name;
        }
    }

    fn place(&mut self, cell: &Cell, subject: &str) {
        match subject {
            "loading point" => self.loading_point = true,
            "flange" => self.flange = true,
            "wrist centre" => self.wrist = true,
            other => {
                let name = other.strip_prefix("measuring point ").unwrap_or(other);
                let points = cell.setup.tool.measuring_points.iter();
                for (point, red) in points.zip(&mut self.measuring) {
                    *red |= point.name == name;
                }
            }
        }
    }
}

/// A sentence for each violated limit, the first few of them.
pub(crate) fn sentences(subject: &str, margins: &[LimitMargin]) -> Vec<String> {
    let violated: Vec<&LimitMargin> = margins.iter().filter(|m| m.is_violated()).collect();
    let shown = match violated.len() {
        count if count > MOST => MOST - 1,
        count => count,
    };
    let told = violated[..shown].iter();
    let mut sentences: Vec<String> = told.map(|margin| format!("{subject} {}.", margin.violation())).collect();
    if shown < violated.len() {
        let rest = violated.len() - shown;
        sentences.push(format!("It violates {rest} other limits, too."));
    }
    sentences
}

/// How much room the limits leave, in each unit: `34 mm at the floor (flange)`; `None` without limits.
pub(crate) fn least_room(margins: &[LimitMargin]) -> Option<String> {
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
