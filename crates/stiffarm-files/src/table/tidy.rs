//! Tables of readings as people lay them out: names that stand in the first row of a group alone,
//! rows of means and remarks below the readings.

use super::grid::{Field, Row, Table};
use super::heading::stem;
use super::naming::NAME;
use super::rows::in_words;
use std::collections::{BTreeMap, BTreeSet};
use stiffarm::findings::{Finding, codes, list};
use stiffarm::model::cell::Columns;

/// The columns of names, the outermost group first.
const NAMES: [&str; 3] = ["posture", "state", "point"];

/// First words of rows that sum up the readings above.
const SUMMARIES: [&str; 31] = [
    "mean",
    "average",
    "avg",
    "mittelwert",
    "mittel",
    "moyenne",
    "media",
    "promedio",
    "median",
    "std",
    "stdev",
    "stddev",
    "sd",
    "sigma",
    "σ",
    "standard",
    "standardabweichung",
    "stabw",
    "ecart",
    "écart",
    "min",
    "minimum",
    "max",
    "maximum",
    "range",
    "spannweite",
    "rms",
    "sum",
    "summe",
    "count",
    "anzahl",
];

/// Numbers of the columns that count and whose name without unit is one of `stems`.
fn columns(table: &Table<'_>, stems: &[&str]) -> Vec<usize> {
    let headings = table.headings.iter().enumerate();
    let matching = headings.filter(|(_, heading)| !heading.ignored && stems.contains(&stem(&heading.name)));
    matching.map(|(at, _)| at).collect()
}

fn is_blank(row: &Row<'_>, at: usize) -> bool {
    row.fields.get(at).is_none_or(|field| field.text.is_empty())
}

/// Leaves out what is no reading: rows of means and the like, whose names are not complete, and
/// below the last reading rows that hold a single text. Says which.
pub(super) fn leave_out(table: &mut Table<'_>, foreign: &Columns) {
    if columns(table, &["x", "y", "z"]).len() != 3 {
        return;
    }
    let names = columns(table, &NAMES);
    let whole = columns(table, &[NAME]);
    let is_named = |row: &Row<'_>| {
        let pattern = foreign.name_pattern.as_ref();
        let fits = |at: &usize| {
            let name = row.fields.get(*at).map_or("", |field| field.text.as_str());
            pattern.map_or(!name.is_empty(), |pattern| pattern.split(name).is_some())
        };
        let mut both = names.iter().chain(&whole).peekable();
        both.peek().is_some() && names.iter().all(|at| !is_blank(row, *at)) && whole.iter().all(fits)
    };
    let label = |row: &Row<'_>| -> Option<String> {
        let texts = row.fields.iter().map(|field| field.text.as_str());
        let first = texts.clone().find(|text| !text.is_empty())?;
        let words = first.to_lowercase();
        let word = words.split(|c: char| !c.is_alphabetic()).find(|word| !word.is_empty());
        let sums_up = word.is_some_and(|word| SUMMARIES.contains(&word));
        (sums_up && !is_named(row)).then(|| first.to_string())
    };
    // A name that other rows have is a slip or a row to come.
    let remark = |row: &Row<'_>| -> Option<String> {
        let mut filled = row.fields.iter().enumerate().filter(|(_, field)| !field.text.is_empty());
        let (Some((at, field)), None) = (filled.next(), filled.next()) else {
            return None;
        };
        let is_number = field.text.replacen(',', ".", 1).parse::<f64>().is_ok();
        let others = table.rows.below().filter(|other| other.line != row.line);
        let mut others = others.filter_map(|other| other.fields.get(at));
        let is_text = !field.other && !is_number && !is_named(row);
        (is_text && !others.any(|other| other.text == field.text)).then(|| field.text.to_string())
    };
    let mut out: BTreeMap<usize, (usize, String)> = BTreeMap::new();
    let mut is_below = true;
    for number in (1..table.rows.len()).rev() {
        let row = table.rows.at(number);
        let text = label(&row).or_else(|| is_below.then(|| remark(&row)).flatten());
        is_below &= text.is_some() || row.is_empty();
        out.extend(text.map(|text| (number, (row.line, text))));
    }
    if out.is_empty() {
        return;
    }
    let shown: Vec<String> = out.values().map(|(line, text)| format!("{line} (\"{text}\")")).collect();
    let sentence = format!("Rows of {} that are no readings are left out: line {}.", table.files[0], list(&shown));
    table.rows.retain(|number| !out.contains_key(&number));
    table.remarks.push(Finding::note(codes::ROWS_LEFT_OUT, "readings", sentence));
}

/// Carries names down from the first row of their group where they stand in none of the others,
/// and forces and angles from the first row of a state or posture. Says which.
pub(super) fn carry_down(table: &mut Table<'_>) {
    if columns(table, &["x", "y", "z"]).len() != 3 {
        return;
    }
    let rows: Vec<usize> = (1..table.rows.len()).filter(|n| !table.rows.at(*n).is_empty()).collect();
    let mut carried: BTreeSet<usize> = BTreeSet::new();
    let mut lines: BTreeSet<usize> = BTreeSet::new();
    let mut fill = |table: &mut Table<'_>, at: usize, from: usize, to: usize| {
        let text = table.rows.at(from).fields[at].clone();
        let line = table.rows.at(to).line;
        if let Some(field) = table.rows.fields_mut(to).get_mut(at) {
            *field = Field { text: text.text, other: text.other, ..field.clone() };
            carried.insert(at);
            lines.insert(line);
        }
    };
    let names: Vec<usize> = NAMES.iter().flat_map(|name| columns(table, &[*name])).collect();
    for (level, at) in names.iter().enumerate() {
        for (from, to) in groups(table, &rows, *at, &names[..level]) {
            fill(table, *at, from, to);
        }
    }
    let joints: Vec<usize> = (0..table.headings.len())
        .filter(|at| {
            let heading = &table.headings[*at];
            let number = stem(&heading.name).strip_prefix('q');
            !heading.ignored && number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
        })
        .collect();
    // A row that is still to be read waits for its forces, too.
    let position = columns(table, &["x", "y", "z"]);
    let is_read = |number: &usize| !position.iter().all(|at| is_blank(&table.rows.at(*number), *at));
    let rows: Vec<usize> = rows.into_iter().filter(is_read).collect();
    let wrench = columns(table, &["fx", "fy", "fz", "mx", "my", "mz"]);
    let state = names.len().min(2);
    for (set, level) in [
        (wrench, state),
        (columns(table, &["load"]), state),
        (columns(table, &["station"]), 1),
        (joints.clone(), 1),
        (joints, state),
    ] {
        for (from, to) in once(table, &rows, &set, &names[..level.min(names.len())]) {
            set.iter().for_each(|at| fill(table, *at, from, to));
        }
    }
    let shown: Vec<&str> = carried.iter().map(|at| table.headings[*at].shown.as_str()).collect();
    let lines: Vec<usize> = lines.into_iter().collect();
    let sentence = format!(
        "{} {} in the first row of a group alone: the rows below have the same (lines {}).",
        list(&shown),
        if shown.len() == 1 { "stands" } else { "stand" },
        in_words(&lines)
    );
    let remark = Finding::note(codes::CARRIED_DOWN, "readings", sentence);
    table.remarks.extend((!shown.is_empty()).then_some(remark));
}

/// Rows from which, and rows to which, the name of column `at` is carried. Every group has two
/// rows or more but the last, which may not be complete, and begins where an outer one does:
/// else a name has been forgotten.
fn groups(table: &Table<'_>, rows: &[usize], at: usize, outer: &[usize]) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    let mut lengths: Vec<usize> = Vec::new();
    let mut first = None;
    let mut before: Option<usize> = None;
    for number in rows {
        let row = table.rows.at(*number);
        let text = |row: &Row<'_>, at: usize| row.fields.get(at).map(|field| field.text.clone());
        let last = before.replace(*number).map(|last| table.rows.at(last));
        let begins = last.is_none_or(|last| outer.iter().any(|o| text(&last, *o) != text(&row, *o)));
        if !is_blank(&row, at) {
            first = Some(*number);
            lengths.push(1);
        } else if begins {
            return Vec::new();
        } else if let (Some(first), Some(length)) = (first, lengths.last_mut()) {
            pairs.push((first, *number));
            *length += 1;
        }
    }
    let complete = lengths.split_last().map_or(&[][..], |(_, complete)| complete);
    let fits = complete.iter().all(|length| *length > 1);
    if fits { pairs } else { Vec::new() }
}

/// Rows from which, and to which, the columns `set` are carried: of rows with the same `names`
/// the first has all of them, and no other has any.
fn once(table: &Table<'_>, rows: &[usize], set: &[usize], names: &[usize]) -> Vec<(usize, usize)> {
    if set.is_empty() {
        return Vec::new();
    }
    let mut groups: BTreeMap<Vec<String>, Vec<usize>> = BTreeMap::new();
    for number in rows {
        let row = table.rows.at(*number);
        let key = names.iter().map(|at| row.fields.get(*at).map_or("", |f| f.text.as_str()).to_string());
        groups.entry(key.collect()).or_default().push(*number);
    }
    let mut pairs = Vec::new();
    for (first, others) in groups.values().filter_map(|group| group.split_first()) {
        let blank = |number: &usize, at: &usize| is_blank(&table.rows.at(*number), *at);
        let whole = !set.iter().any(|at| blank(first, at));
        if whole && others.iter().all(|number| set.iter().all(|at| blank(number, at))) {
            pairs.extend(others.iter().map(|other| (*first, *other)));
        }
    }
    pairs
}
