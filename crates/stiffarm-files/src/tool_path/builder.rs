//! Points of a tool path as a program's lines give them.

use super::{Divided, Form, NEAR_END, Orientation, SPAN, Slot};
use crate::names::harmless;
use crate::program::Number;
use nalgebra::{Isometry3, UnitVector3, Vector3};
use std::collections::BTreeMap;
use std::sync::Arc;
use stiffarm::findings::{Finding, Severity, length};
use stiffarm::model::cell::Cell;
use stiffarm::model::path::{FASTEST, PathPoint, PathTarget};
use stiffarm::model::process::{ForceAxes, TipLoad};
use stiffarm::units::rad_to_deg;

/// A program's frame this far from the cell's is another \[m\], \[rad\].
const OTHER_FRAME: [f64; 2] = [1e-3, 0.002];

/// Where the tip should be, in the frame of the program, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum TipTarget {
    /// The tip frame.
    Pose(Isometry3<f64>),
    /// Position, and direction from the tip to the spindle.
    Axis(Vector3<f64>, UnitVector3<f64>),
}

impl TipTarget {
    pub fn position(&self) -> Vector3<f64> {
        match self {
            TipTarget::Pose(pose) => pose.translation.vector,
            TipTarget::Axis(position, _) => *position,
        }
    }

    /// The same orientation elsewhere.
    pub fn at(&self, position: Vector3<f64>) -> TipTarget {
        match self {
            TipTarget::Pose(pose) => TipTarget::Pose(Isometry3::from_parts(position.into(), pose.rotation)),
            TipTarget::Axis(_, axis) => TipTarget::Axis(position, *axis),
        }
    }

    /// The orientation on the way to that of `other`, which stands at `position`.
    pub fn towards(&self, other: &TipTarget, share: f64, position: Vector3<f64>) -> TipTarget {
        match (self, other) {
            (TipTarget::Pose(from), TipTarget::Pose(to)) => {
                let rotation = from.rotation.try_slerp(&to.rotation, share, 1e-9);
                let rotation = rotation.unwrap_or(to.rotation);
                TipTarget::Pose(Isometry3::from_parts(position.into(), rotation))
            }
            (TipTarget::Axis(_, from), TipTarget::Axis(_, to)) => TipTarget::Axis(position, from.slerp(to, share)),
            _ => other.at(position),
        }
    }
}

/// What is said once of all lines of a kind.
struct Remark {
    severity: Severity,
    line: usize,
    count: usize,
    /// `{}` stands for the lines.
    sentence: String,
}

/// A feed as a program states it.
#[derive(Clone, Copy)]
pub(super) enum Feed {
    /// For a second \[m\].
    Second(f64),
    /// For a turn of the spindle \[m\].
    Turn(f64),
}

/// What has been read so far.
pub(super) struct Builder<'c> {
    pub cell: &'c Cell,
    pub form: Form,
    pub points: Vec<PathPoint>,
    pub slots: Vec<Slot>,
    pub values: Vec<f64>,
    pub ends: Vec<usize>,
    pub divided: Vec<Divided>,
    pub fixed: Option<(usize, &'static str)>,
    /// Name of the feature that the points belong to.
    pub feature: Option<Arc<str>>,
    /// Feed of the points; what is none is no point's.
    pub feed: Option<Feed>,
    /// Turns of the spindle \[1/s\].
    pub spindle: Option<f64>,
    remarks: BTreeMap<(&'static str, String), Remark>,
    frames: Vec<Finding>,
}

impl<'c> Builder<'c> {
    pub fn new(cell: &'c Cell) -> Self {
        Builder {
            cell,
            form: Form {
                orientation: Orientation::Kept,
                unit: 1e-3,
                before: &[],
                decimals: [4, 8],
                frame: cell.work.workpiece,
            },
            points: Vec::new(),
            slots: Vec::new(),
            values: Vec::new(),
            ends: Vec::new(),
            divided: Vec::new(),
            fixed: None,
            feature: None,
            feed: None,
            spindle: None,
            remarks: BTreeMap::new(),
            frames: Vec::new(),
        }
    }

    /// The program is in inches or in millimetres; false where that changes behind its first point.
    pub fn measures(&mut self, in_inches: bool) -> bool {
        let (unit, decimals) = if in_inches { (25.4e-3, 6) } else { (1e-3, 4) };
        if unit != self.form.unit && !self.points.is_empty() {
            return false;
        }
        self.form.unit = unit;
        self.form.decimals[0] = decimals;
        true
    }

    /// The points that follow belong to the feature of this name in `line`, if it is one.
    pub fn named(&mut self, name: &str, line: usize) {
        let name = name.trim();
        let other = harmless(name);
        if other.is_some() {
            self.remark("feature-name", "", line, Severity::Note, || {
                "Some names ({}) are changed to what a table can hold as text.".to_string()
            });
        }
        let name = other.as_deref().unwrap_or(name);
        if !name.is_empty() {
            self.feature = Some(name.into());
        }
    }

    /// A point in `line`. A rapid one carries no load, and how the arm gets there is the machine's.
    pub fn point(&mut self, line: usize, place: &TipTarget, rapid: bool) {
        let frame = &self.form.frame;
        let target = match place {
            TipTarget::Pose(pose) => PathTarget::Pose(frame * pose),
            TipTarget::Axis(position, axis) => PathTarget::Axis {
                position: frame.rotation * position + frame.translation.vector,
                axis: frame.rotation * -*axis,
            },
        };
        let feed = match self.feed {
            Some(Feed::Second(feed)) => Some(feed),
            Some(Feed::Turn(feed)) => self.spindle.map(|turns| feed * turns),
            None => None,
        };
        self.points.push(PathPoint {
            name: (self.points.len() + 1).to_string().into(),
            line: Some(line),
            target,
            load: rapid.then_some(TipLoad { force: Vector3::zeros(), moment: Vector3::zeros(), axes: ForceAxes::Base }),
            feature: self.feature.clone(),
            feed: feed.filter(|feed| !rapid && *feed > 0.0 && *feed <= FASTEST),
            rapid,
        });
        self.ends.push(self.slots.len());
    }

    /// Points on the straight way to a point in `line` that is far away; true where there are any.
    pub fn between(&mut self, line: usize, from: &TipTarget, to: &TipTarget) -> bool {
        let (start, way) = (from.position(), to.position() - from.position());
        let length = way.norm();
        if length < 4.0 * NEAR_END {
            return false;
        }
        // What comes from a rapid move is in the air at first, and its load is not that of its end.
        let is_cutting = self.points.last().is_some_and(|point| !point.rapid);
        let near = is_cutting.then_some(NEAR_END / length);
        let parts = (length / SPAN).ceil() as usize;
        if near.is_none() && parts < 2 {
            return false;
        }
        let inner = (1..parts).map(|k| k as f64 / parts as f64);
        let ends = near.map(|near| 1.0 - near);
        for share in near.into_iter().chain(inner).chain(ends) {
            let place = from.towards(to, share, start + way * share);
            self.point(line, &place, false);
        }
        true
    }

    /// A number of the point that was given last; one of length 0 stays what it was before.
    pub fn number(&mut self, file: u32, component: usize, number: Number) {
        self.numeral(file, component, number, number.length == 0);
    }

    /// The same; where it is not `modal` and left out it is the value of `number`.
    pub fn numeral(&mut self, file: u32, component: usize, number: Number, modal: bool) {
        self.slots.push(Slot {
            at: number.at,
            length: number.length as u16,
            file: file as u8,
            component: component as u8,
            modal,
        });
        self.values.push(number.value);
        if let Some(end) = self.ends.last_mut() {
            *end = self.slots.len();
        }
    }

    /// Says what the lines with `word` leave open. In `sentence`, `{}` stands for the lines.
    pub fn remark(
        &mut self,
        code: &'static str,
        word: &str,
        line: usize,
        severity: Severity,
        sentence: impl FnOnce() -> String,
    ) {
        let remark = self.remarks.entry((code, word.to_string()));
        let remark = remark.or_insert_with(|| Remark { severity, line, count: 0, sentence: sentence() });
        remark.count += 1;
    }

    /// A word of the program that is not followed.
    pub fn not_followed(&mut self, word: &str, line: usize, severity: Severity) {
        self.remark("not-followed", word, line, severity, || format!("{word} ({{}}) is not followed here."));
    }

    /// Holds a frame that the program gives against that of the cell.
    pub fn frame(&mut self, what: &str, counterpart: &str, program_frame: &Isometry3<f64>, cell: &Isometry3<f64>) {
        let off = cell.inverse() * program_frame;
        let (distance, angle) = (off.translation.vector.norm(), off.rotation.angle());
        if distance <= OTHER_FRAME[0] && angle <= OTHER_FRAME[1] {
            return;
        }
        let sentence = format!(
            "{what} of the program lies {} and {:.2}° from {counterpart}: the robot goes elsewhere than the cell says.",
            length(distance),
            rad_to_deg(angle)
        );
        self.frames.push(Finding::serious("program-frame", "work", sentence));
    }

    /// All that is to be known, what matters most first.
    pub fn findings(&mut self) -> Vec<Finding> {
        let remarks = std::mem::take(&mut self.remarks).into_iter();
        let remarks = remarks.map(|((code, _), remark)| {
            let lines = match remark.count {
                1 => format!("line {}", remark.line),
                count => format!("line {} and {} more", remark.line, count - 1),
            };
            let sentence = remark.sentence.replace("{}", &lines);
            Finding::new(code, remark.severity, "path", sentence)
        });
        let mut all: Vec<Finding> = self.frames.drain(..).chain(remarks).collect();
        all.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
        all
    }
}
