//! Paths in FANUC TP: moves, and which tool and user frame they take.

use super::aims::{Aim, Motion};
use super::cursor::Cursor;
use super::ls::point;
use super::reader::{Reader, leading};
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
            reader.sets(line, name);
            return Ok(true);
        }
    }
    path_move(line, reader)
}

/// What moves a position of a tool path.
const CALCULATED: [&str; 9] = [
    "PR[",
    " Offset",
    " OFFSET",
    "Tool_Offset",
    "TOOL_OFFSET",
    " INC",
    "VOFFSET",
    " VOFF",
    "SEARCH",
];

/// A move of a tool path. The end of an arc stands in a line of its own.
fn path_move<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    let place = line.clone();
    if let Some((start, via)) = reader.arc.take() {
        let aim = Aim::Label(place, point(line)?);
        reader.moves(start, Motion::Circular, Some(via), aim);
        reader.at_feed(feed(line.rest()));
        return Ok(true);
    }
    let words = [
        ("L", Motion::Linear),
        ("J", Motion::Joint),
        ("C", Motion::Circular),
    ];
    let Some(motion) = line.motion(&words) else {
        return Ok(false);
    };
    if let Some(word) = CALCULATED.iter().find(|word| line.rest().contains(**word)) {
        return Err(line.wrong_here(format!(
            "This move is calculated by the controller ({}): only stated positions are read.",
            word.trim()
        )));
    }
    let aim = Aim::Label(line.clone(), point(line)?);
    // The path moves with a positioner; the move may end early; the wrist turns as its joints do.
    for word in ["COORD", "Skip", "SKIP", "Wjnt", "WJNT", "RTCP"] {
        if line.rest().contains(&format!(" {word}")) {
            reader.passes_over(line, word);
        }
    }
    match motion {
        Motion::Circular => reader.arc = Some((place, aim)),
        _ => {
            reader.moves(place, motion, None, aim);
            reader.at_feed(feed(line.rest()));
        }
    }
    Ok(true)
}

/// The feed that stands behind the point, `100mm/sec` \[m/s\].
fn feed(rest: &str) -> Option<f64> {
    let units = [
        ("mm/sec", 1e-3),
        ("cm/min", 1e-2 / 60.0),
        ("inch/min", 25.4e-3 / 60.0),
    ];
    let rest = rest.trim_start();
    let unit = rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
    let mut units = units.iter();
    let (_, unit) = units.find(|(name, _)| unit.trim_start().starts_with(name))?;
    Some(leading(rest)? * unit)
}
