//! CL data: APT, as ISO 4343 has it, and the CLSF of Siemens NX.
//!
//! Grammar: ISO 4343:2000 (CLDATA words), Siemens NX, *Cutter Location Source File format* (`MSYS`, `TOOL
//! PATH/`, `CIRCLE/x,y,z,i,j,k,r,…` before the `GOTO/` that ends the arc, which runs *clockwise* about its
//! axis). A statement may go on in the next line behind `$`; `$$` begins a comment. `RAPID` is
//! for the next move. Points are x, y, z or x, y, z, i, j, k; the axis stays until another is given.

use super::arc::Circle;
use super::builder::{Builder, Feed, Place};
use super::{Divided, FAR_AWAY, FARTHEST, Orientation};
use crate::program::{Cursor, Number, ProgramFile, lines};
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, UnitVector3, Vector3};
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::Severity;

/// Words that move nothing.
const QUIET: &str = "PPRINT REMARK TOOL END PAINT LOAD LOADTL SELECT SELECTL TLDATA CUTTER COOLNT SPINDL \
    PARTNO MACHIN MACHINE FINI STOP OPSTOP INTOL OUTTOL TOLER MODE DELAY CLEARP CLRSRF MULTAX OPNAME SPRINT PREFUN \
    AUXFUN SEQNO NOPOST CLPRNT THICK FEDRAT TPRINT INSERT DISPLY CHECK BREAK LINTOL CUTANG TRAFO PPFUN ROTABL \
    CONTOUR SAFETY CLAMP OPSKIP TMARK FEED LEADER TURRET CHANNEL HEAD GOUGCK PLUNGE RETRCT";

/// Words that change where the points lie.
const MOVING: &str = "TRACUT COPY ORIGIN INDEX TRANS GOFWD GOLFT GORGT GOBACK GOUP GODOWN INDIRV INDIRP TLLFT TLRGT \
    TLON PSIS AUTOPS SPLINE NURBS TLAXIS";

/// A statement of one or more lines.
struct Statement<'a> {
    head: Cursor<'a>,
    word: String,
    numbers: Vec<(Cursor<'a>, Number)>,
    words: Vec<String>,
    end: usize,
}

struct State<'b, 'c> {
    builder: &'b mut Builder<'c>,
    axis: UnitVector3<f64>,
    /// As it was stated last.
    stated: [f64; 3],
    position: Option<Vector3<f64>>,
    rapid: bool,
    /// An arc that the next point ends: its numbers, and where it begins in the file.
    circle: Option<(Vector3<f64>, UnitVector3<f64>, usize)>,
    /// Whether the file names its unit.
    has_units: bool,
    /// The first frame of points, and the one that is valid from it.
    frames: Option<(Isometry3<f64>, Isometry3<f64>)>,
}

pub(super) fn read(file: &ProgramFile, builder: &mut Builder<'_>) -> Result<()> {
    builder.form.before = &[",", ",", ",", ",", ",", ","];
    let mut state = State {
        builder,
        axis: Vector3::z_axis(),
        stated: [0.0, 0.0, 1.0],
        position: None,
        rapid: false,
        circle: None,
        has_units: false,
        frames: None,
    };
    let mut open: Option<Statement<'_>> = None;
    for mut line in lines(file) {
        let mut statement = match open.take() {
            Some(statement) => statement,
            None => {
                let head = line.space().clone();
                if line.is_done() || line.clone().passes("$$") {
                    continue;
                }
                let Ok(word) = line.identifier() else {
                    continue;
                };
                let word = word.to_ascii_uppercase();
                if let Some(name) = feature(&word, line.rest()) {
                    state.builder.named(name, line.line_number());
                }
                match word.as_str() {
                    "FEDRAT" => feed(line.rest(), line.line_number(), state.builder),
                    "SPINDL" => spindle(line.rest(), state.builder),
                    _ => {}
                }
                if !is_point(&word) && QUIET.split_whitespace().any(|quiet| quiet == word) {
                    continue;
                }
                line.passes("/");
                Statement {
                    head,
                    word,
                    numbers: Vec::new(),
                    words: Vec::new(),
                    end: 0,
                }
            }
        };
        let goes_on = items(&mut line, &mut statement)?;
        if goes_on {
            open = Some(statement)
        } else {
            state.take(statement)?
        }
    }
    let (has_units, circle) = (state.has_units, state.circle);
    if !has_units {
        builder.remark("units-assumed", "", 1, Severity::Note, || {
            "The file names no unit: its numbers are read as millimetres. `UNITS/INCH` at its head says otherwise.".to_string()
        });
    }
    if let Some((.., place)) = circle {
        let line = file.text[..place].matches('\n').count() + 1;
        let message = "The point that ends this arc is missing: the file ends before it.";
        let error = Error::new(Code::Program, message).line(line, None);
        return Err(error.file(file.name.as_str()));
    }
    match open {
        Some(statement) => Err(statement
            .head
            .wrong("The line that this goes on in behind `$` is missing.")),
        None => Ok(()),
    }
}

/// The name of an operation: `TOOL PATH/NAME,TOOL,…` of NX, `OPNAME/NAME`.
fn feature<'a>(word: &str, rest: &'a str) -> Option<&'a str> {
    let names = match word {
        "TOOL" => rest.trim_start().strip_prefix("PATH")?,
        "OPNAME" => rest,
        _ => return None,
    };
    names.trim_start().strip_prefix('/')?.split(',').next()
}

/// `FEDRAT/2500,MMPM`, in either order; without a unit it is that of the file, per minute.
fn feed(rest: &str, line: usize, builder: &mut Builder<'_>) {
    let (mut unit, mut number) = (builder.form.unit, None);
    let mut is_per_turn = false;
    builder.feed = None;
    for word in words(rest) {
        match word.as_str() {
            "MMPM" | "MMPR" => unit = 1e-3,
            "IPM" | "IPR" => unit = 25.4e-3,
            "INVERS" | "INVERSE" => {
                builder.not_followed(&format!("FEDRAT/{word}"), line, Severity::Note);
                return;
            }
            _ => number = number.or(word.parse::<f64>().ok()),
        }
        is_per_turn |= matches!(word.as_str(), "MMPR" | "IPR" | "PERREV");
    }
    builder.feed = number.map(|own| {
        if is_per_turn {
            Feed::Turn(own * unit)
        } else {
            Feed::Second(own * unit / 60.0)
        }
    });
}

/// `SPINDL/RPM,6000,CLW`, in any order; without a number the speed is as before, that of a cutting edge is none.
fn spindle(rest: &str, builder: &mut Builder<'_>) {
    if words(rest).any(|word| matches!(word.as_str(), "SFM" | "SMM" | "SFPM" | "MPM")) {
        builder.spindle = None;
    } else if let Some(turns) = words(rest).find_map(|word| word.parse::<f64>().ok()) {
        builder.spindle = Some(turns / 60.0);
    }
}

/// The words of the rest of a line, in capitals.
fn words(rest: &str) -> impl Iterator<Item = String> {
    let rest = rest.split('$').next().unwrap_or_default();
    rest.split([',', '/'])
        .map(|word| word.trim().to_ascii_uppercase())
}

/// Numbers and words with commas between them; true where the next line goes on.
fn items<'a>(line: &mut Cursor<'a>, statement: &mut Statement<'a>) -> Result<bool> {
    loop {
        while line.passes(",") {}
        if line.is_done() || line.clone().passes("$$") {
            return Ok(false);
        }
        if line.passes("$") {
            return Ok(true);
        }
        let place = line.space().clone();
        match line.placed() {
            Ok(number) => {
                statement.end = line.position();
                statement.numbers.push((place, number));
            }
            Err(error) => match line.identifier() {
                Ok(word) => statement.words.push(word.to_ascii_uppercase()),
                Err(_) if is_point(&statement.word) => return Err(error),
                // Text of a statement whose numbers do not count.
                Err(_) => line.skip(line.rest().chars().next().map_or(0, char::len_utf8)),
            },
        }
    }
}

fn is_point(word: &str) -> bool {
    matches!(word, "GOTO" | "FROM" | "GODLTA" | "CIRCLE" | "MSYS")
}

impl State<'_, '_> {
    fn take(&mut self, mut statement: Statement<'_>) -> Result<()> {
        let line = statement.head.line_number();
        let wrong = |statement: &mut Statement<'_>, message: &str| {
            Err(statement.head.wrong_here(message.to_string()))
        };
        let has =
            |statement: &Statement<'_>, word: &str| statement.words.iter().any(|own| own == word);
        match statement.word.as_str() {
            "GOTO" | "FROM" => return self.go(&statement),
            "GODLTA" => {
                let Some(position) = self.position else {
                    return wrong(&mut statement, "There is no point before it.");
                };
                let step = self.vector(&statement, 0)?;
                if statement.numbers.len() != 3 {
                    return wrong(&mut statement, "A step has three numbers.");
                }
                self.builder
                    .fixed
                    .get_or_insert((line, "it moves by steps here"));
                let position = position + step * self.builder.form.unit;
                if position.amax() > FARTHEST {
                    return wrong(&mut statement, FAR_AWAY);
                }
                self.to(line, position);
            }
            "RAPID" => self.rapid = true,
            "UNITS" => {
                self.has_units = true;
                let inches = ["INCH", "INCHES", "IN"]
                    .iter()
                    .any(|inch| has(&statement, inch));
                if !self.builder.measures(inches) {
                    return wrong(&mut statement, "The units change within the path.");
                }
            }
            "CIRCLE" => {
                if statement.numbers.len() < 7 {
                    return wrong(
                        &mut statement,
                        "An arc has a centre, an axis and a radius: seven numbers.",
                    );
                }
                let centre = self.point(&statement)?;
                let axis = self.turned(-self.direction(&statement, 3)?);
                if has(&statement, "TIMES") {
                    return wrong(
                        &mut statement,
                        "Arcs of several turns (TIMES) are not read here.",
                    );
                }
                self.circle = Some((centre, axis, statement.head.position()));
            }
            "MSYS" => {
                if statement.numbers.len() != 9 {
                    return wrong(
                        &mut statement,
                        "A frame has nine numbers: origin, x axis, y axis.",
                    );
                }
                let origin = self.vector(&statement, 0)? * self.builder.form.unit;
                let (x, y) = (
                    self.direction(&statement, 3)?,
                    self.direction(&statement, 6)?,
                );
                let axes = Matrix3::from_columns(&[*x, *y, x.cross(&y)]);
                let axes = Rotation3::from_matrix_unchecked(axes);
                let frame = Isometry3::from_parts(
                    origin.into(),
                    UnitQuaternion::from_rotation_matrix(&axes),
                );
                let first = self.frames.map_or(frame, |(first, _)| first);
                self.frames = Some((first, first.inverse() * frame));
                if first != frame {
                    self.builder
                        .fixed
                        .get_or_insert((line, "its frame changes here"));
                }
            }
            "CUTCOM" if !has(&statement, "OFF") => {
                return wrong(
                    &mut statement,
                    "Cutter compensation is not followed: these are not the positions of the tool.",
                );
            }
            "CYCLE" if !has(&statement, "OFF") => {
                self.builder.remark("cycle", "CYCLE", line, Severity::Caution, || {
                    "Of a cycle ({}) the points are read as they stand, and not its moves along the tool axis."
                        .to_string()
                });
            }
            "CYCLE" | "CUTCOM" => {}
            word if MOVING.split_whitespace().any(|own| own == word) => {
                let message = format!("{word} changes where the points lie, and is not read here.");
                return Err(statement
                    .head
                    .wrong_here(message)
                    .hint("let the CAM system give points (GOTO), in the frame of the workpiece"));
            }
            word => {
                let word = word.to_string();
                self.builder.not_followed(&word, line, Severity::Note);
            }
        }
        Ok(())
    }

    /// Three numbers as they stand.
    fn vector(&self, statement: &Statement<'_>, from: usize) -> Result<Vector3<f64>> {
        let numbers = statement.numbers.get(from..from + 3).unwrap_or_default();
        match numbers {
            [(_, x), (_, y), (_, z)] => Ok(Vector3::new(x.value, y.value, z.value)),
            _ => Err(statement.head.wrong("Three numbers are needed here.")),
        }
    }

    fn direction(&self, statement: &Statement<'_>, from: usize) -> Result<UnitVector3<f64>> {
        let vector = self.vector(statement, from)?;
        // Axes of CAM systems are rounded, and not of another length.
        let length = vector.norm();
        if (length - 1.0).abs() > 0.01 {
            let message = format!("This axis has length {length:.3}; it must be 1.");
            let error = statement.numbers[from].0.wrong(message);
            return Err(error.hint("decimals have points here, and numbers commas between them"));
        }
        Ok(UnitVector3::new_normalize(vector))
    }

    /// The first three numbers as a point in the first frame \[m\].
    fn point(&self, statement: &Statement<'_>) -> Result<Vector3<f64>> {
        let point = self.vector(statement, 0)? * self.builder.form.unit;
        if point.amax() > FARTHEST {
            return Err(statement.head.wrong(FAR_AWAY));
        }
        Ok(match &self.frames {
            Some((_, frame)) => frame.rotation * point + frame.translation.vector,
            None => point,
        })
    }

    fn turned(&self, axis: UnitVector3<f64>) -> UnitVector3<f64> {
        self.frames.map_or(axis, |(_, frame)| frame.rotation * axis)
    }

    /// A point that numbers stand for.
    fn go(&mut self, statement: &Statement<'_>) -> Result<()> {
        let line = statement.head.line_number();
        let count = statement.numbers.len();
        if count != 3 && count != 6 {
            let message =
                format!("A point has three numbers, or six with the tool axis; here are {count}.");
            return Err(statement.head.wrong(message));
        }
        let position = self.point(statement)?;
        let before = Place::Axis(Vector3::zeros(), self.axis);
        if count == 6 {
            self.axis = self.turned(self.direction(statement, 3)?);
            self.stated = self.vector(statement, 3)?.into();
            self.builder.form.orientation = Orientation::Axis;
        }
        self.rapid |= statement.word == "FROM";
        if let Some((centre, axis, begin)) = self.circle.take() {
            let start = self.position.unwrap_or(position);
            let Some(circle) = Circle::about(centre, axis, start, position) else {
                let message = "The arc does not lead here: this is not on the circle about its centre through the point before.";
                return Err(statement.head.wrong(message));
            };
            let first = self.builder.points.len();
            let end = Place::Axis(position, self.axis);
            for (share, point) in circle.points() {
                self.builder
                    .point(line, &before.towards(&end, share, point), false);
            }
            self.divided(first, true, begin..statement.end);
            self.position = Some(position);
            self.rapid = false;
            return Ok(());
        }
        let to = Place::Axis(position, self.axis);
        let first = self.builder.points.len();
        let from = self.position.filter(|_| !self.rapid);
        let from = from.map(|start| before.at(start));
        if from.is_some_and(|from| self.builder.between(line, &from, &to)) {
            self.divided(first, false, statement.head.position()..statement.end);
        }
        self.to(line, position);
        let end = Number {
            value: 0.0,
            at: statement.end as u32,
            length: 0,
        };
        for component in 0..6 {
            let number = match statement.numbers.get(component) {
                Some((_, number)) => *number,
                None => Number {
                    value: self.stated[component - 3],
                    ..end
                },
            };
            self.builder.number(0, component, number);
        }
        Ok(())
    }

    /// The points from `first` on, with the next one for a straight move, are those of one move.
    fn divided(&mut self, first: usize, is_arc: bool, text: std::ops::Range<usize>) {
        self.builder.divided.push(Divided {
            points: first..self.builder.points.len() + usize::from(!is_arc),
            is_arc,
            text,
            begin: "GOTO/".to_string(),
            ..Divided::default()
        });
    }

    fn to(&mut self, line: usize, position: Vector3<f64>) {
        let rapid = std::mem::take(&mut self.rapid);
        self.builder
            .point(line, &Place::Axis(position, self.axis), rapid);
        self.position = Some(position);
    }
}
