//! INFORM jobs have their head in order, positions counted, and instructions between NOP and END.

use super::grammar::{Checked, Parsed, Tokens, holds, lines, name, only};
use stiffarm_files::program::ProgramFile;

pub fn check(files: &[ProgramFile], joints: usize) -> Checked {
    let file = only(files)?;
    let lines = lines(file, "\r\n", 120)?;
    let mut rest = lines.iter().copied();
    let mut next = || rest.next().ok_or_else(|| "the end came too early".to_string());
    holds(next()? == "/JOB", "/JOB")?;
    let program = next()?.strip_prefix("//NAME ").ok_or("//NAME")?;
    name(program, 32)?;
    holds(program == program.to_ascii_uppercase() && file.name == format!("{program}.jbi"), "file name")?;
    holds(next()? == "//POS", "//POS")?;
    let counts = next()?.strip_prefix("///NPOS ").ok_or("///NPOS")?;
    let count: usize = counts.strip_suffix(",0,0,0,0,0").and_then(|n| n.parse().ok()).ok_or("///NPOS")?;
    let tool = next()?.strip_prefix("///TOOL ").ok_or("///TOOL")?;
    holds(tool.parse::<u8>().is_ok_and(|tool| tool < 64), "///TOOL")?;
    holds(next()? == "///POSTYPE PULSE", "///POSTYPE")?;
    holds(next()? == "///PULSE", "///PULSE")?;
    let mut points = Vec::new();
    for number in 0..count {
        let mut tokens = Tokens::of(next()?, '"')?;
        tokens.word(&format!("C{number:05}"))?;
        tokens.signs("=")?;
        let mut pulses = Vec::new();
        for joint in 0..joints {
            if joint > 0 {
                tokens.signs(",")?;
            }
            pulses.push(tokens.number(0, 0)?);
        }
        tokens.end()?;
        points.push(pulses);
    }
    let head = ["//INST", "///DATE 2000/01/01 00:00", "///COMM STIFFARM PLAN", "///ATTR SC,RW", "///GROUP1 RB1", "NOP"];
    for wanted in head {
        holds(next()? == wanted, wanted)?;
    }
    let mut parsed = Parsed::default();
    let mut full: Vec<&str> = Vec::new();
    let mut shown: Option<String> = None;
    loop {
        let line = next()?;
        if line == "END" {
            break;
        }
        if let Some(comment) = line.strip_prefix('\'') {
            holds((1..=32).contains(&comment.len()), comment)?;
            full.extend(comment.strip_prefix("> "));
            continue;
        }
        let mut tokens = Tokens::of(line, '"')?;
        match tokens.any_word()?.as_str() {
            "MSG" => {
                holds(shown.is_none(), "a message over a message")?;
                shown = Some(tokens.text(32)?);
            }
            "PAUSE" => {
                let shown = shown.take().ok_or("PAUSE without a message")?;
                let text = full.join(" ");
                // The first words, as many as fit.
                let left = text.strip_prefix(&shown).ok_or("the message is another")?;
                let next = left.split(' ').nth(1).map_or(32, str::len);
                let full_line =
                    left.is_empty() || shown.len() == 32 || (left.starts_with(' ') && shown.len() + 1 + next > 32);
                holds(full_line, "the message is not the first words")?;
                parsed.waits.push(text);
                full.clear();
            }
            "MOVJ" => {
                holds(shown.is_none() && full.is_empty(), "a text without PAUSE")?;
                let number = parsed.moves.len();
                tokens.word(&format!("C{number:05}"))?;
                tokens.word("VJ")?;
                tokens.signs("=")?;
                let speed = tokens.number(2, 2)?;
                tokens.word("PL")?;
                tokens.signs("=")?;
                tokens.exactly("0")?;
                holds((0.01..=100.0).contains(&speed), "VJ")?;
                let target = points.get(number).ok_or("a position that is not there")?;
                parsed.moves.push((target.clone(), speed));
            }
            other => return Err(other.to_string()),
        }
        tokens.end()?;
    }
    holds(rest.next().is_none(), "lines after END")?;
    holds(points.len() == parsed.moves.len(), "a position that is not used")?;
    Ok(parsed)
}
