//! Universal Robots' URScript: a function in a `.script`.
//!
//! Grammar: Universal Robots, *The URScript Programming Language* (G5 and e-Series, 2009–2021): `movej(q, a, v)`
//! takes six joint angles in radians, an acceleration in rad/s² and the speed of the leading joint in
//! rad/s; without a blend radius it ends at rest. `popup(…, blocking=True)` waits until it is
//! confirmed. Comments begin with `#`.
//!
//! LF: the controller runs Linux.

use super::characters;
use super::cursor::{Cursor, Steps, lines};
use super::{Language, Program, ProgramFile, ProgramOptions, Step, text};
use crate::error::Result;
use crate::units::{deg_to_rad, rad_to_deg};

const WIDTH: usize = 76;
const NAME: usize = 60;
/// Speed at 100 per cent \[deg/s\], that of `movej` where none is stated.
const FULL_SPEED: f64 = 60.0;
/// \[rad/s²\]; `movej` has 1.4 where none is stated.
const ACCELERATION: f64 = 0.5;
/// Decimals of an angle in radians: a hundredth of the last digit of degrees.
const DECIMALS: usize = 8;

/// The function.
pub fn write(program: &Program) -> Vec<ProgramFile> {
    let decimals = text::decimals(program, Language::Urscript.most_decimals());
    // One that does not round differently from the degrees that stand beside it.
    let rounded = |angle: f64| {
        deg_to_rad(
            text::fixed(rad_to_deg(angle), decimals)
                .parse()
                .unwrap_or(rad_to_deg(angle)),
        )
    };
    let mut lines = vec![format!("def {}():", program.name)];
    lines.extend(
        text::header(program, Language::Urscript, WIDTH)
            .iter()
            .map(|line| format!("  # {line}")),
    );
    for step in &program.steps {
        match step {
            Step::Wait(said) => {
                lines.push(format!(
                    "  popup(\"{}\", title=\"stiffarm\", blocking=True)",
                    characters::said(said, usize::MAX).concat()
                ));
            }
            Step::Move(target) => {
                lines.push(format!(
                    "  # {}",
                    text::marker(target.kind, &target.name, NAME)
                ));
                let degrees = text::degrees(&target.q, &ProgramOptions::default(), decimals);
                lines.push(format!("  # [{}] deg", degrees.join(", ")));
                let radians: Vec<String> = target
                    .q
                    .iter()
                    .map(|a| text::fixed(rounded(*a), DECIMALS))
                    .collect();
                let speed = deg_to_rad(FULL_SPEED) * f64::from(target.speed_percent) / 100.0;
                lines.push(format!(
                    "  movej([{}], a={ACCELERATION}, v={speed:.4})",
                    radians.join(", ")
                ));
            }
        }
    }
    lines.push("end".to_string());
    vec![ProgramFile {
        name: format!("{}.script", program.name),
        text: text::joined(&lines, "\n"),
    }]
}

/// Reads a function.
pub fn read(file: &ProgramFile, joints: usize) -> Result<Program> {
    let mut steps = Steps::default();
    let mut name = String::new();
    for mut line in lines(file) {
        if line.passes("#") {
            steps.comment(line.rest());
        } else if line.word("def") {
            name = line.identifier()?.to_string();
        } else if line.word("popup") {
            line.expect("(")?;
            steps.say(line.quoted('"')?);
            if line.rest().contains("blocking=True") {
                steps.wait();
            }
        } else if line.word("movej") {
            line.expect("(")?;
            let q = angles(&mut line, joints)?;
            let mut speed = 100;
            while line.passes(",") {
                speed = parameter(&mut line)?.unwrap_or(speed);
            }
            line.expect(")")?;
            line.end()?;
            steps.go(q, speed);
        } else {
            let others = ["movel", "movep", "movec", "servoj", "speedj"];
            if let Some(word) = others.iter().find(|word| line.clone().word(word)) {
                return Err(line
                    .space()
                    .wrong(format!("{word} is no joint move (movej).")));
            }
        }
    }
    Ok(Program {
        name,
        header: Vec::new(),
        steps: steps.done(),
    })
}

/// `a=…`, or `v=…` as a speed in per cent.
fn parameter(line: &mut Cursor<'_>) -> Result<Option<u8>> {
    let place = line.clone();
    let key = line.identifier()?;
    line.expect("=")?;
    let value = line.number()?;
    match key {
        "v" => {
            let percent = (rad_to_deg(value) / FULL_SPEED * 100.0).round();
            match (1.0..=100.0).contains(&percent) {
                true => Ok(Some(percent as u8)),
                false => Err(place.clone().space().wrong(format!(
                    "The speed must lie between 1 and 100 per cent of {FULL_SPEED} deg/s."
                ))),
            }
        }
        "a" => Ok(None),
        "t" | "r" if value == 0.0 => Ok(None),
        _ => Err(place.clone().space().wrong(format!(
            "`{key}` is not read here: the move has a time, or does not end at rest."
        ))),
    }
}

/// `[0.1, 0.2, …]` in radians.
fn angles(line: &mut Cursor<'_>, joints: usize) -> Result<Vec<f64>> {
    line.expect("[")?;
    let mut values = Vec::with_capacity(joints);
    for joint in 0..joints {
        if joint > 0 {
            line.expect(",")?;
        }
        let place = line.clone();
        let angle = line.number()?;
        if angle.abs() > 1e3 {
            return Err(place.wrong("This is no angle of a joint in radians.".to_string()));
        }
        values.push(angle);
    }
    line.expect("]")?;
    Ok(values)
}
