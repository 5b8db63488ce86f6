//! The table that `stiffarm predict` writes.

use std::io::Write;
use stiffarm::units::{m_to_shortest_mm, rad_to_deg, rad_to_shortest_deg};
use stiffarm::work::predict::Prediction;

/// Writes all points as a table.
///
/// # Errors
/// Those of `out`.
pub fn write_csv(result: &Prediction, out: &mut dyn Write) -> std::io::Result<()> {
    let joints = result.points.first().map_or(0, |p| p.q.len());
    let mut heading: Vec<String> = vec!["point".to_string()];
    heading.extend((1..=joints).map(|j| format!("q{j}_deg")));
    let columns = [
        "tip_x_mm",
        "tip_y_mm",
        "tip_z_mm",
        "fx_n",
        "fy_n",
        "fz_n",
        "mx_nm",
        "my_nm",
        "mz_nm",
        "dx_mm",
        "dy_mm",
        "dz_mm",
        "turn_x_deg",
        "turn_y_deg",
        "turn_z_deg",
        "deflection_mm",
        "linear_difference_mm",
    ];
    heading.extend(columns.map(String::from));
    let has_band = result.points.iter().any(|p| p.band.is_some());
    if has_band {
        let band = ["statistical", "common", "load", "total"];
        heading.extend(band.map(|part| format!("{part}_half_width_mm")));
        heading.extend(["x", "y", "z"].map(|axis| format!("total_half_width_{axis}_mm")));
    }
    writeln!(out, "{}", heading.join(","))?;
    let length = |v: f64| m_to_shortest_mm(v).to_string();
    for point in &result.points {
        let mut row = vec![quoted(&point.point)];
        row.extend(point.q.iter().map(|q| rad_to_shortest_deg(*q).to_string()));
        row.extend(point.tip_m.iter().map(|v| length(*v)));
        row.extend(
            point
                .force_n
                .iter()
                .chain(&point.moment_nm)
                .map(f64::to_string),
        );
        row.extend(point.shift_m.iter().map(|v| length(*v)));
        row.extend(point.turn_rad.iter().map(|v| rad_to_deg(*v).to_string()));
        row.extend([point.deflection_m, point.linear_difference_m].map(length));
        if let Some(band) = &point.band {
            row.extend(band.size_m.iter().chain(&band.total_m).map(|v| length(*v)));
        }
        writeln!(out, "{}", row.join(","))?;
    }
    Ok(())
}

/// A name as a field of a table.
fn quoted(name: &str) -> String {
    match name.contains([',', '"', '\n', '#', ';']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.to_string(),
    }
}
