//! Names that hold several names: `collection::group::point`.

use crate::table::grid::{Column, Field, Heading, Rows, Table};
use crate::table::naming::NAME;
use stiffarm::error::{Code, Result};
use stiffarm::model::cell::NamePattern;
use stiffarm::model::measurement::{ReadingTarget, Role};

/// Names that are known beforehand; empty lists say nothing.
#[derive(Debug, Default)]
pub(in crate::table) struct Names<'n> {
    pub(in crate::table) postures: Vec<&'n str>,
    pub(in crate::table) points: Vec<&'n str>,
    pub(in crate::table) cases: Vec<&'n str>,
}

impl Names<'_> {
    /// How many parts of a name are known ones.
    fn count_known(&self, columns: &[&str], parts: &[&str]) -> usize {
        let is_known = |(column, part): (&&str, &&str)| match *column {
            "posture" => self.postures.contains(part),
            "point" => self.points.contains(part) || ReadingTarget::is_base_name(part),
            _ => is_state(part) || self.cases.iter().any(|case| part.starts_with(case)),
        };
        let pairs = columns.iter().zip(parts);
        pairs.filter(|pair| is_known(*pair)).count()
    }

    /// The way to split `name` in which most parts are known; the first of those.
    fn split<'t>(&self, pattern: &NamePattern, name: &'t str) -> Option<Vec<&'t str>> {
        let columns: Vec<&str> = pattern.columns().collect();
        let ways = pattern.splits(name).into_iter().rev();
        ways.max_by_key(|parts| self.count_known(&columns, parts))
    }
}

/// True for the names of states that sheets have: `unloaded-2`, `preload`, `loaded`, `up-250`.
fn is_state(name: &str) -> bool {
    let end = name.find(|c: char| !c.is_alphabetic()).unwrap_or(name.len());
    let word = name[..end].to_lowercase();
    Role::of(name) != Role::Loaded || ["loaded", "up", "down"].contains(&word.as_str())
}

/// Replaces the column `name` by the columns of the pattern.
pub(super) fn split(table: &mut Table<'_>, pattern: &NamePattern, names: &Names<'_>) -> Result<()> {
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
            table.name(&row, Column { at, unit: None, sense: None })?;
            names.split(pattern, &whole.text).ok_or_else(|| {
                let message = format!("\"{}\" does not fit the pattern {}.", whole.text, pattern.text());
                let error = table.error(&row, at, Code::TableRow, message);
                error.hint(
                    "name_pattern in [columns] of the cell file says how names are split; a row that is no \
                        reading can be deleted",
                )
            })?
        };
        let parts = parts.into_iter().map(|text| Field { text: text.into(), column: whole.column, other: false });
        rows.push_as(&row, row.source, row.fields.iter().cloned().chain(parts));
    }
    let whole = table.headings[at].clone();
    let headings = pattern.columns().map(|name| Heading { name: name.to_string(), ..whole.clone() });
    table.headings.extend(headings.collect::<Vec<_>>());
    table.headings[at].ignored = true;
    table.rows = rows;
    Ok(())
}
