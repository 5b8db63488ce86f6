//! Several files as one table.

use crate::table::grid::{Field, Heading, Table};
use stiffarm::error::{Code, Result};

/// Adds the rows of `other` below those of `table`, column by column.
///
/// # Errors
/// The files have different columns, or one is a workbook and the other a text.
pub(in crate::table) fn join<'a>(table: &mut Table<'a>, other: Table<'a>) -> Result<()> {
    let first = table.files[0];
    if table.style != other.style {
        let message =
            format!("The file is not written as {first}: one is a workbook, or their columns are separated otherwise.");
        let error = other.heading_error(None, Code::Conflict, message);
        return Err(error.hint("export all files in one format"));
    }
    let counts = |heading: &&Heading| !heading.ignored;
    for (at, heading) in other.headings.iter().enumerate() {
        if counts(&heading) && !table.headings.iter().any(|candidate| candidate.name == heading.name) {
            let message = format!("{first} has no such column.");
            let error = other.heading_error(Some(at), Code::Conflict, message);
            return Err(error.hint(
                "files that are read together have the same columns; ignore in [columns] of the cell \
                file leaves columns out",
            ));
        }
    }
    let mut places = Vec::with_capacity(table.headings.len());
    for heading in &table.headings {
        let place = other.headings.iter().position(|candidate| candidate.name == heading.name);
        if place.is_none() && !heading.ignored {
            let message = format!("The column {} is missing, which {first} has.", heading.shown);
            let error = other.heading_error(None, Code::Conflict, message);
            return Err(error.hint("files that are read together have the same columns"));
        }
        places.push(place);
    }
    let source = table.files.len();
    table.files.push(other.files[0]);
    table.remarks.extend(other.remarks.iter().cloned());
    for row in other.rows.below() {
        if row.is_empty() {
            continue;
        }
        other.check_length(&row)?;
        let fields = places.iter().map(|place| place.map_or_else(Field::empty, |at| row.fields[at].clone()));
        table.rows.push_as(&row, source, fields);
    }
    Ok(())
}
