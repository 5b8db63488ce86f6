//! The points of a prediction as a table: what its columns are, and the table as a file.

use super::{PointPrediction, Prediction};
use crate::numerics::control::Control;
use crate::numerics::jobs::each_block;
use crate::units::{m_to_mm, rad_to_deg, rad_to_shortest_deg};
use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{Result, Write};

/// A column of the points of a prediction, in files and for people.
#[derive(Debug, Clone, Copy)]
pub struct PointColumn {
    /// Heading in files, its unit at the end; empty where only people see the column.
    pub key: &'static str,
    /// Heading for people, without a unit; empty where only files have the column.
    pub heading: &'static str,
    /// What its numbers are.
    pub measure: PointMeasure,
    /// Whether people see it among the details alone.
    pub is_detail: bool,
    /// The number at a point, in SI units; `None` where the point has none.
    pub at: fn(&PointPrediction) -> Option<f64>,
}

/// What the numbers of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointMeasure {
    /// \[m\]; millimetres in files.
    Length,
    /// \[rad\]; degrees in files.
    Turn,
    /// \[N\].
    Force,
    /// \[N·m\].
    Moment,
}

use PointMeasure::{Force, Length, Moment, Turn};

type At = fn(&PointPrediction) -> Option<f64>;

const fn column(key: &'static str, heading: &'static str, measure: PointMeasure, at: At) -> PointColumn {
    PointColumn { key, heading, measure, is_detail: false, at }
}

const fn detail(key: &'static str, heading: &'static str, at: At) -> PointColumn {
    PointColumn { is_detail: true, ..column(key, heading, Length, at) }
}

/// What is said of each point behind its name and its joint angles.
#[rustfmt::skip]
pub const POINT_COLUMNS: [PointColumn; 25] = [
    column("tip_x_mm", "", Length, |p| Some(p.tip_m[0])),
    column("tip_y_mm", "", Length, |p| Some(p.tip_m[1])),
    column("tip_z_mm", "", Length, |p| Some(p.tip_m[2])),
    column("fx_n", "", Force, |p| Some(p.force_n[0])),
    column("fy_n", "", Force, |p| Some(p.force_n[1])),
    column("fz_n", "", Force, |p| Some(p.force_n[2])),
    column("mx_nm", "", Moment, |p| Some(p.moment_nm[0])),
    column("my_nm", "", Moment, |p| Some(p.moment_nm[1])),
    column("mz_nm", "", Moment, |p| Some(p.moment_nm[2])),
    column("", "force", Force, |p| Some(p.force_n.iter().map(|f| f * f).sum::<f64>().sqrt())),
    column("dx_mm", "along x", Length, |p| Some(p.shift_m[0])),
    column("dy_mm", "along y", Length, |p| Some(p.shift_m[1])),
    column("dz_mm", "along z", Length, |p| Some(p.shift_m[2])),
    column("turn_x_deg", "", Turn, |p| Some(p.turn_rad[0])),
    column("turn_y_deg", "", Turn, |p| Some(p.turn_rad[1])),
    column("turn_z_deg", "", Turn, |p| Some(p.turn_rad[2])),
    column("deflection_mm", "deflection", Length, |p| Some(p.deflection_m)),
    column("linear_difference_mm", "", Length, |p| Some(p.linear_difference_m)),
    detail("statistical_half_width_mm", "± readings", |p| Some(p.band?.size_m[0])),
    detail("common_half_width_mm", "± systematic", |p| Some(p.band?.size_m[1])),
    detail("load_half_width_mm", "± load", |p| Some(p.band?.size_m[2])),
    column("total_half_width_mm", "± total", Length, |p| Some(p.band?.size_m[3])),
    column("total_half_width_x_mm", "", Length, |p| Some(p.band?.total_m[0])),
    column("total_half_width_y_mm", "", Length, |p| Some(p.band?.total_m[1])),
    column("total_half_width_z_mm", "", Length, |p| Some(p.band?.total_m[2])),
];

impl Prediction {
    /// Writes all points as a table with a heading: millimetres, degrees, N and N·m.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_csv(&self, out: &mut dyn Write) -> Result<()> {
        let says = |column: &&PointColumn| self.points.iter().any(|point| (column.at)(point).is_some());
        let columns = POINT_COLUMNS.iter().filter(|column| !column.key.is_empty());
        let columns: Vec<&PointColumn> = columns.filter(says).collect();
        let joints = self.points.first().map_or(0, |p| p.q.len());
        let angles: String = (1..=joints).map(|j| format!("q{j}_deg,")).collect();
        let keys: Vec<&str> = columns.iter().map(|column| column.key).collect();
        writeln!(out, "point,{angles}{}", keys.join(","))?;
        let mut written = Ok(());
        let rows = |_, block: &[PointPrediction]| {
            let mut rows = String::new();
            block.iter().for_each(|point| add_row(&mut rows, point, &columns));
            Ok(rows)
        };
        let take = |rows: String| {
            if written.is_ok() {
                written = out.write_all(rows.as_bytes());
            }
        };
        each_block(&self.points, "writing", Control::default(), rows, take).map_err(std::io::Error::other)?;
        written
    }
}

fn add_row(row: &mut String, point: &PointPrediction, columns: &[&PointColumn]) {
    row.push_str(&quoted(&point.point));
    let mut add = |number: Option<f64>| {
        // Writing to memory cannot fail.
        let _ = match number {
            Some(number) => write!(row, ",{number}"),
            None => write!(row, ","),
        };
    };
    point.q.iter().for_each(|q| add(Some(rad_to_shortest_deg(*q))));
    for column in columns {
        let number = (column.at)(point);
        add(match column.measure {
            Length => number.map(m_to_mm),
            Turn => number.map(rad_to_deg),
            Force | Moment => number,
        });
    }
    row.push('\n');
}

/// A name as a field of a table.
fn quoted(name: &str) -> Cow<'_, str> {
    if name.contains([',', '"', '\n', '#', ';']) {
        format!("\"{}\"", name.replace('"', "\"\"")).into()
    } else {
        name.into()
    }
}
