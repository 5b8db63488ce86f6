//! COMAU PDL2: a program `.pdl`.
//!
//! Grammar: COMAU, *PDL2 Programming Language Manual*, System Software 2.30 (CR00758049) and 3.1x (CR00757508);
//! public generators for C5G controllers (github.com/ros-industrial-attic/robodk_postprocessors,
//! `Comau_C5G.py`). Comments begin with `--`. `MOVE JOINT TO {…}` moves to joint angles in degrees, at most ten
//! joints. `$ARM_SPD_OVR` is the arm's speed in whole per cent; what it was comes back at the end. `WRITE LUN_CRT`
//! shows a line on the pendant's user page, and `PAUSE` waits until the program is let go on from there.
//!
//! CR LF: the controller's tools run on Windows.

use super::characters;
use super::cursor::{Cursor, Steps, lines};
use super::{Language, Program, ProgramFile, ProgramOptions, Step, text};
use crate::error::Result;

const WIDTH: usize = 76;
const MESSAGE: usize = 40;
const NAME: usize = 60;

/// The program.
pub fn write(program: &Program, options: &ProgramOptions) -> Vec<ProgramFile> {
    let decimals = text::decimals(program, Language::Pdl2.most_decimals());
    let mut lines = vec![format!("PROGRAM {}", program.name)];
    lines.extend(
        text::header(program, Language::Pdl2, WIDTH)
            .iter()
            .map(|line| format!("-- {line}")),
    );
    lines.extend(
        [
            "VAR",
            "  speed_before : INTEGER",
            "BEGIN",
            "  speed_before := $ARM_SPD_OVR",
        ]
        .map(String::from),
    );
    let mut speed = None;
    for step in &program.steps {
        match step {
            Step::Wait(said) => {
                let said = characters::said(said, MESSAGE);
                lines.extend(
                    said.iter()
                        .map(|line| format!("  WRITE LUN_CRT ('{line}', NL)")),
                );
                lines.push("  PAUSE".to_string());
            }
            Step::Move(target) => {
                lines.push(format!(
                    "  -- {}",
                    text::marker(target.kind, &target.name, NAME)
                ));
                if speed != Some(target.speed_percent) {
                    lines.push(format!("  $ARM_SPD_OVR := {}", target.speed_percent));
                    speed = Some(target.speed_percent);
                }
                let values = text::degrees(&target.q, options, decimals);
                lines.push(format!("  MOVE JOINT TO {{{}}}", values.join(", ")));
            }
        }
    }
    lines.push("  $ARM_SPD_OVR := speed_before".to_string());
    lines.push(format!("END {}", program.name));
    vec![ProgramFile {
        name: format!("{}.pdl", program.name),
        text: text::joined(&lines, "\r\n"),
    }]
}

/// Reads a program.
pub fn read(file: &ProgramFile, options: &ProgramOptions, joints: usize) -> Result<Program> {
    let mut steps = Steps::default();
    let (mut name, mut speed) = (String::new(), 100);
    for mut line in lines(file) {
        if line.passes("--") {
            steps.comment(line.rest());
        } else if line.word("PROGRAM") {
            name = line.identifier()?.to_string();
        } else if line.word("$ARM_SPD_OVR") {
            line.expect(":=")?;
            if !line.word("speed_before") {
                speed = line.percent()?;
            }
        } else if line.word("WRITE") {
            line.word("LUN_CRT");
            line.expect("(")?;
            steps.say(line.quoted('\'')?);
        } else if line.word("PAUSE") {
            line.end()?;
            steps.wait();
        } else if line.word("MOVEFLY") {
            return Err(line.wrong("The move does not end at rest (MOVE).".to_string()));
        } else if line.word("MOVE") {
            let place = line.clone();
            if line.word("LINEAR") || line.word("CIRCULAR") {
                return Err(place
                    .clone()
                    .space()
                    .wrong("Only joint moves can be read (MOVE JOINT TO).".to_string()));
            }
            line.word("JOINT");
            line.expect("TO")?;
            let values = angles(&mut line, joints)?;
            line.end()?;
            steps.go(options.to_cell(&values), speed);
        }
    }
    Ok(Program {
        name,
        header: Vec::new(),
        steps: steps.done(),
    })
}

/// `{1.0, 2.0, …}`.
fn angles(line: &mut Cursor<'_>, joints: usize) -> Result<Vec<f64>> {
    line.expect("{")?;
    let mut values = Vec::with_capacity(joints);
    for joint in 0..joints {
        if joint > 0 {
            line.expect(",")?;
        }
        values.push(line.angle()?);
    }
    line.expect("}")?;
    Ok(values)
}
