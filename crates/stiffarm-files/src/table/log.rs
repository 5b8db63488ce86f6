//! `along_mm` or `time_s`, and `fx_n,fy_n,fz_n[,mx_nm,my_nm,mz_nm]` or `power_w`: a recorded load along a path.

use super::beside::RowQuantity;
use super::grid::Table;
use super::heading::ColumnDefinition;
use super::quantity::Quantity;
use nalgebra::{Vector3, Vector6};
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::cell::Cell;
use stiffarm::model::load_log::{CountedBy, LoadLog, Recorded};
use stiffarm::model::process::ForceAxes;

/// Reads a log of the load along a path; `file_name` is for messages, `axes` are those of its forces.
///
/// # Errors
/// A heading or row that cannot be read, columns that say neither or both of way and time, of forces and
/// power, forces without axes, rows that go back, fewer than two rows: with line, column and the column's name.
pub fn read_log(bytes: &[u8], file_name: &str, cell: &Cell, axes: Option<ForceAxes>) -> Result<LoadLog> {
    let table = Table::read(bytes, file_name, &cell.columns)?;
    read(&table, axes).map_err(|error| table.with_aside(error))
}

fn read(table: &Table<'_>, axes: Option<ForceAxes>) -> Result<LoadLog> {
    let mut definitions = vec![
        ColumnDefinition::of("along", Quantity::Length, "along"),
        ColumnDefinition::of("time", Quantity::Time, "time"),
        ColumnDefinition::of("power", Quantity::Power, "power"),
    ];
    definitions.extend(RowQuantity::Force.definitions());
    definitions.extend(RowQuantity::Moment.definitions());
    let heading = table.check_heading(&definitions, 0)?;
    let choice = |first: &str, second: &str, columns: [&str; 2]| {
        let (one, other) = (heading.get(first), heading.get(second));
        match (one, other) {
            (Some(column), None) => Ok((true, column)),
            (None, Some(column)) => Ok((false, column)),
            (Some(_), Some(column)) => {
                let message = format!("The log has both {}.", columns.join(" and "));
                let error = table.heading_error(Some(column.at), Code::Conflict, message);
                Err(error.hint("keep one of them"))
            }
            (None, None) => {
                let message = format!("The log has neither {}.", columns.join(" nor "));
                let error = table.heading_error(None, Code::TableHeading, message);
                Err(error.hint(
                    "a log has along_mm or time_s, counted from the path's first point, and fx_n, fy_n, fz_n or \
                     power_w",
                ))
            }
        }
    };
    let (is_length, at) = choice("along", "time", ["along_mm", "time_s"])?;
    let (has_forces, value) = choice("fx", "power", ["fx_n, fy_n, fz_n", "power_w"])?;
    let what = match (has_forces, axes) {
        (false, _) => Recorded::Power,
        (true, Some(axes)) => Recorded::Loads(axes),
        (true, None) => {
            let message = "The axes of the log's forces are not given.";
            let error = table.heading_error(Some(value.at), Code::MissingKey, message);
            return Err(error.hint("say them: --axes base, tool, workpiece or path"));
        }
    };
    let force = if has_forces {
        heading.all(&RowQuantity::Force.definitions(), "give all three components of the force")?
    } else {
        Vec::new()
    };
    let moment = heading.all_or_none(&RowQuantity::Moment.definitions(), &RowQuantity::Moment.hint())?;
    let mut stations: Vec<f64> = Vec::new();
    let mut values = Vec::new();
    for row in table.rows()? {
        let station = table.number(&row, at)?;
        if stations.last().is_some_and(|before| station < *before) {
            let message = "The log goes back here.";
            let error = table.error(&row, at.at, Code::TableRow, message);
            return Err(error.hint("the rows of a log stand in the order in which they were recorded"));
        }
        stations.push(station);
        let [force, moment]: [Vector3<f64>; 2] = if has_forces {
            [
                table.vector(&row, &force)?,
                moment.as_deref().map(|moment| table.vector(&row, moment)).transpose()?.unwrap_or_default(),
            ]
        } else {
            [Vector3::new(table.number(&row, value)?, 0.0, 0.0), Vector3::zeros()]
        };
        values.push(Vector6::from_iterator(force.iter().chain(&moment).copied()));
    }
    if stations.len() < 2 {
        let error: Error = table.heading_error(None, Code::TooFewData, "A log needs two rows or more.");
        return Err(error);
    }
    let by = if is_length { CountedBy::Length } else { CountedBy::Time };
    Ok(LoadLog::new(by, what, stations, values))
}
