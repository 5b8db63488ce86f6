//! `posture,[state,]point,dx_mm,dy_mm,dz_mm[,fx_n,…][,mx_nm,…][,time_s][,q1_deg,…]`.

use super::heading::{Known, stem};
use super::postures::{angle_names, angles};
use super::text::{Row, Table};
use crate::cell::Cell;
use crate::error::{Code, Error, Result, did_you_mean};
use crate::load::{Load, Wrench};
use crate::measurement::{Displacement, MeasuredPosture};
use crate::posture::Posture;
use crate::robot::Robot;
use crate::units::{mm_to_m, rad_to_deg, rad_to_shortest_deg};
use nalgebra::Vector3;
use std::collections::{BTreeMap, HashMap};

/// Angles of the table and of the posture file may differ by this \[deg\].
const ANGLE_TOLERANCE_DEG: f64 = 1e-6;

/// State of the rows of a table without a state column.
pub(super) const DEFAULT_STATE: &str = "loaded";

/// Reads displacements (loaded minus unloaded position, base axes) from a
/// table with one row per posture, load state and measuring point; `file_name`
/// is for messages.
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
/// measured load without forces, raw positions instead of displacements: with
/// line, column and the column's name.
pub fn read_displacements(
    bytes: &[u8],
    file_name: &str,
    cell: &Cell,
    postures: Option<&[Posture]>,
) -> Result<Vec<MeasuredPosture>> {
    let table = Table::read(bytes, file_name)?;
    let columns = Columns::of(&table, cell, postures.is_some())?;
    let rows = table.rows()?;
    let planned: Option<BTreeMap<&str, &Posture>> =
        postures.map(|list| list.iter().map(|p| (p.name.as_str(), p)).collect());
    // First row and number of each group, by posture and state.
    let mut first_rows: HashMap<(&str, &str), (&Row, usize)> = HashMap::new();
    let mut groups: Vec<MeasuredPosture> = Vec::new();
    for row in &rows {
        let name = table.name(row, columns.posture)?;
        let state = match columns.state {
            Some(column) => table.name(row, column)?,
            None => DEFAULT_STATE,
        };
        let displacement = columns.displacement(&table, row, cell)?;
        let wrench = columns.wrench(&table, row)?;
        let q = columns.angles(&table, row, &cell.setup.robot, planned.as_ref())?;
        let new = (row, groups.len());
        let (first, number) = *first_rows.entry((name, state)).or_insert(new);
        if number == groups.len() {
            let name = name.to_string();
            groups.push(MeasuredPosture {
                posture: Posture { name, q },
                state: state.to_string(),
                wrench,
                servo_give: None,
                displacements: vec![displacement],
            });
            continue;
        }
        let group = &mut groups[number];
        if group.posture.q != q || group.wrench != wrench {
            return Err(columns.contradiction(&table, first, row));
        }
        // The r-th repeat of a point has the r-th reference reading, which it
        // shares with the r-th repeats in other load states.
        let point = displacement.point;
        let before = group.displacements.iter().filter(|d| d.point == point);
        let reference = before.count() as u32;
        group.displacements.push(Displacement {
            reference,
            ..displacement
        });
    }
    Ok(groups)
}

/// Positions of the columns.
struct Columns {
    posture: usize,
    state: Option<usize>,
    point: usize,
    displacement: [usize; 3],
    force: Option<Vec<usize>>,
    moment: Option<Vec<usize>>,
    time: Option<usize>,
    angles: Option<Vec<usize>>,
}

impl Columns {
    fn of(table: &Table<'_>, cell: &Cell, has_postures: bool) -> Result<Self> {
        let joints = cell.setup.robot.joint_count();
        refuse_raw_positions(table)?;
        table.check_heading(&known_columns(joints), joints)?;
        let hint = "a measurement table has the columns posture, point, dx_mm, dy_mm, dz_mm";
        let names = |names: [&str; 3]| names.map(String::from);
        let force = table.all_or_none(
            &names(["fx_n", "fy_n", "fz_n"]),
            "give all three components of the force, or none",
        )?;
        let moment = table.all_or_none(
            &names(["mx_nm", "my_nm", "mz_nm"]),
            "give all three components of the moment, or none",
        )?;
        if force.is_none() && cell.setup.load == Load::Measured {
            let message = "The cell's load is measured, but the table has no forces.";
            return Err(table.heading_error(None, Code::TableHeading, message).hint(
                "add fx_n, fy_n, fz_n: the force on the robot in base axes, loaded minus unloaded",
            ));
        }
        if let (None, Some(moment)) = (&force, &moment) {
            let message = "The table has moments but no forces.";
            let error = table.heading_error(Some(moment[0]), Code::TableHeading, message);
            return Err(error.hint("add fx_n, fy_n, fz_n (zeros where a pure moment acts)"));
        }
        let angles = table.all_or_none(
            &angle_names(joints),
            &format!("give the angles of all {joints} joints, or a posture file"),
        )?;
        if angles.is_none() && !has_postures {
            let message = "The table has no controller angles.";
            return Err(table.heading_error(None, Code::TableHeading, message).hint(format!(
                "add q1_deg to q{joints}_deg, or give the posture file whose names the table uses"
            )));
        }
        Ok(Columns {
            posture: table.require("posture", hint)?,
            state: table.find("state"),
            point: table.require("point", hint)?,
            displacement: [
                table.require("dx_mm", hint)?,
                table.require("dy_mm", hint)?,
                table.require("dz_mm", hint)?,
            ],
            force,
            moment,
            time: table.find("time_s"),
            angles,
        })
    }

    fn displacement(&self, table: &Table<'_>, row: &Row, cell: &Cell) -> Result<Displacement> {
        let [x, y, z] = self.displacement;
        let point = self.point(table, row, cell)?;
        let value = Vector3::new(
            mm_to_m(table.number(row, x)?),
            mm_to_m(table.number(row, y)?),
            mm_to_m(table.number(row, z)?),
        );
        let time = self
            .time
            .filter(|column| !row.fields[*column].text.is_empty());
        let time = time.map(|column| table.number(row, column)).transpose()?;
        let mut displacement = Displacement::new(point, value);
        displacement.time = time;
        Ok(displacement)
    }

    fn point(&self, table: &Table<'_>, row: &Row, cell: &Cell) -> Result<usize> {
        let name = table.name(row, self.point)?;
        if let Some(point) = cell.setup.tool.point_index(name) {
            return Ok(point);
        }
        if name.eq_ignore_ascii_case("base") {
            let message = "Base reflectors are not supported in this version.";
            let error = table.error(row, self.point, Code::Unsupported, message);
            return Err(
                error.hint("subtract the base's own motion from the displacements beforehand")
            );
        }
        let names = || {
            cell.setup
                .tool
                .measuring_points
                .iter()
                .map(|p| p.name.as_str())
        };
        let message = format!("The cell has no measuring point \"{name}\".");
        let hint = did_you_mean(name, names()).unwrap_or_else(|| {
            format!(
                "measuring points: {}",
                names().collect::<Vec<_>>().join(", ")
            )
        });
        Err(table
            .error(row, self.point, Code::UnknownName, message)
            .hint(hint))
    }

    fn wrench(&self, table: &Table<'_>, row: &Row) -> Result<Option<Wrench>> {
        let read = |columns: &[usize]| -> Result<Vector3<f64>> {
            let mut vector = Vector3::zeros();
            for (component, column) in vector.iter_mut().zip(columns) {
                *component = table.number(row, *column)?;
            }
            Ok(vector)
        };
        let Some(force) = &self.force else {
            return Ok(None);
        };
        let force = read(force)?;
        let moment = self.moment.as_deref().map(read).transpose()?;
        Ok(Some(Wrench {
            force,
            moment: moment.unwrap_or_default(),
        }))
    }

    fn angles(
        &self,
        table: &Table<'_>,
        row: &Row,
        robot: &Robot,
        postures: Option<&BTreeMap<&str, &Posture>>,
    ) -> Result<Vec<f64>> {
        let own = self
            .angles
            .as_ref()
            .map(|columns| angles(table, row, columns, robot));
        let own = own.transpose()?;
        let Some(postures) = postures else {
            return Ok(own.unwrap_or_default());
        };
        let name = row.fields[self.posture].text.as_str();
        let Some(planned) = postures.get(name) else {
            let message = format!("The posture file has no posture \"{name}\".");
            let error = table.error(row, self.posture, Code::UnknownName, message);
            let hint = did_you_mean(name, postures.keys().copied());
            return Err(match hint {
                Some(hint) => error.hint(hint),
                None => error,
            });
        };
        let (Some(own), Some(columns)) = (own, &self.angles) else {
            return Ok(planned.q.clone());
        };
        for ((a, b), column) in own.iter().zip(&planned.q).zip(columns) {
            if rad_to_deg((a - b).abs()) > ANGLE_TOLERANCE_DEG {
                let message = format!(
                    "The angle {}° differs from that of the posture file, {}°.",
                    rad_to_shortest_deg(*a),
                    rad_to_shortest_deg(*b)
                );
                let error = table.error(row, *column, Code::Conflict, message);
                return Err(
                    error.hint("leave out the posture file to use the angles of this table")
                );
            }
        }
        Ok(own)
    }

    /// The first column in which two rows of one posture and state differ.
    fn contradiction(&self, table: &Table<'_>, first: &Row, row: &Row) -> Error {
        let given = [&self.angles, &self.force, &self.moment];
        let mut columns = given.into_iter().flatten().flatten().copied();
        let differs =
            |column: &usize| table.number(first, *column).ok() != table.number(row, *column).ok();
        let column = columns.find(differs).unwrap_or(self.posture);
        let message = format!(
            "{} differs from {} on line {}, but the posture and its state are the same.",
            row.fields[column].text, first.fields[column].text, first.line
        );
        table.error(row, column, Code::Conflict, message).hint(
            "angles and wrench belong to the posture and state: average them, or name another state",
        )
    }
}

fn known_columns(joints: usize) -> Vec<Known> {
    let mut known = vec![
        Known::new("posture", ""),
        Known::new("state", ""),
        Known::new("point", ""),
    ];
    let mut add = |names: [&'static str; 3], unit| {
        known.extend(names.map(|name| Known::new(name, unit)));
    };
    add(
        ["dx_mm", "dy_mm", "dz_mm"],
        "displacements are in millimetres",
    );
    add(["fx_n", "fy_n", "fz_n"], "forces are in newtons");
    add(["mx_nm", "my_nm", "mz_nm"], "moments are in newton metres");
    known.push(Known::new("time_s", "times are in seconds"));
    known.extend(Known::angles(joints));
    known
}

/// Tracker readings need the unloaded reading of the same point subtracted.
fn refuse_raw_positions(table: &Table<'_>) -> Result<()> {
    let raw = |name: &str| ["x", "y", "z"].contains(&stem(name));
    let Some(column) = table.columns.iter().position(|column| raw(&column.text)) else {
        return Ok(());
    };
    let message = "These are positions; this version reads displacements, loaded minus unloaded.";
    let error = table.heading_error(Some(column), Code::Unsupported, message);
    Err(error.hint(
        "subtract the unloaded from the loaded reading, turn it into base axes, and give dx_mm, dy_mm, dz_mm",
    ))
}
