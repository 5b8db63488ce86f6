//! Yaskawa INFORM: a job `.jbi`.
//!
//! Grammar: Yaskawa Motoman, *Sample Inform Header*
//! (knowledge.motoman.com/hc/en-us/article_attachments/21577948130839): `/JOB`, `//NAME` of at most 32
//! characters, `///NPOS` with the numbers of positions, and *NX100 / DX100 Data Transmission Function*,
//! chapter "Job Data Format": comments of at most 32 characters. `///POSTYPE` is PULSE, BASE, ROBOT,
//! TOOL, USER or MTOOL there: joint positions are encoder pulses, whose number per degree is no
//! public figure and comes from the user. (`///POSTYPE ANGLE` is seen in jobs for external axes;
//! neither manual has it for the arm, so it is not written.) `VJ` is per cent of the largest joint speed, `PL=0` ends a
//! move at rest, `PAUSE` waits for the start button. `MSG` shows one line of 32 characters; the
//! whole text stands in comments before it. On arms of seven axes the order is S, L, U, R, B, T, E.
//!
//! The date of the head is a constant, so that equal plans give equal bytes. CR LF, as the
//! controller writes.

use super::characters::said;
use super::cursor::Cursor;
use super::dialect::{Angles, Dialect, PoseForm, Syntax, Tool};
use super::inform_path;
use super::move_target::MoveTarget;
use super::reader::{Reader, Section};
use stiffarm::error::Result;
use stiffarm::model::pose::Convention;
use stiffarm::model::robot::Controller;

/// Characters of a comment and of a message.
const WIDTH: usize = 32;
/// Begins a comment that is part of a text.
const SAID: &str = "> ";

pub const INFORM: Dialect = Dialect {
    name: "inform",
    title: "Yaskawa INFORM",
    controller: Some(Controller::Yaskawa),
    axes: [6, 7],
    axis_name: |axis| Controller::Yaskawa.axis_name(axis),
    in_pulses: true,
    tool: Tool::Number(63, Some("0")),
    upper_case: true,
    reserved: "END NOP",
    syntax: Some(Syntax {
        files: &[("jbi", JOB)],
        comment_width: WIDTH,
        // After `posture `.
        name_width: 24,
        label: |number| format!("C{:05}", number - 1),
        marker: |named| format!("'{named}"),
        movement: |to| vec![format!("MOVJ {} VJ={}.00 PL=0", to.label, to.speed_percent)],
        point: |to| vec![format!("{}={}", to.label, to.values.join(","))],
        wait: |text| {
            let lines = said(text, WIDTH - SAID.len()).into_iter();
            let comments = lines.map(|line| format!("'{SAID}{line}"));
            let shown = format!("MSG \"{}\"", said(text, WIDTH)[0]);
            comments.chain([shown, "PAUSE".to_string()]).collect()
        },
        read,
        joint_move: "MOVJ",
        other_moves: &["MOVL", "MOVC", "MOVS", "IMOV", "SMOVL", "SMOVC", "SMOVJ", "EIMOVL", "EIMOVC", "EMOVL", "EMOVC"],
        branches: &["JUMP", "CALL", "IF", "IFTHEN", "ELSEIF", "FOR", "WHILE", "SWITCH"],
        poses: Some(PoseForm {
            convention: Convention::Fanuc,
            unit: 1e-3,
            degrees: true,
            before: &[],
            decimals: [3, 4],
            in_base: false,
            null_frames: &["BASE", "ROBOT"],
            turns_on_the_way: true,
            moves: None,
        }),
        missing_point: "//POS has no",
        comment: "'",
        comments_fill_lines: true,
        notes: &["///date", "///comm"],
        angle_words: &["="],
        angles: Angles::Second("="),
        ..Syntax::USUAL
    }),
    ..Dialect::USUAL
};

const JOB: &str = "\
/JOB
//NAME {name}
//POS
///NPOS {moves},0,0,0,0,0
///TOOL {tool}
///POSTYPE PULSE
///PULSE
{points}
//INST
///DATE 2000/01/01 00:00
///COMM STIFFARM PLAN
///ATTR SC,RW
///GROUP1 RB1
NOP
'{header}
'{scales}
{body}
END
";

fn read<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    if line.word("//NAME") {
        reader.named(line.identifier()?);
    } else if line.word("//INST") {
        reader.section = Section::Body;
    } else if line.passes("'") {
        match line.rest().strip_prefix(SAID) {
            Some(text) => reader.say(text),
            None => reader.comment(line.rest()),
        }
    } else if reader.is_path {
        return inform_path::read(line, reader);
    } else if line.word("///POSTYPE") {
        if !line.word("PULSE") {
            return Err(line.wrong_here("Only positions in pulses can be read (PULSE)."));
        }
    } else if line.clone().passes("/") || line.is_done() {
    } else if reader.section != Section::Body {
        point(line, reader)?;
    } else if line.word("MSG") {
        // The comments before it have the whole text.
        let text = line.quoted('"')?;
        if !reader.has_said() {
            reader.say(text);
        }
    } else if line.word("PAUSE") {
        reader.wait();
    } else if line.word("MOVJ") {
        let place = line.clone();
        let label = line.identifier()?;
        line.expect("VJ=")?;
        reader.speed = line.percent()?;
        if line.passes("PL=") && line.number()? != 0.0 {
            return Err(line.wrong("The move does not end at rest (PL=0)."));
        }
        line.end()?;
        reader.go(place.clone(), MoveTarget::Label(place, label.to_string()));
    } else {
        return Ok(false);
    }
    Ok(true)
}

/// `C00000=1,2,…`; positions of other groups and position variables are passed over.
fn point(line: &mut Cursor<'_>, reader: &mut Reader<'_>) -> Result<()> {
    let label = line.identifier()?;
    if !label.starts_with(['C', 'c']) {
        return Ok(());
    }
    line.expect("=")?;
    let scales = reader.options.pulses_per_degree.as_deref().unwrap_or_default();
    let values = line.list(scales.len(), |line, axis| {
        let place = line.clone();
        let degrees = line.number()? / scales[axis];
        if degrees.abs() > 1e5 {
            return Err(place.wrong("No axis has so many pulses."));
        }
        Ok(degrees.to_radians())
    })?;
    line.end()?;
    let target = reader.angles(&values);
    reader.point(label, target);
    Ok(())
}
