//! Readings that are none, or whose number lost its decimal sign: found by what the other readings
//! of the same point say.

use super::columns::MeasurementColumns;
use super::grid::{Row, Table};
use super::rows::in_words;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stiffarm::error::{Code, Result};
use stiffarm::findings::each_once;

/// Readings that far from the tracker's origin are no zeros of a dial \[m\].
const FAR_FROM_TRACKER: f64 = 0.1;

/// Readings of one point in one posture differ by less \[m\] …
const SAME_POINT_DISTANCE: f64 = 0.01;

/// … and by less than this part of the coordinate, so that a power of ten is no chance.
const SAME_POINT_SHARE: f64 = 0.3;

/// By so much more a distance must stray from the usual one, as a logarithm, to be the wrong one.
const CLEARLY: f64 = 0.5;

/// Powers of ten by which a lost decimal sign or one of thousands changes a number.
const MOST_TENS: i32 = 6;

/// Readings of one point in one posture that are held against each other.
const MOST_REPEATS: usize = 1000;

/// A row with a position \[m\], and the names of its posture and point.
struct PositionRow<'r> {
    row: &'r Row<'r>,
    position: Vector3<f64>,
    of: (&'r str, &'r str),
}

/// Refuses positions that are no readings.
///
/// # Errors
/// 0, 0, 0 where the point stands far from there, and a coordinate that is 10, 100, … times what
/// the other readings of its point are: with row, column and the number that fits them.
pub(super) fn check(table: &Table<'_>, columns: &MeasurementColumns, rows: &[Row<'_>]) -> Result<()> {
    let mut read = Vec::new();
    for row in rows.iter().filter(|row| !columns.has_no_position(table, row)) {
        read.push(PositionRow {
            row,
            position: columns.vector(table, row)?,
            of: (&row.fields[columns.posture.at].text, &row.fields[columns.point.at].text),
        });
    }
    zeros(table, columns, &read)?;
    let mut groups: BTreeMap<_, Vec<&PositionRow<'_>>> = BTreeMap::new();
    for one in &read {
        groups.entry(one.of).or_default().push(one);
    }
    let norms = read.iter().map(|one| one.position.norm());
    let usual = median(norms.collect()).unwrap_or(0.0);
    let mut faults = Vec::new();
    for group in groups.values().filter(|group| group.len() <= MOST_REPEATS) {
        for (at, one) in group.iter().enumerate() {
            let others = group.iter().enumerate().filter(|(other, _)| *other != at);
            let others: Vec<&PositionRow<'_>> = others.map(|(_, other)| *other).collect();
            let powers = tens(one, &others, usual).into_iter().flatten();
            faults.extend(powers.map(|(k, tens)| (one.row, k, tens)));
        }
    }
    faults.sort_by_key(|(row, k, _)| (row.source, row.line, *k));
    let Some(((row, k, tens), more)) = faults.split_first() else {
        return Ok(());
    };
    let column = columns.component(*k);
    let fitting = |row: &Row<'_>, k: usize, tens: i32| -> Result<String> {
        let column = columns.component(k);
        let value = table.number(row, column)?;
        let shown = column.unit.map_or(value, |unit| unit.shortest(value));
        // Rounded to what a double tells of a number in another power of ten.
        Ok(format!("{:.9}", shown / 10f64.powi(tens)).trim_end_matches('0').trim_end_matches('.').to_string())
    };
    let text = &row.fields[column.at].text;
    let (posture, point) = (&row.fields[columns.posture.at].text, &row.fields[columns.point.at].text);
    let message = format!(
        "{text} is about {} the other readings of \"{point}\" in posture \"{posture}\": a decimal sign is lost, or was \
         taken for one of thousands.",
        if *tens > 0 {
            format!("{} times", 10i64.pow(tens.unsigned_abs()))
        } else {
            format!("1/{} of", 10i64.pow(tens.unsigned_abs()))
        },
    );
    let mut hint = format!("write {}", fitting(row, *k, *tens)?);
    for (number, (row, k, tens)) in more.iter().enumerate() {
        if number == 10 {
            hint += &format!(", and {} more", more.len() - number);
            break;
        }
        let at = columns.component(*k).at;
        let (heading, text) = (&table.headings[at].shown, &row.fields[at].text);
        hint += &format!("; on line {} {heading} {} for {text}", row.line, fitting(row, *k, *tens)?);
    }
    Err(table.error(row, column.at, Code::InvalidValue, message).hint(hint))
}

fn zeros(table: &Table<'_>, columns: &MeasurementColumns, read: &[PositionRow<'_>]) -> Result<()> {
    let is_zero = |one: &&PositionRow<'_>| one.position == Vector3::zeros();
    let mut distances: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for one in read.iter().filter(|one| !is_zero(one)) {
        distances.entry(one.of.1).or_default().push(one.position.norm());
    }
    let far = distances
        .into_iter()
        .filter(|(_, point_distances)| median(point_distances.clone()).is_some_and(|d| d > FAR_FROM_TRACKER));
    let far: Vec<&str> = far.map(|(point, _)| point).collect();
    let is_lost = |one: &&PositionRow<'_>| is_zero(one) && far.contains(&one.of.1);
    let lost: Vec<&PositionRow<'_>> = read.iter().filter(is_lost).collect();
    let Some(first) = lost.first() else {
        return Ok(());
    };
    let postures: Vec<&str> = lost.iter().map(|one| one.of.0).collect();
    let lines: Vec<usize> = lost.iter().map(|one| one.row.line).collect();
    let message = format!(
        "The position is 0, 0, 0, which a tracker writes that has lost its reflector: {} of posture {}.",
        if lines.len() == 1 { format!("line {}", lines[0]) } else { format!("lines {}", in_words(&lines)) },
        each_once(&postures).join(", ")
    );
    let error = table.error(first.row, columns.component(0).at, Code::InvalidValue, message);
    Err(error.hint("delete these rows, or leave x, y and z empty where nothing was read"))
}

/// The coordinates of a reading that are a power of ten too large or small against the `others` of
/// its point, and the powers, where they explain all in which it differs from them.
fn tens(one: &PositionRow<'_>, others: &[&PositionRow<'_>], usual: f64) -> Option<Vec<(usize, i32)>> {
    let mut powers = Vec::new();
    let mut corrected = one.position;
    for k in 0..3 {
        let other = median(others.iter().map(|other| other.position[k]).collect())?;
        let (value, tolerance) = (one.position[k], SAME_POINT_DISTANCE.min(SAME_POINT_SHARE * other.abs()));
        if (value - other).abs() <= SAME_POINT_DISTANCE {
            continue;
        }
        let power = (value / other).abs().log10().round();
        if !(power.abs() >= 1.0 && power.abs() <= f64::from(MOST_TENS)) {
            return None;
        }
        corrected[k] = value / 10f64.powf(power);
        if (corrected[k] - other).abs() > tolerance {
            return None;
        }
        powers.push((k, power as i32));
    }
    // Several others that agree are right; of two readings the one is wrong that stands where no
    // other of the table does.
    let near = |other: &&PositionRow<'_>| {
        let first = others.first();
        first.is_some_and(|first| (other.position - first.position).norm() < 2.0 * SAME_POINT_DISTANCE)
    };
    let agree = others.len() > 1 && others.iter().all(near);
    let apart = |position: &Vector3<f64>| (position.norm() / usual).ln().abs();
    (agree || apart(&one.position) > apart(&corrected) + CLEARLY).then_some(powers)
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
