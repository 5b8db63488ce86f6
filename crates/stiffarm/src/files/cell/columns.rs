//! `[columns]`: what another software calls the columns of measurement tables and paths.

use super::raw::{At, RawColumn, RawColumns, Text};
use super::source::Source;
use crate::error::{Code, Result};
use crate::files::table::own_heading;
use crate::model::cell::Columns;
use crate::model::robot::Robot;

/// The key of the headings that do not matter.
const IGNORE: &str = "ignore";

/// The headings of the other software, where the cell names them.
pub(super) fn columns(
    source: &Source<'_>,
    table: Option<&At<RawColumns>>,
    robot: &Robot,
) -> Result<Columns> {
    let mut columns = Columns::default();
    // Without case: two headings that differ in it alone are one.
    let mut taken: Vec<(String, String)> = Vec::new();
    let mut take = |theirs: &str, key: &str, place: &dyn Fn(&str) -> crate::error::Error| {
        let lower = theirs.to_lowercase();
        if let Some((_, other)) = taken.iter().find(|(name, _)| *name == lower) {
            return Err(place(&format!("{other} has this heading already.")));
        }
        taken.push((lower, key.to_string()));
        Ok(())
    };
    for (name, value) in table.into_iter().flat_map(|table| &table.get().0) {
        let key = format!("columns.{}", name.get());
        match value.get() {
            RawColumn::Several(list) if name.get() == IGNORE => {
                for (i, theirs) in list.iter().enumerate() {
                    let key = format!("{key}[{}]", i + 1);
                    let heading = source.name(theirs, &key)?;
                    take(&heading, &key, &|message| {
                        source.error(Code::Duplicate, &key, theirs.span(), message)
                    })?;
                    columns.ignore.push(heading);
                }
            }
            RawColumn::One(_) if name.get() == IGNORE => {
                let message = "This is text; it must be a list in brackets.";
                let error = source.error(Code::WrongType, &key, value.span(), message);
                return Err(error.hint("write ignore = [\"…\", \"…\"]"));
            }
            RawColumn::Several(_) => {
                ours(source, name, &key, robot)?;
                let message = "This is a list; it must be text in quotes.";
                return Err(source.error(Code::WrongType, &key, value.span(), message));
            }
            RawColumn::One(theirs) => {
                let ours = ours(source, name, &key, robot)?;
                let theirs = source.checked_name(theirs, value.span(), &key)?;
                take(&theirs, &key, &|message| {
                    source.error(Code::Duplicate, &key, value.span(), message)
                })?;
                if columns.names.insert(ours, theirs).is_some() {
                    let message = "This column appears twice, in different case.";
                    return Err(source.error(Code::Duplicate, &key, name.span(), message));
                }
            }
        }
    }
    Ok(columns)
}

/// The heading of ours that a key names.
fn ours(source: &Source<'_>, name: &Text, key: &str, robot: &Robot) -> Result<String> {
    let joints = robot.joint_count();
    own_heading(name.get(), joints, IGNORE).map_err(|e| source.place(e, key, name.span()))
}
