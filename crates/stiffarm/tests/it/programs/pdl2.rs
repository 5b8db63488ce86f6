//! PDL2 programs are one program whose variable is declared, set, and used.

use super::grammar::{Checked, Parsed, Tokens, holds, lines, name, only};
use stiffarm_files::program::ProgramFile;

pub fn check(files: &[ProgramFile], joints: usize) -> Checked {
    let file = only(files)?;
    let program = file.name.strip_suffix(".pdl").ok_or("pdl")?;
    name(program, 32)?;
    let lines = lines(file, "\r\n", 120)?;
    let code: Vec<&str> = lines.iter().map(|line| line.trim_start()).filter(|line| !line.starts_with("--")).collect();
    let head =
        [&format!("PROGRAM {program}"), "VAR", "speed_before : INTEGER", "BEGIN", "speed_before := $ARM_SPD_OVR"];
    let tail = ["$ARM_SPD_OVR := speed_before", &format!("END {program}")];
    let middle = code.strip_prefix(&head[..]).ok_or("head")?;
    let middle = middle.strip_suffix(&tail[..]).ok_or("end")?;
    let mut parsed = Parsed::default();
    let (mut speed, mut said) = (None, Vec::new());
    for line in middle {
        let mut tokens = Tokens::of(line, '\'')?;
        match tokens.any_word()?.as_str() {
            "$ARM_SPD_OVR" => {
                tokens.signs(":=")?;
                let value = tokens.number(0, 0)?;
                holds((1.0..=100.0).contains(&value), "override")?;
                speed = Some(value);
            }
            "WRITE" => {
                tokens.word("LUN_CRT")?;
                tokens.signs("(")?;
                said.push(tokens.text(40)?);
                tokens.signs(",")?;
                tokens.word("NL")?;
                tokens.signs(")")?;
            }
            "PAUSE" => {
                holds(!said.is_empty(), "PAUSE without a text")?;
                parsed.waits.push(said.join(" "));
                said.clear();
            }
            "MOVE" => {
                holds(said.is_empty(), "a text without PAUSE")?;
                tokens.word("JOINT")?;
                tokens.word("TO")?;
                tokens.signs("{")?;
                let mut values = Vec::new();
                for joint in 0..joints {
                    if joint > 0 {
                        tokens.signs(",")?;
                    }
                    values.push(tokens.number(2, 4)?);
                }
                tokens.signs("}")?;
                parsed.moves.push((values, speed.ok_or("no speed")?));
            }
            other => return Err(other.to_string()),
        }
        tokens.end()?;
    }
    holds(said.is_empty(), "a text without PAUSE")?;
    Ok(parsed)
}
