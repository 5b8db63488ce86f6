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

use super::aims::{Aim, External, Motion};
use super::characters::said;
use super::cursor::Cursor;
use super::dialect::{Angles, Dialect, Leads, Moves, PoseForm, Syntax, Tool};
use super::krl_path::{self, PROCEDURES};
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
    axis_name: |axis| match axis {
        0..6 => Controller::Kuka.axis_name(axis),
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
                            format!("PTP {{{}}}", Leads::named(&axes, &to.angles, " ")),
                        ]
                    }
                    _ => vec![format!(
                        "LIN {{{}}} C_DIS",
                        Leads::named(&POSE, &to.pose, " ")
                    )],
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

/// Numbers of a pose.
const POSE: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];

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
        reader.move_to(line, Motion::Joint, aim)?;
        line.end()?;
    } else {
        return declaration(line, reader, &["E6AXIS", "AXIS"]);
    }
    Ok(true)
}

/// `DECL E6AXIS XP1={…}`, of one of these types.
pub fn declaration<'a>(
    line: &mut Cursor<'a>,
    reader: &mut Reader<'a>,
    types: &[&str],
) -> Result<bool> {
    while line.word("DECL") || line.word("GLOBAL") || line.word("CONST") {}
    if !types.iter().any(|name| line.word(name)) {
        return Ok(false);
    }
    let label = line.identifier()?;
    if line.passes("=") {
        let aim = aggregate(line, reader)?;
        line.end()?;
        reader.point(label, aim);
    }
    Ok(true)
}

/// A position in braces, or the label of one.
pub fn aim<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<Aim<'a>> {
    if line.clone().passes("{") {
        return aggregate(line, reader);
    }
    line.label()
}

/// `{A1 …,A2 …}` or, of a tool path, `{X …,Y …}`, with or without the name of its type.
pub fn aggregate<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<Aim<'a>> {
    let start = line.clone();
    line.expect("{")?;
    let mut named = line.clone();
    if named.identifier().is_ok() && named.passes(":") {
        *line = named;
    }
    let mut values = vec![None; reader.joints];
    let (mut pose, mut is_pose, mut last) = ([None; 7], false, line.clone());
    let mut external = Vec::new();
    loop {
        let field = line.clone();
        let axis = line.identifier()?.to_ascii_uppercase();
        let known = (0..12).find(|i| (KRL.axis_name)(*i) == axis);
        if let Some(at) = POSE.iter().position(|name| *name == axis && reader.is_path) {
            if pose[at].replace(line.placed()?).is_some() {
                return Err(field.wrong(format!("`{axis}` stands twice in this position.")));
            }
            (is_pose, last) = (true, line.clone());
        } else if let Some(at) = known {
            match values.get_mut(at).filter(|_| !is_pose) {
                Some(own) => *own = Some(line.angle()?),
                // An axis that is none of the cell's.
                None => external.push(External {
                    value: line.number()?,
                    name: axis,
                    place: field,
                }),
            }
        } else if is_pose {
            // Status and turn, also as bits: `'B010'`.
            if line.clone().passes("'") {
                line.quoted('\'')?;
            } else {
                line.number()?;
            }
        } else {
            let message = format!("`{axis}` is no axis: this is no joint position.");
            return Err(field.wrong(message));
        }
        if !line.passes(",") {
            break;
        }
    }
    line.expect("}")?;
    if is_pose {
        let mut pose = reader.pose(pose, &last);
        pose.external = external;
        return Ok(Aim::Pose(pose));
    }
    match reader.complete(&values) {
        Ok(Aim::Angles(q, _)) => Ok(Aim::Angles(q, external)),
        Ok(aim) => Ok(aim),
        Err(axis) => Err(start.wrong(format!("The position has no {axis}."))),
    }
}
