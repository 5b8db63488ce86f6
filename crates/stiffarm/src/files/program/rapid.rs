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
use super::dialect::{Angles, Dialect, Syntax, Tool};
use super::reader::Reader;
use crate::error::Result;
use crate::model::robot::Controller;

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
        other_moves: &["MoveJ", "MoveL", "MoveC", "MoveExtJ"],
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
    let declares = line.word("CONST") || line.word("PERS") || line.word("VAR");
    if declares && line.word("jointtarget") {
        let label = line.identifier()?;
        line.expect(":=")?;
        let q = target(line, reader)?;
        line.expect(";")?;
        reader.point(label, q);
    } else if line.word("VelSet") {
        reader.speed = line.percent()?;
    } else if line.word("TPWrite") {
        reader.say(line.quoted('"')?);
        line.expect(";")?;
    } else if line.word("Stop") {
        line.expect(";")?;
        reader.wait();
    } else if line.word("MoveAbsJ") {
        if line.clone().passes("[") {
            let q = target(line, reader)?;
            reader.go(q);
        } else {
            let place = line.clone();
            reader.go_to(place, line.identifier()?);
        }
        ends_at_rest(line)?;
    } else {
        return Ok(false);
    }
    Ok(true)
}

/// `[[six angles],[six external axes]]`.
fn target(line: &mut Cursor<'_>, reader: &Reader<'_>) -> Result<Vec<f64>> {
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
    Ok(reader.options.to_cell(&values))
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
