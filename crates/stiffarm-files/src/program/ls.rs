//! FANUC teach pendant program as text: `.ls`.
//!
//! Grammar: listings that R-30iA and R-30iB controllers write (public examples:
//! github.com/mitchtown98/FANUC_LS_Examples, github.com/WILDER-SYSTEMS-LLC/git-ftp) and FANUC, *R-30iB
//! HandlingTool Setup and Operations Manual*: a remark has at most 32 characters, a message 24, the
//! comment of a position 16; `PAUSE` waits for the start key. Positions are in joint representation,
//! three decimals; axes beyond the sixth of the group are E1 to E3. `FINE` ends a move at rest. The
//! dates of the head are constants, so that equal plans give equal bytes.
//!
//! CR LF, as the controller writes.

use super::characters::said;
use super::cursor::Cursor;
use super::dialect::{Angles, Dialect, Moves, PoseForm, Syntax, Target, Tool};
use super::ls_path::{is_no_move, label, path_statement, point};
use super::move_target::{External, MoveTarget, OpenPoint};
use super::reader::{Reader, Section};
use stiffarm::error::Result;
use stiffarm::model::pose::Convention;
use stiffarm::model::robot::Controller;

pub const LS: Dialect = Dialect {
    name: "ls",
    title: "FANUC TP",
    controller: Some(Controller::Fanuc),
    axes: [1, 9],
    axis_name: |axis| match axis {
        0..6 => format!("J{}", axis + 1),
        _ => format!("E{}", axis - 5),
    },
    most_decimals: 3,
    tool: Tool::Number(29, Some("1")),
    upper_case: true,
    reserved: "ALL CON NUL PRN AUX",
    syntax: Some(Syntax {
        files: &[("ls", LISTING)],
        small_file_names: true,
        comment_width: 32,
        // After `posture `.
        name_width: 24,
        label: |number| format!("P[{number}]"),
        marker: |named| format!("  !{named} ;"),
        movement: |to| vec![format!("J {} {}% FINE ;", to.label, to.speed_percent)],
        point: |to| {
            let values = to.values.iter().map(|value| format!("{value:>9} deg"));
            let padded = Target { label: String::new(), values: values.collect(), ..*to };
            let fields = padded.named(&LS, "= ");
            let rows = fields.chunks(3).map(|row| format!("\t{}", row.join(",\t")));
            let rows = rows.collect::<Vec<_>>().join(",\n");
            let head = [format!("{}{{", to.label), "   GP1:".to_string(), format!("\tUF : 0, UT : {},", to.tool)];
            let rows = rows.lines().chain(["};"]).map(String::from);
            head.into_iter().chain(rows).collect()
        },
        wait: |text| {
            let said = said(text, 24).into_iter();
            let shown = said.map(|line| format!("  MESSAGE[{line}] ;"));
            shown.chain(["  PAUSE ;".to_string()]).collect()
        },
        read,
        joint_move: "J",
        other_moves: &["L", "C", "A", "S"],
        branches: &["IF", "JMP", "FOR", "SELECT", "CALL", "RUN", "OFFSET", "TOOL_OFFSET"],
        poses: Some(PoseForm {
            convention: Convention::Fanuc,
            unit: 1e-3,
            degrees: true,
            before: &[],
            decimals: [3, 3],
            in_base: false,
            null_frames: &["UFRAME[0]", "UTOOL[0]"],
            turns_on_the_way: true,
            moves: Some(Moves {
                template: LISTING,
                frames: ["1", "1"],
                // Lines of a program are numbered with 15 bits.
                most: 32_000,
                lines: |to| {
                    vec![match to.number {
                        1 => "J P[1] 10% FINE ;".to_string(),
                        number => format!("L P[{number}] {}mm/sec CNT10 ;", to.speed_mm_s),
                    }]
                },
                point: |to| {
                    let [first, second] = match to.number {
                        1 => {
                            let rows = |at: usize| {
                                let angles = to.angles[at..at + 3].iter().zip(at + 1..);
                                let angles = angles.map(|(angle, axis)| format!("J{axis}= {angle:>9} deg"));
                                angles.collect::<Vec<_>>().join(",\t")
                            };
                            [rows(0), rows(3)]
                        }
                        _ => {
                            let rows = |at: usize, unit: &str| {
                                let names = POSE[at..at + 3].iter().zip(&to.pose[at..]);
                                let names = names.map(|(name, value)| format!("{name} = {value:>9} {unit}"));
                                names.collect::<Vec<_>>().join(",\t")
                            };
                            [rows(0, " mm"), rows(3, "deg")]
                        }
                    };
                    let configuration = match to.number {
                        1 => String::new(),
                        _ => format!("\t\tCONFIG : '{}',", to.configuration),
                    };
                    vec![
                        format!("P[{}]{{", to.number),
                        "   GP1:".to_string(),
                        format!("\tUF : {}, UT : {},{configuration}", to.base, to.tool),
                        format!("\t{first},"),
                        format!("\t{second}"),
                        "};".to_string(),
                    ]
                },
            }),
        }),
        missing_point: "/POS has no",
        comment: "!",
        comments_fill_lines: true,
        numbered: true,
        notes: &[
            "owner=",
            "comment=",
            "prog_size=",
            "create=",
            "modified=",
            "file_name=",
            "version=",
            "line_count=",
            "memory_size=",
        ],
        angle_words: &["deg"],
        angles: Angles::Named(2),
        ..Syntax::USUAL
    }),
    ..Dialect::USUAL
};

const LISTING: &str = "\
/PROG  {name}
/ATTR
OWNER\t\t= MNEDITOR;
COMMENT\t\t= \"stiffarm {what}\";
PROG_SIZE\t= 0;
CREATE\t\t= DATE 00-01-01  TIME 00:00:00;
MODIFIED\t= DATE 00-01-01  TIME 00:00:00;
FILE_NAME\t= ;
VERSION\t\t= 0;
LINE_COUNT\t= {count};
MEMORY_SIZE\t= 0;
PROTECT\t\t= READ_WRITE;
TCD:  STACK_SIZE\t= 0,
      TASK_PRIORITY\t= 50,
      TIME_SLICE\t= 0,
      BUSY_LAMP_OFF\t= 0,
      ABORT_REQUEST\t= 0,
      PAUSE_REQUEST\t= 0;
DEFAULT_GROUP\t= 1,*,*,*,*;
CONTROL_CODE\t= 00000000 00000000;
/MN
{n}  !{header} ;
{n}  UFRAME_NUM={base} ;
{n}  UTOOL_NUM={tool} ;
{n}{body}
/POS
{points}
/END
";

fn read<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    if line.word("/PROG") {
        // The controller's own have names that begin with a sign.
        reader.named(line.identifier().unwrap_or_default());
    } else if line.word("/MN") {
        reader.section = Section::Body;
    } else if line.word("/POS") {
        reader.section = Section::Points;
    } else if line.word("/END") {
        reader.section = Section::Head;
    } else if reader.section == Section::Points {
        position(line, reader)?;
    } else if reader.section == Section::Body && !line.is_done() {
        // The number of the line; a long instruction goes on without one.
        if line.number().is_ok() || line.passes(":") {
            line.passes(":");
        }
        return statement(line, reader);
    }
    Ok(true)
}

fn statement<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    if line.passes("!") {
        reader.comment(line.rest().trim_end().trim_end_matches(';'));
    } else if line.passes("MESSAGE[") {
        let Some((said, _)) = line.rest().split_once(']') else {
            return Err(line.wrong("The `]` of this message is missing."));
        };
        reader.say(said);
    } else if line.word("PAUSE") {
        reader.wait();
    } else if is_no_move(line) {
    } else if reader.is_path {
        return path_statement(line, reader);
    } else if line.word("J") {
        let place = line.clone();
        let label = point(line)?;
        reader.speed = line.percent()?;
        line.expect("%")?;
        if !line.word("FINE") {
            return Err(line.wrong_here("The move does not end at rest (FINE)."));
        }
        line.expect(";")?;
        reader.go(place.clone(), MoveTarget::Label(place, label));
    } else {
        return Ok(false);
    }
    Ok(true)
}

/// A line of `/POS`.
fn position<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<()> {
    if line.passes("P[") {
        let place = line.clone();
        let label = label(line)?;
        reader.open = Some(OpenPoint {
            label,
            place,
            values: vec![None; reader.joints],
            pose: [None; 7],
            external: Vec::new(),
            group: 1,
        });
    } else if line.passes("}") {
        if let Some(open) = reader.open.take() {
            let label = open.label;
            let target = if open.pose.iter().any(Option::is_some) {
                match open.pose.iter().take(6).position(Option::is_none) {
                    None => {
                        let mut pose = reader.pose(open.pose, &open.place);
                        pose.external = open.external;
                        Ok(MoveTarget::Pose(pose))
                    }
                    Some(at) => Err(POSE[at].to_string()),
                }
            } else {
                reader.complete(&open.values)
            };
            // It counts only where a move goes there: controllers keep points that were never taught.
            let unset = |name| MoveTarget::Unset(open.place, format!("{label} has no {name}."));
            reader.point(&label, target.unwrap_or_else(unset));
        }
    } else if let Some(open) = &mut reader.open {
        fields(line, open, reader.is_path)?;
    }
    Ok(())
}

/// Numbers of a pose in their order.
const POSE: [&str; 6] = ["X", "Y", "Z", "W", "P", "R"];

/// A line within a position: `J1= 10.000 deg,`.
fn fields<'a>(line: &mut Cursor<'a>, open: &mut OpenPoint<'a>, is_path: bool) -> Result<()> {
    if line.passes("GP") {
        open.group = if is_path { line.number()? as u32 } else { 1 };
        return Ok(());
    }
    if line.word("UF") || (is_path && line.word("CONFIG")) {
        return Ok(());
    }
    let values = &mut open.values;
    while !line.is_done() {
        let mut field = line.clone();
        let axis = line.identifier()?.to_ascii_uppercase();
        let joint_axis = (0..9).find(|i| (LS.axis_name)(*i) == axis);
        if is_path && line.clone().passes("=") && line.rest().trim_start()[1..].trim_start().starts_with('*') {
            // Never taught.
            line.skip(line.rest().find(',').map_or(line.rest().len(), |comma| comma + 1));
            continue;
        }
        if let Some(at) = POSE.iter().position(|name| is_path && open.group == 1 && *name == axis) {
            line.expect("=")?;
            if open.pose[at].replace(line.placed()?).is_some() {
                return Err(field.wrong_here(format!("`{axis}` stands twice in this position.")));
            }
            let _ = line.word("mm") || line.word("deg");
            if !line.passes(",") {
                line.end()?;
            }
            continue;
        }
        if is_path && (open.group > 1 || joint_axis.is_some_and(|at| at >= values.len())) {
            line.expect("=")?;
            let name = if open.group > 1 { format!("{axis} of group {}", open.group) } else { axis };
            open.external.push(External { name, value: line.number()?, place: field });
            let _ = line.word("mm") || line.word("deg");
            if !line.passes(",") {
                line.end()?;
            }
            continue;
        }
        let Some(joint_axis) = joint_axis else {
            let message = format!("`{axis}` is not a joint: only positions in joint representation can be read.");
            return Err(field.wrong_here(message));
        };
        line.expect("=")?;
        let value = line.angle()?;
        let unit = line.word("deg");
        match values.get_mut(joint_axis) {
            Some(value_of) if unit => *value_of = Some(value),
            Some(_) => return Err(line.wrong_here("`deg` is missing here.")),
            // Further axes of the group are none of the cell's.
            None => {
                line.word("mm");
            }
        }
        if !line.passes(",") {
            line.end()?;
        }
    }
    Ok(())
}
