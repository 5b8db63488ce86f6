//! TOML syntax and the version of the format, with their places.

use super::raw::{Node, RawCell, Reading, Value};
use super::source::Source;
use crate::text::is_table;
use stiffarm::error::{Code, Error, Result};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Newest cell file format that this version reads.
const FORMAT: i64 = 1;

/// Parses the text into the raw cell: valid TOML, a known format, known keys
/// only, each value of the right kind.
pub(super) fn read(source: &mut Source<'_>) -> Result<RawCell> {
    let root = DeTable::parse(source.body()).map_err(|error| syntax_error(source, &error))?;
    // First the format: a newer one may have keys that this version cannot know.
    check_format(source, root.get_ref())?;
    let table = Spanned::new(root.span(), DeValue::Table(root.into_inner()));
    let (value, path) = (&table, String::new());
    let mut reading = Reading::of(source);
    let read = RawCell::read(&Node { value, path }, &mut reading);
    let (errors, paths) = (reading.errors, reading.paths);
    // Tables are sorted by key; report what comes first in the file.
    let start = |error: &Error| error.place().span.as_ref().map(|span| span.start);
    if let Some(first) = errors.into_iter().min_by_key(start) {
        return Err(first);
    }
    source.set_paths(paths);
    Ok(read.expect("what could not be read has been noted"))
}

fn syntax_error(source: &Source<'_>, error: &toml::de::Error) -> Error {
    let span = error.span().unwrap_or_default();
    let body = source.body();
    if error.message() == "duplicate key" {
        let key = body.get(span.clone()).unwrap_or_default();
        return source.error_at(Code::Duplicate, key, span, "This key appears twice.");
    }
    if body.trim_start().starts_with('{') {
        let message = "This is JSON, and no cell file: cells are TOML.";
        let hint = "give the cell file that the result was made with, or builtin:comau";
        return source.error_at(Code::TomlSyntax, "", span, message).hint(hint);
    }
    if is_table(body) {
        let message = "This is a table, and no cell file: cells are TOML.";
        return source.error_at(Code::TomlSyntax, "", span, message).hint("the cell comes first, tables after it");
    }
    let message = format!("This is not valid TOML: {}.", error.message());
    let place = source.error_at(Code::TomlSyntax, "", span.clone(), message);
    let digit = |byte: Option<&u8>| byte.is_some_and(u8::is_ascii_digit);
    let bytes = body.as_bytes();
    // `x = 1,5` is reported at the comma or just behind it.
    let decimal_comma = (span.start.saturating_sub(1)..=span.start)
        .any(|at| bytes.get(at) == Some(&b',') && digit(bytes.get(at.wrapping_sub(1))) && digit(bytes.get(at + 1)));
    let unquoted = ["string values must be quoted", "invalid boolean"];
    if decimal_comma {
        place.hint("TOML writes decimals with a point: 1.5")
    } else if unquoted.iter().any(|start| error.message().starts_with(start)) {
        place.hint("text stands in quotes: name = \"…\"")
    } else {
        place
    }
}

fn check_format(source: &Source<'_>, root: &DeTable<'_>) -> Result<()> {
    let Some((_, value)) = root.iter().find(|(key, _)| key.get_ref() == "format") else {
        let message = "The file does not say which format it follows.";
        let error = source.error_at(Code::MissingKey, "format", 0..0, message);
        return Err(error.hint("write format = 1 as the first line"));
    };
    let path = "format".to_string();
    let mut reading = Reading::of(source);
    let Some(number) = i64::read(&Node { value, path }, &mut reading) else {
        return Err(reading.errors.remove(0).hint("write format = 1"));
    };
    if number > FORMAT {
        let message = format!("The file has format {number}; this version of stiffarm reads format {FORMAT}.");
        let error = source.error_at(Code::Unsupported, "format", value.span(), message);
        return Err(error.hint("install a newer stiffarm, or write the file in format 1"));
    }
    if number < FORMAT {
        let message = format!("The format must be {FORMAT}, got {number}.");
        let error = source.error_at(Code::InvalidValue, "format", value.span(), message);
        return Err(error.hint("write format = 1"));
    }
    Ok(())
}
