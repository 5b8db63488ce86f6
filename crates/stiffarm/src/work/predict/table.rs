//! A prediction as a table.

use super::{PointPrediction, Prediction};
use crate::numerics::control::Control;
use crate::numerics::jobs::each_in_order;
use crate::units::{m_to_mm, rad_to_deg, rad_to_shortest_deg};
use std::fmt::Write as _;
use std::io::{Result, Write};

/// Columns behind the joint angles, and those of the band.
const COLUMNS: &str = "tip_x_mm,tip_y_mm,tip_z_mm,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm,dx_mm,dy_mm,dz_mm,\
turn_x_deg,turn_y_deg,turn_z_deg,deflection_mm,linear_difference_mm";
const BAND: &str = "statistical_half_width_mm,common_half_width_mm,load_half_width_mm,total_half_width_mm,\
total_half_width_x_mm,total_half_width_y_mm,total_half_width_z_mm";

impl Prediction {
    /// Writes all points as a table with a heading: millimetres, degrees, N and N·m.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_csv(&self, out: &mut dyn Write) -> Result<()> {
        let joints = self.points.first().map_or(0, |p| p.q.len());
        let angles: String = (1..=joints).map(|j| format!("q{j}_deg,")).collect();
        let has_band = self.points.iter().any(|p| p.band.is_some());
        let band = if has_band { format!(",{BAND}") } else { String::new() };
        writeln!(out, "point,{angles}{COLUMNS}{band}")?;
        let mut written = Ok(());
        each_in_order(
            &self.points,
            "writing",
            Control::default(),
            |(_, point)| Ok(row(point)),
            |row| {
                if written.is_ok() {
                    written = out.write_all(row.as_bytes());
                }
            },
        )
        .map_err(std::io::Error::other)?;
        written
    }
}

fn row(point: &PointPrediction) -> String {
    let mut row = quoted(&point.point);
    let mut add = |value: f64| {
        // Writing to memory cannot fail.
        let _ = write!(row, ",{value}");
    };
    let mm = |v: &f64| m_to_mm(*v);
    point.q.iter().for_each(|q| add(rad_to_shortest_deg(*q)));
    point.tip_m.iter().map(mm).for_each(&mut add);
    let wrench = point.force_n.iter().chain(&point.moment_nm);
    wrench.copied().for_each(&mut add);
    point.shift_m.iter().map(mm).for_each(&mut add);
    point.turn_rad.iter().for_each(|v| add(rad_to_deg(*v)));
    let sizes = [point.deflection_m, point.linear_difference_m];
    sizes.iter().map(mm).for_each(&mut add);
    if let Some(band) = &point.band {
        let widths = band.size_m.iter().chain(&band.total_m);
        widths.map(mm).for_each(&mut add);
    }
    row.push('\n');
    row
}

/// A name as a field of a table.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '#', ';']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_string()
    }
}
