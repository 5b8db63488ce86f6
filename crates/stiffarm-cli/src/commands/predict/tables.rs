//! What `stiffarm predict` prints and writes.

use crate::numbers::{confidence, mm, significant};
use crate::path::largest_first;
use crate::table::{Align, Table, title};
use std::io::Write;
use stiffarm::units::{m_to_shortest_mm, rad_to_deg, rad_to_shortest_deg};
use stiffarm::work::predict::{CartesianStiffness, PointPrediction, Prediction};

/// Rows of the table on the terminal.
const SHOWN: usize = 12;
/// Entries of a matrix below this share of the largest are rounding.
const ROUNDING: f64 = 1e-12;

/// The largest deflections, and what they are altogether.
pub fn table(result: &Prediction) -> String {
    let rows = largest_first(&result.points, |p| p.deflection_m, SHOWN);
    let mut out = match rows.len() < result.points.len() {
        true => title(&format!("The {SHOWN} largest deflections of the tip [mm]")),
        false => title("Deflection of the tip [mm]"),
    };
    let mut headings: Vec<String> = ["point", "force [N]", "x", "y", "z", "size"]
        .map(String::from)
        .into();
    if let Some(level) = result.confidence {
        headings.push(format!("± {} %", confidence(level)));
        headings.extend(["statistical", "common", "load"].map(String::from));
    }
    let mut table = Table::new(headings);
    table.align(0, Align::Left);
    for point in rows {
        let force = nalgebra::Vector3::from(point.force_n).norm();
        let mut row = vec![point.point.to_string(), significant(force, 3)];
        row.extend(point.shift_m.iter().map(|v| mm(*v)));
        row.push(mm(point.deflection_m));
        if let Some(band) = &point.band {
            row.extend([3, 0, 1, 2].map(|i| mm(band.size_m[i])));
        }
        table.row(row);
    }
    out += &table.to_string();
    let largest = match result.points.len() {
        1 => String::new(),
        _ => format!(
            "\nDeflection RMS {} mm, largest {} mm at point {}.\n",
            mm(result.deflection_rms_m),
            mm(result.deflection_max_m),
            result.deflection_max_point
        ),
    };
    out += if largest.is_empty() { "\n" } else { &largest };
    if let Some(error) = result.error_rms_m {
        out += &format!(
            "RMS error that the bands stand for, all axes together: {} mm.\n",
            mm(error)
        );
    }
    out
}

/// Matrices and principal axes of one point.
pub fn matrices(point: &PointPrediction) -> String {
    let Some(CartesianStiffness {
        matrix,
        matrix_with_k_c,
        principal,
        ..
    }) = point.stiffness.as_deref()
    else {
        return String::new();
    };
    let mut out = title(&format!(
        "Principal axes of the translational stiffness at {}",
        point.point
    ));
    let mut axes = Table::new(["axis", "stiffness [N/mm]", "x", "y", "z"]);
    for (name, axis) in ["softest", "middle", "stiffest"].iter().zip(principal) {
        let stiffness = axis.stiffness_n_per_m.map(|k| k / 1e3);
        let mut row = vec![(*name).to_string(), crate::numbers::optional(stiffness, 4)];
        row.extend(axis.direction.iter().map(|v| format!("{v:.3}")));
        axes.row(row);
    }
    out += &axes.to_string();
    for (what, matrix) in [
        ("K, Eq. (2)", matrix),
        ("K with K_C of this load", matrix_with_k_c),
    ] {
        out += &title(&format!(
            "{what} at {} [N/mm, N/mrad; N·m/mm, N·m/mrad]",
            point.point
        ));
        match matrix {
            None => out += "none: the posture is singular\n",
            Some(rows) => {
                let mut table = Table::new(["", "x", "y", "z", "about x", "about y", "about z"]);
                let largest = rows.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
                for (name, row) in ["Fx", "Fy", "Fz", "Mx", "My", "Mz"].iter().zip(rows) {
                    // Newtons per millimetre and per milliradian alike.
                    let values = row.iter().map(|v| match v.abs() < ROUNDING * largest {
                        true => "0".to_string(),
                        false => significant(v / 1e3, 5),
                    });
                    table.row(std::iter::once((*name).to_string()).chain(values));
                }
                out += &table.to_string();
            }
        }
    }
    out
}

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
