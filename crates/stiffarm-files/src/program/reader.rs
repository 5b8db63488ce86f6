//! What the lines of a program have said so far.

use super::cursor::{Cursor, Number};
use super::{Move, MoveKind, Program, ProgramFile, ProgramOptions, Step, text};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;
use stiffarm::error::{Code, Error, Result};

/// Part of a file that has parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Section {
    Head,
    Body,
    Points,
}

impl<'a> Cursor<'a> {
    /// The variable that the line sets, as a whole or in part.
    pub fn assigned(&self) -> Option<&'a str> {
        let mut line = self.clone();
        let name = line.identifier().ok()?;
        (line.passes(".") || line.passes("=") || line.passes(":=")).then_some(name)
    }

    /// Whether the line sets a whole variable.
    pub fn assigns_whole(&self) -> bool {
        let mut line = self.clone();
        line.identifier().is_ok() && line.passes("=")
    }

    /// Passes the word of a move, one of `words`.
    pub fn motion(&mut self, words: &[(&str, Motion)]) -> Option<Motion> {
        let mut words = words.iter().filter(|(word, _)| self.word(word));
        words.next().map(|(_, motion)| *motion)
    }

    /// The name of a point, which is stated and not calculated.
    pub fn label(&mut self) -> Result<Aim<'a>> {
        let mut place = self.clone();
        let label = self.identifier()?.to_string();
        if self.clone().passes("(") || self.clone().passes("{") {
            Err(place.wrong_here(format!(
                "`{label}` is calculated by the program: only stated positions are read."
            )))
        } else {
            Ok(Aim::Label(place, label))
        }
    }
}

/// A point that stands in several lines.
pub struct OpenPoint<'a> {
    pub label: String,
    /// Where it begins.
    pub place: Cursor<'a>,
    /// Angles found so far \[rad\].
    pub values: Vec<Option<f64>>,
    /// Numbers of a pose found so far.
    pub pose: [Option<Number>; 7],
    /// False within what it says of a second group of axes.
    pub is_first_group: bool,
}

/// A pose as it stands in a program: x, y, z and the numbers of the orientation, in its units.
#[derive(Debug, Clone, Default)]
pub struct Pose {
    /// In the order of the language; `None` where it is not said.
    pub numbers: [Option<Number>; 7],
    /// Which file.
    pub file: u32,
    /// Byte position behind its last number.
    pub end: u32,
    pub line: usize,
}

/// Where a move goes.
#[derive(Debug, Clone)]
pub enum Aim<'a> {
    /// Joint angles in the cell's order \[rad\].
    Angles(Vec<f64>),
    Pose(Box<Pose>),
    /// A point that stands elsewhere.
    Label(Cursor<'a>, String),
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
pub struct Leg<'a> {
    /// Where the word stands that moves.
    pub place: Cursor<'a>,
    pub motion: Motion,
    /// Of an arc the point on the way.
    pub via: Option<Box<Aim<'a>>>,
    pub aim: Aim<'a>,
    /// Name of the procedure that it stands in.
    pub feature: Option<Arc<str>>,
    /// Feed \[m/s\], where the program states it.
    pub feed: Option<f64>,
    speed: u8,
    marked: Option<(MoveKind, String)>,
}

enum Read<'a> {
    Wait(String),
    Leg(Leg<'a>),
}

/// What has been read so far.
pub struct Reader<'a> {
    pub options: &'a ProgramOptions,
    /// Joints of the robot.
    pub joints: usize,
    /// Whether moves are those of a tool path, which need not end at rest.
    pub is_path: bool,
    /// Speed of the moves that come, in per cent.
    pub speed: u8,
    /// Feed of the moves that come \[m/s\].
    pub feed: Option<f64>,
    /// Feeds that the program gives \[m/s\], by their names in capital letters.
    pub feeds: HashMap<String, f64>,
    pub section: Section,
    pub open: Option<OpenPoint<'a>>,
    /// An arc whose end is still to come: where its word stands, and its point on the way.
    pub arc: Option<(Cursor<'a>, Aim<'a>)>,
    /// Which file is read.
    pub file: u32,
    /// Frames that the program gives, by their names in capital letters.
    pub frames: HashMap<String, Box<Pose>>,
    /// Names of tools and of bases that moves name.
    pub used: [BTreeMap<String, usize>; 2],
    /// Name of the procedure that is read.
    pub feature: Option<Arc<str>>,
    /// Variables that the program sets, with the line.
    pub assigned: Vec<(usize, &'a str)>,
    /// Points that moves name, in capital letters.
    pub named_points: HashSet<String>,
    /// What is not followed, with the line.
    pub passed_over: Vec<(usize, &'a str)>,
    /// What an axis of the controller is called.
    axis_name: fn(usize) -> String,
    name: String,
    /// By their labels in capital letters.
    points: HashMap<String, Aim<'a>>,
    steps: Vec<Read<'a>>,
    /// Kind and name of the next move.
    next: Option<(MoveKind, String)>,
    /// What has been said since the last step.
    said: Vec<String>,
}

/// The number that a text begins with.
pub fn leading(text: &str) -> Option<f64> {
    let text = text.trim_start();
    let is_none = |c: char| !(c.is_ascii_digit() || matches!(c, '.' | '+' | '-' | 'e' | 'E'));
    let end = text.find(is_none).unwrap_or(text.len());
    // Behind a number may stand a sign or an e that is none of its own.
    (1..=end).rev().find_map(|end| text[..end].parse().ok())
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

impl Pose {
    /// Its numbers alone.
    pub fn values(&self) -> [Option<f64>; 7] {
        self.numbers.map(|number| number.map(|number| number.value))
    }
}

impl<'a> Reader<'a> {
    /// Nothing has been read.
    pub fn new(options: &'a ProgramOptions, joints: usize, axis_name: fn(usize) -> String) -> Self {
        Reader {
            options,
            joints,
            is_path: false,
            speed: 100,
            feed: None,
            feeds: HashMap::new(),
            section: Section::Head,
            open: None,
            arc: None,
            file: 0,
            frames: HashMap::new(),
            used: [BTreeMap::new(), BTreeMap::new()],
            feature: None,
            assigned: Vec::new(),
            named_points: HashSet::new(),
            passed_over: Vec::new(),
            axis_name,
            name: String::new(),
            points: HashMap::new(),
            steps: Vec::new(),
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
        self.steps.push(Read::Wait(text));
    }

    /// A joint move to the aim, whose word stands at `place`.
    pub fn go(&mut self, place: Cursor<'a>, aim: Aim<'a>) {
        self.moves(place, Motion::Joint, None, aim);
    }

    /// A move.
    pub fn moves(&mut self, place: Cursor<'a>, motion: Motion, via: Option<Aim<'a>>, aim: Aim<'a>) {
        self.steps.push(Read::Leg(Leg {
            place,
            motion,
            via: via.map(Box::new),
            aim,
            feature: self.feature.clone(),
            feed: self.feed,
            speed: self.speed,
            marked: self.next.take(),
        }));
    }

    /// The feed of the move given last \[m/s\].
    pub fn at_feed(&mut self, feed: Option<f64>) {
        if let Some(Read::Leg(leg)) = self.steps.last_mut() {
            leg.feed = feed;
        }
    }

    /// A move whose word has been read: to the aims that stand next.
    pub fn move_to(
        &mut self,
        line: &mut Cursor<'a>,
        motion: Motion,
        aim: fn(&mut Cursor<'a>, &Self) -> Result<Aim<'a>>,
    ) -> Result<()> {
        let place = line.clone();
        let via = if motion == Motion::Circular {
            let via = aim(line, self)?;
            line.expect(",")?;
            Some(via)
        } else {
            None
        };
        let aim = aim(line, self)?;
        self.moves(place, motion, via, aim);
        Ok(())
    }

    /// A move or a line takes the tool (0) or the base (1) of this name; the first line counts.
    pub fn uses(&mut self, number: usize, name: String, line: usize) {
        self.used[number].entry(name).or_insert(line);
    }

    /// A point.
    pub fn point(&mut self, label: &str, aim: Aim<'a>) {
        self.points.insert(label.to_ascii_uppercase(), aim);
    }

    /// Joint angles of the controller's axes.
    pub fn angles(&self, values: &[f64]) -> Aim<'a> {
        Aim::Angles(self.options.to_cell(values))
    }

    /// Angles in the order of the cell's joints, if all are there; else the name of the first that is not.
    pub fn complete(&self, values: &[Option<f64>]) -> std::result::Result<Aim<'a>, String> {
        match values.iter().position(Option::is_none) {
            Some(axis) => Err((self.axis_name)(axis)),
            None => {
                let values: Vec<f64> = values.iter().copied().flatten().collect();
                Ok(self.angles(&values))
            }
        }
    }

    /// The pose with these numbers, which ends at `line`'s place.
    pub fn pose(&self, numbers: [Option<Number>; 7], line: &Cursor<'_>) -> Box<Pose> {
        Box::new(Pose {
            numbers,
            file: self.file,
            end: line.position() as u32,
            line: line.line_number(),
        })
    }

    fn check_closed(&self) -> Result<()> {
        match &self.open {
            Some(OpenPoint { label, place, .. }) => {
                Err(place.wrong(format!("The `}}` that ends {label} is missing.")))
            }
            None => Ok(()),
        }
    }

    /// The program, where all its points are there; `missing` says what is not.
    pub fn program(self, missing: &str) -> Result<Program> {
        self.check_closed()?;
        let mut moves = 0;
        let steps = self.steps.into_iter().map(|step| {
            let mut leg = match step {
                Read::Wait(text) => return Ok(Step::Wait(text)),
                Read::Leg(leg) => leg,
            };
            let q = match leg.aim {
                Aim::Angles(q) => q,
                Aim::Pose(_) => {
                    return Err(leg.place.wrong_here("This goes to no joint position."));
                }
                Aim::Label(mut place, label) => {
                    match self.points.get(&label.to_ascii_uppercase()) {
                        Some(Aim::Angles(q)) => q.clone(),
                        _ => return Err(place.wrong_here(format!("{missing} {label}."))),
                    }
                }
            };
            moves += 1;
            // Without a comment before it, it has a number for a name.
            let unnamed = || (MoveKind::Posture, format!("move {moves}"));
            let (kind, name) = leg.marked.unwrap_or_else(unnamed);
            Ok(Step::Move(Move {
                name,
                kind,
                q,
                speed_percent: leg.speed,
            }))
        });
        Ok(Program {
            name: self.name,
            header: Vec::new(),
            steps: steps.collect::<Result<_>>()?,
        })
    }

    /// The moves of a tool path, points in place of their labels.
    pub fn legs(&mut self) -> Result<Vec<Leg<'a>>> {
        self.check_closed()?;
        let (points, named) = (&self.points, &mut self.named_points);
        let mut resolved = |aim: Aim<'a>, motion: Motion| match aim {
            Aim::Label(mut place, label) => match points.get(&label.to_ascii_uppercase()) {
                Some(aim) => {
                    named.insert(label.to_ascii_uppercase());
                    Ok(aim.clone())
                }
                // A position of the controller, as HOME: not of the path.
                None if motion == Motion::Joint => Ok(Aim::Angles(Vec::new())),
                None => Err(place.wrong_here(format!("The program has no point {label}."))),
            },
            aim => Ok(aim),
        };
        let legs = std::mem::take(&mut self.steps).into_iter();
        let legs = legs.filter_map(|step| match step {
            Read::Wait(_) => None,
            Read::Leg(leg) => Some(leg),
        });
        legs.map(|leg| {
            Ok(Leg {
                via: leg
                    .via
                    .map(|via| resolved(*via, leg.motion).map(Box::new))
                    .transpose()?,
                aim: resolved(leg.aim, leg.motion)?,
                ..leg
            })
        })
        .collect()
    }
}
