//! Paths in INFORM: jobs whose positions are Cartesian.
//!
//! `///POSTYPE` says in which frame the positions behind it count, `///USER` and `///TOOL` which frame and tool; a
//! position is x, y, z in millimetres and turns about fixed x, y, z in degrees (the developer pages of Yaskawa
//! Motoman, YMConnect; the public posts in github.com/ros-industrial-attic/robodk_postprocessors, `Motoman.py`). An
//! arc is three `MOVC`: a straight way to the first, then the arc through the second to the third; `FPT` at the third
//! begins another one there.

use super::cursor::Cursor;
use super::move_target::{External, Motion, MoveTarget};
use super::reader::{Reader, Section};
use stiffarm::error::Result;
use stiffarm::findings::Severity;

/// The words of moves.
const MOVES: [(&str, Motion); 3] = [("MOVJ", Motion::Joint), ("MOVL", Motion::Linear), ("MOVC", Motion::Circular)];

/// What sets a frame of the controller: the instruction, how it names the frame, and what a job calls it.
const SETS: [[&str; 3]; 2] = [["MFRAME", "UF#(", "USER"], ["SETTOOL", "TL#(", "TOOL"]];

/// A line of a path.
pub fn read<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    if line.clone().passes("/") || line.is_done() {
        head(line, reader)?;
        return Ok(true);
    }
    if reader.section != Section::Body {
        position(line, reader)?;
        return Ok(true);
    }
    if line.clone().passes("+") {
        return Err(line.wrong_here("A move of a second robot or station along with this one (+) is not read here."));
    }
    if line.clone().word("SFTON") {
        return Err(line.wrong_here("SFTON shifts the positions behind it: shifted positions are not read."));
    }
    for [word, before, name] in SETS {
        if line.clone().word(word) {
            let set = line.behind(before).and_then(|set| set.rest().split_once(')'));
            let index = set.map_or("", |(index, _)| index.trim());
            reader.sets(line, format!("{name} {index}"));
            return Ok(true);
        }
    }
    let Some(motion) = line.motion(&MOVES) else {
        if line.clone().word("END") && matches!(reader.arc_points, 1 | 2) {
            return Err(too_few(line));
        }
        return Ok(false);
    };
    movement(line, motion, reader)?;
    Ok(true)
}

/// What the positions that follow are: `///POSTYPE USER`, `///USER 3`, `///TOOL 1`.
fn head<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<()> {
    let number = line.line_number();
    if reader.section == Section::Body {
        return Ok(());
    }
    for (at, word) in ["TOOL", "USER"].into_iter().enumerate() {
        if line.word(&format!("///{word}")) {
            reader.takes(at, format!("{word} {}", line.rest().trim()), number);
            return Ok(());
        }
    }
    if !line.word("///POSTYPE") {
        return Ok(());
    }
    reader.has_poses = !(line.word("PULSE") || line.word("ANGLE"));
    if let Some(frame_name) = ["BASE", "ROBOT"].into_iter().find(|frame_name| line.word(frame_name)) {
        reader.takes(1, frame_name, number);
    } else if reader.has_poses && !line.word("USER") {
        return Err(line.wrong_here("Positions are read in BASE, ROBOT, USER and PULSE, not in this frame."));
    }
    Ok(())
}

/// `C00000=x,y,z,Rx,Ry,Rz`, or pulses of any axes.
fn position<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<()> {
    let label = line.identifier()?;
    if !line.passes("=") {
        return Ok(());
    }
    let is_pose = reader.has_poses && label.starts_with(['C', 'c']);
    let (mut numbers, mut external) = ([None; 7], Vec::new());
    for axis in 0.. {
        let place = line.clone();
        match numbers.get_mut(axis).filter(|_| is_pose && axis < 6) {
            Some(number) => *number = Some(line.placed()?),
            None => {
                let name = format!("axis {} of {}", axis + 1, label.trim_end_matches(|c: char| c.is_ascii_digit()));
                let value = line.number()?;
                external.push(External { name, value, place });
            }
        }
        if !line.passes(",") {
            break;
        }
    }
    let target = if is_pose {
        let mut pose = reader.pose(numbers, line);
        (pose.frames, pose.external) = (reader.taken.clone(), external);
        MoveTarget::Pose(pose)
    } else {
        MoveTarget::Angles(Vec::new(), external)
    };
    reader.point(label, target);
    Ok(())
}

/// `MOVL C00001 BC00001 V=100.0 PL=0`.
fn movement<'a>(line: &mut Cursor<'a>, motion: Motion, reader: &mut Reader<'a>) -> Result<()> {
    let mut place = line.clone();
    let label = line.identifier()?;
    if label.starts_with(['P', 'p']) && motion != Motion::Joint {
        let message =
            format!("`{label}` is a variable of the controller: only positions of the job (C00001) are read.");
        return Err(place.wrong_here(message));
    }
    let point = reader.target_of(label).cloned();
    let mut target = point.unwrap_or_else(|| MoveTarget::Label(place.clone(), label.to_string()));
    // What carries the robot or the workpiece has positions of its own; those of the arm in pulses are its joints.
    if let MoveTarget::Pose(pose) = &mut target {
        let mut others = line.clone();
        while let Some(MoveTarget::Angles(_, axes)) = others.identifier().ok().and_then(|other| reader.target_of(other))
        {
            pose.external.extend(axes.iter().cloned());
        }
    } else if let MoveTarget::Angles(_, axes) = &mut target {
        axes.clear();
    }
    if line.behind("UNTIL").is_some() {
        reader.passes_over(line, "UNTIL");
    }
    let feed = line.behind("V=").and_then(|mut feed| feed.number().ok());
    if feed.is_some() {
        let sentence =
            "Speeds (V=, {}) are taken as mm/s; where the controller counts them in cm/min, feeds are others.";
        reader.remark("speed-unit", "", line, Severity::Note, sentence);
    }
    let via = match (motion, reader.arc_points) {
        (Motion::Circular, 1 | 4) => {
            reader.arc = Some((place, target));
            reader.arc_points = 2;
            return Ok(());
        }
        (Motion::Circular, 2) => reader.arc.take().map(|(_, via)| via),
        (Motion::Circular, 3) => {
            let message = "A fourth point of an arc is not read: say FPT at the third, where another arc begins.";
            return Err(place.wrong_here(message));
        }
        (_, 1 | 2) if motion != Motion::Circular => return Err(too_few(&place)),
        _ => None,
    };
    let is_arc = via.is_some();
    reader.arc_points = match motion {
        Motion::Circular if is_arc && line.behind("FPT").is_none() => 3,
        Motion::Circular if is_arc => 4,
        Motion::Circular => 1,
        _ => 0,
    };
    let motion = if motion == Motion::Circular && !is_arc { Motion::Linear } else { motion };
    reader.moves(place, motion, via, target);
    reader.at_feed(feed.map(|mm| mm * 1e-3));
    Ok(())
}

fn too_few(line: &Cursor<'_>) -> stiffarm::Error {
    line.clone().wrong_here("The arc before this has fewer than three points (MOVC).")
}
