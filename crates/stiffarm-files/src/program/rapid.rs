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
use super::move_target::MoveTarget;
use super::rapid_path::{self, PROCEDURES, external, speed};
use super::reader::Reader;
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
            vec![format!("  LOCAL CONST jointtarget {}:=[[{arm}],[{external}]];", to.label)]
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
            "TriggAbsJ",
            "TriggLIOs",
            "TriggJIOs",
            "SearchL",
            "SearchC",
            "SearchExtJ",
            "PDispSet",
            "PDispOn",
            "EOffsSet",
            "EOffsOn",
            "CorrCon",
            "IndAMove",
            "IndRMove",
            "IndDMove",
            "IndCMove",
            "FCPressL",
            "FCPressC",
            "FCPress1LStart",
            "EGMMoveL",
            "EGMMoveC",
            "EGMRunPose",
            "EGMRunJoint",
        ],
        branches: &["FOR", "WHILE", "IF", "ELSEIF", "TEST", "GOTO", "SoftAct", "CallByVar"],
        procedures: Some(PROCEDURES),
        poses: Some(PoseForm {
            convention: Convention::Abb,
            unit: 1e-3,
            degrees: false,
            before: &[],
            decimals: [4, 8],
            in_base: false,
            null_frames: &["WOBJ0", "TOOL0"],
            turns_on_the_way: true,
            moves: Some(Moves {
                template: PATH,
                frames: ["tool1", "wobj1"],
                most: usize::MAX,
                lines: |to| {
                    let (tool, base) = (to.tool, to.base);
                    const NONE: &str = "[9E9,9E9,9E9,9E9,9E9,9E9]";
                    vec![match to.number {
                        1 => format!("    MoveAbsJ [[{}],{NONE}],v100,fine,{tool}\\WObj:={base};", to.angles.join(",")),
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
            }),
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

fn read<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    if line.passes("!") {
        reader.comment(line.rest());
        return Ok(true);
    }
    if line.word("MODULE") {
        reader.named(line.identifier()?);
        return Ok(true);
    }
    let _ = line.word("LOCAL") || line.word("TASK");
    if line.word("PROC") {
        reader.feature = Some(line.identifier()?.into());
        return Ok(true);
    }
    let declares = line.word("CONST") || line.word("PERS") || line.word("VAR");
    if declares && line.word("jointtarget") {
        let label = line.identifier()?;
        if reader.is_path
            && !{
                let mut line = line.clone();
                line.passes(":=") && line.passes("[")
            }
        {
            // Its moves are no part of the path.
            return Ok(true);
        }
        line.expect(":=")?;
        let target = target(line, reader)?;
        line.expect(";")?;
        reader.point(label, target);
    } else if declares && line.word("speeddata") {
        let label = line.identifier()?.to_ascii_uppercase();
        speed(line, label, reader);
    } else if !reader.is_path && line.word("VelSet") {
        reader.speed = line.percent()?;
    } else if !reader.is_path && line.word("TPWrite") {
        reader.say(line.quoted('"')?);
        line.expect(";")?;
    } else if !reader.is_path && line.word("Stop") {
        line.expect(";")?;
        reader.wait();
    } else if line.word("MoveAbsJ") {
        if reader.is_path && line.clone().passes("\\Conc") {
            line.expect("\\Conc")?;
            line.expect(",")?;
        }
        let place = line.clone();
        let target = if line.clone().passes("[") {
            target(line, reader)?
        } else {
            MoveTarget::Label(place.clone(), line.identifier()?.to_string())
        };
        reader.go(place, target);
        if !reader.is_path {
            ends_at_rest(line)?;
        }
    } else if reader.is_path {
        return rapid_path::read(line, reader, declares);
    } else {
        return Ok(false);
    }
    Ok(true)
}

/// `[[six angles],[six external axes]]`.
fn target<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<MoveTarget<'a>> {
    line.expect("[")?;
    line.expect("[")?;
    let mut values = line.list(6, |line, _| line.angle())?;
    line.expect("]")?;
    line.expect(",")?;
    let extra_joints = reader.joints.saturating_sub(6);
    let before = line.clone();
    let others = external(line, extra_joints)?;
    line.expect("]")?;
    // The axes of an arm of more than six joints stand with the external ones.
    let mut arm = before;
    for axis in 0..extra_joints {
        arm.expect(if axis == 0 { "[" } else { "," })?;
        values.push(arm.angle()?);
    }
    let MoveTarget::Angles(q, _) = reader.angles(&values) else {
        return Ok(reader.angles(&values));
    };
    Ok(MoveTarget::Angles(q, others))
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
