//! Where moves go, and what they take with them.

use super::MoveKind;
use super::cursor::{Cursor, Number};
use std::sync::Arc;
use stiffarm::error::Result;
use stiffarm::findings::Severity;

/// A point that stands in several lines.
pub struct OpenPoint<'a> {
    pub label: String,
    /// Where it begins.
    pub place: Cursor<'a>,
    /// Angles found so far \[rad\].
    pub values: Vec<Option<f64>>,
    /// Numbers of a pose found so far.
    pub pose: [Option<Number>; 7],
    /// External axes found so far.
    pub external: Vec<External<'a>>,
    /// Number of the group of axes that is read.
    pub group: u32,
}

/// An axis that carries the robot or the workpiece, in the program's own unit.
#[derive(Debug, Clone)]
pub struct External<'a> {
    pub name: String,
    pub value: f64,
    pub place: Cursor<'a>,
}

/// A tool or a base that moves take.
#[derive(Debug, Clone)]
pub struct ActiveFrame<'a> {
    pub name: String,
    pub line: usize,
    /// Its frame as it is then, where the program says it: the product of these.
    pub factors: Vec<Pose<'a>>,
}

/// A tool (0) and a base (1).
pub type Frames<'a> = [Option<Arc<ActiveFrame<'a>>>; 2];

/// A pose as it stands in a program: x, y, z and the numbers of the orientation, in its units.
#[derive(Debug, Clone, Default)]
pub struct Pose<'a> {
    /// In the order of the language; `None` where it is not said.
    pub numbers: [Option<Number>; 7],
    /// Which file.
    pub file: u32,
    /// Byte position behind its last number.
    pub end: u32,
    pub line: usize,
    pub external: Vec<External<'a>>,
    /// Frames of its own, which it takes before those of the move.
    pub frames: Frames<'a>,
}

/// Where a move goes.
#[derive(Debug, Clone)]
pub enum MoveTarget<'a> {
    /// Joint angles in the cell's order \[rad\], and axes that are none of the cell's.
    Angles(Vec<f64>, Vec<External<'a>>),
    Pose(Box<Pose<'a>>),
    /// A point that stands elsewhere.
    Label(Cursor<'a>, String),
    /// A point that no move may go to: where it stands, and why.
    Unset(Cursor<'a>, String),
}

/// How a move goes there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    Joint,
    Linear,
    /// An arc; the move before the last one is its point on the way.
    Circular,
}

/// A move as it was read.
pub struct ProgramMove<'a> {
    /// Where the word stands that moves.
    pub place: Cursor<'a>,
    pub motion: Motion,
    /// Of an arc the point on the way.
    pub via: Option<Box<MoveTarget<'a>>>,
    pub target: MoveTarget<'a>,
    /// Name of the procedure that it stands in.
    pub feature: Option<Arc<str>>,
    /// Feed \[m/s\], where the program states it.
    pub feed: Option<f64>,
    /// What the program has set before it.
    pub frames: Frames<'a>,
    pub(super) speed: u8,
    pub(super) marked: Option<(MoveKind, String)>,
}

/// What is to be said of a program, once for all its lines of the same kind and word.
pub struct Remark {
    pub code: &'static str,
    pub word: String,
    pub line: usize,
    pub severity: Severity,
    /// `{}` stands for the lines.
    pub sentence: String,
}

impl Pose<'_> {
    /// Its numbers alone.
    pub fn values(&self) -> [Option<f64>; 7] {
        self.numbers.map(|number| number.map(|number| number.value))
    }
}

impl ActiveFrame<'_> {
    /// Whether both are one frame: the same name, which means the same.
    pub fn is_same(&self, other: &ActiveFrame<'_>) -> bool {
        let values = |taken: &ActiveFrame<'_>| -> Vec<_> { taken.factors.iter().map(Pose::values).collect() };
        self.name.eq_ignore_ascii_case(&other.name) && values(self) == values(other)
    }
}

impl<'a> Cursor<'a> {
    /// The variable that the line sets, in capital letters, and whether it sets all of it: `w.uframe := …`,
    /// `BASE_DATA[3] = …`, `P1[2] = …`. An index belongs to the name.
    pub fn assigned(&self) -> Option<(String, bool)> {
        let mut line = self.clone();
        let mut name = line.identifier().ok()?.to_ascii_uppercase();
        if line.passes("[") {
            let (index, _) = line.rest().split_once(']')?;
            name += &format!("[{}]", index.trim());
            line.skip(index.len() + 1);
        }
        let part = line.passes(".");
        while part && line.identifier().is_ok() && line.passes(".") {}
        let is_set = line.passes(":=") || line.passes("=") && !line.rest().starts_with('=');
        is_set.then_some((name, !part))
    }

    /// Passes the word of a move, one of `words`.
    pub fn motion(&mut self, words: &[(&str, Motion)]) -> Option<Motion> {
        let mut words = words.iter().filter(|(word, _)| self.word(word));
        words.next().map(|(_, motion)| *motion)
    }

    /// The name of a point, which is stated and not calculated.
    pub fn label(&mut self) -> Result<MoveTarget<'a>> {
        let mut place = self.clone();
        let label = self.identifier()?.to_string();
        if self.clone().passes("(") || self.clone().passes("{") {
            Err(place.wrong_here(format!("`{label}` is calculated by the program: only stated positions are read.")))
        } else {
            Ok(MoveTarget::Label(place, label))
        }
    }
}
