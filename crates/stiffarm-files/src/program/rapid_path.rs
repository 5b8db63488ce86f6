//! Paths in RAPID: what moves, points and frames say.

use super::cursor::Cursor;
use super::flow::Procedures;
use super::move_target::{External, Motion, MoveTarget, Pose};
use super::rapid_statements::statements;
use super::reader::{Reader, leading};
use stiffarm::error::Result;
use stiffarm::findings::Severity;

pub const PROCEDURES: Procedures = Procedures {
    statements,
    scopes: &["LOCAL", "TASK"],
    begin: &["PROC", "FUNC", "TRAP"],
    end: &["ENDPROC", "ENDFUNC", "ENDTRAP"],
    blocks: &[],
    handlers: &["ERROR", "UNDO", "BACKWARD"],
    first_is_main: false,
    call,
};

/// Instructions without arguments, which are no calls.
const ALONE: [&str; 27] = [
    "AliasIOReset",
    "Break",
    "ClearPath",
    "ClearRawBytes",
    "DeactEventBufer",
    "EOffsOff",
    "EXIT",
    "ExitCycle",
    "PDispOff",
    "RAISE",
    "ResetPPMoved",
    "RestoPath",
    "RETRY",
    "RETURN",
    "SoftDeact",
    "StartMove",
    "StartMoveRetry",
    "StepBwdPath",
    "Stop",
    "StopMove",
    "StopMoveReset",
    "StorePath",
    "TPErase",
    "TRYNEXT",
    "UIClear",
    "WaitRob",
    "WaitUntil",
];

/// The words of moves of a tool path.
const MOVES: [(&str, Motion); 3] = [("MoveL", Motion::Linear), ("MoveJ", Motion::Joint), ("MoveC", Motion::Circular)];

/// `name;`, `name argument, …;`.
fn call<'a>(statement: &Cursor<'a>) -> Option<&'a str> {
    let mut line = statement.clone();
    let name = line.identifier().ok()?;
    let is_other = line.passes(":") || line.passes("=") || line.passes(".") || line.passes("{");
    (!is_other).then_some(name)
}

/// A line of a path that a plan has not.
pub fn read<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>, declares: bool) -> Result<bool> {
    if declares && line.word("robtarget") {
        let label = line.identifier()?;
        if line.clone().passes(":=") {
            line.expect(":=")?;
            let target = if line.clone().passes("[") {
                robtarget(line, reader)?
            } else {
                MoveTarget::Unset(line.clone(), format!("{label} is calculated: only stated positions are read."))
            };
            reader.point(label, target);
        }
    } else if declares && (line.word("tooldata") || line.word("wobjdata")) {
        let label = line.identifier()?.to_ascii_uppercase();
        if line.passes(":=") && line.clone().passes("[") {
            let frame = frame(line, reader)?;
            reader.frames.insert(label, frame);
        }
    } else if let Some((name, is_whole)) = line.assigned() {
        if !sets_frame(line, &name, reader)? {
            if is_whole && reader.feeds.contains_key(&name) {
                reader.feeds.remove(&name);
                speed(line, name.clone(), reader);
            }
            reader.sets(line, name);
        }
    } else if let Some(motion) = line.motion(&MOVES) {
        if line.passes("\\") {
            // Instructions that go on while it moves.
            line.expect("Conc")?;
            line.expect(",")?;
        }
        reader.move_to(line, motion, move_target)?;
        move_ends(line, reader)?;
    } else {
        return instruction(line, reader);
    }
    Ok(true)
}

/// `name := [speed, …]`.
pub fn speed<'a>(line: &Cursor<'a>, name: String, reader: &mut Reader<'a>) {
    if let Some((_, list)) = line.rest().split_once('[') {
        let speed = leading(list).map(|mm| (name, mm * 1e-3));
        reader.feeds.extend(speed);
    }
}

/// Any other instruction: one that begins with a point is a move, a name alone is a procedure.
fn instruction<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    let start = line.clone();
    let mut next = line.clone();
    if line.rest().starts_with("%\"") {
        reader.passes_over(line, "A call of a procedure by its text");
    }
    let Ok(name) = next.identifier() else {
        return Ok(false);
    };
    if next.passes("\\") {
        let _ = next.word("Conc") && next.passes(",");
    }
    let is_point = next.clone().identifier().is_ok_and(|label| reader.target_of(label).is_some());
    if next.clone().passes("[[") || is_point {
        return Err(start.wrong(format!("{name} is a move that is not read here.")));
    }
    let is_known = ALONE.iter().any(|word| word.eq_ignore_ascii_case(name));
    if next.passes(";") && !is_known {
        let sentence = format!("{name} ({{}}) is a procedure that is not in the file: what it does is not known here.");
        reader.remark("not-followed", name, line, Severity::Caution, sentence);
        return Ok(true);
    }
    Ok(false)
}

/// A tool or work object that the program sets to stated numbers, as a whole or one of its frames; false where it
/// sets anything else.
fn sets_frame<'a>(line: &Cursor<'a>, name: &str, reader: &mut Reader<'a>) -> Result<bool> {
    let Some(frames) = reader.frames.get(name).cloned() else {
        return Ok(false);
    };
    let mut line = line.clone();
    line.identifier()?;
    let part = if line.passes(".") { line.identifier()?.to_ascii_uppercase() } else { String::new() };
    if !line.passes(":=") {
        return Ok(false);
    }
    let is_stated = line.clone().passes("[");
    let new = match part.as_str() {
        "" if is_stated => frame(&mut line, reader)?,
        "" => match line.identifier().ok().filter(|_| line.passes(";")) {
            Some(other) => match reader.frames.get(&other.to_ascii_uppercase()) {
                Some(other) => other.clone(),
                None => return Ok(false),
            },
            None => return Ok(false),
        },
        "TFRAME" | "UFRAME" | "OFRAME" if is_stated => {
            let mut new = frames;
            let at = usize::from(part == "OFRAME");
            let pose = placed(&mut line, reader)?;
            match new.get_mut(at) {
                Some(old) => *old = *pose,
                None => return Ok(false),
            }
            new
        }
        _ => return Ok(false),
    };
    reader.frames.insert(name.to_string(), new);
    Ok(true)
}

/// A robtarget, or the label of one.
fn move_target<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<MoveTarget<'a>> {
    if line.clone().passes("[") {
        return robtarget(line, reader);
    }
    line.label()
}

/// `[x,y,z],[q1,q2,q3,q4]` in brackets.
fn placed<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<Box<Pose<'a>>> {
    let mut numbers = [None; 7];
    for (at, number) in numbers.iter_mut().enumerate() {
        let signs: &[&str] = match at {
            0 => &["[", "["],
            3 => &["]", ",", "["],
            _ => &[","],
        };
        for sign in signs {
            line.expect(sign)?;
        }
        *number = Some(line.placed()?);
    }
    line.expect("]")?;
    Ok(reader.pose(numbers, line))
}

/// `[[x,y,z],[q1,q2,q3,q4],[cf1,cf4,cf6,cfx],[eax_a…]]`.
fn robtarget<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<MoveTarget<'a>> {
    let mut pose = placed(line, reader)?;
    line.expect(",")?;
    line.expect("[")?;
    line.list(4, |line, _| line.number())?;
    line.expect("]")?;
    line.expect(",")?;
    pose.external = external(line, 0)?;
    line.expect("]")?;
    Ok(MoveTarget::Pose(pose))
}

/// `[eax_a,eax_b,…]` from the axis `first` of the controller on; 9E9 stands for one that is not there.
pub fn external<'a>(line: &mut Cursor<'a>, first: usize) -> Result<Vec<External<'a>>> {
    let mut all = Vec::new();
    for axis in 0..6 {
        line.expect(if axis == 0 { "[" } else { "," })?;
        let place = line.clone();
        let value = line.number()?;
        if axis >= first && value != 9e9 {
            let name = format!("eax_{}", char::from(b'a' + axis as u8));
            all.push(External { name, value, place });
        }
    }
    line.expect("]")?;
    Ok(all)
}

/// The pose of a tooldata, `[TRUE,[pose],[load]]`, or the frames of a wobjdata, `[FALSE,TRUE,"",[uframe],[oframe]]`:
/// the control takes their product.
fn frame<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<Vec<Pose<'a>>> {
    line.expect("[")?;
    let is_tool = line.word("TRUE");
    if !is_tool {
        line.expect("FALSE")?;
    }
    line.expect(",")?;
    if is_tool && !line.clone().passes("[") {
        return Err(line.wrong_here("A work object that the robot holds (TRUE) is not read here."));
    }
    if line.clone().passes("[") {
        return if is_tool {
            Ok(vec![*placed(line, reader)?])
        } else {
            Err(line.wrong_here("A tool that stands still (FALSE) is not read here."))
        };
    }
    if !line.word("TRUE") {
        line.expect("FALSE")?;
    }
    line.expect(",")?;
    line.quoted('"')?;
    line.expect(",")?;
    let user = placed(line, reader)?;
    line.expect("]")?;
    line.expect(",")?;
    let object = placed(line, reader)?;
    Ok(vec![*user, *object])
}

/// A name, or a list in brackets; and what it is.
fn argument<'a>(line: &mut Cursor<'a>) -> Result<&'a str> {
    line.space();
    let text = line.rest();
    if line.passes("[") {
        let Some(length) = text.find(']') else {
            return Err(line.wrong("The `]` that ends this list is missing."));
        };
        line.skip(length);
        return Ok(&text[..=length]);
    }
    line.identifier()
}

/// Optional arguments, `\V:=50`; a comma may stand before the first.
fn options<'a>(line: &mut Cursor<'a>, mut each: impl FnMut(&str, &'a str)) -> Result<()> {
    let mut before = line.clone();
    if before.passes(",") && before.clone().passes("\\") {
        *line = before;
    }
    while line.passes("\\") {
        let key = line.identifier()?;
        let mut value = "";
        if line.passes(":=") {
            line.space();
            let rest = line.rest();
            let length = rest.find([',', ';', '\\']).unwrap_or(rest.len());
            line.skip(length);
            value = rest[..length].trim();
        }
        each(&key.to_ascii_uppercase(), value);
    }
    Ok(())
}

/// What follows the target: a speed, a zone, the tool and the work object.
fn move_ends<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<()> {
    let number = line.line_number();
    options(line, |_, _| {})?;
    line.expect(",")?;
    let speed = argument(line)?.trim_start_matches('[').to_ascii_uppercase();
    let stated_feed = reader.feeds.get(&speed).copied();
    let mut feed = stated_feed.or(leading(speed.trim_start_matches('V')).map(|mm| mm * 1e-3));
    options(line, |key, value| match key {
        "V" => feed = leading(value).map(|mm| mm * 1e-3),
        _ => feed = None,
    })?;
    line.expect(",")?;
    argument(line)?;
    options(line, |_, _| {})?;
    line.expect(",")?;
    let tool = line.identifier()?;
    let (mut object, mut is_corrected) = ("wobj0", false);
    options(line, |key, value| match key {
        "WOBJ" => object = value,
        "CORR" => is_corrected = true,
        _ => {}
    })?;
    if is_corrected {
        reader.passes_over(line, "\\Corr, a path that a sensor corrects,");
    }
    line.expect(";")?;
    reader.takes(0, tool.to_ascii_uppercase(), number);
    reader.takes(1, object.to_ascii_uppercase(), number);
    reader.in_frames(reader.taken.clone());
    reader.at_feed(feed);
    Ok(())
}
