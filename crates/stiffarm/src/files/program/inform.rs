//! Yaskawa INFORM: a job `.jbi`.
//!
//! Grammar: Yaskawa Motoman, *Sample Inform Header*
//! (knowledge.motoman.com/hc/en-us/article_attachments/21577948130839): `/JOB`, `//NAME` of at most 32
//! characters, `///NPOS` with the numbers of positions, and *NX100 / DX100 Data Transmission Function*,
//! chapter "Job Data Format": comments of at most 32 characters. `///POSTYPE` is PULSE, BASE, ROBOT,
//! TOOL, USER or MTOOL there: joint positions are encoder pulses, whose number per degree is no
//! public figure and comes from the user. (`///POSTYPE ANGLE` is seen in jobs for external axes;
//! neither manual has it for the arm, so it is not written.) `VJ` is per cent of the largest joint speed, `PL=0` ends a
//! move at rest, `PAUSE` waits for the start button. `MSG` shows one line of 32 characters; the
//! whole text stands in comments before it. On arms of seven axes the order is S, L, U, R, B, T, E.
//!
//! The date of the head is a constant, so that equal plans give equal bytes. CR LF, as the
//! controller writes.

use super::characters;
use super::cursor::{Cursor, Steps, lines};
use super::{Language, Program, ProgramFile, ProgramOptions, Step, text};
use crate::error::Result;
use crate::units::rad_to_deg;
use std::collections::HashMap;

/// Characters of a comment and of a message.
const WIDTH: usize = 32;
/// Of a name in a comment, after `posture `.
const NAME: usize = 24;
/// Begins a comment that is part of a text.
const SAID: &str = "> ";
/// The tool where none is given.
const TOOL: &str = "0";

/// Pulses per degree; [`ProgramOptions::check`] has seen that they are there.
fn pulses(options: &ProgramOptions) -> &[f64] {
    options.pulses_per_degree.as_deref().unwrap_or_default()
}

/// The job.
pub fn write(program: &Program, options: &ProgramOptions) -> Vec<ProgramFile> {
    let scales = pulses(options);
    let mut points = Vec::new();
    let mut body = vec!["NOP".to_string()];
    body.extend(
        text::header(program, Language::Inform, WIDTH)
            .iter()
            .map(|line| format!("'{line}")),
    );
    let axes = scales.iter().enumerate();
    body.extend(axes.map(|(axis, scale)| {
        let line = format!("'pulses/deg {} {scale}", Language::Inform.axis_name(axis));
        line.chars().take(WIDTH + 1).collect()
    }));
    for step in &program.steps {
        match step {
            Step::Wait(said) => {
                let lines = characters::said(said, WIDTH - SAID.len());
                body.extend(lines.iter().map(|line| format!("'{SAID}{line}")));
                let first = characters::said(said, WIDTH);
                body.push(format!("MSG \"{}\"", first[0]));
                body.push("PAUSE".to_string());
            }
            Step::Move(target) => {
                let number = points.len();
                let values = options.to_controller(&target.q);
                let values = values.iter().zip(scales);
                let values: Vec<String> = values
                    .map(|(angle, scale)| text::fixed(rad_to_deg(*angle) * scale, 0))
                    .collect();
                points.push(format!("C{number:05}={}", values.join(",")));
                body.push(format!(
                    "'{}",
                    text::marker(target.kind, &target.name, NAME)
                ));
                body.push(format!(
                    "MOVJ C{number:05} VJ={}.00 PL=0",
                    target.speed_percent
                ));
            }
        }
    }
    body.push("END".to_string());
    let mut lines = vec![
        "/JOB".to_string(),
        format!("//NAME {}", program.name),
        "//POS".to_string(),
    ];
    lines.push(format!("///NPOS {},0,0,0,0,0", points.len()));
    lines.push(format!(
        "///TOOL {}",
        options.tool.as_deref().unwrap_or(TOOL)
    ));
    lines.extend(["///POSTYPE PULSE", "///PULSE"].map(String::from));
    lines.extend(points);
    lines.extend(
        [
            "//INST",
            "///DATE 2000/01/01 00:00",
            "///COMM STIFFARM PLAN",
            "///ATTR SC,RW",
            "///GROUP1 RB1",
        ]
        .map(String::from),
    );
    lines.extend(body);
    vec![ProgramFile {
        name: format!("{}.jbi", program.name),
        text: text::joined(&lines, "\r\n"),
    }]
}

/// Reads a job.
pub fn read(file: &ProgramFile, options: &ProgramOptions, joints: usize) -> Result<Program> {
    let mut steps = Steps::default();
    let mut points: HashMap<String, Vec<f64>> = HashMap::new();
    let (mut name, mut in_body, mut said) = (String::new(), false, false);
    for mut line in lines(file) {
        if line.word("//NAME") {
            name = line.identifier()?.to_string();
        } else if line.word("///POSTYPE") {
            if !line.word("PULSE") {
                return Err(line
                    .space()
                    .wrong("Only positions in pulses can be read (PULSE).".to_string()));
            }
        } else if line.word("//INST") {
            in_body = true;
        } else if line.passes("'") {
            match line.rest().strip_prefix(SAID) {
                Some(text) => {
                    steps.say(text);
                    said = true;
                }
                None => steps.comment(line.rest()),
            }
        } else if line.clone().passes("/") || line.is_done() {
        } else if !in_body {
            point(&mut line, options, joints, &mut points)?;
        } else if line.word("MSG") {
            let text = line.quoted('"')?;
            if !said {
                steps.say(text);
            }
        } else if line.word("PAUSE") {
            steps.wait();
            said = false;
        } else if line.word("MOVJ") {
            let place = line.clone();
            let label = line.identifier()?;
            let found = points.get(&label.to_ascii_uppercase());
            let wrong = || {
                place
                    .clone()
                    .space()
                    .wrong(format!("//POS has no {label}."))
            };
            let q = found.cloned().ok_or_else(wrong)?;
            line.expect("VJ=")?;
            let speed = line.percent()?;
            if line.passes("PL=") && line.number()? != 0.0 {
                return Err(line.wrong("The move does not end at rest (PL=0).".to_string()));
            }
            line.end()?;
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

/// `C00000=1,2,…`; positions of other groups and position variables are passed over.
fn point(
    line: &mut Cursor<'_>,
    options: &ProgramOptions,
    joints: usize,
    points: &mut HashMap<String, Vec<f64>>,
) -> Result<()> {
    let label = line.identifier()?.to_ascii_uppercase();
    if !label.starts_with('C') {
        return Ok(());
    }
    line.expect("=")?;
    let mut values = Vec::with_capacity(joints);
    for (axis, scale) in pulses(options).iter().enumerate() {
        if axis > 0 {
            line.expect(",")?;
        }
        let place = line.clone();
        let degrees = line.number()? / scale;
        if degrees.abs() > 1e5 {
            return Err(place.wrong("These are no pulses of an axis.".to_string()));
        }
        values.push(degrees.to_radians());
    }
    line.end()?;
    points.insert(label, options.to_cell(&values));
    Ok(())
}

/// Refuses moves that are not to joint angles.
fn other_motion(line: &Cursor<'_>) -> Result<()> {
    let others = ["MOVL", "MOVC", "MOVS", "IMOV", "SMOVL"];
    match others.iter().find(|word| line.clone().word(word)) {
        Some(word) => Err(line
            .clone()
            .space()
            .wrong(format!("{word} is no joint move (MOVJ)."))),
        None => Ok(()),
    }
}
