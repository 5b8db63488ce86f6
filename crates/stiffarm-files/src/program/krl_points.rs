//! Positions in KRL.

use super::cursor::Cursor;
use super::move_target::{External, MoveTarget};
use super::reader::Reader;
use stiffarm::error::Result;
use stiffarm::model::robot::Controller;

/// Numbers of a pose.
pub const POSE: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];

/// What the controller calls an axis.
pub fn axis_name(axis: usize) -> String {
    match axis {
        0..6 => Controller::Kuka.axis_name(axis),
        _ => format!("E{}", axis - 5),
    }
}

/// `DECL E6AXIS XP1={…}`, of one of these types.
pub fn declaration<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>, types: &[&str]) -> Result<bool> {
    while line.word("DECL") || line.word("GLOBAL") || line.word("CONST") {}
    if !types.iter().any(|name| line.word(name)) {
        return Ok(false);
    }
    let label = line.identifier()?;
    if line.passes("=") {
        let target = aggregate(line, reader)?;
        line.end()?;
        reader.point(label, target);
    }
    Ok(true)
}

/// A position in braces, or the label of one.
pub fn move_target<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<MoveTarget<'a>> {
    if line.clone().passes("{") {
        return aggregate(line, reader);
    }
    line.label()
}

/// `{A1 …,A2 …}` or, of a tool path, `{X …,Y …}`, with or without the name of its type.
pub fn aggregate<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<MoveTarget<'a>> {
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
        let joint_axis = (0..12).find(|i| axis_name(*i) == axis);
        if let Some(at) = POSE.iter().position(|name| *name == axis && reader.is_path) {
            if pose[at].replace(line.placed()?).is_some() {
                return Err(field.wrong(format!("`{axis}` stands twice in this position.")));
            }
            (is_pose, last) = (true, line.clone());
        } else if let Some(at) = joint_axis {
            match values.get_mut(at).filter(|_| !is_pose) {
                Some(angle) => *angle = Some(line.angle()?),
                // An axis that is none of the cell's.
                None => external.push(External { value: line.number()?, name: axis, place: field }),
            }
        } else if is_pose {
            // Status and turn, also as bits: `'B010'`.
            if line.clone().passes("'") {
                line.quoted('\'')?;
            } else {
                line.number()?;
            }
        } else {
            let message = format!("`{axis}` is not an axis, and this not a joint position.");
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
        return Ok(MoveTarget::Pose(pose));
    }
    match reader.complete(&values) {
        Ok(MoveTarget::Angles(q, _)) => Ok(MoveTarget::Angles(q, external)),
        Ok(target) => Ok(target),
        Err(axis) => Err(start.wrong(format!("The position has no {axis}."))),
    }
}
