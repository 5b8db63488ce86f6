//! Paths in FANUC TP: moves, and which tool and user frame they take.

use super::cursor::Cursor;
use super::move_target::{Motion, MoveTarget};
use super::reader::Reader;
use stiffarm::error::Result;

/// What names the tool (0) and the user frame (1): the number that is active, and the frames.
const FRAMES: [[&str; 2]; 2] = [["UTOOL_NUM", "UTOOL"], ["UFRAME_NUM", "UFRAME"]];

/// Whether the letter of a move stands here without a position behind it: German controllers write outputs as
/// `A[1]=ON`.
pub fn is_no_move(line: &Cursor<'_>) -> bool {
    let mut line = line.clone();
    let is_letter = ["J", "L", "C", "A", "S"].iter().any(|word| line.word(word));
    is_letter && !line.clone().passes("P[") && !line.passes("PR[")
}

/// A statement of a path.
pub fn path_statement<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    for (number, [active, frame]) in FRAMES.iter().enumerate() {
        let mut next = line.clone();
        if next.word(active) && next.passes("=") {
            let name = next.rest().trim().trim_end_matches(';').trim();
            reader.takes(number, format!("{frame}[{name}]"), line.line_number());
            return Ok(true);
        }
        let set = line.assigned().filter(|_| line.clone().word(frame));
        if let Some((name, _)) = set {
            sets_frame(line, number, name, reader);
            return Ok(true);
        }
    }
    if line.clone().word("PR") {
        sets_register(line, reader);
        return Ok(true);
    }
    path_move(line, reader)
}

/// `UFRAME[1]=PR[9]`: followed where the program has set all numbers of the register to stated ones.
fn sets_frame<'a>(line: &Cursor<'a>, number: usize, name: String, reader: &mut Reader<'a>) {
    let (_, value) = line.rest().split_once('=').unwrap_or_default();
    let register = value.trim().trim_end_matches(';').trim().to_ascii_uppercase();
    let stated = reader.registers.get(&register);
    let stated = stated.filter(|numbers| numbers.iter().take(6).all(Option::is_some));
    match stated.map(|numbers| *reader.pose(*numbers, line)) {
        Some(pose) => {
            reader.frames.insert(name.clone(), vec![pose]);
            // The moves that come take it as it is now, if they took it before.
            let is_taken = reader.taken[number].as_ref().is_some_and(|taken| taken.name == name);
            if is_taken {
                reader.takes(number, name, line.line_number());
            }
        }
        None => reader.sets(line, name),
    }
}

/// `PR[9,1]=807.7`; any other value makes the register unknown.
fn sets_register<'a>(line: &Cursor<'a>, reader: &mut Reader<'a>) {
    let Some((name, value)) = line.rest().split_once('=') else {
        return;
    };
    let name = name.trim().to_ascii_uppercase();
    let inner = name.trim_start_matches("PR[").trim_end_matches(']');
    let (register, component) = inner.split_once(',').unwrap_or((inner, ""));
    let key = format!("PR[{}]", register.trim());
    let mut at = line.clone();
    at.skip(line.rest().len() - value.len());
    let number = at.placed().ok().filter(|_| at.passes(";"));
    match (component.trim().parse::<usize>(), number) {
        (Ok(component @ 1..=6), Some(number)) => {
            let numbers = reader.registers.entry(key).or_insert([None; 7]);
            numbers[component - 1] = Some(number);
        }
        _ => {
            reader.registers.remove(&key);
        }
    }
}

/// What moves a position of a tool path.
const CALCULATED: [&str; 7] = ["PR[", "Offset", "Tool_Offset", "INC", "VOFFSET", "VOFF", "Search"];

/// The path moves with a positioner; the move may end early; the wrist turns as its joints do.
const PASSED_OVER: [&str; 4] = ["COORD", "Skip", "Wjnt", "RTCP"];

/// Units of feeds \[m/s\].
const UNITS: [(&str, f64); 3] = [("mm/sec", 1e-3), ("cm/min", 1e-2 / 60.0), ("inch/min", 25.4e-3 / 60.0)];

/// A move of a tool path. The end of an arc stands in a line of its own.
fn path_move<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    let place = line.clone();
    if let Some((start, via)) = reader.arc.take() {
        let target = move_target(line, reader)?;
        reader.moves(start, Motion::Circular, Some(via), target);
        reader.at_feed(feed(line));
        return Ok(true);
    }
    let words = [("L", Motion::Linear), ("J", Motion::Joint), ("C", Motion::Circular)];
    let Some(motion) = line.motion(&words) else {
        return Ok(false);
    };
    let target = move_target(line, reader)?;
    match motion {
        Motion::Circular => reader.arc = Some((place, target)),
        _ => {
            reader.moves(place, motion, None, target);
            reader.at_feed(feed(line));
        }
    }
    Ok(true)
}

/// The point of a move, and what is said of the words behind it.
fn move_target<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<MoveTarget<'a>> {
    let mut place = line.clone();
    let is_register = line.clone().passes("PR[");
    let label = if is_register { String::new() } else { point(line)? };
    if let Some(word) = CALCULATED.iter().find(|word| line.behind(word).is_some()) {
        return Err(place.wrong_here(format!(
            "This move is calculated by the controller ({word}): only stated positions are read."
        )));
    }
    for word in PASSED_OVER {
        if line.behind(word).is_some() {
            reader.passes_over(line, word);
        }
    }
    Ok(MoveTarget::Label(place, label))
}

/// The feed that stands behind the point, `100mm/sec` \[m/s\].
fn feed(line: &Cursor<'_>) -> Option<f64> {
    let mut line = line.clone();
    let number = line.number().ok()?;
    let (_, unit) = UNITS.iter().find(|(name, _)| line.passes(name))?;
    Some(number * unit)
}

/// `P[1]`, with or without a comment.
pub fn point(line: &mut Cursor<'_>) -> Result<String> {
    line.expect("P[")?;
    let label = label(line)?;
    if line.passes(":") {
        line.skip(line.rest().find(']').unwrap_or(0));
    }
    line.expect("]")?;
    Ok(label)
}

/// `P[` and the number of a point.
pub fn label(line: &mut Cursor<'_>) -> Result<String> {
    let place = line.clone();
    let number = line.number()?;
    if number >= 1.0 && number.fract() == 0.0 && number <= 1e6 {
        Ok(format!("P[{number}]"))
    } else {
        Err(place.wrong("This is not the number of a point."))
    }
}
