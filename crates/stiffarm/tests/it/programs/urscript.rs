//! URScript programs are one function; angles in radians come back as degrees, speeds as per cent of 60 deg/s.

use super::grammar::{Checked, Parsed, Tokens, holds, lines, name, only};
use stiffarm_files::program::ProgramFile;

pub fn check(files: &[ProgramFile], joints: usize) -> Checked {
    let file = only(files)?;
    let program = file.name.strip_suffix(".script").ok_or("script")?;
    name(program, 60)?;
    let lines = lines(file, "\n", 400)?;
    holds(lines[0] == format!("def {program}():"), "def")?;
    holds(lines.last() == Some(&"end"), "end")?;
    let mut parsed = Parsed::default();
    for line in &lines[1..lines.len() - 1] {
        let line = line.strip_prefix("  ").filter(|l| !l.starts_with(' ')).ok_or("indent")?;
        if line.starts_with("# ") {
            continue;
        }
        let mut tokens = Tokens::of(line, '"')?;
        match tokens.any_word()?.as_str() {
            "popup" => {
                tokens.signs("(")?;
                parsed.waits.push(tokens.text(1000)?);
                tokens.signs(",")?;
                tokens.word("title")?;
                tokens.signs("=")?;
                tokens.text(20)?;
                tokens.signs(",")?;
                tokens.word("blocking")?;
                tokens.signs("=")?;
                tokens.word("True")?;
                tokens.signs(")")?;
            }
            "movej" => {
                tokens.signs("([")?;
                let mut values = Vec::new();
                for joint in 0..joints {
                    if joint > 0 {
                        tokens.signs(",")?;
                    }
                    values.push(tokens.number(8, 8)?.to_degrees());
                }
                tokens.signs("],")?;
                tokens.word("a")?;
                tokens.signs("=")?;
                let acceleration = tokens.number(1, 2)?;
                tokens.signs(",")?;
                tokens.word("v")?;
                tokens.signs("=")?;
                let speed = tokens.number(4, 4)?.to_degrees() / 0.6;
                tokens.signs(")")?;
                holds(acceleration > 0.0 && speed > 0.5 && speed < 100.1, "speed")?;
                parsed.moves.push((values, speed.round()));
            }
            other => return Err(other.to_string()),
        }
        tokens.end()?;
    }
    Ok(parsed)
}
