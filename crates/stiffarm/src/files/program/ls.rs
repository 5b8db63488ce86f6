//! FANUC teach pendant program as text: `.ls`.
//!
//! Grammar: listings that R-30iA and R-30iB controllers write (public examples:
//! github.com/mitchtown98/FANUC_LS_Examples, github.com/WILDER-SYSTEMS-LLC/git-ftp) and FANUC, *R-30iB
//! HandlingTool Setup and Operations Manual*: a remark has at most 32 characters, a message 24, the
//! comment of a position 16; `PAUSE` waits for the start key. Positions are in joint representation,
//! three decimals; axes beyond the sixth of the group are E1 to E3. `FINE` ends a move at rest. The
//! dates of the head are constants, so that equal plans give equal bytes.
//!
//! CR LF, as the controller writes.

use super::characters;
use super::cursor::{Cursor, Steps, lines};
use super::{Language, Program, ProgramFile, ProgramOptions, Step, text};
use crate::error::Result;
use std::collections::HashMap;

/// Characters of a remark.
const WIDTH: usize = 32;
const MESSAGE: usize = 24;
/// Of a name in a remark, after `posture `.
const NAME: usize = 24;
/// The tool frame where none is given.
const TOOL: &str = "1";

/// The listing.
pub fn write(program: &Program, options: &ProgramOptions) -> Vec<ProgramFile> {
    let decimals = text::decimals(program, Language::Ls.most_decimals());
    let tool = options.tool.as_deref().unwrap_or(TOOL);
    let mut body: Vec<String> = Vec::new();
    let remark = |said: &str| format!("  !{said} ;");
    body.extend(
        text::header(program, Language::Ls, WIDTH)
            .iter()
            .map(|line| remark(line)),
    );
    body.push("  UFRAME_NUM=0 ;".to_string());
    body.push(format!("  UTOOL_NUM={tool} ;"));
    let mut points = Vec::new();
    let mut moves = 0;
    for step in &program.steps {
        match step {
            Step::Wait(said) => {
                body.extend(
                    characters::said(said, MESSAGE)
                        .iter()
                        .map(|line| format!("  MESSAGE[{line}] ;")),
                );
                body.push("  PAUSE ;".to_string());
            }
            Step::Move(target) => {
                moves += 1;
                body.push(remark(&text::marker(target.kind, &target.name, NAME)));
                body.push(format!("J P[{moves}] {}% FINE ;", target.speed_percent));
                points.push(format!("P[{moves}]{{"));
                points.push("   GP1:".to_string());
                points.push(format!("\tUF : 0, UT : {tool},"));
                let values = text::degrees(&target.q, options, decimals);
                let named = values.iter().enumerate();
                let fields: Vec<String> = named
                    .map(|(axis, value)| {
                        format!("{}= {value:>9} deg", Language::Ls.axis_name(axis))
                    })
                    .collect();
                let rows: Vec<String> = fields
                    .chunks(3)
                    .map(|row| format!("\t{}", row.join(",\t")))
                    .collect();
                let last = rows.len() - 1;
                points.extend(rows.iter().take(last).map(|row| format!("{row},")));
                points.extend(rows.last().cloned());
                points.push("};".to_string());
            }
        }
    }
    let count = body.len();
    let mut lines = head(&program.name, count);
    let numbered = body.iter().enumerate();
    lines.extend(numbered.map(|(i, line)| format!("{:4}:{line}", i + 1)));
    lines.push("/POS".to_string());
    lines.extend(points);
    lines.push("/END".to_string());
    vec![ProgramFile {
        name: format!("{}.ls", program.name.to_ascii_lowercase()),
        text: text::joined(&lines, "\r\n"),
    }]
}

fn head(name: &str, count: usize) -> Vec<String> {
    let mut lines = vec![format!("/PROG  {name}"), "/ATTR".to_string()];
    lines.extend(
        [
            "OWNER\t\t= MNEDITOR;",
            "COMMENT\t\t= \"stiffarm plan\";",
            "PROG_SIZE\t= 0;",
            "CREATE\t\t= DATE 00-01-01  TIME 00:00:00;",
            "MODIFIED\t= DATE 00-01-01  TIME 00:00:00;",
            "FILE_NAME\t= ;",
            "VERSION\t\t= 0;",
        ]
        .map(String::from),
    );
    lines.push(format!("LINE_COUNT\t= {count};"));
    lines.extend(
        [
            "MEMORY_SIZE\t= 0;",
            "PROTECT\t\t= READ_WRITE;",
            "TCD:  STACK_SIZE\t= 0,",
            "      TASK_PRIORITY\t= 50,",
            "      TIME_SLICE\t= 0,",
            "      BUSY_LAMP_OFF\t= 0,",
            "      ABORT_REQUEST\t= 0,",
            "      PAUSE_REQUEST\t= 0;",
            "DEFAULT_GROUP\t= 1,*,*,*,*;",
            "CONTROL_CODE\t= 00000000 00000000;",
            "/MN",
        ]
        .map(String::from),
    );
    lines
}

/// Reads a listing.
pub fn read(file: &ProgramFile, options: &ProgramOptions, joints: usize) -> Result<Program> {
    let points = points(file, options, joints)?;
    let mut steps = Steps::default();
    let (mut name, mut in_body) = (String::new(), false);
    for mut line in lines(file) {
        if line.word("/PROG") {
            name = line.identifier()?.to_string();
        } else if line.word("/MN") {
            in_body = true;
        } else if line.word("/POS") {
            break;
        } else if in_body && !line.is_done() {
            // The number of the line; a long instruction goes on without one.
            if line.number().is_ok() || line.passes(":") {
                line.passes(":");
            }
            statement(&mut line, &points, &mut steps)?;
        }
    }
    Ok(Program {
        name,
        header: Vec::new(),
        steps: steps.done(),
    })
}

fn statement(
    line: &mut Cursor<'_>,
    points: &HashMap<u64, Vec<f64>>,
    steps: &mut Steps,
) -> Result<()> {
    if line.passes("!") {
        steps.comment(line.rest().trim_end().trim_end_matches(';'));
    } else if line.passes("MESSAGE[") {
        let rest = line.rest();
        let end = rest
            .find(']')
            .ok_or_else(|| line.wrong("The `]` of this message is missing.".to_string()))?;
        steps.say(&rest[..end]);
    } else if line.word("PAUSE") {
        steps.wait();
    } else if line.word("J") {
        let place = line.clone();
        line.expect("P[")?;
        let number = index(line)?;
        if line.passes(":") {
            let rest = line.rest();
            let end = rest.find(']').unwrap_or(0);
            for _ in 0..rest[..end].chars().count() {
                line.step();
            }
        }
        line.expect("]")?;
        let found = points.get(&number);
        let wrong = || {
            place
                .clone()
                .space()
                .wrong(format!("/POS has no P[{number}]."))
        };
        let q = found.cloned().ok_or_else(wrong)?;
        let speed = line.percent()?;
        line.expect("%")?;
        if !line.word("FINE") {
            return Err(line
                .space()
                .wrong("The move does not end at rest (FINE).".to_string()));
        }
        line.expect(";")?;
        steps.go(q, speed);
    } else {
        let others = ["L", "C", "A", "S"];
        if let Some(word) = others.iter().find(|word| line.clone().word(word)) {
            let message = format!("{word} is no joint move (J).");
            return Err(line.space().wrong(message));
        }
    }
    Ok(())
}

/// The number of a point.
fn index(line: &mut Cursor<'_>) -> Result<u64> {
    let place = line.clone();
    let number = line.number()?;
    match number >= 1.0 && number.fract() == 0.0 && number <= 1e6 {
        true => Ok(number as u64),
        false => Err(place.wrong("This is no number of a point.".to_string())),
    }
}

/// The positions of `/POS` by number.
fn points(
    file: &ProgramFile,
    options: &ProgramOptions,
    joints: usize,
) -> Result<HashMap<u64, Vec<f64>>> {
    let mut points = HashMap::new();
    let mut open: Option<(u64, Cursor<'_>, Vec<Option<f64>>)> = None;
    let mut in_points = false;
    for mut line in lines(file) {
        if line.word("/POS") {
            in_points = true;
        } else if line.word("/END") {
            break;
        } else if !in_points || line.is_done() {
        } else if line.passes("P[") {
            let place = line.clone();
            let number = index(&mut line)?;
            open = Some((number, place, vec![None; joints]));
        } else if line.passes("}") {
            if let Some((number, place, values)) = open.take() {
                if let Some(axis) = values.iter().position(Option::is_none) {
                    let axis = Language::Ls.axis_name(axis);
                    return Err(place.wrong(format!("P[{number}] has no {axis}.")));
                }
                let values: Vec<f64> = values.into_iter().flatten().collect();
                points.insert(number, options.to_cell(&values));
            }
        } else if let Some((_, _, values)) = &mut open {
            fields(&mut line, values)?;
        }
    }
    match open {
        Some((number, place, _)) => {
            Err(place.wrong(format!("The `}}` that ends P[{number}] is missing.")))
        }
        None => Ok(points),
    }
}

/// A line within a position: `J1= 10.000 deg,`.
fn fields(line: &mut Cursor<'_>, values: &mut [Option<f64>]) -> Result<()> {
    if line.word("GP1") || line.word("UF") {
        return Ok(());
    }
    while !line.is_done() {
        let field = line.clone();
        let axis = line.identifier()?.to_ascii_uppercase();
        let Some(known) = (0..9).find(|i| Language::Ls.axis_name(*i) == axis) else {
            let message = format!(
                "`{axis}` is no joint: only positions in joint representation can be read."
            );
            return Err(field.clone().space().wrong(message));
        };
        line.expect("=")?;
        let value = line.angle()?;
        let unit = line.word("deg");
        match values.get_mut(known) {
            Some(value_of) if unit => *value_of = Some(value),
            Some(_) => return Err(line.space().wrong("`deg` is missing here.".to_string())),
            // Further axes of the group are none of the cell's.
            None => {
                line.word("mm");
            }
        }
        if !line.passes(",") {
            line.end()?;
        }
    }
    Ok(())
}
