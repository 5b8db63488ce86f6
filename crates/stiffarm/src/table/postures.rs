//! `posture,q1_deg,…,qn_deg`.

use super::heading::Known;
use super::text::{Row, Table};
use crate::error::{Code, Result};
use crate::posture::Posture;
use crate::robot::Robot;
use crate::units::{deg_to_rad, rad_to_shortest_deg};
use std::collections::HashMap;

/// Reads postures of `robot` from a table `posture,q1_deg,…,qn_deg`;
/// `file_name` is for messages.
///
/// # Errors
/// A heading or row that cannot be read, a name that stands twice, an angle
/// outside the machine's limits: with line, column and the column's name.
pub fn read_postures(bytes: &[u8], file_name: &str, robot: &Robot) -> Result<Vec<Posture>> {
    let table = Table::read(bytes, file_name)?;
    let joints = robot.joint_count();
    let known: Vec<Known> = std::iter::once(Known::new("posture", ""))
        .chain(Known::angles(joints))
        .collect();
    table.check_heading(&known, joints)?;
    let hint = format!("a posture table has the columns posture, q1_deg to q{joints}_deg");
    let name_column = table.require("posture", &hint)?;
    let columns = angle_names(joints)
        .iter()
        .map(|name| table.require(name, &hint))
        .collect::<Result<Vec<usize>>>()?;
    let rows = table.rows()?;
    let mut postures = Vec::with_capacity(rows.len());
    let mut lines: HashMap<&str, usize> = HashMap::new();
    for row in &rows {
        let name = table.name(row, name_column)?;
        if let Some(first) = lines.insert(name, row.line) {
            let message = format!("The posture \"{name}\" stands twice; first on line {first}.");
            return Err(table.error(row, name_column, Code::Duplicate, message));
        }
        let q = angles(&table, row, &columns, robot)?;
        postures.push(Posture {
            name: name.to_string(),
            q,
        });
    }
    Ok(postures)
}

/// Names of the angle columns.
pub(super) fn angle_names(joints: usize) -> Vec<String> {
    Known::angles(joints).map(|known| known.name).collect()
}

/// Controller angles of a row \[rad\], inside the machine's limits.
pub(super) fn angles(
    table: &Table<'_>,
    row: &Row,
    columns: &[usize],
    robot: &Robot,
) -> Result<Vec<f64>> {
    let q = columns
        .iter()
        .map(|column| table.number(row, *column).map(deg_to_rad))
        .collect::<Result<Vec<f64>>>()?;
    if let Some((j, angle)) = robot.outside_limits(&q) {
        let joint = &robot.joints()[j];
        let angle = rad_to_shortest_deg(angle);
        let [low, high] = joint.limits.map(rad_to_shortest_deg);
        let message = format!(
            "{} at {angle}° is outside the machine's limits, {low}° to {high}°.",
            joint.name
        );
        return Err(table.error(row, columns[j], Code::OutsideLimits, message));
    }
    Ok(q)
}
