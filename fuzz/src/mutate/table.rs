//! Changes of tables: cells, headings, columns, rows and the way they are written.

use super::numbers::{WORDS, edge_number};
use crate::random::Random;

/// Units and frames as headings name them.
const UNITS: [&str; 20] = [
    "_mm", "_m", "_um", "_in", "_deg", "_rad", "_mrad", "_n", "_kn", "_nm", "_kg", "_s", "_ms", "_percent", " [mm]",
    " [deg]", " (N)", "", "_X", "_µm",
];

/// Headings of some table or other.
const HEADINGS: [&str; 24] = [
    "posture",
    "state",
    "point",
    "q1_deg",
    "q6_deg",
    "q7_deg",
    "x_mm",
    "y_mm",
    "z_mm",
    "dx_mm",
    "fx_n",
    "mx_nm",
    "load_n",
    "time_s",
    "axes",
    "base_x_mm",
    "tracker_x_mm",
    "name",
    "roll_deg",
    "axis_x",
    "dq1_deg",
    "q1_rad",
    "load_kg",
    "force_n",
];

type Rows = Vec<Vec<String>>;

/// One change.
pub fn change(text: &str, random: &mut Random) -> String {
    let separator = [',', ';', '\t'].into_iter().find(|s| text.contains(*s)).unwrap_or(',');
    let mut rows: Rows = text.lines().map(|line| line.split(separator).map(String::from).collect()).collect();
    let Some(row) = random.place(&rows) else {
        return random.pick(&HEADINGS).to_string();
    };
    let Some(column) = random.place(&rows[row]) else {
        return text.to_string();
    };
    match random.below(25) {
        0..=5 => {
            let cell = &mut rows[row][column];
            *cell = edge_number(cell.trim().parse().ok(), random);
        }
        6 => rows[row][column] = random.pick(&WORDS).to_string(),
        7 => whole_column(&mut rows, column, random),
        8 => heading(&mut rows, random),
        9 => each(&mut rows, |cells| {
            if column < cells.len() {
                cells.remove(column);
            }
        }),
        10 => each(&mut rows, |cells| {
            if let Some(cell) = cells.get(column).cloned() {
                cells.push(cell);
            }
        }),
        11 => {
            let other = random.below(rows[0].len().max(1));
            each(&mut rows, |cells| {
                if column.max(other) < cells.len() {
                    cells.swap(column, other);
                }
            });
        }
        12 => {
            rows.remove(row);
        }
        13 => {
            let copy = rows[row].clone();
            let times = if random.one_in(6) { 60 } else { 1 };
            rows.splice(row..row, std::iter::repeat_n(copy, times));
        }
        14 => {
            let other = random.below(rows.len());
            rows.swap(row, other);
        }
        15 => rows.truncate(row + 1),
        16 => {
            // The value of the row before: the same name, state or point twice.
            let above = rows[row.saturating_sub(1)].get(column).cloned();
            rows[row][column] = above.unwrap_or_default();
        }
        17 => {
            rows[row].pop();
        }
        18 => {
            let cell = rows[row][column].clone();
            rows[row][column] = format!("\"{cell}\"");
        }
        19 => {
            // The same values under another name: postures or points that are one.
            let other = random.below(rows.len());
            let tail = rows[other].get(column..).unwrap_or_default().to_vec();
            rows[row].truncate(column);
            rows[row].extend(tail);
        }
        20 | 21 => columns_scaled(&mut rows, column, random),
        22 => {
            // All rows of one name, or all others.
            let name = rows[row].first().cloned();
            let keep = random.one_in(2);
            let mut number = 0;
            rows.retain(|cells| {
                number += 1;
                number == 1 || (cells.first() == name.as_ref()) == keep
            });
        }
        23 => {
            // Every second row, or the first few: few data.
            let few = 2 + random.below(12);
            rows.truncate(few);
        }
        _ => return rewritten(&rows, separator, random),
    }
    joined(&rows, separator, "\n")
}

/// A column of one value, or of the edges.
fn whole_column(rows: &mut Rows, column: usize, random: &mut Random) {
    let fixed = edge_number(None, random);
    let scale = [1e3, 1e-3, 0.0, -1.0, 1e9, 1e150][random.below(6)];
    let kind = random.below(3);
    for cells in rows.iter_mut().skip(1) {
        let Some(cell) = cells.get_mut(column) else {
            continue;
        };
        let number: Option<f64> = cell.trim().parse().ok();
        match (kind, number) {
            (0, _) => *cell = fixed.clone(),
            (1, Some(number)) => *cell = format!("{:?}", number * scale),
            (1, None) => {}
            _ => cell.clear(),
        }
    }
}

/// Some columns side by side made large, small, nothing or turned about.
fn columns_scaled(rows: &mut Rows, column: usize, random: &mut Random) {
    let scale = [0.0, 1e-9, 1e-3, 0.5, -1.0, 2.0, 30.0, 1e3][random.below(8)];
    let end = column + 1 + random.below(6);
    for cells in rows.iter_mut().skip(1) {
        for cell in cells.iter_mut().take(end).skip(column) {
            if let Ok(number) = cell.trim().parse::<f64>() {
                *cell = format!("{:?}", number * scale);
            }
        }
    }
}

/// Another unit or another column in the heading.
fn heading(rows: &mut Rows, random: &mut Random) {
    let column = random.below(rows[0].len().max(1));
    let Some(cell) = rows[0].get_mut(column) else {
        return;
    };
    *cell = match random.below(4) {
        0 => random.pick(&HEADINGS).to_string(),
        1 => cell.to_uppercase(),
        _ => {
            let stem = cell.rfind('_').map_or(cell.as_str(), |at| &cell[..at]);
            format!("{stem}{}", random.pick(&UNITS))
        }
    };
}

fn each(rows: &mut Rows, change: impl FnMut(&mut Vec<String>)) {
    rows.iter_mut().for_each(change);
}

/// The same table in another spelling.
fn rewritten(rows: &Rows, separator: char, random: &mut Random) -> String {
    let text = joined(rows, separator, "\n");
    match random.below(7) {
        0 => joined(rows, ';', "\n").replace('.', ","),
        1 => joined(rows, '\t', "\n"),
        2 => joined(rows, ';', "\r\n"),
        3 => format!("\u{feff}{text}"),
        4 => joined(rows, separator, "\r"),
        5 => joined(rows, separator, "\n\n"),
        _ => format!("# comment\n{text}"),
    }
}

fn joined(rows: &Rows, separator: char, end: &str) -> String {
    let mut text = String::new();
    for cells in rows {
        text += &cells.join(&separator.to_string());
        text += end;
    }
    text
}
