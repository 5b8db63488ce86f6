//! Names that hold several names: `collection::group::point`.

use crate::table::grid::{Column, Field, Heading, Rows, Table};
use crate::table::naming::NAME;
use stiffarm::error::{Code, Result};
use stiffarm::model::cell::NamePattern;

/// Replaces the column `name` by the columns of the pattern.
pub(super) fn split(table: &mut Table<'_>, pattern: &NamePattern) -> Result<()> {
    let is_name = |heading: &Heading| !heading.ignored && heading.name == NAME;
    let Some(at) = table.headings.iter().position(is_name) else {
        return Ok(());
    };
    let mut rows = Rows::default();
    for (number, row) in (0..table.rows.len()).map(|number| (number, table.rows.at(number))) {
        let Some(whole) = row.fields.get(at).filter(|_| number > 0) else {
            rows.push_as(&row, row.source, row.fields.iter().cloned());
            continue;
        };
        if row.is_empty() {
            continue;
        }
        // Said with the columns that the file has.
        table.check_length(&row)?;
        let parts = if whole.text.is_empty() {
            vec![""; pattern.columns().count()]
        } else {
            table.name(&row, Column { at, unit: None })?;
            pattern.split(&whole.text).ok_or_else(|| {
                    let message = format!(
                        "\"{}\" does not fit the pattern {}.",
                        whole.text,
                        pattern.text()
                    );
                    let error = table.error(&row, at, Code::TableRow, message);
                    error.hint("name_pattern in [columns] of the cell file says how names are split; a row that is no reading can be deleted")
                })?
        };
        let parts = parts.into_iter().map(|text| Field {
            text: text.into(),
            column: whole.column,
            other: false,
        });
        rows.push_as(&row, row.source, row.fields.iter().cloned().chain(parts));
    }
    let whole = table.headings[at].clone();
    let own = pattern.columns().map(|name| Heading {
        name: name.to_string(),
        ..whole.clone()
    });
    table.headings.extend(own.collect::<Vec<_>>());
    table.headings[at].ignored = true;
    table.rows = rows;
    Ok(())
}
