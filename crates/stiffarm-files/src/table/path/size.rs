//! Positions whose size shows that they are in another unit.

use super::heading::PathColumns;
use crate::table::grid::Table;
use nalgebra::{Isometry3, Point3, Vector3};
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::length;
use stiffarm::model::cell::Cell;
use stiffarm::model::path::{PathPoint, PathTarget};

/// A path all of whose points are nearer to axis 1 than this part of the arm's
/// reach lies inside the robot: 10 mm of 3 m.
const INSIDE: f64 = 1.0 / 300.0;

/// A path smaller than this part of the reach is no work for it: 1 mm of 3 m.
const TINY: f64 = 1.0 / 3000.0;

/// A path all of whose points are farther than this many reaches is nowhere near.
const FARTHEST_REACHES: f64 = 5.0;

/// Refuses positions that look like those in another unit.
pub(super) fn check_size(table: &Table<'_>, columns: &PathColumns, cell: &Cell, points: &[PathPoint]) -> Result<()> {
    let Some(first) = columns.position.first() else {
        return Ok(());
    };
    let suffix = first.unit.map_or("", |unit| unit.suffix);
    let positions: Vec<Vector3<f64>> = points
        .iter()
        .filter_map(|point| match &point.target {
            PathTarget::Pose(pose) => Some(pose.translation.vector),
            PathTarget::Axis { position, .. } => Some(*position),
            PathTarget::Angles(_) => None,
        })
        .collect();
    let refuse = |message: String, hint: &str| -> Result<()> {
        let error: Error = table.heading_error(Some(first.at), Code::InvalidValue, message);
        Err(error.hint(hint))
    };
    let arm = Arm::of(cell);
    let distances = positions.iter().map(|p| arm.beside_axis(p).norm());
    let nearest = distances.fold(f64::INFINITY, f64::min);
    if nearest > FARTHEST_REACHES * arm.reach {
        let message = format!(
            "The numbers look like another unit: the nearest point is {nearest:.0} m away, and the arm is {:.1} m \
             long.",
            arm.reach
        );
        return match suffix {
            "mm" => refuse(message, "if they are micrometres, name the columns x_um, y_um, z_um"),
            "um" => refuse(message, "check the columns and [work] workpiece_mm of the cell"),
            _ => refuse(message, "if they are millimetres, name the columns x_mm, y_mm, z_mm"),
        };
    }
    if suffix != "mm" {
        return Ok(());
    }
    let small = Extent::of(&positions);
    let inside = |p: &Vector3<f64>| arm.beside_axis(p).xy().amax() < INSIDE * arm.reach;
    if positions.iter().all(inside) && small.largest < 3.0 * INSIDE * arm.reach {
        let message =
            "The numbers look like metres: as millimetres, the whole path lies inside the robot, at its axis 1.";
        let hint = "if they are metres, name the columns x_m, y_m, z_m";
        return refuse(message.to_string(), hint);
    }
    // In a frame of its own a path in metres lies beside its origin.
    let workpiece = &cell.work.workpiece;
    let as_metres = |p: &Vector3<f64>| {
        let local = workpiece.inverse_transform_point(&Point3::from(*p));
        workpiece.transform_point(&(local * 1e3)).coords
    };
    if written_to_a_nanometre(table, columns) {
        return Ok(());
    }
    let reachable = |p: &Vector3<f64>| arm.beside_axis(&as_metres(p)).norm() < arm.reach;
    if small.has_shape && small.largest < TINY * arm.reach && positions.iter().all(reachable) {
        let message = format!(
            "The numbers look like metres: as millimetres, the whole path is within {}.",
            length(small.largest)
        );
        let hint =
            "if they are metres, name the columns x_m, y_m, z_m; a path that small can be given as x_um, y_um, z_um";
        return refuse(message, hint);
    }
    Ok(())
}

/// True where the numbers have the decimals with which this program writes
/// millimetres. Metres are typed with fewer and calculated with more, and a
/// compensated dwell is as small as its corrections.
fn written_to_a_nanometre(table: &Table<'_>, columns: &PathColumns) -> bool {
    let rows = table.rows().unwrap_or_default();
    let fields = rows.iter().flat_map(|row| {
        let at = columns.position.iter().map(|column| column.at);
        at.filter_map(|at| row.fields.get(at))
    });
    let decimals = fields.map(|field| {
        let fraction = field.text.split(['.', ',']).nth(1).unwrap_or_default();
        fraction.bytes().take_while(u8::is_ascii_digit).count()
    });
    matches!(decimals.max(), Some(8..=9))
}

/// Where the robot stands, and how far it reaches at most.
struct Arm {
    axis: Isometry3<f64>,
    reach: f64,
}

impl Arm {
    fn of(cell: &Cell) -> Self {
        let robot = &cell.setup.robot;
        let (first, others) = robot.joints().split_first().unzip();
        let links = others.unwrap_or_default().iter();
        let links = links.map(|joint| joint.placement.translation.vector.norm());
        let tip = cell.work.tip(&cell.setup.tool).translation.vector.norm();
        let flange = robot.flange().translation.vector.norm();
        Arm {
            axis: first.map_or_else(Isometry3::identity, |joint| joint.placement),
            reach: links.sum::<f64>() + flange + tip,
        }
    }

    /// A point in the frame of axis 1, which is its z \[m\].
    fn beside_axis(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let point = Point3::from(*point);
        self.axis.inverse_transform_point(&point).coords
    }
}

/// How large a path is.
struct Extent {
    /// Largest side of the box around it \[m\].
    largest: f64,
    /// Three or more of its points are apart from each other.
    has_shape: bool,
}

impl Extent {
    fn of(positions: &[Vector3<f64>]) -> Self {
        let Some(first) = positions.first() else {
            return Extent { largest: 0.0, has_shape: false };
        };
        let (mut low, mut high) = (*first, *first);
        for position in positions {
            low = low.inf(position);
            high = high.sup(position);
        }
        let mut others = positions.iter().filter(|p| *p != first);
        let second = others.next();
        Extent { largest: (high - low).amax(), has_shape: second.is_some_and(|second| others.any(|p| p != second)) }
    }
}
