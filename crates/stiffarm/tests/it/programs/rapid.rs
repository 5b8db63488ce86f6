//! RAPID programs are one module with its jointtargets and one procedure.

use super::grammar::{Checked, Parsed, Tokens, holds, lines, name, only};
use stiffarm_files::program::ProgramFile;

pub fn check(files: &[ProgramFile], joints: usize) -> Checked {
    let file = only(files)?;
    let program = file.name.strip_suffix(".mod").ok_or("mod")?;
    let lines = lines(file, "\r\n", 140)?;
    holds(lines[0] == format!("MODULE {program}"), "MODULE")?;
    name(program, 32)?;
    name(&format!("{program}_run"), 32)?;
    holds(lines.last() == Some(&"ENDMODULE"), "ENDMODULE")?;
    let mut parsed = Parsed::default();
    let mut points: Vec<Vec<f64>> = Vec::new();
    // 0 before PROC, 1 in it, 2 after it.
    let (mut part, mut speed, mut said, mut tool) = (0, None, Vec::new(), None);
    for line in &lines[1..lines.len() - 1] {
        if line.trim_start().starts_with('!') {
            continue;
        }
        let mut tokens = Tokens::of(line, '"')?;
        let first = tokens.any_word()?;
        match (part, first.as_str()) {
            (0, "LOCAL") => {
                tokens.word("CONST")?;
                tokens.word("jointtarget")?;
                tokens.word(&format!("jp{}", points.len() + 1))?;
                tokens.signs(":=[[")?;
                points.push(target(&mut tokens, joints)?);
                tokens.signs(";")?;
            }
            (0, "PROC") => {
                tokens.word(&format!("{program}_run"))?;
                tokens.signs("()")?;
                part = 1;
            }
            (1, "ENDPROC") => {
                // The speed that others programmed with comes back.
                holds(speed == Some((100.0, 5000.0)), "VelSet at the end")?;
                part = 2;
            }
            (1, "VelSet") => {
                let percent = tokens.number(0, 0)?;
                tokens.signs(",")?;
                speed = Some((percent, tokens.number(0, 0)?));
                tokens.signs(";")?;
            }
            (1, "TPWrite") => {
                said.push(tokens.text(40)?);
                tokens.signs(";")?;
            }
            (1, "Stop") => {
                tokens.signs(";")?;
                holds(!said.is_empty(), "Stop without a text")?;
                parsed.waits.push(said.join(" "));
                said.clear();
            }
            (1, "MoveAbsJ") => {
                let number = parsed.moves.len();
                tokens.word(&format!("jp{}", number + 1))?;
                let q = points.get(number).ok_or("a point that is not declared")?;
                tokens.signs(",")?;
                tokens.word("v1000")?;
                tokens.signs(",")?;
                tokens.word("fine")?;
                tokens.signs(",")?;
                let used = tokens.any_word()?;
                holds(*tool.get_or_insert(used.clone()) == used, "another tool")?;
                tokens.signs(";")?;
                let (percent, most) = speed.ok_or("no speed")?;
                holds(most == 1000.0 && said.is_empty(), "speed, or a text without Stop")?;
                parsed.moves.push((q.clone(), percent));
            }
            _ => return Err(line.to_string()),
        }
        tokens.end()?;
    }
    holds(part == 2, "PROC and ENDPROC")?;
    holds(points.len() == parsed.moves.len(), "a point that is not used")?;
    Ok(parsed)
}

/// After `[[`: six angles, six external axes, `9E9` for those that are not there.
fn target(tokens: &mut Tokens, joints: usize) -> Checked<Vec<f64>> {
    let mut values = Vec::new();
    for axis in 0..12 {
        match axis {
            0 => {}
            6 => tokens.signs("],[")?,
            _ => tokens.signs(",")?,
        }
        if axis < joints { values.push(tokens.number(2, 4)?) } else { tokens.exactly("9E9")? }
    }
    tokens.signs("]]")?;
    Ok(values)
}
