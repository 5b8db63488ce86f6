//! A program out of the files of a language: lines that are looked for, one after the other.

use super::cursor::{Cursor, lines};
use super::dialect::{Dialect, Syntax};
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
    dialect: &'static Dialect,
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

/// Reads a program of `joints` joints.
pub fn read(
    files: &[ProgramFile],
    dialect: &'static Dialect,
    syntax: &Syntax,
    options: &ProgramOptions,
    joints: usize,
) -> Result<Program> {
    let mut reader = Reader {
        options,
        joints,
        speed: 100,
        section: Section::Head,
        open: None,
        dialect,
        name: String::new(),
        points: HashMap::new(),
        steps: Vec::new(),
        labelled: Vec::new(),
        moves: 0,
        next: None,
        said: Vec::new(),
    };
    for file in in_order(files, dialect, syntax)? {
        for mut line in lines(file) {
            if (syntax.read)(&mut line, &mut reader)? {
                continue;
            }
            let mut others = syntax.other_moves.iter();
            if let Some(word) = others.find(|word| line.clone().word(word)) {
                let joint_move = syntax.joint_move;
                let message = format!("{word} is no move to joint angles ({joint_move}).");
                return Err(line.wrong_here(message));
            }
        }
    }
    reader.program(syntax)
}

/// The files in the order of the language.
fn in_order<'a>(
    files: &'a [ProgramFile],
    dialect: &Dialect,
    syntax: &Syntax,
) -> Result<Vec<&'a ProgramFile>> {
    let title = dialect.title;
    if syntax.files.len() == 1 {
        return Ok(vec![only(files, title)?]);
    }
    let extensions = syntax
        .files
        .iter()
        .map(|(extension, _)| format!(".{extension}"));
    let extensions: Vec<String> = extensions.collect();
    let of = |extension: &String| {
        let mut files = files.iter();
        let found = files.find(|file| file.name.to_ascii_lowercase().ends_with(extension));
        found.ok_or_else(|| {
            let parts = extensions.join(" and a ");
            let message = format!("A program in {title} is a {parts}; there is no {extension}.");
            Error::new(Code::Usage, message).hint("give all its files")
        })
    };
    extensions.iter().map(of).collect()
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
            Some(axis) => Err((self.dialect.axis_name)(axis)),
            None => {
                let values: Vec<f64> = values.iter().copied().flatten().collect();
                Ok(self.options.to_cell(&values))
            }
        }
    }

    fn program(mut self, syntax: &Syntax) -> Result<Program> {
        if let Some((label, place, _)) = &self.open {
            return Err(place.wrong(format!("The `}}` that ends {label} is missing.")));
        }
        for (step, mut place, label) in self.labelled {
            let Some(q) = self.points.get(&label.to_ascii_uppercase()) else {
                let missing = syntax.missing_point;
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
