//! KRL programs have the head of the controller's template, and each point of the `.dat` is declared and used once.

use super::grammar::{Checked, Parsed, Tokens, holds, lines, name};
use stiffarm_files::program::ProgramFile;

const INI: [&str; 7] = [
    ";FOLD INI",
    ";FOLD BASISTECH INI",
    "GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM ( )",
    "INTERRUPT ON 3",
    "BAS (#INITMOV,0)",
    ";ENDFOLD (BASISTECH INI)",
    ";ENDFOLD (INI)",
];

pub fn check(files: &[ProgramFile], joints: usize) -> Checked {
    let [src, dat] = files else {
        return Err("two files".to_string());
    };
    let program = src.name.strip_suffix(".src").ok_or("src")?;
    holds(dat.name == format!("{program}.dat"), "the names of the files")?;
    name(program, 24)?;
    let points = data(dat, program, joints)?;
    let lines = lines(src, "\r\n", 100)?;
    let mut rest = lines.iter().copied();
    for wanted in ["&ACCESS RVP", "&REL 1", &format!("DEF {program} ( )")] {
        holds(rest.next() == Some(wanted), wanted)?;
    }
    let mut next = rest.next();
    while next.is_some_and(|line| line.starts_with("; ")) {
        next = rest.next();
    }
    for wanted in INI {
        holds(next == Some(wanted), wanted)?;
        next = rest.next();
    }
    let mut parsed = Parsed::default();
    let (mut speed, mut said, mut waiting, mut ended) = (None, Vec::new(), false, false);
    while let Some(line) = next {
        next = rest.next();
        holds(!ended, "a line after END")?;
        if line.starts_with("; ") {
            continue;
        }
        let mut tokens = Tokens::of(line, '"')?;
        match tokens.any_word()?.as_str() {
            "WAIT" => {
                holds(!waiting, "WAIT twice")?;
                waiting = true;
                tokens.word("SEC")?;
                tokens.number(0, 0)?;
            }
            "MsgNotify" => {
                holds(waiting, "a message without WAIT SEC 0")?;
                tokens.signs("(")?;
                said.push(tokens.text(80)?);
                tokens.signs(")")?;
            }
            "HALT" => {
                holds(waiting && !said.is_empty(), "HALT without a message")?;
                parsed.waits.push(said.join(" "));
                (waiting, said) = (false, Vec::new());
            }
            "BAS" => {
                tokens.signs("(")?;
                let what = tokens.any_word()?;
                tokens.signs(",")?;
                let value = tokens.number(0, 0)?;
                tokens.signs(")")?;
                match what.as_str() {
                    "#VEL_PTP" if (1.0..=100.0).contains(&value) => speed = Some(value),
                    "#TOOL" if parsed == Parsed::default() => {}
                    _ => return Err(format!("BAS {what} {value}")),
                }
            }
            "PTP" => {
                holds(!waiting, "a move between WAIT and HALT")?;
                let point = tokens.any_word()?;
                let number = parsed.moves.len();
                holds(point == format!("XP{}", number + 1), "the order of points")?;
                let target = points.get(number).ok_or("a point that is not declared")?;
                parsed.moves.push((target.clone(), speed.ok_or("no speed")?));
            }
            "END" => ended = true,
            other => return Err(other.to_string()),
        }
        tokens.end()?;
    }
    holds(ended && !waiting, "no END")?;
    holds(points.len() == parsed.moves.len(), "a point that is not used")?;
    Ok(parsed)
}

fn data(dat: &ProgramFile, program: &str, joints: usize) -> Checked<Vec<Vec<f64>>> {
    let lines = lines(dat, "\r\n", 200)?;
    let head = ["&ACCESS RVP", "&REL 1", &format!("DEFDAT {program}")];
    holds(lines.len() > head.len() && lines[..3] == head, "head of the .dat")?;
    holds(lines.last() == Some(&"ENDDAT"), "ENDDAT")?;
    let mut points = Vec::new();
    let declared = lines[3..lines.len() - 1].iter();
    for line in declared.skip_while(|line| line.starts_with("; ")) {
        let mut tokens = Tokens::of(line, '"')?;
        tokens.word("DECL")?;
        tokens.word("E6AXIS")?;
        tokens.word(&format!("XP{}", points.len() + 1))?;
        tokens.signs("={")?;
        let mut values = Vec::new();
        for joint in 0..joints {
            if joint > 0 {
                tokens.signs(",")?;
            }
            let axis = match joint {
                0..6 => format!("A{}", joint + 1),
                _ => format!("E{}", joint - 5),
            };
            tokens.word(&axis)?;
            values.push(tokens.number(2, 4)?);
        }
        tokens.signs("}")?;
        tokens.end()?;
        points.push(values);
    }
    Ok(points)
}
