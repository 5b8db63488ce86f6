//! What the lines of a program have said so far.

use super::cursor::Cursor;
use super::{Move, MoveKind, Program, ProgramFile, ProgramOptions, Step, text};
use crate::error::{Code, Error, Result};
use std::collections::HashMap;

/// Part of a file that has parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Section {
    Head,
    Body,
    Points,
}

/// A point that stands in several lines: its label, where it begins, the angles found so far \[rad\].
type OpenPoint<'a> = (String, Cursor<'a>, Vec<Option<f64>>);

/// What has been read so far.
pub struct Reader<'a> {
    pub options: &'a ProgramOptions,
    /// Joints of the robot.
    pub joints: usize,
    /// Speed of the moves that come, in per cent.
    pub speed: u8,
    pub section: Section,
    pub open: Option<OpenPoint<'a>>,
    /// What an axis of the controller is called.
    axis_name: fn(usize) -> String,
    name: String,
    /// By their labels in capital letters.
    points: HashMap<String, Vec<f64>>,
    steps: Vec<Step>,
    /// Moves to points by label: the step, where it stands and the label.
    labelled: Vec<(usize, Cursor<'a>, String)>,
    moves: usize,
    /// Kind and name of the next move.
    next: Option<(MoveKind, String)>,
    /// What has been said since the last step.
    said: Vec<String>,
}

/// The one file of most languages.
pub fn only<'a>(files: &'a [ProgramFile], title: &str) -> Result<&'a ProgramFile> {
    match files {
        [file] => Ok(file),
        _ => {
            let message = format!("A program in {title} is one file, got {}.", files.len());
            Err(Error::new(Code::Usage, message))
        }
    }
}

impl<'a> Reader<'a> {
    /// Nothing has been read.
    pub fn new(options: &'a ProgramOptions, joints: usize, axis_name: fn(usize) -> String) -> Self {
        Reader {
            options,
            joints,
            speed: 100,
            section: Section::Head,
            open: None,
            axis_name,
            name: String::new(),
            points: HashMap::new(),
            steps: Vec::new(),
            labelled: Vec::new(),
            moves: 0,
            next: None,
            said: Vec::new(),
        }
    }

    /// The program's name; the first counts.
    pub fn named(&mut self, name: &str) {
        if self.name.is_empty() {
            self.name = name.to_string();
        }
    }

    /// A comment: it may name the next move.
    pub fn comment(&mut self, comment: &str) {
        if let Some(marked) = text::marked(comment) {
            self.next = Some(marked);
        }
    }

    /// A line of a message.
    pub fn say(&mut self, line: &str) {
        self.said.push(line.to_string());
    }

    /// Whether something has been said since the last step.
    pub fn has_said(&self) -> bool {
        !self.said.is_empty()
    }

    /// The program waits for somebody.
    pub fn wait(&mut self) {
        let text = std::mem::take(&mut self.said).join(" ");
        self.steps.push(Step::Wait(text));
    }

    /// A move. Without a comment before it, it has a number for a name.
    pub fn go(&mut self, q: Vec<f64>) {
        self.moves += 1;
        let unnamed = || (MoveKind::Posture, format!("move {}", self.moves));
        let (kind, name) = self.next.take().unwrap_or_else(unnamed);
        self.steps.push(Step::Move(Move {
            name,
            kind,
            q,
            speed_percent: self.speed,
        }));
    }

    /// A move to a point, which may stand further below.
    pub fn go_to(&mut self, place: Cursor<'a>, label: &str) {
        self.labelled
            .push((self.steps.len(), place, label.to_string()));
        self.go(Vec::new());
    }

    /// A point.
    pub fn point(&mut self, label: &str, q: Vec<f64>) {
        self.points.insert(label.to_ascii_uppercase(), q);
    }

    /// Angles in the order of the cell's joints, if all are there; else the name of the first that is not.
    pub fn complete(&self, values: &[Option<f64>]) -> std::result::Result<Vec<f64>, String> {
        match values.iter().position(Option::is_none) {
            Some(axis) => Err((self.axis_name)(axis)),
            None => {
                let values: Vec<f64> = values.iter().copied().flatten().collect();
                Ok(self.options.to_cell(&values))
            }
        }
    }

    /// The program, where all its points are there; `missing` says what is not.
    pub fn program(mut self, missing: &str) -> Result<Program> {
        if let Some((label, place, _)) = &self.open {
            return Err(place.wrong(format!("The `}}` that ends {label} is missing.")));
        }
        for (step, mut place, label) in self.labelled {
            let Some(q) = self.points.get(&label.to_ascii_uppercase()) else {
                return Err(place.wrong_here(format!("{missing} {label}.")));
            };
            if let Step::Move(target) = &mut self.steps[step] {
                target.q.clone_from(q);
            }
        }
        Ok(Program {
            name: self.name,
            header: Vec::new(),
            steps: self.steps,
        })
    }
}
