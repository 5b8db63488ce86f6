//! Controller programs: a plan as joint moves in the language of a robot controller, and such a
//! program read back.
//!
//! A [`Program`] is the same for every language: moves to controller angles, and stops with a text
//! at which the program waits until somebody lets it go on. [`program_of_stops`] makes one from the
//! postures to measure; [`write_program`] puts it into a [`Language`], [`read_program`] takes it out
//! again, also after changes at the pendant. [`compare_moves`] tells which moves have changed,
//! [`compare_statements`] what else a program holds than one that was written.
//!
//! What is written is the smallest part of each language that does this: no tool, base, load or
//! acceleration is set, and nothing is computed on the controller. Each language is a file with one
//! value (`Dialect`), which also says where its grammar is described; `writer` and `reader`
//! serve all.
//!
//! ```
//! use stiffarm_files::program::{
//!     Language, ProgramOptions, Stop, program_of_stops, read_program, write_program,
//! };
//! use stiffarm::model::posture::Posture;
//!
//! # fn main() -> stiffarm::Result<()> {
//! let q = [10.0, -20.0, 95.5, 0.0, 45.25, 0.0].map(f64::to_radians);
//! let posture = Posture { name: "p1".into(), q: q.into() };
//! let stops = [Stop::new(posture, "measure unloaded, loaded")];
//! let program = program_of_stops("plan_a", vec![], &stops, None, 10);
//! let options = ProgramOptions::default();
//! let files = write_program(&program, Language::Rapid, &options)?;
//! assert!(files[0].text.contains("[[10.00,-20.00,95.50,0.00,45.25,0.00],"));
//! assert_eq!(read_program(&files, Language::Rapid, &options, 6)?.moves().count(), 1);
//! # Ok(())
//! # }
//! ```

pub(crate) mod characters;
mod checks;
mod compare;
mod csv;
mod cursor;
mod dialect;
mod flow;
mod inform;
mod inform_path;
mod krl;
mod krl_path;
mod krl_points;
mod language;
mod ls;
mod ls_path;
mod move_target;
mod options;
mod pdl2;
mod rapid;
mod rapid_path;
mod rapid_statements;
mod read;
mod reader;
mod statements;
pub(crate) mod text;
mod urscript;
mod writer;

pub use compare::{Difference, compare_moves, missing_stops};
pub(super) use cursor::{Cursor, Number, lines};
pub(super) use dialect::{LinearMove, PoseForm};
pub use language::Language;
pub(super) use move_target::{ActiveFrame, External, Frames, Motion, MoveTarget, Pose, ProgramMove};
pub use options::ProgramOptions;
pub(super) use reader::Reader;
pub use statements::compare_statements;
pub(super) use text::fixed;
pub(super) use writer::filled;

use stiffarm::error::{Code, Error, Result};
use stiffarm::model::posture::Posture;

/// Most moves of a program: what every controller takes.
const MOST_MOVES: usize = 999;

/// Speed of the first move at most, in per cent as [`Move::speed_percent`].
const FIRST_SPEED: u8 = 5;

/// Joint moves and stops, whatever the language.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    /// Its name on the controller.
    pub name: String,
    /// Lines at its head, for the reader. Empty in a program that was read.
    pub header: Vec<String>,
    /// What it does, in this order.
    pub steps: Vec<Step>,
}

/// One step of a [`Program`].
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// A joint move that ends at rest.
    Move(Move),
    /// The program shows the text and waits until somebody lets it go on.
    Wait(String),
}

/// A joint move to controller angles.
#[derive(Debug, Clone, PartialEq)]
pub struct Move {
    /// Name of the posture it goes to.
    pub name: String,
    /// What the posture is for.
    pub kind: MoveKind,
    /// Controller angles at its end, in the order of the cell's joints \[rad\].
    pub q: Vec<f64>,
    /// Speed, 1 to 100 per cent of what the language counts from ([`Language::speed_of`]).
    pub speed_percent: u8,
}

/// What the end of a move is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum MoveKind {
    /// Where the program begins and ends.
    Start,
    /// On the way; nothing is measured there.
    Via,
    /// A posture to be measured.
    Posture,
}

impl MoveKind {
    /// All of them.
    pub const ALL: [MoveKind; 3] = [MoveKind::Start, MoveKind::Via, MoveKind::Posture];

    /// Its name in programs.
    pub fn as_str(self) -> &'static str {
        match self {
            MoveKind::Start => "start",
            MoveKind::Via => "via",
            MoveKind::Posture => "posture",
        }
    }
}

/// One posture to be measured, with the way to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Texts to confirm before the robot leaves for it, for example that the rope must be unhooked.
    pub before: Vec<String>,
    /// Postures on the way, in order.
    pub via: Vec<Posture>,
    /// The posture.
    pub posture: Posture,
    /// What is to be done there.
    pub task: String,
}

impl Stop {
    /// A posture that is reached by one joint move.
    pub fn new(posture: Posture, task: impl Into<String>) -> Self {
        Stop { before: Vec::new(), via: Vec::new(), posture, task: task.into() }
    }
}

/// Where a program begins and ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// The posture.
    pub posture: Posture,
    /// Postures on the way back to it from the last one.
    pub back: Vec<Posture>,
}

/// One file of a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProgramFile {
    /// File name, without a folder.
    pub name: String,
    /// Its whole text.
    pub text: String,
}

impl Program {
    /// The moves, in order.
    pub fn moves(&self) -> impl Iterator<Item = &Move> {
        self.steps.iter().filter_map(|step| match step {
            Step::Move(target) => Some(target),
            Step::Wait(_) => None,
        })
    }
}

/// The program that goes through `stops`.
///
/// It begins with a text to confirm, then moves slowly to `start`, or where there is none towards
/// the first stop: nobody knows where the robot stands before. All other moves have
/// `speed_percent`, the first at most 5 and at most half of it. At each posture it waits. With a
/// `start` it ends there, after another text to confirm.
pub fn program_of_stops(
    name: impl Into<String>,
    header: Vec<String>,
    stops: &[Stop],
    start: Option<&Start>,
    speed_percent: u8,
) -> Program {
    let mut speed = (speed_percent / 2).clamp(1, FIRST_SPEED);
    let first_stop = stops.first().map(|stop| match stop.via.first() {
        Some(via) => (MoveKind::Via, via),
        None => (MoveKind::Posture, &stop.posture),
    });
    let begin = start.map(|start| &start.posture);
    let first = begin.map(|begin| (MoveKind::Start, begin)).or(first_stop);
    let mut steps = Vec::new();
    if let Some((kind, first)) = first {
        let place = format!("{} {}", kind.as_str(), first.name);
        steps.push(Step::Wait(format!("Cell empty. Slow move to {place}. Path free?")));
    }
    let mut go = |posture: &Posture, kind| {
        let target = Move { name: posture.name.clone(), kind, q: posture.q.clone(), speed_percent: speed };
        speed = speed_percent;
        Step::Move(target)
    };
    steps.extend(begin.map(|begin| go(begin, MoveKind::Start)));
    for stop in stops {
        steps.extend(stop.before.iter().cloned().map(Step::Wait));
        steps.extend(stop.via.iter().map(|via| go(via, MoveKind::Via)));
        steps.push(go(&stop.posture, MoveKind::Posture));
        let said = format!("posture {}: {}", stop.posture.name, stop.task);
        steps.push(Step::Wait(said));
    }
    if let Some(start) = start {
        steps.push(Step::Wait(format!("All measured. Back to start {}", start.posture.name)));
        steps.extend(start.back.iter().map(|via| go(via, MoveKind::Via)));
        steps.push(go(&start.posture, MoveKind::Start));
    }
    Program { name: name.into(), header, steps }
}

/// Puts `program` into a language: its files, with names that the controller takes. The same program
/// gives the same bytes.
///
/// Texts hold only characters that every controller shows; others are written in letters or as `_`.
/// Angles have as many decimals as the program's own need, at least two and at most what the language
/// takes.
///
/// # Errors
/// A name that the language does not allow, more joints than it has axes, an angle that is not
/// finite, options that do not fit, too many moves.
pub fn write_program(program: &Program, language: Language, options: &ProgramOptions) -> Result<Vec<ProgramFile>> {
    language.check_name(&program.name)?;
    let joints = program.moves().next().map_or(0, |first| first.q.len());
    for target in program.moves() {
        check_move(target, joints)?;
    }
    let count = program.moves().count();
    if count > MOST_MOVES {
        return Err(Error::new(
            Code::Unsupported,
            format!("A program of {count} moves is too long; at most {MOST_MOVES} are written."),
        )
        .hint("export parts of the plan, each to a program of its own"));
    }
    options.check(language.dialect(), joints)?;
    let dialect = language.dialect();
    match &dialect.syntax {
        Some(syntax) => Ok(writer::write(program, dialect, syntax, options)),
        None => csv::write(program),
    }
}

/// Reads the moves of a tool path; the reader keeps what else the lines say.
pub(super) fn read_legs<'a>(
    files: &'a [ProgramFile],
    language: Language,
    reader: &mut Reader<'a>,
) -> Result<Vec<ProgramMove<'a>>> {
    if let Some(syntax) = &language.dialect().syntax {
        read::read_lines(files.iter().collect(), syntax, reader)?;
    }
    reader.legs()
}

fn check_move(target: &Move, joints: usize) -> Result<()> {
    let fault = |code, message: String| Err(Error::new(code, message));
    if target.q.len() != joints {
        return fault(
            Code::Dimension,
            format!("Posture {} has {} angles, the others have {joints}.", target.name, target.q.len()),
        );
    }
    if target.q.iter().any(|angle| !angle.is_finite()) {
        return fault(Code::NotFinite, format!("Posture {} has an angle that is not finite.", target.name));
    }
    if !(1..=100).contains(&target.speed_percent) {
        return fault(
            Code::InvalidValue,
            format!("The speed must be 1 to 100 per cent, got {}.", target.speed_percent),
        );
    }
    Ok(())
}

/// Reads a program of `joints` joints back from its files: those that [`write_program`] gave, also
/// changed at the pendant. Names come back as far as the language holds them, texts as far as it
/// shows them.
///
/// # Errors
/// A move that does not go to stated joint angles, a number or bracket that is missing, a point that
/// is not there: with file, line and column.
pub fn read_program(
    files: &[ProgramFile],
    language: Language,
    options: &ProgramOptions,
    joints: usize,
) -> Result<Program> {
    options.check(language.dialect(), joints)?;
    let dialect = language.dialect();
    let program = match &dialect.syntax {
        Some(syntax) => read::read(files, dialect, syntax, options, joints),
        None => csv::read(reader::only(files, dialect.title)?, joints),
    }?;
    let is_empty = program.moves().next().is_none();
    match files.first().filter(|_| is_empty) {
        Some(file) => {
            Err(Error::new(Code::TooFewData, format!("The file has no joint move as {} has it.", language.title()))
                .file(file.name.as_str())
                .hint("check --language"))
        }
        None => Ok(program),
    }
}
