//! Paths in KRL: moves, and which tool and base they take.

use super::ProgramFile;
use super::cursor::{Cursor, lines};
use super::flow::Procedures;
use super::krl_points::{aggregate, declaration, move_target};
use super::move_target::{Motion, MoveTarget};
use super::reader::Reader;
use stiffarm::error::Result;

pub const PROCEDURES: Procedures = Procedures {
    statements: |file: &ProgramFile| lines(file).collect(),
    scopes: &["GLOBAL"],
    begin: &["DEF", "DEFFCT"],
    end: &["END", "ENDFCT"],
    blocks: &[],
    handlers: &[],
    first_is_main: true,
    call,
};

/// The words of moves of a tool path.
const MOVES: [(&str, Motion); 6] = [
    ("PTP", Motion::Joint),
    ("SPTP", Motion::Joint),
    ("LIN", Motion::Linear),
    ("SLIN", Motion::Linear),
    ("CIRC", Motion::Circular),
    ("SCIRC", Motion::Circular),
];

/// What names the tool (0) and the base (1): variables, the first arguments of `BAS`, fields of an FDAT, arrays.
const FRAMES: [[&str; 4]; 2] = [["$TOOL", "#TOOL", "TOOL_NO", "TOOL_DATA"], ["$BASE", "#BASE", "BASE_NO", "BASE_DATA"]];

/// Words before a bracket that are no calls of procedures which may move the robot.
const NO_CALLS: [&str; 23] = [
    "IF",
    "WHILE",
    "UNTIL",
    "SWITCH",
    "CASE",
    "WAIT",
    "FOR",
    "RETURN",
    "PULSE",
    "TRIGGER",
    "INTERRUPT",
    "EXT",
    "EXTFCT",
    "BAS",
    "IR_STOPM",
    "MsgNotify",
    "MsgQuit",
    "MsgDialog",
    "CWRITE",
    "SWRITE",
    "SREAD",
    "SET_CD_PARAMS",
    "CLEAR",
];

/// `name ( … )`.
fn call<'a>(statement: &Cursor<'a>) -> Option<&'a str> {
    let mut line = statement.clone();
    let name = line.identifier().ok()?;
    line.passes("(").then_some(name)
}

/// A number that stands for itself: what is calculated with it, `0.5*V`, is not known.
fn number_alone(line: &mut Cursor<'_>) -> Option<f64> {
    let number = line.number().ok()?;
    (!line.rest().trim_start().starts_with(['*', '/', '+', '-'])).then_some(number)
}

/// A line of a path.
pub fn read<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    if line.word("BAS") {
        line.expect("(")?;
        if line.passes("#VEL_CP") {
            line.expect(",")?;
            reader.feed = number_alone(line);
        }
        let named = |number: usize| line.clone().passes(FRAMES[number][1]);
        if let Some(number) = (0..2).find(|number| named(*number)) {
            let (_, index) = line.rest().split_once(',').unwrap_or_default();
            takes_number(line, number, index.split(')').next().unwrap_or_default(), reader);
        }
    } else if let Some(motion) = line.motion(&MOVES) {
        reader.move_to(line, motion, move_target)?;
        move_ends(line, reader)?;
    } else if line.passes("$VEL.CP") {
        line.expect("=")?;
        reader.feed = number_alone(line);
    } else if let Some((name, is_whole)) = line.assigned() {
        sets(line, &name, is_whole, reader)?;
    } else {
        let mut declared = line.clone();
        while declared.word("DECL") || declared.word("GLOBAL") {}
        if declared.word("FDAT") {
            let name = declared.identifier()?.to_ascii_uppercase();
            if declared.passes("=") {
                reader.forms.insert(name, declared);
            }
            return Ok(true);
        }
        if let Some(name) = call(line) {
            if !NO_CALLS.iter().any(|ignored| ignored.eq_ignore_ascii_case(name)) {
                reader.passes_over(line, &format!("The call of {name}"));
            }
            return Ok(false);
        }
        let mut named = declared.clone();
        if named.word("FRAME") && named.assigned().is_some_and(|(_, is_whole)| is_whole) {
            let (name, _) = named.assigned().unwrap_or_default();
            named.skip(named.rest().find('=').unwrap_or(0));
            stated(&mut named, &name, reader)?;
        }
        return declaration(line, reader, &["E6AXIS", "AXIS", "E6POS", "POS", "FRAME"]);
    }
    Ok(true)
}

/// `… = {X …}`: the frame of this name, if it is stated as a whole.
fn stated<'a>(line: &mut Cursor<'a>, name: &str, reader: &mut Reader<'a>) -> Result<bool> {
    if !line.passes("=") || !line.clone().passes("{") {
        return Ok(false);
    }
    let MoveTarget::Pose(pose) = aggregate(line, reader)? else {
        return Ok(false);
    };
    let is_whole = pose.numbers[..6].iter().all(Option::is_some) && !line.clone().passes(":");
    if is_whole {
        reader.frames.insert(name.to_string(), vec![*pose]);
    }
    Ok(is_whole)
}

/// The program sets a variable.
fn sets<'a>(line: &mut Cursor<'a>, name: &str, is_whole: bool, reader: &mut Reader<'a>) -> Result<()> {
    let number = FRAMES.iter().position(|words| words[0] == name);
    let value = line.rest().split_once('=').map_or("", |(_, value)| value);
    let value = value.split(';').next().unwrap_or_default().trim();
    if name == "$IPO_MODE" || name == "FDAT_ACT" {
        let form_name = value.to_ascii_uppercase();
        let form = reader.forms.get(&form_name).cloned();
        match form {
            _ if !is_whole => {
                for number in 0..2 {
                    reader.takes(number, name, line.line_number());
                }
                reader.sets(line, name);
            }
            Some(form) => takes_form(line, form.rest(), reader)?,
            None if form_name.starts_with('{') || form_name.starts_with('#') => takes_form(line, &form_name, reader)?,
            None => {
                for number in 0..2 {
                    reader.takes(number, form_name.clone(), line.line_number());
                }
            }
        }
    } else if let Some(number) = number {
        let mut after = line.clone();
        after.identifier()?;
        if !is_whole {
            // A part of it: what it is then is not known.
            let part = format!("{name} in part");
            reader.sets(line, part.to_ascii_uppercase());
            reader.takes(number, part, line.line_number());
        } else if stated(&mut after, name, reader)? {
            reader.takes(number, name, line.line_number());
        } else {
            let other: String = value.split_whitespace().collect();
            reader.takes(number, other, line.line_number());
        }
    } else {
        let mut after = line.clone();
        after.skip(after.rest().find('=').unwrap_or(0));
        let is_frame = FRAMES.iter().any(|words| name.starts_with(&format!("{}[", words[3])));
        let is_frame = is_frame || reader.frames.contains_key(name);
        if !(is_frame && is_whole && stated(&mut after, name, reader)?) {
            reader.forms.remove(name);
            reader.sets(line, name);
        }
    }
    Ok(())
}

/// `{TOOL_NO 1,BASE_NO 3,IPO_FRAME #BASE}`, or the last alone.
fn takes_form<'a>(line: &Cursor<'a>, form: &str, reader: &mut Reader<'a>) -> Result<()> {
    let form = form.to_ascii_uppercase();
    if form.contains("#TCP") {
        return Err(line.wrong("The tool stands still here (#TCP): the robot leads the workpiece, which is not read."));
    }
    for (number, words) in FRAMES.iter().enumerate() {
        if let Some((_, index)) = form.split_once(words[2]) {
            let index = index.split([',', '}']).next().unwrap_or_default();
            takes_number(line, number, index, reader);
        }
    }
    Ok(())
}

/// The moves that come take `BASE_DATA[3]`.
fn takes_number<'a>(line: &Cursor<'a>, number: usize, index: &str, reader: &mut Reader<'a>) {
    let name = format!("{}[{}]", FRAMES[number][3], index.trim());
    reader.takes(number, name, line.line_number());
}

/// What stands behind the target: an approximation, or `WITH` and variables of this move alone.
fn move_ends<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<()> {
    let line = &mut line.before(';');
    if line.clone().passes(":") {
        return Err(line.wrong_here("This position is calculated by the controller: only stated positions are read."));
    }
    if line.clone().passes(",") {
        return Err(line.wrong_here("An arc that ends at an angle of its own (CA) is not read here."));
    }
    if let Some(mut velocity) = line.behind("$VEL.CP") {
        let is_set = velocity.passes("=");
        reader.at_feed(number_alone(&mut velocity).filter(|_| is_set));
    }
    let Some(with) = line.behind("WITH") else {
        return Ok(());
    };
    let before = reader.taken.clone();
    for (number, words) in FRAMES.iter().enumerate() {
        let Some(value) = with.behind(words[0]) else {
            continue;
        };
        let value = value.rest().trim_start().trim_start_matches('=').trim();
        // `$BASE=SBASE(FP1.BASE_NO)`: what an inline form took from its FDAT.
        let named = value.split_once('(').map_or(value, |(_, named)| named);
        let named = named.split(['.', ')', ',']).next().unwrap_or_default().trim();
        let form = reader.forms.get(&named.to_ascii_uppercase()).cloned();
        match form {
            Some(form) => {
                let other = reader.taken[1 - number].clone();
                takes_form(line, form.rest(), reader)?;
                reader.taken[1 - number] = other;
            }
            None => reader.takes(number, named.to_ascii_uppercase(), line.line_number()),
        }
    }
    let move_frames = std::mem::replace(&mut reader.taken, before);
    reader.in_frames(move_frames);
    Ok(())
}
