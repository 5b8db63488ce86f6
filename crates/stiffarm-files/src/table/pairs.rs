//! `name,tracker_x_mm,tracker_y_mm,tracker_z_mm,base_x_mm,base_y_mm,base_z_mm`.

use super::grid::{Column, Row, Table};
use super::heading::ColumnDefinition;
use super::quantity::Quantity;
use nalgebra::Vector3;
use std::collections::HashMap;
use stiffarm::error::Result;
use stiffarm::measure::registration::PointPair;
use stiffarm::model::cell::Columns;

/// Reads point pairs from a table with one row per point, its position in
/// tracker axes and in the base frame, each in one unit of length (`_mm`, `_m`,
/// …); `file_name` is for messages.
///
/// # Errors
/// A heading or row that cannot be read, a name that appears twice: with line,
/// column and the column's name.
pub fn read_pairs(bytes: &[u8], file_name: &str) -> Result<Vec<PointPair>> {
    let table = Table::read(bytes, file_name, &Columns::default())?;
    read(&table).map_err(|error| table.with_aside(error))
}

fn read(table: &Table<'_>) -> Result<Vec<PointPair>> {
    let name = ColumnDefinition::name("name");
    let position_of = |frame: &'static str| -> Vec<ColumnDefinition> {
        ["x", "y", "z"]
            .iter()
            .map(|axis| ColumnDefinition::of(format!("{frame}_{axis}"), Quantity::Length, frame))
            .collect()
    };
    let (tracker, base) = (position_of("tracker"), position_of("base"));
    let definitions = [std::slice::from_ref(&name), &tracker, &base].concat();
    let heading = table.check_heading(&definitions, 0)?;
    let hint = "a table of point pairs has the columns name, tracker_x_mm to tracker_z_mm, base_x_mm to base_z_mm";
    let name_column = heading.require(&name, hint)?;
    let (tracker, base) = (heading.all(&tracker, hint)?, heading.all(&base, hint)?);
    let rows = table.rows()?;
    let mut pairs = Vec::with_capacity(rows.len());
    let mut lines: HashMap<&str, usize> = HashMap::new();
    for row in &rows {
        let name = table.name(row, name_column)?;
        table
            .once(&mut lines, ("point", name), row, name_column.at)
            .map_err(|e| e.hint("average repeated readings of a point, or give each a name of its own"))?;
        pairs.push(PointPair {
            name: name.to_string(),
            tracker: position(table, row, &tracker)?,
            base: position(table, row, &base)?,
        });
    }
    Ok(pairs)
}

fn position(table: &Table<'_>, row: &Row, columns: &[Column]) -> Result<Vector3<f64>> {
    let mut position = Vector3::zeros();
    for (coordinate, column) in position.iter_mut().zip(columns) {
        *coordinate = table.number(row, *column)?;
    }
    Ok(position)
}
