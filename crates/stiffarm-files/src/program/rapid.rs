//! ABB RAPID: a module `.mod`.
//!
//! Grammar: ABB, *Technical reference manual, RAPID Overview* 3HAC050947 (identifiers of at most 32
//! characters, comments from `!` to the end of the line) and *RAPID Instructions, Functions and Data
//! types* 3HAC050917: `jointtarget` is `[robax, extax]` with six angles in degrees and six external
//! axes, `9E9` where there is none; the seventh axis of an arm is `eax_a`. `MoveAbsJ` moves to it,
//! `VelSet` takes per cent of the programmed speed, `TPWrite` shows 40 characters a line, `Stop` waits for
//! the start button.
//!
//! CR LF: RobotStudio writes modules so.

use super::characters::said;
use super::cursor::Cursor;
use super::dialect::{Angles, Dialect, Moves, PoseForm, Syntax, Tool};
use super::reader::{Aim, Motion, Pose, Reader, leading};
use stiffarm::error::Result;
use stiffarm::model::pose::Convention;
use stiffarm::model::robot::Controller;

pub const RAPID: Dialect = Dialect {
    name: "rapid",
    title: "ABB RAPID",
    controller: Some(Controller::Abb),
    axes: [6, 12],
    axis_name: |axis| match axis {
        0..6 => format!("rax_{}", axis + 1),
        _ => format!("eax_{}", (b'a' + (axis - 6) as u8) as char),
    },
    speed_of: "1000 mm/s and 500 deg/s of the tool",
    tool: Tool::Name("tool0"),
    // Four characters are kept for the procedure's `_run`.
    longest_name: 28,
    reserved: "base case const default else endmodule endproc error exit for func goto if local main module \
               nostepin pers proc raise readonly record retry return stop task test then trap user var \
               while with",
    syntax: Some(Syntax {
        files: &[("mod", MODULE)],
        label: |number| format!("jp{number}"),
        marker: |named| format!("    ! {named}"),
        speed: Some(|percent| format!("    VelSet {percent},1000;")),
        movement: |to| vec![format!("    MoveAbsJ {},v1000,fine,{};", to.label, to.tool)],
        point: |to| {
            let mut values = to.values.clone();
            // What stands for an external axis that is not there.
            values.resize(12, "9E9".to_string());
            let (arm, external) = values.split_at(6);
            let (arm, external) = (arm.join(","), external.join(","));
            vec![format!(
                "  LOCAL CONST jointtarget {}:=[[{arm}],[{external}]];",
                to.label
            )]
        },
        wait: |text| {
            let said = said(text, 40).into_iter();
            let shown = said.map(|line| format!("    TPWrite \"{line}\";"));
            shown.chain(["    Stop;".to_string()]).collect()
        },
        read,
        joint_move: "MoveAbsJ",
        other_moves: &[
            "MoveJ",
            "MoveL",
            "MoveC",
            "MoveExtJ",
            "MoveLDO",
            "MoveJDO",
            "MoveCDO",
            "MoveLSync",
            "MoveJSync",
            "MoveCSync",
            "TriggL",
            "TriggJ",
            "TriggC",
            "SearchL",
            "SearchC",
            "PDispSet",
            "PDispOn",
            "EOffsSet",
            "EOffsOn",
        ],
        branches: &["FOR", "WHILE", "IF", "TEST", "GOTO"],
        poses: Some(PoseForm {
            convention: Convention::Abb,
            unit: 1e-3,
            degrees: false,
            before: &[],
            decimals: [4, 8],
            in_base: false,
            moves: Moves {
                template: PATH,
                frames: ["tool1", "wobj1"],
                most: usize::MAX,
                lines: |to| {
                    let (tool, base) = (to.tool, to.base);
                    const NONE: &str = "[9E9,9E9,9E9,9E9,9E9,9E9]";
                    vec![match to.number {
                        1 => format!(
                            "    MoveAbsJ [[{}],{NONE}],v100,fine,{tool}\\WObj:={base};",
                            to.angles.join(",")
                        ),
                        _ => {
                            let (place, turn) = (to.pose[..3].join(","), to.pose[3..].join(","));
                            let speed = to.speed_mm_s;
                            format!(
                                "    MoveL [[{place}],[{turn}],[0,0,0,0],{NONE}],[{speed},500,5000,1000],z1,{tool}\\WObj:={base};"
                            )
                        }
                    }]
                },
                point: |_| Vec::new(),
            },
        }),
        missing_point: "The module has no jointtarget",
        comment: "!",
        angle_words: &["jointtarget", "moveabsj"],
        angles: Angles::After("["),
        ..Syntax::USUAL
    }),
    ..Dialect::USUAL
};

const MODULE: &str = "\
MODULE {name}
  ! {header}
{points}
  PROC {name}_run()
{body}
    VelSet 100,5000;
  ENDPROC
ENDMODULE
";

/// Poses come without a configuration: `ConfL \Off` takes the nearest.
const PATH: &str = "\
MODULE {name}
  ! {header}
  PROC {name}_run()
    ConfL \\Off;
{body}
    ConfL \\On;
  ENDPROC
ENDMODULE
";

/// The words of moves of a tool path.
const MOVES: [(&str, Motion); 3] = [
    ("MoveL", Motion::Linear),
    ("MoveJ", Motion::Joint),
    ("MoveC", Motion::Circular),
];

fn read<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    if line.passes("!") {
        reader.comment(line.rest());
        return Ok(true);
    }
    if line.word("MODULE") {
        reader.named(line.identifier()?);
        return Ok(true);
    }
    if line.word("PROC") {
        reader.feature = Some(line.identifier()?.into());
        return Ok(true);
    }
    let _ = line.word("LOCAL") || line.word("TASK");
    let declares = line.word("CONST") || line.word("PERS") || line.word("VAR");
    if declares && line.word("jointtarget") {
        let label = line.identifier()?;
        line.expect(":=")?;
        let aim = target(line, reader)?;
        line.expect(";")?;
        reader.point(label, aim);
    } else if declares && reader.is_path && line.word("robtarget") {
        let label = line.identifier()?;
        line.expect(":=")?;
        let aim = robtarget(line, reader)?;
        reader.point(label, aim);
    } else if declares && reader.is_path && (line.word("tooldata") || line.word("wobjdata")) {
        let label = line.identifier()?.to_ascii_uppercase();
        if line.passes(":=") {
            let frame = frame(line, reader)?;
            reader.frames.insert(label, frame);
        }
    } else if declares && line.word("speeddata") {
        let label = line.identifier()?.to_ascii_uppercase();
        if let Some(speed) = line.rest().split_once('[') {
            let speed = leading(speed.1).map(|mm| (label, mm * 1e-3));
            reader.feeds.extend(speed);
        }
    } else if line.word("VelSet") {
        reader.speed = line.percent()?;
    } else if line.word("TPWrite") {
        reader.say(line.quoted('"')?);
        line.expect(";")?;
    } else if line.word("Stop") {
        line.expect(";")?;
        reader.wait();
    } else if line.word("MoveAbsJ") {
        let place = line.clone();
        let aim = if line.clone().passes("[") {
            target(line, reader)?
        } else {
            Aim::Label(place.clone(), line.identifier()?.to_string())
        };
        reader.go(place, aim);
        if !reader.is_path {
            ends_at_rest(line)?;
        }
    } else if let Some(name) = line.assigned().filter(|_| reader.is_path) {
        reader.assigned.push((line.line_number(), name));
    } else if let Some(motion) = line.motion(if reader.is_path { &MOVES } else { &[] }) {
        reader.move_to(line, motion, aim)?;
        frames_of_move(line, reader)?;
    } else {
        return Ok(false);
    }
    Ok(true)
}

/// A robtarget, or the label of one.
fn aim<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<Aim<'a>> {
    if line.clone().passes("[") {
        return robtarget(line, reader);
    }
    line.label()
}

/// `[x,y,z],[q1,q2,q3,q4]` in brackets.
fn placed<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<Box<Pose>> {
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
fn robtarget<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<Aim<'a>> {
    let pose = placed(line, reader)?;
    for (count, what) in [(4, false), (6, true)] {
        line.expect(",")?;
        line.expect("[")?;
        line.list(count, |line, _| {
            let place = line.clone();
            let value = line.number()?;
            if what && value != 0.0 && value != 9e9 {
                Err(place.wrong("An external axis is not at 0: the path moves with it."))
            } else {
                Ok(value)
            }
        })?;
        line.expect("]")?;
    }
    line.expect("]")?;
    Ok(Aim::Pose(pose))
}

/// The pose of a tooldata, `[TRUE,[pose],[load]]`, or the frames of a wobjdata,
/// `[FALSE,TRUE,"",[uframe],[oframe]]`, of which one is the identity.
fn frame<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<Box<Pose>> {
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
            placed(line, reader)
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
    let place = line.clone();
    let object = placed(line, reader)?;
    let is_identity = |pose: &Pose| {
        let values = pose.numbers.iter().flatten().map(|number| number.value);
        values.eq([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    };
    match (is_identity(&user), is_identity(&object)) {
        (true, _) => Ok(object),
        (_, true) => Ok(user),
        _ => Err(place
            .wrong("A work object with both a user frame and an object frame is not read here.")),
    }
}

/// What follows the target: a speed, a zone, the tool and the work object.
fn frames_of_move<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<()> {
    let number = line.line_number();
    let parts: Vec<&str> = line
        .rest()
        .split(';')
        .next()
        .unwrap_or_default()
        .split(',')
        .collect();
    let last = parts.last().map_or("", |part| part.trim());
    let mut words = last.split('\\');
    let tool = words.next().unwrap_or_default().trim();
    if tool.is_empty() || parts.len() < 3 {
        return Err(line.wrong_here("A speed, a zone and a tool are missing here."));
    }
    let speed = parts[1].trim().trim_start_matches('[').to_ascii_uppercase();
    let known = reader.feeds.get(&speed).copied();
    let stated = leading(speed.trim_start_matches('V')).map(|mm| mm * 1e-3);
    reader.at_feed(known.or(stated));
    reader.uses(0, tool.to_ascii_uppercase(), number);
    let object = words.find_map(|word| {
        let (key, name) = word.split_once(":=")?;
        key.trim().eq_ignore_ascii_case("WObj").then(|| name.trim())
    });
    let object = object.unwrap_or("wobj0").to_ascii_uppercase();
    reader.uses(1, object, number);
    Ok(())
}

/// `[[six angles],[six external axes]]`.
fn target<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<Aim<'a>> {
    let mut values = Vec::with_capacity(12);
    for axis in 0..12 {
        let signs: &[&str] = match axis {
            0 => &["[", "["],
            6 => &["]", ",", "["],
            _ => &[","],
        };
        for sign in signs {
            line.expect(sign)?;
        }
        if axis < reader.joints {
            values.push(line.angle()?);
        } else {
            line.number()?;
        }
    }
    line.expect("]")?;
    line.expect("]")?;
    Ok(reader.angles(&values))
}

/// What follows the target: a speed, `fine`, a tool.
fn ends_at_rest(line: &mut Cursor<'_>) -> Result<()> {
    while line.passes("\\") {
        line.identifier()?;
    }
    line.expect(",")?;
    line.identifier()?;
    line.expect(",")?;
    if !line.word("fine") {
        return Err(line.wrong_here("The move does not end at rest (fine)."));
    }
    line.expect(",")?;
    line.identifier()?;
    while line.passes("\\") {
        line.identifier()?;
        if line.passes(":=") {
            line.identifier()?;
        }
    }
    line.expect(";")
}
