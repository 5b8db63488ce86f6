//! Writing of paths.

use super::contents::{Content, PathKind};
use super::format::{FormatColumn, PathFormat};
use crate::table::line::separated;
use crate::table::quantity::Unit;
use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};
use std::borrow::Borrow;
use std::f64::consts::PI;
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::path::{PathPoint, PathTarget};
use stiffarm::model::process::{ForceAxes, TipLoad};
use stiffarm::units::rounded;

/// Decimals of a component of the tool axis.
const AXIS_DECIMALS: i32 = 12;

/// A path in the columns of `format`, which [`read_path`](super::read_path)
/// reads: in its order and units, with its separator and decimal sign, LF. Targets are in the base frame, as
/// everywhere; a load is carried over where the table has columns for it, and
/// where it is `None` its fields stay empty.
///
/// Angles and loads are the shortest decimals that are read back as the same
/// values. Poses come out of products of rotations, so their last digits are
/// rounding: they are written to 1e-12 m and 1e-10° (in other units as fine or
/// finer), and what was written, read and written again is the same text. Of roll
/// and yaw only a sum counts at a pitch of ±90°; roll is 0 there.
///
/// # Errors
/// A target that the columns cannot hold (angles for poses or the reverse, a tool
/// axis for poses), a wrong number of angles, a load whose axes or moment the
/// table has no column for.
pub fn write_path<P: Borrow<PathPoint>>(format: &PathFormat, points: impl IntoIterator<Item = P>) -> Result<String> {
    let headings: Vec<String> = format.columns.iter().map(|c| c.heading.clone()).collect();
    let line = |fields: &[String]| separated(fields, format.separator);
    let mut text = line(&headings);
    let mut fields = Vec::with_capacity(headings.len());
    let points = points.into_iter();
    let (heading, rows) = (text.len(), points.size_hint().0);
    for (i, point) in points.enumerate() {
        if i == 1 {
            // As long as the first row and a little more: no copy as it grows.
            text.reserve((text.len() - heading + 8) * rows);
        }
        let point = point.borrow();
        let target = Numbers::of(format, point)?;
        check_load(format, point)?;
        fields.clear();
        let columns = format.columns.iter();
        fields.extend(columns.map(|column| {
            let text = field(column, point, &target);
            match (column.content, format.decimal_commas) {
                (Content::Name | Content::Axes | Content::Feature, _) | (_, false) => text,
                (_, true) => text.replace('.', ","),
            }
        }));
        text += &line(&fields);
    }
    Ok(text)
}

/// The numbers that say where the tip is: angles \[rad\], or position \[m\] and
/// rotation or tool axis in the frame of the table.
enum Numbers<'p> {
    Angles(&'p [f64]),
    Pose(Isometry3<f64>, [f64; 3]),
    Axis(Vector3<f64>, [f64; 3]),
}

impl<'p> Numbers<'p> {
    fn of(format: &PathFormat, point: &'p PathPoint) -> Result<Self> {
        let from_base = format.workpiece.inverse();
        let place = |p: &Vector3<f64>| from_base.rotation * p + from_base.translation.vector;
        match (format.kind, &point.target) {
            (PathKind::Angles, PathTarget::Angles(q)) => {
                let count = |c: &&FormatColumn| matches!(c.content, Content::Angle(_));
                let joints = format.columns.iter().filter(count).count();
                if q.len() != joints {
                    let message = format!("Point {} has {} angles, the table {joints}.", point.name, q.len());
                    return Err(Error::new(Code::Dimension, message));
                }
                Ok(Numbers::Angles(q))
            }
            (PathKind::Poses, PathTarget::Pose(pose)) => {
                let pose = from_base * pose;
                let turn = format.columns.iter().find(|c| c.content == Content::Turn(0));
                let unit = turn.and_then(|column| column.unit);
                let turns = unit.map(|unit| rounded_turns(&pose.rotation, &unit));
                Ok(Numbers::Pose(pose, turns.unwrap_or_default()))
            }
            (PathKind::ToolAxes, PathTarget::Axis { position, axis }) => {
                let axis = rounded_axis(&(from_base.rotation * axis.as_ref()));
                Ok(Numbers::Axis(place(position), axis))
            }
            (PathKind::ToolAxes, PathTarget::Pose(pose)) => {
                let axis = pose.rotation * Vector3::z();
                let axis = rounded_axis(&(from_base.rotation * axis));
                Ok(Numbers::Axis(place(&pose.translation.vector), axis))
            }
            (kind, target) => {
                let target_kind = match target {
                    PathTarget::Angles(_) => "joint angles",
                    PathTarget::Pose(_) => "a pose",
                    PathTarget::Axis { .. } => "a position with a tool axis",
                };
                let wanted = match kind {
                    PathKind::Angles => "joint angles",
                    PathKind::Poses => "poses",
                    PathKind::ToolAxes => "positions with a tool axis",
                };
                let message = format!("Point {} is given as {target_kind}; the table holds {wanted}.", point.name);
                Err(Error::new(Code::Conflict, message))
            }
        }
    }
}

impl PathFormat {
    /// Whether a table can hold the whole load of a point, or none.
    pub(crate) fn holds(&self, point: &PathPoint) -> bool {
        check_load(self, point).is_ok()
    }
}

/// Refuses a load of which the table could hold a part only.
fn check_load(format: &PathFormat, point: &PathPoint) -> Result<()> {
    let Some(load) = point.load.as_ref().filter(|_| format.has_loads()) else {
        return Ok(());
    };
    let missing = if !format.has(Content::Axes) && format.axes != Some(load.axes) {
        format!("the axes \"{}\" of its load", load.axes.as_str())
    } else if !format.has(Content::Moment(0)) && load.moment != Vector3::zeros() {
        "the moment of its load".to_string()
    } else {
        return Ok(());
    };
    let message = format!("Point {}: the table has no column for {missing}.", point.name);
    Err(Error::new(Code::Conflict, message))
}

fn field(column: &FormatColumn, point: &PathPoint, target: &Numbers<'_>) -> String {
    let load = point.load.as_ref();
    let of_load = |value: fn(&TipLoad) -> &Vector3<f64>, i: usize| {
        load.map_or_else(String::new, |load| shortest(column, value(load)[i]))
    };
    match (column.content, target) {
        (Content::Name, _) => point.name.to_string(),
        (Content::Angle(j), Numbers::Angles(q)) => shortest(column, q[j]),
        (Content::Position(i), Numbers::Pose(pose, _)) => length(column, pose.translation.vector[i]),
        (Content::Position(i), Numbers::Axis(position, _)) => length(column, position[i]),
        (Content::Turn(i), Numbers::Pose(_, turns)) => turns[i].to_string(),
        (Content::Axis(i), Numbers::Axis(_, axis)) => axis[i].to_string(),
        (Content::Force(i), _) => of_load(|load| &load.force, i),
        (Content::Moment(i), _) => of_load(|load| &load.moment, i),
        (Content::Feature, _) => point.feature.as_deref().unwrap_or_default().to_string(),
        (Content::Feed, _) => point.feed.map_or_else(String::new, |feed| shortest(column, feed)),
        (Content::Axes, _) => {
            let axes = load.map(|load| ForceAxes::as_str(load.axes));
            axes.unwrap_or_default().to_string()
        }
        // The kinds of columns and of numbers are the same.
        _ => String::new(),
    }
}

/// A value in the column's unit, read back as the same.
fn shortest(column: &FormatColumn, value: f64) -> String {
    let number = column.unit.map_or(value, |unit| unit.shortest(value));
    number.to_string()
}

/// A length to a picometre.
fn length(column: &FormatColumn, value: f64) -> String {
    let number = column.unit.map(|unit| {
        let decimals = match unit.suffix {
            "m" => 12,
            "um" => 6,
            "in" => 11,
            _ => 9,
        };
        unit.rounded(value, decimals)
    });
    number.unwrap_or(value).to_string()
}

/// Roll, pitch, yaw of Rz(yaw) Ry(pitch) Rx(roll) as numbers of `unit`, rounded so
/// that the rotation they make has the same ones again.
fn rounded_turns(rotation: &UnitQuaternion<f64>, unit: &Unit) -> [f64; 3] {
    let decimals = match unit.suffix {
        "rad" => 12,
        _ => 10,
    };
    let r: Matrix3<f64> = rotation.to_rotation_matrix().into_inner();
    let cosine = r[(2, 1)].hypot(r[(2, 2)]);
    let pitch = unit.rounded((-r[(2, 0)]).atan2(cosine), decimals);
    // A turn by roll moves the tool by cos(pitch) of it, and roll is known that well:
    // it has as many decimals less. The decades end between powers of ten, so
    // that none ends at a pitch of 0.
    let lost = (unit.to_si)(pitch).cos().max(1e-16).log10().round() as i32;
    let roll = if lost > -12 { rounded_turn(r[(2, 1)].atan2(r[(2, 2)]), decimals + lost, unit) } else { 0.0 };
    // Yaw is what is left once this roll is undone.
    let (s, c) = (unit.to_si)(roll).sin_cos();
    let yaw = (s * r[(0, 2)] - c * r[(0, 1)]).atan2(c * r[(1, 1)] - s * r[(1, 2)]);
    [roll, pitch, rounded_turn(yaw, decimals, unit)]
}

/// A turn \[rad\] as a rounded number of `unit` above −π and up to π.
fn rounded_turn(turn: f64, decimals: i32, unit: &Unit) -> f64 {
    let number = unit.rounded(turn, decimals);
    if (unit.to_si)(number).abs() > PI {
        // Radians do not hold half a turn: the next number inside.
        rounded(number - number.signum() * 10f64.powi(-decimals), decimals)
    } else if (unit.to_si)(number) == -PI {
        // Half a turn back is half a turn on: rounding decides which of them it is.
        -number
    } else {
        number
    }
}

/// Components of a unit vector, rounded: two to a fixed number of decimals, the
/// largest as they leave it, so that the length stays one to the last digit and
/// the vector that is read has the same ones again.
fn rounded_axis(axis: &Vector3<f64>) -> [f64; 3] {
    let mut axis: [f64; 3] = (*axis).into();
    let largest = axis.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
    // Among equals the last, whichever rounding made larger.
    let Some(free) = axis.iter().rposition(|a| a.abs() > largest - 1e-6) else {
        return axis;
    };
    let sign = axis[free].signum();
    let mut rest = 1.0;
    for (i, a) in axis.iter_mut().enumerate() {
        if i != free {
            *a = rounded(*a, AXIS_DECIMALS);
            rest -= *a * *a;
        }
    }
    axis[free] = sign * rounded(rest.max(0.0).sqrt(), 15);
    axis
}
