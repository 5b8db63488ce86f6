//! `posture,[state,]point,dx_mm,dy_mm,dz_mm[,fx_n,…][,mx_nm,…][,time_s][,q1_deg,…]`.

use super::columns::{MeasurementColumns, Plan};
use super::grid::{Row, Table};
use super::values::Values;
use std::collections::HashMap;
use stiffarm::error::{Code, Result};
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::{Displacement, MeasuredPosture, ReadingTarget, ReferencePart};
use stiffarm::model::posture::Posture;
use stiffarm::units::{rad_to_deg, rad_to_shortest_deg};

/// Angles of the table and of the posture file may differ by this \[deg\].
const ANGLE_TOLERANCE_DEG: f64 = 1e-6;

/// State of the rows of a table without a state column.
pub(super) const DEFAULT_STATE: &str = "loaded";

/// Reads displacements (loaded minus unloaded position, base axes) from a
/// table with one row per posture, load state and measuring point.
///
/// The rows of one posture and state form one [`MeasuredPosture`], in the
/// order in which they first appear; repeats of a point are kept. The wrench
/// is the force on the robot in base axes with its moment about the loading
/// point, zero where the table has none; without force columns the cell's
/// load gives it. The controller angles come from the table's own columns or,
/// by the posture's name, from `postures`; where both give them they must agree.
///
/// # Errors
/// A heading or row that cannot be read, unknown names, angles or wrenches that
/// differ within one posture and state, angles outside the machine's limits, a
/// measured load without forces: with line, column and the column's name.
pub(super) fn displacements(
    table: &Table<'_>,
    cell: &Cell,
    postures: Option<&[Posture]>,
) -> Result<Vec<MeasuredPosture>> {
    let columns = MeasurementColumns::of(table, cell, Values::Displacements, postures.is_some())?;
    let plan: Option<Plan<'_>> = postures.map(|list| list.iter().map(|p| (p.name.as_str(), p)).collect());
    // First row and number of each group, by posture and state.
    let mut first_rows: HashMap<(&str, &str), (&Row<'_>, usize)> = HashMap::new();
    let mut groups: Vec<MeasuredPosture> = Vec::new();
    let rows = table.rows()?;
    for row in &rows {
        let name = table.name(row, columns.posture)?;
        let state = match columns.state {
            Some(column) => table.name(row, column)?,
            None => DEFAULT_STATE,
        };
        let case = columns.load_case(table, row, cell, state)?;
        let displacement = displacement(&columns, table, row, cell)?;
        // Under each of several loads the arm was read unloaded once more.
        let first_reference = (case as u32) << 16;
        let wrench = columns.wrench(table, row)?;
        let q = agreed_angles(&columns, table, row, cell, plan.as_ref())?;
        let new = (row, groups.len());
        let (first, number) = *first_rows.entry((name, state)).or_insert(new);
        if number == groups.len() {
            let name = name.to_string();
            groups.push(MeasuredPosture {
                posture: Posture { name, q },
                state: state.to_string(),
                wrench,
                preload: None,
                common_readings: [0.0; 2],
                servo_deflection: None,
                displacements: vec![Displacement {
                    reference: vec![ReferencePart::reading(first_reference)],
                    ..displacement
                }],
            });
            continue;
        }
        let group = &mut groups[number];
        if group.posture.q != q || group.wrench != wrench {
            return Err(columns.contradiction(table, first, row));
        }
        // The r-th repeat of a point has the r-th reference reading, which it
        // shares with the r-th repeats in other states of the same load.
        let point = displacement.point;
        let before = group.displacements.iter().filter(|d| d.point == point);
        let reference = first_reference + before.count() as u32;
        group.displacements.push(Displacement { reference: vec![ReferencePart::reading(reference)], ..displacement });
    }
    Ok(groups)
}

fn displacement(columns: &MeasurementColumns, table: &Table<'_>, row: &Row, cell: &Cell) -> Result<Displacement> {
    let name = table.name(row, columns.point)?;
    if ReadingTarget::is_base_name(name) {
        let message = "A reflector on the base has no displacement of its own.";
        let error = table.error(row, columns.point.at, Code::Unsupported, message);
        return Err(error.hint(
            "give the readings themselves (x_mm, y_mm, z_mm), from which the base's motion is subtracted, or subtract \
             it beforehand",
        ));
    }
    let point = columns.measuring_point(table, row, cell, &[])?;
    Ok(Displacement { time: columns.time(table, row)?, ..Displacement::new(point, columns.vector(table, row)?) })
}

/// Angles of the table or of the posture file, which must agree.
fn agreed_angles(
    columns: &MeasurementColumns,
    table: &Table<'_>,
    row: &Row,
    cell: &Cell,
    plan: Option<&Plan<'_>>,
) -> Result<Vec<f64>> {
    let row_angles = columns.row_angles(table, row, cell)?;
    let planned = columns.planned(table, row, plan)?;
    let (Some(row_angles), Some(planned)) = (&row_angles, planned) else {
        return Ok(row_angles.or_else(|| Some(planned?.q.clone())).unwrap_or_default());
    };
    let angle_columns = columns.angles.iter().flatten();
    for ((a, b), column) in row_angles.iter().zip(&planned.q).zip(angle_columns) {
        if rad_to_deg((a - b).abs()) > ANGLE_TOLERANCE_DEG {
            let message = format!(
                "The angle {}° differs from that of the posture file, {}°.",
                rad_to_shortest_deg(*a),
                rad_to_shortest_deg(*b)
            );
            let error = table.error(row, column.at, Code::Conflict, message);
            return Err(error.hint("leave out the posture file to use the angles of this table"));
        }
    }
    Ok(row_angles.clone())
}
