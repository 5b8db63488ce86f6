//! KUKA KRL: a `.src` with the moves and a `.dat` with the points.
//!
//! Grammar: KUKA, *Operating and Programming Instructions for System Integrators*, KUKA System
//! Software 8.x, and *Expert Documentation, Programming Messages*, KSS 8.2; the reference of
//! openkuka.github.io/krl (`E6AXIS`, `$VEL_AXIS`, `KrlMsg_T`: a message has at most 80 characters).
//! The head of the `.src` is the controller's own template: without `BAS (#INITMOV,0)` no speed is
//! set. `BAS (#VEL_PTP,n)` sets `$VEL_AXIS`, per cent of each axis's largest speed. Axes that an
//! aggregate does not name stay where they are. `MsgNotify` is of the message library that comes
//! with KSS 8; `WAIT SEC 0` before it stops the advance run, so that the text appears when the robot
//! is there, and `HALT` waits for the start key.
//!
//! CR LF: the controller's file system is that of Windows.

use super::characters;
use super::cursor::{Cursor, Steps, lines};
use super::{Language, Program, ProgramFile, ProgramOptions, Step, text};
use crate::error::{Code, Error, Result};
use std::collections::HashMap;

/// Characters of a message and of a comment.
const WIDTH: usize = 76;
/// Of a name in a comment.
const NAME: usize = 60;

/// The two files.
pub fn write(program: &Program, options: &ProgramOptions) -> Vec<ProgramFile> {
    let decimals = text::decimals(program, Language::Krl.most_decimals());
    let mut src: Vec<String> = ["&ACCESS RVP", "&REL 1"].map(String::from).into();
    let mut dat = src.clone();
    src.push(format!("DEF {} ( )", program.name));
    let header = text::header(program, Language::Krl, WIDTH);
    let header = header.iter().map(|line| format!("; {line}"));
    src.extend(header.clone());
    src.extend(
        [
            ";FOLD INI",
            ";FOLD BASISTECH INI",
            "GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM ( )",
            "INTERRUPT ON 3",
            "BAS (#INITMOV,0)",
            ";ENDFOLD (BASISTECH INI)",
            ";ENDFOLD (INI)",
        ]
        .map(String::from),
    );
    src.extend(
        options
            .tool
            .iter()
            .map(|tool| format!("BAS (#TOOL,{tool})")),
    );
    dat.push(format!("DEFDAT {}", program.name));
    dat.extend(header);
    let (mut moves, mut speed) = (0, None);
    for step in &program.steps {
        match step {
            Step::Wait(said) => {
                src.push("WAIT SEC 0".to_string());
                src.extend(
                    characters::said(said, WIDTH)
                        .iter()
                        .map(|line| format!("MsgNotify (\"{line}\")")),
                );
                src.push("HALT".to_string());
            }
            Step::Move(target) => {
                moves += 1;
                src.push(format!(
                    "; {}",
                    text::marker(target.kind, &target.name, NAME)
                ));
                if speed != Some(target.speed_percent) {
                    src.push(format!("BAS (#VEL_PTP,{})", target.speed_percent));
                    speed = Some(target.speed_percent);
                }
                src.push(format!("PTP XP{moves}"));
                let values = text::degrees(&target.q, options, decimals);
                let fields = values.iter().enumerate();
                let fields: Vec<String> = fields
                    .map(|(axis, value)| format!("{} {value}", Language::Krl.axis_name(axis)))
                    .collect();
                dat.push(format!("DECL E6AXIS XP{moves}={{{}}}", fields.join(",")));
            }
        }
    }
    src.push("END".to_string());
    dat.push("ENDDAT".to_string());
    [("src", src), ("dat", dat)]
        .map(|(extension, lines)| ProgramFile {
            name: format!("{}.{extension}", program.name),
            text: text::joined(&lines, "\r\n"),
        })
        .into()
}

/// Reads both files.
pub fn read(files: &[ProgramFile], options: &ProgramOptions, joints: usize) -> Result<Program> {
    let of = |extension: &str| {
        let found = files
            .iter()
            .find(|file| file.name.to_ascii_lowercase().ends_with(extension));
        found.ok_or_else(|| {
            let message = format!("A KRL program is a .src and a .dat; there is no {extension}.");
            Error::new(Code::Usage, message).hint("give both files")
        })
    };
    let (src, dat) = (of(".src")?, of(".dat")?);
    let reader = Reader { options, joints };
    let points = reader.points(dat)?;
    reader.program(src, &points)
}

struct Reader<'a> {
    options: &'a ProgramOptions,
    joints: usize,
}

impl Reader<'_> {
    /// The joint points of the `.dat`; what else it declares is not looked at.
    fn points(&self, dat: &ProgramFile) -> Result<HashMap<String, Vec<f64>>> {
        let mut points = HashMap::new();
        for mut line in lines(dat) {
            line.word("DECL");
            line.word("GLOBAL");
            if !(line.word("E6AXIS") || line.word("AXIS")) {
                continue;
            }
            let name = line.identifier()?.to_ascii_uppercase();
            if !line.passes("=") {
                continue;
            }
            let q = self.aggregate(&mut line)?;
            line.end()?;
            points.insert(name, q);
        }
        Ok(points)
    }

    /// `{A1 …,A2 …}`, with or without the name of its type.
    fn aggregate(&self, line: &mut Cursor<'_>) -> Result<Vec<f64>> {
        let start = line.clone();
        line.expect("{")?;
        let _ = line.passes("E6AXIS:") || line.passes("AXIS:");
        let mut values = vec![None; self.joints];
        loop {
            let field = line.clone();
            let axis = line.identifier()?.to_ascii_uppercase();
            let value = line.angle()?;
            let known = (0..12).find(|i| Language::Krl.axis_name(*i) == axis);
            match known {
                Some(i) if i < self.joints => values[i] = Some(value),
                // Further external axes of the controller are none of the cell's.
                Some(_) => {}
                None => {
                    return Err(
                        field.wrong(format!("`{axis}` is no axis: this is no joint position."))
                    );
                }
            }
            if !line.passes(",") {
                break;
            }
        }
        line.expect("}")?;
        let missing = values.iter().position(Option::is_none);
        if let Some(axis) = missing {
            let name = Language::Krl.axis_name(axis);
            return Err(start.wrong(format!("The position has no {name}.")));
        }
        let values: Vec<f64> = values.into_iter().flatten().collect();
        Ok(self.options.to_cell(&values))
    }

    fn program(&self, src: &ProgramFile, points: &HashMap<String, Vec<f64>>) -> Result<Program> {
        let mut steps = Steps::default();
        let (mut name, mut speed) = (None, 100);
        for mut line in lines(src) {
            if line.passes(";") {
                steps.comment(line.rest());
            } else if line.word("DEF") {
                let found = line.identifier()?;
                name.get_or_insert_with(|| found.to_string());
            } else if line.word("BAS") {
                line.expect("(")?;
                if line.passes("#VEL_PTP") {
                    line.expect(",")?;
                    speed = line.percent()?;
                    line.expect(")")?;
                }
            } else if line.word("MsgNotify") {
                line.expect("(")?;
                steps.say(line.quoted('"')?);
            } else if line.word("HALT") {
                line.end()?;
                steps.wait();
            } else if line.word("PTP") {
                let q = match line.clone().passes("{") {
                    true => self.aggregate(&mut line)?,
                    false => {
                        let place = line.clone();
                        let point = line.identifier()?;
                        let found = points.get(&point.to_ascii_uppercase());
                        let wrong = || {
                            let message =
                                format!("The .dat has no joint position (E6AXIS) {point}.");
                            place.clone().space().wrong(message)
                        };
                        found.cloned().ok_or_else(wrong)?
                    }
                };
                line.end()?;
                steps.go(q, speed);
            } else {
                other_motion(&line)?;
            }
        }
        Ok(Program {
            name: name.unwrap_or_default(),
            header: Vec::new(),
            steps: steps.done(),
        })
    }
}

/// Refuses moves that are not to joint angles.
fn other_motion(line: &Cursor<'_>) -> Result<()> {
    let others = [
        "LIN", "CIRC", "SPTP", "SLIN", "SCIRC", "PTP_REL", "LIN_REL", "SPTP_REL",
    ];
    match others.iter().find(|word| line.clone().word(word)) {
        Some(word) => Err(line
            .clone()
            .space()
            .wrong(format!("{word} is no joint move that can be read (PTP)."))),
        None => Ok(()),
    }
}
