//! COMAU PDL2: a program `.pdl`.
//!
//! Grammar: COMAU, *PDL2 Programming Language Manual*, System Software 2.30 (CR00758049) and 3.1x (CR00757508);
//! public generators for C5G controllers (github.com/ros-industrial-attic/robodk_postprocessors,
//! `Comau_C5G.py`). Comments begin with `--`. `MOVE JOINT TO {…}` moves to joint angles in degrees, at most ten
//! joints. `$ARM_SPD_OVR` is the arm's speed in whole per cent; what it was comes back at the end. `WRITE LUN_CRT`
//! shows a line on the pendant's user page, and `PAUSE` waits until the program is let go on from there.
//!
//! CR LF: the controller's tools run on Windows.

use super::characters::said;
use super::cursor::Cursor;
use super::dialect::{Angles, Dialect, Syntax};
use super::reader::Reader;
use stiffarm::error::Result;
use stiffarm::model::robot::Controller;

pub const PDL2: Dialect = Dialect {
    name: "pdl2",
    title: "COMAU PDL2",
    controller: Some(Controller::Comau),
    axes: [1, 10],
    reserved: "abort activate and attach begin call close const delay do else end endif exit for goto hold \
               if move not open or pause program read repeat return routine select type var wait while with \
               write",
    syntax: Some(Syntax {
        files: &[("pdl", PROGRAM)],
        marker: |named| format!("  -- {named}"),
        speed: Some(|percent| format!("  $ARM_SPD_OVR := {percent}")),
        movement: |to| vec![format!("  MOVE JOINT TO {{{}}}", to.values.join(", "))],
        wait: |text| {
            let said = said(text, 40).into_iter();
            let shown = said.map(|line| format!("  WRITE LUN_CRT ('{line}', NL)"));
            shown.chain(["  PAUSE".to_string()]).collect()
        },
        read,
        joint_move: "MOVE JOINT TO",
        other_moves: &["LINEAR", "CIRCULAR"],
        comment: "--",
        quote: '\'',
        angle_words: &["move"],
        angles: Angles::After("{"),
        ..Syntax::USUAL
    }),
    ..Dialect::USUAL
};

const PROGRAM: &str = "\
PROGRAM {name}
-- {header}
VAR
  speed_before : INTEGER
BEGIN
  speed_before := $ARM_SPD_OVR
{body}
  $ARM_SPD_OVR := speed_before
END {name}
";

fn read<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    if line.passes("--") {
        reader.comment(line.rest());
    } else if line.word("PROGRAM") {
        reader.named(line.identifier()?);
    } else if line.word("$ARM_SPD_OVR") {
        line.expect(":=")?;
        if !line.word("speed_before") {
            reader.speed = line.percent()?;
        }
    } else if line.word("WRITE") {
        line.word("LUN_CRT");
        line.expect("(")?;
        reader.say(line.quoted('\'')?);
    } else if line.word("PAUSE") {
        line.end()?;
        reader.wait();
    } else if line.word("MOVEFLY") {
        return Err(line.wrong("The move does not end at rest (MOVE)."));
    } else if line.word("MOVE") {
        let place = line.clone();
        if line.clone().word("LINEAR") || line.clone().word("CIRCULAR") {
            return Ok(false);
        }
        line.word("JOINT");
        line.expect("TO")?;
        line.expect("{")?;
        let values = line.list(reader.joints, |line, _| line.angle())?;
        line.expect("}")?;
        line.end()?;
        let target = reader.angles(&values);
        reader.go(place, target);
    }
    Ok(true)
}
