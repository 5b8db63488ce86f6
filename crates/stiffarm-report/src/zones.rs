//! Dumas' zones as a figure and a table.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::map::ranged_axis;
use crate::study::{Cell, Table};
use stiffarm::plan::zones::{ZoneMap, Zones};
use stiffarm::units::{rad_to_shortest_deg, rounded, with_minus};

/// Three maps over joints 2 and 3, side by side: dexterity 1/k(J_N), and the
/// relative deviation of translation and rotation with and without K_C \[%\].
pub fn zones_figure(zones: &Zones) -> Figure {
    let deviation = |range| ranged_axis("relative deviation", "%", range);
    let held: Vec<String> = zones
        .held
        .iter()
        .enumerate()
        .filter_map(|(j, q)| {
            q.map(|q| format!("q{} = {}°", j + 1, with_minus(rounded(rad_to_shortest_deg(q), 6).to_string())))
        })
        .collect();
    Figure {
        id: "zones".into(),
        title: "Zones for stiffness identification (Dumas et al.)".into(),
        caption: format!(
            "Dexterity 1/k(J_N), larger is better, and relative deviation of translation and rotation of the TCP \
             computed with and without K_C, smaller is better, over {} and {} with {}. The brighter, the better. \
             Marked: the most dexterous posture of the zone where both are good.",
            zones.joints[0],
            zones.joints[1],
            held.join(", ")
        ),
        columns: 3,
        panels: vec![
            panel(zones, "dexterity", &zones.inverse_condition, 1.0, Axis::linear("1/k(J_N)", ""), false),
            panel(
                zones,
                "influence of K_C on the translation",
                &zones.translation_deviation,
                100.0,
                deviation(zones.translation_range),
                true,
            ),
            panel(
                zones,
                "influence of K_C on the rotation",
                &zones.rotation_deviation,
                100.0,
                deviation(zones.rotation_range),
                true,
            ),
        ],
    }
}

/// One map; `factor` brings its values to the unit of `axis`.
fn panel(zones: &Zones, title: &str, map: &ZoneMap, factor: f64, axis: Axis, small_is_good: bool) -> Panel {
    let (columns, rows) = (&degrees(&zones.q2), &degrees(&zones.q3));
    let values: Vec<f64> = map.iter().flatten().map(|v| v.map_or(f64::NAN, |v| factor * v)).collect();
    let missing = if values.iter().any(|v| v.is_nan()) { "outside the limits of the cell, or singular" } else { "" };
    let x = rows.iter().flat_map(|_| columns.iter().copied()).collect();
    let y = rows.iter().flat_map(|row| columns.iter().map(move |_| *row)).collect();
    let values = Series::new(missing, Style::Map, x, y).with_colour(axis, values).with_small_bright(small_is_good);
    let mut series = vec![values];
    if let Some(best) = &zones.best {
        series.push(Series::new(
            "best posture",
            Style::Hollow,
            vec![rad_to_shortest_deg(best.best_q[1])],
            vec![rad_to_shortest_deg(best.best_q[2])],
        ));
    }
    Panel::new(title, fitted(&zones.joints[0], columns), fitted(&zones.joints[1], rows), series)
}

fn degrees(angles: &[f64]) -> Vec<f64> {
    angles.iter().map(|a| rad_to_shortest_deg(*a)).collect()
}

/// An axis that ends where the outermost cells end.
fn fitted(joint: &str, angles: &[f64]) -> Axis {
    let axis = Axis::linear(joint, "deg");
    let half = |a: usize, b: usize| 0.5 * (angles[b] - angles[a]);
    match angles.len() {
        0 | 1 => axis,
        n => axis.with_range(angles[0] - half(0, 1), angles[n - 1] + half(n - 2, n - 1)),
    }
}

/// One row per posture of the map; no value where it violates a limit or is
/// singular.
pub fn zones_table(zones: &Zones) -> Table {
    let headings = ["q2_deg", "q3_deg", "inverse_k_jn", "translation_deviation_percent", "rotation_deviation_percent"];
    let mut rows = Vec::new();
    let columns = degrees(&zones.q2);
    for (r, q3) in degrees(&zones.q3).iter().enumerate() {
        for (c, q2) in columns.iter().enumerate() {
            let percent = |map: &ZoneMap| Cell::Number(map[r][c].map(|v| 100.0 * v));
            rows.push(vec![
                (*q2).into(),
                (*q3).into(),
                zones.inverse_condition[r][c].into(),
                percent(&zones.translation_deviation),
                percent(&zones.rotation_deviation),
            ]);
        }
    }
    Table {
        id: "zones".into(),
        caption: "Dexterity and influence of K_C over joints 2 and 3.".into(),
        headings: headings.map(String::from).to_vec(),
        rows,
    }
}
