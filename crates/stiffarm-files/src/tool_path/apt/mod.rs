//! CL data: APT, as ISO 4343 has it, and what NX, CATIA, Creo and CAMWorks write.
//!
//! Grammar: ISO 4343:2000 (CLDATA words), Siemens NX, *Cutter Location Source File format* (`MSYS`, `TOOL
//! PATH/`), PTC, *Creo NC: CL Output for Circular Interpolation*. A statement may go on in the next line
//! behind `$`; `$$` begins a comment. `RAPID` is for the next move. Points are x, y, z or x, y, z, i, j, k;
//! the axis stays until another is given. Arcs: `arcs`; what each word does: `words`.

mod arcs;
mod comments;
mod points;
mod statement;
mod words;

use super::builder::Builder;
use super::{FAR_AWAY, FARTHEST};
use crate::program::{Cursor, ProgramFile, lines};
use arcs::{Arcs, Pending};
use comments::Comment;
use nalgebra::{Isometry3, UnitVector3, Vector3};
use statement::{Statement, goes_on, word};
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::Severity;
use words::Weight;

/// The CAM system that wrote a file, where it can be told.
#[derive(Debug, Clone, Copy, PartialEq)]
enum System {
    Nx,
    Camworks,
    Creo,
}

struct State<'b, 'c> {
    builder: &'b mut Builder<'c>,
    axis: UnitVector3<f64>,
    /// As it was stated last.
    stated: [f64; 3],
    position: Option<Vector3<f64>>,
    rapid: bool,
    /// What the next point or `TLON` ends.
    pending: Option<Pending>,
    arcs: Arcs,
    system: Option<System>,
    /// The first frame of points, and the one that is valid from it.
    frames: Option<(Isometry3<f64>, Isometry3<f64>)>,
    /// The frame of a set-up (`CSYS`) as it was stated last.
    setup: Vec<f64>,
    /// Whether points count from one frame in all set-ups.
    is_world: bool,
}

pub(super) fn read(file: &ProgramFile, builder: &mut Builder<'_>) -> Result<()> {
    if read_with(file, builder, false)? {
        *builder = Builder::new(builder.cell);
        read_with(file, builder, true)?;
    }
    Ok(())
}

/// Reads arcs of an unknown system clockwise or not; true where the moves beside them say the other.
fn read_with(file: &ProgramFile, builder: &mut Builder<'_>, clockwise: bool) -> Result<bool> {
    builder.form.before = &[",", ",", ",", ",", ",", ","];
    assume_unit(file, builder);
    let is_creo = file.name.to_ascii_lowercase().contains(".ncl");
    let mut state = State {
        builder,
        axis: Vector3::z_axis(),
        stated: [0.0, 0.0, 1.0],
        position: None,
        rapid: false,
        pending: None,
        arcs: Arcs::new(clockwise),
        system: is_creo.then_some(System::Creo),
        frames: None,
        setup: Vec::new(),
        is_world: false,
    };
    let weights = words::weights();
    let mut open: Option<Statement<'_>> = None;
    let mut all = lines(file);
    let mut comment = Comment::default();
    while let Some(mut line) = all.next() {
        let mut statement = match open.take() {
            Some(statement) => statement,
            None => {
                let head = line.space().clone();
                if line.is_done() || comment.takes(&line, &mut state) {
                    continue;
                }
                let word = word(&mut line);
                if let Some(name) = words::feature(&word, line.rest()) {
                    state.builder.named(name, head.line_number());
                }
                match &*word {
                    "FEDRAT" => words::feed(line.rest(), line.line_number(), state.builder),
                    "SPINDL" => words::spindle(line.rest(), state.builder),
                    "TOOL" | "TLDATA" | "MSYS" => state.system = Some(System::Nx),
                    "FINI" => {
                        behind_the_end(all, state.builder);
                        break;
                    }
                    _ => {}
                }
                if word != "GOTO" {
                    state.arcs.open = None;
                }
                // Most lines are points.
                let weight = match &*word {
                    "GOTO" => Some(Weight::Numbers),
                    _ => weights.get(&*word).copied(),
                };
                match weight {
                    Some(Weight::Text) => continue,
                    Some(Weight::Raw) => {
                        if words::has_code(line.rest()) {
                            let number = line.line_number();
                            state.builder.not_followed(&word, number, Severity::Caution);
                        }
                        continue;
                    }
                    Some(Weight::Quiet) => {
                        comment.goes_on = goes_on(line.rest());
                        continue;
                    }
                    _ => {}
                }
                if word.starts_with(|c: char| c.is_ascii_digit()) || word.is_empty() {
                    let message = "This line belongs to no statement: no word begins it, and the line before does not \
                        end with `$`.";
                    return Err(head.wrong(message));
                }
                let (mut word, mut weight) = (word, weight);
                if weight.is_none() && line.passes("=") {
                    // A definition moves nothing, but a macro may.
                    word = statement::word(&mut line);
                    weight = weights.get(&*word).copied();
                    if weight != Some(Weight::Refused) {
                        comment.goes_on = goes_on(line.rest());
                        let number = head.line_number();
                        let builder = &mut state.builder;
                        builder.not_followed("A definition (=)", number, Severity::Note);
                        continue;
                    }
                }
                line.passes("/");
                Statement::new(head, word, weight)
            }
        };
        if statement.items(&mut line)? { open = Some(statement) } else { state.take(statement)? }
    }
    let other = state.sense_of_arcs();
    if let Some(Pending::Circle { at, .. }) = state.pending {
        let line = file.text[..at].matches('\n').count() + 1;
        let message = "The point that ends this arc is missing: the file ends before it.";
        let error = Error::new(Code::Program, message).line(line, None);
        return Err(error.file(file.name.as_str()));
    }
    match open {
        Some(statement) => Err(statement.wrong("The line that this goes on in behind `$` is missing.")),
        None => Ok(other),
    }
}

/// Without a unit a file's feeds may say it.
fn assume_unit(file: &ProgramFile, builder: &mut Builder<'_>) {
    let Some([inch, mm]) = words::unit_of_feeds(file) else {
        return;
    };
    let in_inches = inch.is_some() && mm.is_none();
    builder.measures(in_inches);
    let (severity, why) = match inch {
        Some(_) if in_inches => (
            Severity::Caution,
            ", and its feeds are in inches ({}): its numbers are read as inches. `UNITS/MM` or `UNITS/INCH` at its \
             head settles it.",
        ),
        Some(_) => (
            Severity::Caution,
            ", and its feeds are in inches ({}) and in millimetres: its numbers are read as millimetres. `UNITS/MM` or \
             `UNITS/INCH` at its head settles it.",
        ),
        None => (Severity::Note, ": its numbers are read as millimetres. `UNITS/INCH` at its head says otherwise."),
    };
    builder.remark("units-assumed", "", inch.unwrap_or(1), severity, || format!("The file names no unit{why}"));
}

/// Says what moves stand behind the end.
fn behind_the_end<'a>(rest: impl Iterator<Item = Cursor<'a>>, builder: &mut Builder<'_>) {
    for mut line in rest {
        if matches!(&*word(&mut line), "GOTO" | "GODLTA" | "CIRCLE" | "TLON") {
            builder.remark("behind-end", "", line.line_number(), Severity::Caution, || {
                "Moves behind the end of the program (FINI) are left out: {}.".to_string()
            });
        }
    }
}

impl State<'_, '_> {
    fn take(&mut self, statement: Statement<'_>) -> Result<()> {
        let line = statement.head.line_number();
        match &*statement.word {
            "GOHOME" if statement.numbers.is_empty() => {
                (self.position, self.rapid) = (None, true);
            }
            "GOTO" | "FROM" | "GOHOME" => return self.go(&statement),
            "GODLTA" => {
                let Some(position) = self.position else {
                    return Err(statement.wrong("There is no point before it."));
                };
                let step = statement.vector(0)?;
                if statement.numbers.len() != 3 {
                    return Err(statement.wrong("A step has three numbers."));
                }
                self.builder.fixed.get_or_insert((line, "it moves by steps here"));
                let position = position + self.axes() * step * self.builder.form.unit;
                if position.amax() > FARTHEST {
                    return Err(statement.wrong(FAR_AWAY));
                }
                self.to(line, position);
            }
            "RAPID" => self.rapid = true,
            "UNITS" | "UNIT" => {
                let units: Vec<_> = statement.words.iter().map(|word| words::is_inch(word)).collect();
                let [Some(in_inches)] = units[..] else {
                    let error = statement.wrong("Lengths in this unit are not read here.");
                    return Err(error.hint("`UNITS/MM` or `UNITS/INCH` is read; let the CAM system give one of them"));
                };
                if !self.builder.measures(in_inches) {
                    return Err(statement.wrong("The units change within the path."));
                }
            }
            "TLAXIS" => {
                self.axis = self.turned(statement.direction(0)?);
                self.stated = statement.vector(0)?.into();
            }
            "CIRCLE" => return self.circle(&statement),
            "INDIRV" | "INDIRP" => return self.sets_out(&statement),
            "TLON" | "GOFWD" if !statement.numbers.is_empty() => {
                return self.goes_round(&statement);
            }
            "TLON" => {}
            "MSYS" => return self.frame(&statement),
            "CSYS" => return self.set_up(&statement),
            "TRNTYP" => {
                let is_zero = statement.numbers.iter().all(|(_, number)| number.value == 0.0);
                self.is_world = statement.has("WORLD") && is_zero;
            }
            word @ ("CUTCOM" | "TLCOMP") if !statement.has("OFF") => {
                let message = match word {
                    "CUTCOM" => "Cutter compensation is not followed: these are not the positions of the tool.",
                    _ => "The tool's compensation is not followed: these are not the positions of the tool.",
                };
                return Err(statement.wrong(message));
            }
            "CYCLE" if !["OFF", "INIT", "CLEAR", "NOMORE"].iter().any(|off| statement.has(off)) => {
                self.builder.remark("cycle", "CYCLE", line, Severity::Caution, || {
                    "Of a cycle ({}) the points are read as they stand, and not its moves along the tool axis."
                        .to_string()
                });
            }
            "CYCLE" | "CUTCOM" | "TLCOMP" => {}
            _ => return self.left(&statement),
        }
        Ok(())
    }

    /// A word that gives no point.
    fn left(&mut self, statement: &Statement<'_>) -> Result<()> {
        let (word, line) = (&*statement.word, statement.head.line_number());
        let is_zero = statement.numbers.iter().all(|(_, number)| number.value == 0.0);
        match statement.weight {
            Some(Weight::Said(severity, what)) => {
                self.builder.remark("not-followed", word, line, severity, || format!("{word} ({{}}) {what}"));
            }
            Some(Weight::Away) => {
                self.position = None;
                self.builder.not_followed(word, line, Severity::Note);
            }
            Some(_) => {
                let is_off = ["OFF", "NOMORE"].iter().any(|off| statement.has(off));
                if !(is_zero && (is_off || !statement.numbers.is_empty())) {
                    let message = format!("{word} changes where the points lie, and is not read here.");
                    let error = statement.wrong(message);
                    return Err(error.hint("let the CAM system give points (GOTO), in the frame of the workpiece"));
                }
            }
            // What has numbers may be a move.
            None if statement.numbers.is_empty() => {
                self.builder.not_followed(word, line, Severity::Note);
            }
            None => self.builder.not_followed(word, line, Severity::Caution),
        }
        Ok(())
    }
}
