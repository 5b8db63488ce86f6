//! Reading of paths.

use super::heading::PathColumns;
use super::size::check_size;
use super::{PathFormat, PathKind, PathTable};
use crate::table::grid::{Column, Row, Table};
use crate::table::naming::normal;
use crate::table::postures::angles;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, UnitVector3, Vector3};
use std::collections::HashMap;
use std::sync::Arc;
use stiffarm::error::{Code, Error, Result, did_you_mean};
use stiffarm::model::cell::Cell;
use stiffarm::model::path::{FASTEST, PathPoint, PathTarget};
use stiffarm::model::process::{ForceAxes, TipLoad};

/// A tool axis shorter than this has no direction.
const SHORTEST_AXIS: f64 = 1e-9;

/// What helps where a force has no frame.
const AXES_HINT: &str =
    "add a column axes with base, tool, workpiece or path in each row, or give the axes of the whole table with --axes";

/// Reads a path of the tool tip from a table with one row per point; `file_name`
/// is for messages. Each row has one of three forms:
///
/// - `q1_deg, …, qn_deg`: controller angles, within the machine's limits;
/// - `x_mm, y_mm, z_mm, roll_deg, pitch_deg, yaw_deg`: pose of the tip frame,
///   Rz(yaw) Ry(pitch) Rx(roll), turns about x, then y, then z of the frame that
///   stays;
/// - `x_mm, y_mm, z_mm, axis_x, axis_y, axis_z`: position of the tip and direction
///   of the tool axis, of any length; the turn about it is free.
///
/// Poses and tool axes are those in the cell's workpiece frame, which is the base
/// frame where the cell names none; the targets that are returned are in the base
/// frame. `point` names the points; without it they are numbered from 1.
///
/// `fx_n, fy_n, fz_n` and `mx_nm, my_nm, mz_nm` are force and moment *on the robot*
/// at the tip, in the axes of the column `axes` or, where a row has none there, in
/// `axes`. A row whose fields of force and moment are all empty takes the load of
/// the cell's process. `feature` names the feature of the part that a point belongs to, `feed_mm_per_min` is the
/// feed at which the tip gets there. All columns may be in other units, as in every
/// [table](crate::table), and have the headings that the cell's `[columns]` names.
///
/// # Errors
/// A heading or row that cannot be read, both angles and poses, a force without a
/// frame, a name that appears twice, angles outside the machine's limits, a tool
/// axis of length zero, positions whose size shows that they are in another unit:
/// with line, column and the column's name.
pub fn read_path(bytes: &[u8], file_name: &str, cell: &Cell, axes: Option<ForceAxes>) -> Result<PathTable> {
    let table = Table::read(bytes, file_name, &cell.columns)?;
    read(&table, cell, axes).map_err(|error| table.with_aside(error))
}

fn read(table: &Table<'_>, cell: &Cell, axes: Option<ForceAxes>) -> Result<PathTable> {
    let columns = PathColumns::of(table, cell)?;
    let reader = Reader { table, columns: &columns, cell, axes };
    let rows = table.rows()?;
    let mut points = Vec::with_capacity(rows.len());
    let mut lines: HashMap<&str, usize> = HashMap::with_capacity(rows.len());
    for (i, row) in rows.iter().enumerate() {
        let name = match columns.point {
            Some(column) => {
                let name = table.name(row, column)?;
                table.once(&mut lines, ("point", name), row, column.at).map_err(|e| {
                    e.hint("give each point a name of its own, or leave the column out: points are then numbered")
                })?;
                name.into()
            }
            None => (i + 1).to_string().into(),
        };
        points.push(PathPoint {
            name,
            line: Some(row.line),
            target: reader.target(row)?,
            load: reader.load(row)?,
            feature: reader.feature(row)?,
            feed: reader.feed(row)?,
            rapid: false,
        });
    }
    check_size(table, &columns, cell, &points)?;
    let format = PathFormat {
        columns: columns.format,
        kind: columns.kind,
        workpiece: cell.work.workpiece,
        axes,
        separator: table.delimiter,
        decimal_commas: table.has_decimal_commas(),
    };
    Ok(PathTable { points, format })
}

struct Reader<'a> {
    table: &'a Table<'a>,
    columns: &'a PathColumns,
    cell: &'a Cell,
    /// Axes of the loads of rows that do not say it.
    axes: Option<ForceAxes>,
}

impl Reader<'_> {
    /// Where the tip should be, base frame.
    fn target(&self, row: &Row) -> Result<PathTarget> {
        let (table, columns) = (self.table, self.columns);
        if columns.kind == PathKind::Angles {
            let robot = &self.cell.setup.robot;
            return angles(table, row, &columns.angles, robot).map(PathTarget::Angles);
        }
        let workpiece = &self.cell.work.workpiece;
        let position = table.vector(row, &columns.position)?;
        let orientation = table.vector(row, &columns.orientation)?;
        if columns.kind == PathKind::Poses {
            let [roll, pitch, yaw] = orientation.into();
            let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
            let pose = Isometry3::from_parts(Translation3::from(position), rotation);
            return Ok(PathTarget::Pose(workpiece * pose));
        }
        let Some(axis) = UnitVector3::try_new(orientation, SHORTEST_AXIS) else {
            let message = "The tool axis has length zero.";
            let at = columns.orientation[0].at;
            let error = table.error(row, at, Code::InvalidValue, message);
            return Err(error.hint("give the direction from the tool into the workpiece, for example 0, 0, -1"));
        };
        Ok(PathTarget::Axis {
            position: workpiece.rotation * position + workpiece.translation.vector,
            axis: workpiece.rotation * axis,
        })
    }

    /// The row's own load; `None` where all its fields are empty.
    fn load(&self, row: &Row) -> Result<Option<TipLoad>> {
        let (table, columns) = (self.table, self.columns);
        // A slip in a word is found even where there is no load.
        let row_axes = self.row_axes(row)?;
        let Some(force) = &columns.force else {
            return Ok(None);
        };
        let fields = || force.iter().chain(columns.moment.iter().flatten());
        let blank = |column: &&Column| table.is_blank(row, **column);
        if fields().all(|column| blank(&column)) {
            return Ok(None);
        }
        if let Some(empty) = fields().find(blank) {
            let message = "The field is empty, but others of this row's load are not.";
            let error = table.error(row, empty.at, Code::TableRow, message);
            return Err(
                error.hint("write 0 where there is no component; leave all of them empty for the load of the cell")
            );
        }
        let Some(axes) = row_axes.or(self.axes) else {
            let at = columns.axes.unwrap_or(force[0]).at;
            let message = "The axes of the force are not given.";
            let error = table.error(row, at, Code::TableRow, message);
            return Err(error.hint(AXES_HINT));
        };
        let moment = columns.moment.as_deref();
        let moment = moment.map(|columns| table.vector(row, columns));
        Ok(Some(TipLoad {
            force: table.vector(row, force)?,
            moment: moment.transpose()?.unwrap_or_else(Vector3::zeros),
            axes,
        }))
    }

    /// The feature that the row names.
    fn feature(&self, row: &Row) -> Result<Option<Arc<str>>> {
        let column = self.table.filled(row, self.columns.feature);
        let name = column.map(|column| self.table.name(row, column));
        Ok(name.transpose()?.map(Arc::from))
    }

    /// The feed at which the tip gets to the row's point.
    fn feed(&self, row: &Row) -> Result<Option<f64>> {
        let Some(column) = self.table.filled(row, self.columns.feed) else {
            return Ok(None);
        };
        let feed = self.table.number(row, column)?;
        if !(feed > 0.0 && feed <= FASTEST) {
            let message = "A feed must be above 0, and at most 100 m/s.";
            let error = self.table.error(row, column.at, Code::InvalidValue, message);
            return Err(error.hint("leave the field empty where the feed is not known"));
        }
        Ok(Some(feed))
    }

    /// The axes that the row names.
    fn row_axes(&self, row: &Row) -> Result<Option<ForceAxes>> {
        let table = self.table;
        let Some(column) = table.filled(row, self.columns.axes) else {
            return Ok(None);
        };
        let axes_name = table.name(row, column)?;
        let word = normal(axes_name);
        let mut names = ForceAxes::NAMES.iter();
        if let Some((_, axes)) = names.find(|(name, _)| *name == word) {
            return Ok(Some(*axes));
        }
        let names = ForceAxes::NAMES.map(|(name, _)| name);
        let message = format!("Axes \"{axes_name}\" are not known.");
        let error: Error = table.error(row, column.at, Code::UnknownName, message);
        Err(error.hint(did_you_mean(&word, names).unwrap_or_else(|| format!("axes: {}", names.join(", ")))))
    }
}
