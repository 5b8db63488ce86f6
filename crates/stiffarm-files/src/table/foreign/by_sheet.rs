//! Readings without names beside the sheet that says in which order they were taken.

use super::order::{self, POSITION};
use crate::table::grid::{Field, Heading, Row, Rows, Table};
use crate::table::heading::stem;
use crate::table::naming::NAME;
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::{Finding, codes};

/// Takes a sheet out of several tables: one with names and no position in any row, where no other table has names.
pub(in crate::table) fn take<'a>(tables: &mut Vec<Table<'a>>) -> Option<Table<'a>> {
    let has_names = |table: &Table<'_>| {
        let names = ["posture", "state", "point", NAME];
        let mut headings = table.headings.iter().filter(|heading| !heading.ignored);
        headings.any(|heading| names.contains(&heading.name.as_str()))
    };
    let mut named = (0..tables.len()).filter(|at| has_names(&tables[*at]));
    let (at, None) = (named.next()?, named.next()) else {
        return None;
    };
    let sheet = &tables[at];
    let is_position = |heading: &Heading| POSITION.contains(&stem(&heading.name));
    let positions = columns_where(&sheet.headings, is_position);
    let is_empty = |row: Row<'_>| {
        let mut fields = positions.iter().filter_map(|at| row.fields.get(*at));
        fields.all(|field| field.text.is_empty())
    };
    let is_sheet = tables.len() > 1 && positions.len() == 3 && sheet.rows.below().all(is_empty);
    is_sheet.then(|| tables.remove(at))
}

fn columns_where(headings: &[Heading], wanted: impl Fn(&Heading) -> bool) -> Vec<usize> {
    let all = headings.iter().enumerate();
    let matching = all.filter(|(_, heading)| !heading.ignored && wanted(heading));
    matching.map(|(at, _)| at).collect()
}

/// Puts what the sheet says beside the readings, row by row, and leaves a remark. Of readings that are `growing` the
/// rows at the end of the sheet are still to come.
///
/// # Errors
/// Another number of rows; a row that does not fit the heading.
pub(in crate::table) fn put<'a>(table: &mut Table<'a>, sheet: &Table<'a>, growing: bool) -> Result<()> {
    let (readings, rows) = (table.rows()?, sheet.rows()?);
    order::check(table, sheet, &readings, &rows, growing)?;
    let (files, name) = (table.files.join(", "), sheet.files[0]);
    let some_to_come = growing && readings.len() < rows.len();
    if readings.len() != rows.len() && !some_to_come {
        let message = format!(
            "{} readings without names stand beside {} rows of {name}, which say in which order they were taken.",
            readings.len(),
            rows.len()
        );
        let error = Error::new(Code::Conflict, message).file(table.files[0]);
        return Err(error.hint(
            "add what is missing, delete what was read twice or in between, or give the readings columns posture, \
             state, point",
        ));
    }
    // What the readings have themselves counts.
    let is_in_table = |heading: &Heading| {
        let of_table = table.headings.iter().filter(|heading| !heading.ignored);
        let mut stems = of_table.map(|heading| stem(&heading.name));
        stems.any(|other| other == stem(&heading.name))
    };
    let added = columns_where(&sheet.headings, |heading| !is_in_table(heading));
    let beside = |row: &Row<'_>| -> Vec<Field> {
        let fields = added.iter().map(|at| row.fields.get(*at).cloned());
        fields.map(|field| field.unwrap_or_else(Field::empty)).collect()
    };
    let mut out = Rows::default();
    let heading = table.rows.at(0);
    let columns = table.headings.len();
    let first = heading.fields[..columns].iter().cloned();
    out.push_as(&heading, heading.source, first.chain(beside(&sheet.rows.at(0))));
    for (reading, row) in readings.iter().zip(&rows) {
        let fields = reading.fields.iter().cloned().chain(beside(row));
        out.push_as(reading, reading.source, fields);
    }
    for row in &rows[readings.len()..] {
        let empty = (0..columns).map(|_| Field::empty());
        out.push_as(row, table.files.len(), empty.chain(beside(row)));
    }
    let sentence = format!("{files} has no names: {name} says row by row what its {} readings are of.", readings.len());
    table.remarks.extend(sheet.remarks.iter().cloned());
    let remark = Finding::note(codes::NAMES_BY_SHEET, "readings", sentence);
    table.remarks.push(remark);
    table.rows = out;
    table.files.push(name);
    let headings = added.iter().map(|at| sheet.headings[*at].clone());
    table.headings.extend(headings.collect::<Vec<_>>());
    Ok(())
}
