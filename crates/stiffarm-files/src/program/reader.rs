//! What the lines of a program have said so far.

use super::cursor::{Cursor, Number};
use super::move_target::{ActiveFrame, Frames, Motion, MoveTarget, OpenPoint, Pose, ProgramMove, Remark};
use super::{Move, MoveKind, Program, ProgramFile, ProgramOptions, Step, text};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::Severity;

/// Part of a file that has parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Section {
    Head,
    Body,
    Points,
}

enum ReadStatement<'a> {
    Wait(String),
    ProgramMove(Box<ProgramMove<'a>>),
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
    pub arc: Option<(Cursor<'a>, MoveTarget<'a>)>,
    /// How many points of an arc have been said, where each is a move of its own; 4 where the third begins another.
    pub arc_points: u8,
    /// Whether the positions that come are poses.
    pub has_poses: bool,
    /// Frames that the program gives, by their names in capital letters: products of these.
    pub frames: HashMap<String, Vec<Pose<'a>>>,
    /// Numbers of position registers that the program has set.
    pub registers: HashMap<String, [Option<Number>; 7]>,
    /// What says which tool and base an inline form takes (FDAT), by its name in capital letters.
    pub forms: HashMap<String, Cursor<'a>>,
    /// The tool and the base of the moves that come.
    pub taken: Frames<'a>,
    /// Name of the procedure that is read.
    pub feature: Option<Arc<str>>,
    /// Variables in capital letters that the program sets to what is not read, with the line.
    pub assigned: Vec<(usize, String)>,
    /// Points that moves name, in capital letters.
    pub named_points: HashSet<String>,
    /// What is to be said.
    pub remarks: Vec<Remark>,
    /// What an axis of the controller is called.
    axis_name: fn(usize) -> String,
    name: String,
    /// By their labels in capital letters.
    points: HashMap<String, MoveTarget<'a>>,
    steps: Vec<ReadStatement<'a>>,
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
            arc_points: 0,
            has_poses: false,
            frames: HashMap::new(),
            registers: HashMap::new(),
            forms: HashMap::new(),
            taken: [None, None],
            feature: None,
            assigned: Vec::new(),
            named_points: HashSet::new(),
            remarks: Vec::new(),
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
        self.steps.push(ReadStatement::Wait(text));
    }

    /// A joint move to the target, whose word stands at `place`.
    pub fn go(&mut self, place: Cursor<'a>, target: MoveTarget<'a>) {
        self.moves(place, Motion::Joint, None, target);
    }

    /// A move.
    pub fn moves(&mut self, place: Cursor<'a>, motion: Motion, via: Option<MoveTarget<'a>>, target: MoveTarget<'a>) {
        let (via, target) = (via.map(|via| self.as_current(via)), self.as_current(target));
        self.steps.push(ReadStatement::ProgramMove(Box::new(ProgramMove {
            place,
            motion,
            via: via.map(Box::new),
            target,
            feature: self.feature.clone(),
            feed: self.feed,
            frames: self.taken.clone(),
            speed: self.speed,
            marked: self.next.take(),
        })));
    }

    /// The point of this label as it is now.
    pub fn target_of(&self, label: &str) -> Option<&MoveTarget<'a>> {
        self.points.get(&label.to_ascii_uppercase())
    }

    /// Of a path the point of this label as it is now: the program may set it to another later.
    fn as_current(&mut self, target: MoveTarget<'a>) -> MoveTarget<'a> {
        match &target {
            MoveTarget::Label(_, label) if self.is_path => {
                let label = label.to_ascii_uppercase();
                match self.points.get(&label) {
                    Some(point) => {
                        let point = point.clone();
                        if matches!(point, MoveTarget::Pose(_)) {
                            self.named_points.insert(label);
                        }
                        point
                    }
                    None => target,
                }
            }
            _ => target,
        }
    }

    /// The feed of the move given last \[m/s\].
    pub fn at_feed(&mut self, feed: Option<f64>) {
        if let Some(ReadStatement::ProgramMove(leg)) = self.steps.last_mut() {
            leg.feed = feed;
        }
    }

    /// The move given last takes these frames, those that come do not.
    pub fn in_frames(&mut self, frames: Frames<'a>) {
        if let Some(ReadStatement::ProgramMove(leg)) = self.steps.last_mut() {
            leg.frames = frames;
        }
    }

    /// A move whose word has been read: to the targets that stand next.
    pub fn move_to(
        &mut self,
        line: &mut Cursor<'a>,
        motion: Motion,
        target: fn(&mut Cursor<'a>, &Self) -> Result<MoveTarget<'a>>,
    ) -> Result<()> {
        let place = line.clone();
        let via = if motion == Motion::Circular {
            let via = target(line, self)?;
            line.expect(",")?;
            Some(via)
        } else {
            None
        };
        let target = target(line, self)?;
        self.moves(place, motion, via, target);
        Ok(())
    }

    /// The moves that come take the tool (0) or the base (1) of this name, as it is now.
    pub fn takes(&mut self, number: usize, name: impl Into<String>, line: usize) {
        let name = name.into();
        let factors = self.frames.get(&name.to_ascii_uppercase());
        let factors = factors.cloned().unwrap_or_default();
        let taken = ActiveFrame { name, line, factors };
        let current = self.taken[number].take();
        let current = current.filter(|current| current.is_same(&taken));
        self.taken[number] = current.or_else(|| Some(Arc::new(taken)));
    }

    /// The program sets the variable of this name to what is not read.
    pub fn sets(&mut self, line: &Cursor<'_>, name: impl Into<String>) {
        self.assigned.push((line.line_number(), name.into()));
    }

    /// A word of the line is not followed.
    pub fn passes_over(&mut self, line: &Cursor<'_>, word: &str) {
        let sentence = format!("{word} ({{}}) is not followed here.");
        self.remark("not-followed", word, line, Severity::Caution, sentence);
    }

    /// Says what the lines with `word` leave open. In `sentence`, `{}` stands for the lines.
    pub fn remark(
        &mut self,
        code: &'static str,
        word: &str,
        line: &Cursor<'_>,
        severity: Severity,
        sentence: impl Into<String>,
    ) {
        self.remarks.push(Remark {
            code,
            word: word.to_string(),
            line: line.line_number(),
            severity,
            sentence: sentence.into(),
        });
    }

    /// A point.
    pub fn point(&mut self, label: &str, target: MoveTarget<'a>) {
        self.points.insert(label.to_ascii_uppercase(), target);
    }

    /// Joint angles of the controller's axes.
    pub fn angles(&self, values: &[f64]) -> MoveTarget<'a> {
        MoveTarget::Angles(self.options.to_cell(values), Vec::new())
    }

    /// Angles in the order of the cell's joints, if all are there; else the name of the first that is not.
    pub fn complete(&self, values: &[Option<f64>]) -> std::result::Result<MoveTarget<'a>, String> {
        match values.iter().position(Option::is_none) {
            Some(axis) => Err((self.axis_name)(axis)),
            None => {
                let values: Vec<f64> = values.iter().copied().flatten().collect();
                Ok(self.angles(&values))
            }
        }
    }

    /// The pose with these numbers, which ends at `line`'s place.
    pub fn pose(&self, numbers: [Option<Number>; 7], line: &Cursor<'_>) -> Box<Pose<'a>> {
        Box::new(Pose {
            numbers,
            file: line.file_index(),
            end: line.position() as u32,
            line: line.line_number(),
            ..Pose::default()
        })
    }

    fn check_closed(&self) -> Result<()> {
        match &self.open {
            Some(OpenPoint { label, place, .. }) => Err(place.wrong(format!("The `}}` that ends {label} is missing."))),
            None => match &self.arc {
                Some((place, _)) => Err(place.clone().wrong_here("The end of this arc is missing.")),
                None => Ok(()),
            },
        }
    }

    /// The program, where all its points are there; `missing` says what is not.
    pub fn program(self, missing: &str) -> Result<Program> {
        self.check_closed()?;
        let mut moves = 0;
        let steps = self.steps.into_iter().map(|step| {
            let mut leg = match step {
                ReadStatement::Wait(text) => return Ok(Step::Wait(text)),
                ReadStatement::ProgramMove(leg) => *leg,
            };
            let q = match leg.target {
                MoveTarget::Angles(q, _) => q,
                MoveTarget::Pose(_) | MoveTarget::Unset(..) => {
                    return Err(leg.place.wrong_here("This goes to no joint position."));
                }
                MoveTarget::Label(mut place, label) => match self.points.get(&label.to_ascii_uppercase()) {
                    Some(MoveTarget::Angles(q, _)) => q.clone(),
                    Some(MoveTarget::Unset(place, why)) => return Err(place.wrong(why.as_str())),
                    _ => return Err(place.wrong_here(format!("{missing} {label}."))),
                },
            };
            moves += 1;
            // Without a comment before it, it has a number for a name.
            let unnamed = || (MoveKind::Posture, format!("move {moves}"));
            let (kind, name) = leg.marked.unwrap_or_else(unnamed);
            Ok(Step::Move(Move { name, kind, q, speed_percent: leg.speed }))
        });
        Ok(Program { name: self.name, header: Vec::new(), steps: steps.collect::<Result<_>>()? })
    }

    /// The moves of a tool path, points in place of their labels.
    pub fn legs(&mut self) -> Result<Vec<ProgramMove<'a>>> {
        self.check_closed()?;
        let (points, assigned, named) = (&self.points, &self.assigned, &mut self.named_points);
        let mut resolved = |target: MoveTarget<'a>, motion: Motion| match target {
            MoveTarget::Label(mut place, label) => match points.get(&label.to_ascii_uppercase()) {
                Some(MoveTarget::Unset(place, why)) => Err(place.wrong(why.as_str())),
                Some(target) => {
                    if matches!(target, MoveTarget::Pose(_)) {
                        named.insert(label.to_ascii_uppercase());
                    }
                    Ok(target.clone())
                }
                // A position of the controller, as HOME: not of the path.
                None if motion == Motion::Joint => Ok(MoveTarget::Angles(Vec::new(), Vec::new())),
                None => {
                    let name = label.to_ascii_uppercase();
                    let message = if assigned.iter().any(|(_, set)| *set == name) {
                        format!("{label} is calculated by the program: only stated positions are read.")
                    } else {
                        format!("The program has no point {label}.")
                    };
                    Err(place.wrong_here(message))
                }
            },
            MoveTarget::Unset(place, why) => Err(place.wrong(why)),
            target => Ok(target),
        };
        let legs = std::mem::take(&mut self.steps).into_iter();
        let legs = legs.filter_map(|step| match step {
            ReadStatement::Wait(_) => None,
            ReadStatement::ProgramMove(leg) => Some(*leg),
        });
        legs.map(|leg| {
            Ok(ProgramMove {
                via: leg.via.map(|via| resolved(*via, leg.motion).map(Box::new)).transpose()?,
                target: resolved(leg.target, leg.motion)?,
                ..leg
            })
        })
        .collect()
    }
}
