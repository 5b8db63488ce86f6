//! `posture,x_mm,y_mm,z_mm` and the numbers of an orientation.

use super::grid::Table;
use super::heading::ColumnDefinition;
use super::line::line;
use super::quantity::Quantity;
use nalgebra::{Isometry3, Translation3};
use std::collections::HashMap;
use stiffarm::error::Result;
use stiffarm::model::cell::Columns;
use stiffarm::model::pose::Convention;
pub use stiffarm::model::pose::NamedPose;
use stiffarm::units::{m_to_mm, rounded};

/// Decimals of written positions \[mm\] and orientations: rounding of the
/// kinematics stays out.
const DECIMALS: i32 = 9;

/// Reads poses from a table `x_mm,y_mm,z_mm` with the columns of `convention`,
/// and `posture` for names (P1, P2, … without it); `file_name` is for messages.
///
/// # Errors
/// A heading or row that cannot be read, a name that appears twice, numbers that
/// are no orientation: with line, column and the column's name.
pub fn read_poses(bytes: &[u8], file_name: &str, convention: Convention) -> Result<Vec<NamedPose>> {
    let table = Table::read(bytes, file_name, &Columns::default())?;
    let name = ColumnDefinition::name("posture");
    let position = ["x", "y", "z"].map(|stem| ColumnDefinition::of(stem, Quantity::Length, "position"));
    let orientation: Vec<ColumnDefinition> = convention.columns().iter().map(|c| definition(c)).collect();
    let all = [std::slice::from_ref(&name), position.as_slice(), orientation.as_slice()].concat();
    let heading = table.check_heading(&all, 0)?;
    let hint = format!(
        "poses in the convention {} have the columns x_mm, y_mm, z_mm, {}",
        convention.as_str(),
        convention.columns().join(", ")
    );
    let name_column = heading.of(&name);
    let position = heading.all(&position, &hint)?;
    let orientation = heading.all(&orientation, &hint)?;
    let rows = table.rows()?;
    let mut poses = Vec::with_capacity(rows.len());
    let mut lines: HashMap<String, usize> = HashMap::new();
    for (i, row) in rows.iter().enumerate() {
        let name = match name_column {
            Some(column) => table.name(row, column)?.to_string(),
            None => format!("P{}", i + 1),
        };
        let at = name_column.map_or(0, |column| column.at);
        table.once(&mut lines, ("posture", name.clone()), row, at)?;
        let numbers = |columns: &[super::grid::Column]| -> Result<Vec<f64>> {
            columns.iter().map(|c| table.number(row, *c)).collect()
        };
        let at = numbers(&position)?;
        let rotation = convention.rotation(&numbers(&orientation)?).map_err(|e| {
            let error = table.error(row, orientation[0].at, e.code(), e.message());
            error.hint_if(e.hint_text())
        })?;
        poses.push(NamedPose { name, pose: Isometry3::from_parts(Translation3::new(at[0], at[1], at[2]), rotation) });
    }
    Ok(poses)
}

/// The column of a convention as tables know it.
fn definition(column: &'static str) -> ColumnDefinition {
    match column.strip_suffix("_deg").or(column.strip_suffix("_rad")) {
        Some(stem) => ColumnDefinition::of(stem, Quantity::Angle, "orientation"),
        None => ColumnDefinition::of(column, Quantity::Number, "orientation"),
    }
}

/// Poses in the columns that [`read_poses`] reads, rounded to a millionth of a
/// micrometre.
pub fn write_poses(poses: &[NamedPose], convention: Convention) -> String {
    let heading = ["posture", "x_mm", "y_mm", "z_mm"].map(String::from);
    let columns = convention.columns().iter().map(ToString::to_string);
    let heading: Vec<String> = heading.into_iter().chain(columns).collect();
    let mut out = line(&heading);
    for named in poses {
        let position = named.pose.translation.vector.map(m_to_mm);
        let numbers = convention.shown(&named.pose.rotation);
        let numbers = position.iter().copied().chain(numbers);
        let numbers = numbers.map(|v| rounded(v, DECIMALS).to_string());
        let fields: Vec<String> = std::iter::once(named.name.clone()).chain(numbers).collect();
        out += &line(&fields);
    }
    out
}
