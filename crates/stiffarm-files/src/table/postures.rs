//! `posture,q1_deg,…,qn_deg`.

use super::grid::{Column, Row, Table};
use super::heading::ColumnDefinition;
use std::collections::HashMap;
use stiffarm::error::{Code, Result};
use stiffarm::model::cell::Columns;
use stiffarm::model::posture::Posture;
use stiffarm::model::robot::Robot;
use stiffarm::units::rad_to_shortest_deg;

/// Reads postures of `robot` from a table `posture,q1_deg,…,qn_deg` (or
/// `q1_rad`, …); `file_name` is for messages.
///
/// # Errors
/// A heading or row that cannot be read, a name that appears twice, an angle
/// outside the machine's limits: with line, column and the column's name.
pub fn read_postures(bytes: &[u8], file_name: &str, robot: &Robot) -> Result<Vec<Posture>> {
    let table = Table::read(bytes, file_name, &Columns::default())?;
    read(&table, robot).map_err(|error| table.with_aside(error))
}

fn read(table: &Table<'_>, robot: &Robot) -> Result<Vec<Posture>> {
    let joints = robot.joint_count();
    let name = ColumnDefinition::name("posture");
    let angle_columns: Vec<ColumnDefinition> = ColumnDefinition::angles(joints).collect();
    let definitions = [std::slice::from_ref(&name), &angle_columns].concat();
    let heading = table.check_heading(&definitions, joints)?;
    let hint = format!("a posture table has the columns posture, q1_deg to q{joints}_deg");
    let name_column = heading.require(&name, &hint)?;
    let columns = heading.all(&angle_columns, &hint)?;
    let rows = table.rows()?;
    let mut postures = Vec::with_capacity(rows.len());
    let mut lines: HashMap<&str, usize> = HashMap::new();
    for row in &rows {
        let name = table.name(row, name_column)?;
        table.once(&mut lines, ("posture", name), row, name_column.at)?;
        let q = angles(table, row, &columns, robot)?;
        postures.push(Posture { name: name.to_string(), q });
    }
    Ok(postures)
}

/// Names of the angle columns as they are written.
pub(super) fn angle_names(joints: usize) -> Vec<String> {
    ColumnDefinition::angles(joints).map(|definition| definition.heading()).collect()
}

/// Controller angles of a row \[rad\], inside the machine's limits.
pub(super) fn angles(table: &Table<'_>, row: &Row, columns: &[Column], robot: &Robot) -> Result<Vec<f64>> {
    let q = columns.iter().map(|column| table.number(row, *column)).collect::<Result<Vec<f64>>>()?;
    if let Some((j, angle)) = robot.outside_limits(&q) {
        let joint = &robot.joints()[j];
        let angle = rad_to_shortest_deg(angle);
        let [low, high] = joint.limits.map(rad_to_shortest_deg);
        let message = format!("{} at {angle}° is outside the machine's limits, {low}° to {high}°.", joint.name);
        return Err(table.error(row, columns[j].at, Code::OutsideLimits, message));
    }
    Ok(q)
}
