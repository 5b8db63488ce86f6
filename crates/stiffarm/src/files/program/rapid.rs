//! ABB RAPID: a module `.mod`.
//!
//! Grammar: ABB, *Technical reference manual, RAPID Overview* 3HAC050947 (identifiers of at most 32
//! characters, comments from `!` to the end of the line) and *RAPID Instructions, Functions and Data
//! types* 3HAC050917: `jointtarget` is `[robax, extax]` with six angles in degrees and six external
//! axes, `9E9` where there is none; the seventh axis of an arm is `eax_a`. `MoveAbsJ` moves to it,
//! `VelSet` takes per cent of the programmed speed, `TPWrite` shows 40 characters a line, `Stop` waits for
//! the start button.
//!
//! CR LF: RobotStudio writes modules so.

use super::characters;
use super::cursor::{Cursor, Steps, lines};
use super::{Language, Program, ProgramFile, ProgramOptions, Step, text};
use crate::error::Result;
use std::collections::HashMap;

const WIDTH: usize = 76;
const MESSAGE: usize = 40;
const NAME: usize = 60;
/// The tool where none is given.
const TOOL: &str = "tool0";
/// What stands for an external axis that is not there.
const NO_AXIS: &str = "9E9";
/// Programmed speed, of which [`Move`](super::Move)s have per cent.
const SPEED: &str = "v1000";

/// The module.
pub fn write(program: &Program, options: &ProgramOptions) -> Vec<ProgramFile> {
    let decimals = text::decimals(program, Language::Rapid.most_decimals());
    let tool = options.tool.as_deref().unwrap_or(TOOL);
    let mut head = vec![format!("MODULE {}", program.name)];
    head.extend(
        text::header(program, Language::Rapid, WIDTH)
            .iter()
            .map(|line| format!("  ! {line}")),
    );
    let mut body = vec![format!("  PROC {}_run()", program.name)];
    let (mut moves, mut speed) = (0, None);
    for step in &program.steps {
        match step {
            Step::Wait(said) => {
                body.extend(
                    characters::said(said, MESSAGE)
                        .iter()
                        .map(|line| format!("    TPWrite \"{line}\";")),
                );
                body.push("    Stop;".to_string());
            }
            Step::Move(target) => {
                moves += 1;
                let mut values = text::degrees(&target.q, options, decimals);
                values.resize(12, NO_AXIS.to_string());
                let (arm, external) = values.split_at(6);
                head.push(format!(
                    "  LOCAL CONST jointtarget jp{moves}:=[[{}],[{}]];",
                    arm.join(","),
                    external.join(",")
                ));
                body.push(format!(
                    "    ! {}",
                    text::marker(target.kind, &target.name, NAME)
                ));
                if speed != Some(target.speed_percent) {
                    body.push(format!("    VelSet {},1000;", target.speed_percent));
                    speed = Some(target.speed_percent);
                }
                body.push(format!("    MoveAbsJ jp{moves},{SPEED},fine,{tool};"));
            }
        }
    }
    body.push("    VelSet 100,5000;".to_string());
    body.extend(["  ENDPROC", "ENDMODULE"].map(String::from));
    head.extend(body);
    vec![ProgramFile {
        name: format!("{}.mod", program.name),
        text: text::joined(&head, "\r\n"),
    }]
}

/// Reads a module.
pub fn read(file: &ProgramFile, options: &ProgramOptions, joints: usize) -> Result<Program> {
    let mut steps = Steps::default();
    let mut points: HashMap<String, Vec<f64>> = HashMap::new();
    let (mut name, mut speed) = (String::new(), 100);
    for mut line in lines(file) {
        if line.passes("!") {
            steps.comment(line.rest());
            continue;
        }
        if line.word("MODULE") {
            name = line.identifier()?.to_string();
            continue;
        }
        let _ = line.word("LOCAL") || line.word("TASK");
        let declares = line.word("CONST") || line.word("PERS") || line.word("VAR");
        if declares && line.word("jointtarget") {
            let point = line.identifier()?.to_ascii_lowercase();
            line.expect(":=")?;
            let q = target(&mut line, options, joints)?;
            line.expect(";")?;
            points.insert(point, q);
        } else if line.word("VelSet") {
            speed = line.percent()?;
        } else if line.word("TPWrite") {
            steps.say(line.quoted('"')?);
            line.expect(";")?;
        } else if line.word("Stop") {
            line.expect(";")?;
            steps.wait();
        } else if line.word("MoveAbsJ") {
            let q = match line.clone().passes("[") {
                true => target(&mut line, options, joints)?,
                false => {
                    let place = line.clone();
                    let point = line.identifier()?;
                    let found = points.get(&point.to_ascii_lowercase());
                    let wrong = || {
                        let message = format!("No jointtarget {point} stands above.");
                        place.clone().space().wrong(message)
                    };
                    found.cloned().ok_or_else(wrong)?
                }
            };
            ends_at_rest(&mut line)?;
            steps.go(q, speed);
        } else {
            other_motion(&line)?;
        }
    }
    Ok(Program {
        name,
        header: Vec::new(),
        steps: steps.done(),
    })
}

/// `[[six angles],[six external axes]]`.
fn target(line: &mut Cursor<'_>, options: &ProgramOptions, joints: usize) -> Result<Vec<f64>> {
    let mut values = Vec::with_capacity(12);
    line.expect("[")?;
    for part in 0..2 {
        if part > 0 {
            line.expect(",")?;
        }
        line.expect("[")?;
        for axis in 0..6 {
            if axis > 0 {
                line.expect(",")?;
            }
            let number = part * 6 + axis;
            match number < joints {
                true => values.push(line.angle()?),
                false => {
                    line.number()?;
                }
            }
        }
        line.expect("]")?;
    }
    line.expect("]")?;
    Ok(options.to_cell(&values))
}

/// What follows the target: a speed, `fine`, a tool.
fn ends_at_rest(line: &mut Cursor<'_>) -> Result<()> {
    while line.passes("\\") {
        line.identifier()?;
    }
    line.expect(",")?;
    line.identifier()?;
    line.expect(",")?;
    if !line.word("fine") {
        return Err(line
            .space()
            .wrong("The move does not end at rest (fine).".to_string()));
    }
    line.expect(",")?;
    line.identifier()?;
    while line.passes("\\") {
        line.identifier()?;
        if line.passes(":=") {
            line.identifier()?;
        }
    }
    line.expect(";")
}

/// Refuses moves that are not to joint angles.
fn other_motion(line: &Cursor<'_>) -> Result<()> {
    let others = ["MoveJ", "MoveL", "MoveC", "MoveExtJ"];
    match others.iter().find(|word| line.clone().word(word)) {
        Some(word) => Err(line
            .clone()
            .space()
            .wrong(format!("{word} is no move to joint angles (MoveAbsJ)."))),
        None => Ok(()),
    }
}
