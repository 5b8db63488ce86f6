//! KUKA KRL: a `.src` with the moves and a `.dat` with the points.
//!
//! Grammar: KUKA, *Operating and Programming Instructions for System Integrators*, KUKA System
//! Software 8.x, and *Expert Documentation, Programming Messages*, KSS 8.2; the reference of
//! openkuka.github.io/krl (`E6AXIS`, `$VEL_AXIS`, `KrlMsg_T`: a message has at most 80 characters).
//! The head of the `.src` is the controller's own template: without `BAS (#INITMOV,0)` no speed is
//! set. `BAS (#VEL_PTP,n)` sets `$VEL_AXIS`, per cent of each axis's largest speed. Axes that an
//! aggregate does not name stay where they are. `MsgNotify` is of the message library that comes
//! with KSS 8; `WAIT SEC 0` before it stops the advance run, so that the text appears when the robot
//! is there, and `HALT` waits for the start key.
//!
//! CR LF: the controller's file system is that of Windows.

use super::characters::said;
use super::cursor::Cursor;
use super::dialect::{Angles, Dialect, Syntax, Tool};
use super::reader::Reader;
use crate::error::Result;
use crate::model::robot::Controller;

pub const KRL: Dialect = Dialect {
    name: "krl",
    title: "KUKA KRL",
    controller: Some(Controller::Kuka),
    axes: [6, 12],
    axis_name: |axis| match axis {
        0..6 => format!("A{}", axis + 1),
        _ => format!("E{}", axis - 5),
    },
    tool: Tool::Number(128, None),
    // KSS operating manuals: 24 characters for a module.
    longest_name: 24,
    reserved: "bas cell continue def deffct end for halt if ir_stopm loop ptp repeat return sps switch wait \
               while",
    syntax: Some(Syntax {
        files: &[("src", SRC), ("dat", DAT)],
        label: |number| format!("XP{number}"),
        marker: |named| format!("; {named}"),
        speed: Some(|percent| format!("BAS (#VEL_PTP,{percent})")),
        movement: |to| vec![format!("PTP {}", to.label)],
        point: |to| {
            let angles = to.named(&KRL, " ").join(",");
            vec![format!("DECL E6AXIS {}={{{angles}}}", to.label)]
        },
        wait: |text| {
            let said = said(text, 76).into_iter();
            let shown = said.map(|line| format!("MsgNotify (\"{line}\")"));
            let stop = |line: &str| [line.to_string()];
            stop("WAIT SEC 0")
                .into_iter()
                .chain(shown)
                .chain(stop("HALT"))
                .collect()
        },
        read,
        joint_move: "PTP",
        other_moves: &[
            "LIN", "CIRC", "SPTP", "SLIN", "SCIRC", "PTP_REL", "LIN_REL", "SPTP_REL",
        ],
        missing_point: "The .dat has no joint position (E6AXIS)",
        comment: ";",
        notes: &["&"],
        angle_words: &["e6axis", "axis", "ptp"],
        angles: Angles::Named(1),
        ..Syntax::USUAL
    }),
    ..Dialect::USUAL
};

const SRC: &str = "\
&ACCESS RVP
&REL 1
DEF {name} ( )
; {header}
;FOLD INI
;FOLD BASISTECH INI
GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM ( )
INTERRUPT ON 3
BAS (#INITMOV,0)
;ENDFOLD (BASISTECH INI)
;ENDFOLD (INI)
BAS (#TOOL,{tool})
{body}
END
";

const DAT: &str = "\
&ACCESS RVP
&REL 1
DEFDAT {name}
; {header}
{points}
ENDDAT
";

/// What else the `.dat` declares is not looked at.
fn read<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    if line.passes(";") {
        reader.comment(line.rest());
    } else if line.word("DEF") {
        reader.named(line.identifier()?);
    } else if line.word("BAS") {
        line.expect("(")?;
        if line.passes("#VEL_PTP") {
            line.expect(",")?;
            reader.speed = line.percent()?;
            line.expect(")")?;
        }
    } else if line.word("MsgNotify") {
        line.expect("(")?;
        reader.say(line.quoted('"')?);
    } else if line.word("HALT") {
        line.end()?;
        reader.wait();
    } else if line.word("PTP") {
        if line.clone().passes("{") {
            let q = aggregate(line, reader)?;
            reader.go(q);
        } else {
            let place = line.clone();
            reader.go_to(place, line.identifier()?);
        }
        line.end()?;
    } else {
        line.word("DECL");
        line.word("GLOBAL");
        if !(line.word("E6AXIS") || line.word("AXIS")) {
            return Ok(false);
        }
        let label = line.identifier()?;
        if line.passes("=") {
            let q = aggregate(line, reader)?;
            line.end()?;
            reader.point(label, q);
        }
    }
    Ok(true)
}

/// `{A1 …,A2 …}`, with or without the name of its type.
fn aggregate(line: &mut Cursor<'_>, reader: &Reader<'_>) -> Result<Vec<f64>> {
    let start = line.clone();
    line.expect("{")?;
    let _ = line.passes("E6AXIS:") || line.passes("AXIS:");
    let mut values = vec![None; reader.joints];
    loop {
        let field = line.clone();
        let axis = line.identifier()?.to_ascii_uppercase();
        let value = line.angle()?;
        let Some(known) = (0..12).find(|i| (KRL.axis_name)(*i) == axis) else {
            let message = format!("`{axis}` is no axis: this is no joint position.");
            return Err(field.wrong(message));
        };
        // Further external axes of the controller are none of the cell's.
        if let Some(own) = values.get_mut(known) {
            *own = Some(value);
        }
        if !line.passes(",") {
            break;
        }
    }
    line.expect("}")?;
    reader
        .complete(&values)
        .map_err(|axis| start.wrong(format!("The position has no {axis}.")))
}
