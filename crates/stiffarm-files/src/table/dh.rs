//! `joint,alpha_deg,a_mm,d_mm,offset_deg` with limits and signs: rows of a robot.

use super::grid::{Row, Table};
use super::heading::{ColumnDefinition, NamedColumns};
use super::quantity::Quantity;
use nalgebra::{DMatrix, DVector, Isometry3};
use std::collections::HashMap;
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::cell::Columns;
use stiffarm::model::robot::{DhConvention, DhRobot, DhRow, MOST_JOINTS};
use stiffarm::units::rad_to_deg;

/// What a table of rows must have.
const HINT: &str = "a table of rows has the columns joint, alpha_deg, a_mm, d_mm, offset_deg; \
                    and low_deg, high_deg, sign where wanted";

/// Reads a robot from a table of Denavit–Hartenberg rows `joint, alpha_deg, a_mm, d_mm,
/// offset_deg`, base to flange, as `convention` means them; with `low_deg` and `high_deg`
/// for the machine's limits and `sign` (1 or −1) for controller angles that count
/// against θ. `name` is the robot's, `file_name` is for messages.
///
/// # Errors
/// A heading or row that cannot be read, a joint that appears twice, limits the wrong way
/// round, a sign that is none: with line, column and the column's name.
pub fn read_dh_rows(bytes: &[u8], file_name: &str, name: &str, convention: DhConvention) -> Result<DhRobot> {
    let table = Table::read(bytes, file_name, &Columns::default())?;
    let joint = ColumnDefinition::name("joint");
    let numbers = [
        ColumnDefinition::of("alpha", Quantity::Angle, "alpha"),
        ColumnDefinition::of("a", Quantity::Length, "a"),
        ColumnDefinition::of("d", Quantity::Length, "d"),
        ColumnDefinition::of("offset", Quantity::Angle, "offset"),
    ];
    let limits = ["low", "high"].map(|stem| ColumnDefinition::of(stem, Quantity::Angle, "limits"));
    let sign = ColumnDefinition::of("sign", Quantity::Number, "sign");
    let definitions = [std::slice::from_ref(&joint), &numbers, &limits, std::slice::from_ref(&sign)].concat();
    let heading = table.check_heading(&definitions, 0)?;
    let joint = heading.require(&joint, HINT)?;
    let numbers = numbers.iter().map(|definition| heading.require(definition, HINT));
    let numbers = numbers.collect::<Result<Vec<_>>>()?;
    let with_limits = heading.all_or_none(&limits, "give both limits, or none")?;
    let mut robot = DhRobot {
        name: name.to_string(),
        convention,
        rows: Vec::new(),
        tilts: Vec::new(),
        joint_names: Vec::new(),
        limits: with_limits.as_ref().map(|_| Vec::new()),
        coupling: DMatrix::zeros(0, 0),
        base: Isometry3::identity(),
        flange: Isometry3::identity(),
        speeds: None,
        maker: None,
    };
    let mut signs = Vec::new();
    let mut lines: HashMap<&str, usize> = HashMap::new();
    let rows = table.rows()?;
    if let Some(row) = rows.get(MOST_JOINTS) {
        let message = format!("The table has {} joints; at most {MOST_JOINTS} are supported.", rows.len());
        return Err(table.error(row, joint.at, Code::Unsupported, message));
    }
    for row in &rows {
        let name = table.name(row, joint)?;
        table.once(&mut lines, ("joint", name), row, joint.at)?;
        robot.joint_names.push(name.to_string());
        let mut values = [0.0; 4];
        for (value, column) in values.iter_mut().zip(&numbers) {
            *value = table.number(row, *column)?;
        }
        let [alpha, a, d, offset] = values;
        robot.rows.push(DhRow { alpha, a, d, offset });
        if let (Some(columns), Some(limits)) = (&with_limits, &mut robot.limits) {
            let low = table.number(row, columns[0])?;
            let high = table.number(row, columns[1])?;
            if low >= high {
                let [low, high] = [low, high].map(rad_to_deg);
                let message = format!("The lower limit is not below the upper one: {low:.3}° and {high:.3}°.");
                return Err(table.error(row, columns[1].at, Code::InvalidValue, message));
            }
            limits.push([low, high]);
        }
        signs.push(read_sign(&table, &heading, &sign, row)?);
    }
    robot.coupling = DMatrix::from_diagonal(&DVector::from_vec(signs));
    match other_convention(convention, &robot.rows) {
        Some(error) => Err(error.file(file_name)),
        None => Ok(robot),
    }
}

/// Sine of a twist, and length as a share of the arm's, below which two axes are one: calibration moves axes by less.
const ONE_TWIST: f64 = 1e-2;
const ONE_LENGTH: f64 = 2e-3;

/// The first two neighbouring axes, counted from 0, that lie on one line: no arm has such.
fn on_one_line(convention: DhConvention, rows: &[DhRow]) -> Option<usize> {
    let total: f64 = rows.iter().map(|row| row.a.abs() + row.d.abs()).sum();
    let is_one = |row: &DhRow| row.alpha.sin().abs() < ONE_TWIST && row.a.abs() <= ONE_LENGTH * total;
    convention.between_axes(rows).iter().position(is_one)
}

/// The refusal of rows that have two axes on one line in this convention, and none in the other.
pub(crate) fn other_convention(convention: DhConvention, rows: &[DhRow]) -> Option<Error> {
    let at = on_one_line(convention, rows)?;
    let other = convention.other();
    if rows.len() < 3 || on_one_line(other, rows).is_some() {
        return None;
    }
    let name = other.name();
    let message = format!(
        "Read as {} rows, axes {} and {} lie on one line, which no arm has; read as {name} rows no two do.",
        convention.name(),
        at + 1,
        at + 2,
    );
    Some(Error::new(Code::Conflict, message).hint(format!(
        "give the rows as dh_{name}, or --dh-convention {name}: there alpha and a of a row lie {} the joint's turn",
        if other == DhConvention::Standard { "behind" } else { "before" }
    )))
}

/// 1 or −1; 1 without a column.
fn read_sign(
    table: &Table<'_>,
    heading: &NamedColumns<'_, '_>,
    definition: &ColumnDefinition,
    row: &Row,
) -> Result<f64> {
    let Some(column) = heading.of(definition) else {
        return Ok(1.0);
    };
    let sign = table.number(row, column)?;
    if sign.abs() == 1.0 {
        Ok(sign)
    } else {
        let message = format!("A sign must be 1 or -1, got {sign}.");
        Err(table.error(row, column.at, Code::InvalidValue, message))
    }
}
