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
use super::dialect::{Angles, Dialect, LinearMove, Moves, PoseForm, Syntax, Tool};
use super::krl_path::{self, PROCEDURES};
use super::krl_points::{POSE, axis_name, declaration, move_target};
use super::move_target::Motion;
use super::reader::Reader;
use super::text::fixed;
use stiffarm::error::Result;
use stiffarm::model::pose::Convention;
use stiffarm::model::robot::Controller;

pub const KRL: Dialect = Dialect {
    name: "krl",
    title: "KUKA KRL",
    controller: Some(Controller::Kuka),
    axes: [6, 12],
    axis_name,
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
            stop("WAIT SEC 0").into_iter().chain(shown).chain(stop("HALT")).collect()
        },
        read,
        joint_move: "PTP",
        other_moves: &[
            "LIN",
            "CIRC",
            "SPTP",
            "SLIN",
            "SCIRC",
            "PTP_REL",
            "LIN_REL",
            "SPTP_REL",
            "SLIN_REL",
            "CIRC_REL",
            "SCIRC_REL",
            "SPL",
        ],
        branches: &["FOR", "WHILE", "LOOP", "REPEAT", "SWITCH", "IF", "GOTO"],
        procedures: Some(PROCEDURES),
        poses: Some(PoseForm {
            convention: Convention::Kuka,
            unit: 1e-3,
            degrees: true,
            before: &[",X ", ",Y ", ",Z ", ",A ", ",B ", ",C "],
            decimals: [4, 5],
            in_base: false,
            null_frames: &["BASE_DATA[0]", "TOOL_DATA[0]", "$NULLFRAME", "$WORLD"],
            turns_on_the_way: true,
            moves: Some(Moves {
                template: SRC,
                frames: ["1", "1"],
                most: usize::MAX,
                lines: |to| match to.number {
                    1 => {
                        let axes = ["A1", "A2", "A3", "A4", "A5", "A6"];
                        vec![
                            format!("BAS (#BASE,{})", to.base),
                            "BAS (#VEL_PTP,10)".to_string(),
                            format!("$VEL.CP={}", fixed(to.speed_mm_s / 1e3, 5)),
                            "$APO.CDIS=0.5".to_string(),
                            format!("PTP {{{}}}", LinearMove::named(&axes, &to.angles, " ")),
                        ]
                    }
                    _ => vec![format!("LIN {{{}}} C_DIS", LinearMove::named(&POSE, &to.pose, " "))],
                },
                point: |_| Vec::new(),
            }),
        }),
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
    } else if reader.is_path {
        return krl_path::read(line, reader);
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
        reader.move_to(line, Motion::Joint, move_target)?;
        line.end()?;
    } else {
        return declaration(line, reader, &["E6AXIS", "AXIS"]);
    }
    Ok(true)
}
