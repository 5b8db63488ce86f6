//! Columns that `ignore` of `[columns]` names by their place.

use super::naming::normal;
use super::rows::Row;
use stiffarm::findings::{Finding, list};
use stiffarm::model::cell::Columns;

/// The number of a column that `ignore` names by its letters in a spreadsheet, `C`, or by its number, from 1.
pub(super) fn place_of(entry: &str) -> Option<usize> {
    if entry.bytes().all(|b| b.is_ascii_digit()) {
        return entry.parse().ok().filter(|number| *number > 0);
    }
    let letters = (1..=3).contains(&entry.len()) && entry.bytes().all(|b| b.is_ascii_uppercase());
    let number = |number, letter: u8| 26 * number + usize::from(letter - b'A') + 1;
    letters.then(|| entry.bytes().fold(0, number))
}

/// Columns, from 0, that `ignore` names by their place, where none has that heading; `first` is the number of the
/// first column: a sheet may begin to the right of its own.
pub(super) fn by_place(heading: &Row<'_>, first: usize, foreign: &Columns) -> Vec<usize> {
    let is_heading = |entry: &String| {
        let mut fields = heading.fields.iter();
        fields.any(|field| normal(&field.text) == normal(entry))
    };
    let entries = foreign.ignore.iter().filter(|entry| !is_heading(entry));
    let places = entries.filter_map(|entry| place_of(entry)?.checked_sub(first));
    places.collect()
}

/// Names what is left out by its place, by number from 0 and heading: another file may have something else there.
pub(super) fn left_out_by_place(left: &[(usize, &str)], file: &str) -> Option<Finding> {
    let names = left.iter().map(|(at, heading)| match *heading {
        "" => format!("{} without a heading", at + 1),
        shown => format!("{} (\"{shown}\")", at + 1),
    });
    let names: Vec<String> = names.collect();
    let sentence = format!("`ignore` in [columns] leaves out by its place: column {} of {file}.", list(&names));
    (!names.is_empty()).then(|| Finding::note("columns-left-out", "readings", sentence))
}
