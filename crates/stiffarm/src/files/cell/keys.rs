//! TOML syntax, unknown keys and values of the wrong kind, with their places.

use super::raw::{
    RawBounds, RawCell, RawClearance, RawElastic, RawForce, RawLimits, RawLinkShape, RawLoad,
    RawMilling, RawNoise, RawPoint, RawPosture, RawRobot, RawRoute, RawSensor, RawSeries, RawShape,
    RawStation, RawStiffness, RawTask, RawTool, RawTracker, RawUncertainty, RawValidation, RawWork,
};
use super::source::Source;
use crate::error::{Code, Error, Result, did_you_mean};
use serde::Deserialize;
use serde::de::{Deserializer, Error as _, Visitor};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Newest cell file format that this version reads.
const FORMAT: i64 = 1;

/// A table of the format: its path without indices, whether it is an array of
/// tables, and the keys it knows. `[columns]` is none of them: its keys are
/// checked as headings.
struct Section {
    path: &'static str,
    array: bool,
    keys: fn() -> &'static [&'static str],
}

#[rustfmt::skip]
const SECTIONS: [Section; 27] = [
    Section { path: "", array: false, keys: keys_of::<RawCell> },
    Section { path: "robot", array: false, keys: keys_of::<RawRobot> },
    Section { path: "robot.shape", array: true, keys: keys_of::<RawLinkShape> },
    Section { path: "bounds", array: false, keys: keys_of::<RawBounds> },
    Section { path: "tool", array: false, keys: keys_of::<RawTool> },
    Section { path: "tool.measuring_point", array: true, keys: keys_of::<RawPoint> },
    Section { path: "tool.series_compliance", array: false, keys: keys_of::<RawSeries> },
    Section { path: "tool.shape", array: true, keys: keys_of::<RawShape> },
    Section { path: "load", array: false, keys: keys_of::<RawLoad> },
    Section { path: "load.case", array: true, keys: keys_of::<RawLoad> },
    Section { path: "limits", array: false, keys: keys_of::<RawLimits> },
    Section { path: "obstacle", array: true, keys: keys_of::<RawShape> },
    Section { path: "clearance", array: false, keys: keys_of::<RawClearance> },
    Section { path: "noise", array: false, keys: keys_of::<RawNoise> },
    Section { path: "stiffness", array: false, keys: keys_of::<RawStiffness> },
    Section { path: "elastic", array: false, keys: keys_of::<RawElastic> },
    Section { path: "validation", array: false, keys: keys_of::<RawValidation> },
    Section { path: "validation.posture", array: true, keys: keys_of::<RawPosture> },
    Section { path: "task", array: true, keys: keys_of::<RawTask> },
    Section { path: "work", array: false, keys: keys_of::<RawWork> },
    Section { path: "work.force", array: false, keys: keys_of::<RawForce> },
    Section { path: "work.milling", array: false, keys: keys_of::<RawMilling> },
    Section { path: "route", array: false, keys: keys_of::<RawRoute> },
    Section { path: "sensor", array: false, keys: keys_of::<RawSensor> },
    Section { path: "tracker", array: false, keys: keys_of::<RawTracker> },
    Section { path: "tracker.station", array: true, keys: keys_of::<RawStation> },
    Section { path: "uncertainty", array: false, keys: keys_of::<RawUncertainty> },
];

/// Parses the text into the raw cell: valid TOML, a known format, known keys
/// only, each value of the right kind.
pub(super) fn read(source: &mut Source<'_>) -> Result<RawCell> {
    let root = DeTable::parse(source.body()).map_err(|error| syntax_error(source, &error))?;
    // First the format: a newer one may have keys that this version cannot know.
    check_format(source, root.get_ref())?;
    let mut found = Vec::new();
    check_table(source, root.get_ref(), &SECTIONS[0], "", &mut found);
    // Tables are sorted by key; report what comes first in the file.
    found.sort_by_key(|error| error.place().span.as_ref().map(|span| span.start));
    if let Some(first) = found.into_iter().next() {
        return Err(first);
    }
    let mut values = Vec::new();
    note_table(root.get_ref(), "", &mut values);
    let read = RawCell::deserialize(toml::de::Deserializer::from(root.clone()))
        .map_err(|error| type_error(source, &values, &error))?;
    let paths = values.into_iter().map(|(path, value)| (value.span(), path));
    source.set_paths(paths);
    Ok(read)
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
        return source
            .error_at(Code::TomlSyntax, "", span, message)
            .hint(hint);
    }
    let message = format!("This is not valid TOML: {}.", error.message());
    let place = source.error_at(Code::TomlSyntax, "", span.clone(), message);
    let digit = |byte: Option<&u8>| byte.is_some_and(u8::is_ascii_digit);
    let bytes = body.as_bytes();
    // `x = 1,5` is reported at the comma or just behind it.
    let decimal_comma = (span.start.saturating_sub(1)..=span.start).any(|at| {
        bytes.get(at) == Some(&b',')
            && digit(bytes.get(at.wrapping_sub(1)))
            && digit(bytes.get(at + 1))
    });
    let unquoted = ["string values must be quoted", "invalid boolean"];
    if decimal_comma {
        place.hint("TOML writes decimals with a point: 1.5")
    } else if unquoted
        .iter()
        .any(|start| error.message().starts_with(start))
    {
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
    let number = match value.get_ref() {
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).unwrap_or(i64::MAX)
        }
        _ => {
            return Err(wrong_kind(
                source,
                "format",
                value,
                "a whole number",
                Some("write format = 1"),
            ));
        }
    };
    if number > FORMAT {
        let message = format!(
            "The file has format {number}; this version of stiffarm reads format {FORMAT}."
        );
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

/// Notes every unknown key, and everything that should be a table and is not.
fn check_table(
    source: &Source<'_>,
    table: &DeTable<'_>,
    section: &Section,
    shown: &str,
    found: &mut Vec<Error>,
) {
    let known = (section.keys)();
    for (key, value) in table {
        let name = key.get_ref().as_ref();
        let shown = join(shown, name);
        if !known.contains(&name) {
            found.push(unknown_key(source, name, &shown, key.span(), section));
            continue;
        }
        let path = join(section.path, name);
        let Some(child) = SECTIONS.iter().find(|child| child.path == path) else {
            continue;
        };
        match (value.get_ref(), child.array) {
            (DeValue::Table(table), false) => check_table(source, table, child, &shown, found),
            (DeValue::Array(entries), true) => {
                for (i, entry) in entries.iter().enumerate() {
                    let shown = format!("{shown}[{}]", i + 1);
                    match entry.get_ref() {
                        DeValue::Table(table) => check_table(source, table, child, &shown, found),
                        _ => found.push(wrong_kind(source, &shown, entry, "a table", None)),
                    }
                }
            }
            (_, false) => {
                let hint = format!("write [{path}] on a line of its own, and its keys below it");
                found.push(wrong_kind(source, &shown, value, "a table", Some(&hint)));
            }
            (_, true) => {
                let hint = format!("write [[{path}]] once for each, and its keys below it");
                found.push(wrong_kind(
                    source,
                    &shown,
                    value,
                    "an array of tables",
                    Some(&hint),
                ));
            }
        }
    }
}

fn unknown_key(
    source: &Source<'_>,
    name: &str,
    shown: &str,
    span: Range<usize>,
    here: &Section,
) -> Error {
    let known = (here.keys)();
    let elsewhere = || {
        // A table inside this one is meant before any other with such a key.
        let inside = |s: &&Section| !here.path.is_empty() && s.path.starts_with(here.path);
        let mut owners = SECTIONS.iter().filter(|s| (s.keys)().contains(&name));
        let section = owners.clone().find(inside).or_else(|| owners.next())?;
        Some(match (section.path, section.array) {
            ("", _) => format!("{name} stands at the top of the file, before the first [table]"),
            (path, true) => format!("{name} belongs in [[{path}]]"),
            (path, false) => format!("{name} belongs in [{path}]"),
        })
    };
    let hint = elsewhere()
        .or_else(|| did_you_mean(name, known.iter().copied()))
        .unwrap_or_else(|| format!("known keys here: {}", known.join(", ")));
    let message = format!("The format has no key \"{name}\" here.");
    source
        .error_at(Code::UnknownKey, shown, span, message)
        .hint(hint)
}

/// Serde's complaint about a value in the field's words.
fn type_error(source: &Source<'_>, values: &[PathOf<'_, '_>], error: &toml::de::Error) -> Error {
    let span = error.span().unwrap_or_default();
    let mut innermost = values.iter().rev();
    let Some((path, value)) = innermost.find(|(_, value)| value.span() == span) else {
        return source.error_at(Code::WrongType, "", span, format!("{}.", error.message()));
    };
    let expected = match error.message().rsplit_once("expected ").map(|(_, e)| e) {
        // Another integer would have been accepted.
        Some("f64" | "i64") if matches!(value.get_ref(), DeValue::Integer(_)) => None,
        Some("f64") => Some("a number"),
        Some("i64") => Some("a whole number"),
        Some("a string") => Some("text in quotes"),
        Some("a sequence") => Some("a list in brackets"),
        Some("a boolean") => Some("true or false"),
        Some("a table") => Some("a table"),
        _ => None,
    };
    let Some(expected) = expected else {
        let message = "The number is too large to be read.";
        return source.error_at(Code::NotFinite, path, span, message);
    };
    let quoted_number = match value.get_ref() {
        DeValue::String(text) => text.trim().parse::<f64>().is_ok(),
        _ => false,
    };
    let hint = match expected {
        "a number" if quoted_number => Some("write the number without quotes"),
        "a list in brackets" if path.ends_with(']') => {
            Some("a list of lists is needed here: [[…], […]]")
        }
        _ => None,
    };
    wrong_kind(source, path, value, expected, hint)
}

fn wrong_kind(
    source: &Source<'_>,
    key: &str,
    value: &Spanned<DeValue<'_>>,
    expected: &str,
    hint: Option<&str>,
) -> Error {
    let found = match value.get_ref() {
        DeValue::String(_) => "text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    };
    let found = match value.get_ref() {
        DeValue::Float(_) if expected == "a whole number" => "a number with a decimal point",
        _ => found,
    };
    let message = format!("This is {found}; it must be {expected}.");
    let error = source.error_at(Code::WrongType, key, value.span(), message);
    match hint {
        Some(hint) => error.hint(hint),
        None => error,
    }
}

/// A value with its key path.
type PathOf<'t, 'i> = (String, &'t Spanned<DeValue<'i>>);

/// Notes the values of a table, each before those inside it.
fn note_table<'t, 'i>(table: &'t DeTable<'i>, path: &str, values: &mut Vec<PathOf<'t, 'i>>) {
    for (key, value) in table {
        note_value(value, join(path, key.get_ref()), values);
    }
}

fn note_value<'t, 'i>(
    value: &'t Spanned<DeValue<'i>>,
    path: String,
    values: &mut Vec<PathOf<'t, 'i>>,
) {
    values.push((path.clone(), value));
    match value.get_ref() {
        DeValue::Table(table) => note_table(table, &path, values),
        DeValue::Array(entries) => {
            for (i, entry) in entries.iter().enumerate() {
                note_value(entry, format!("{path}[{}]", i + 1), values);
            }
        }
        _ => {}
    }
}

/// Key path of `name` below `path`, with quotes where TOML needs them.
fn join(path: &str, name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let name = if !name.is_empty() && name.chars().all(bare) {
        name.to_string()
    } else {
        format!("{name:?}")
    };
    if path.is_empty() {
        name
    } else {
        format!("{path}.{name}")
    }
}

/// The keys that a raw table knows, as its `Deserialize` has them.
fn keys_of<'de, T: Deserialize<'de>>() -> &'static [&'static str] {
    let mut keys: &'static [&'static str] = &[];
    // Always fails, after it has noted the names.
    let _ = T::deserialize(KeyNames(&mut keys));
    keys
}

struct KeyNames<'a>(&'a mut &'static [&'static str]);

impl<'de> Deserializer<'de> for KeyNames<'_> {
    type Error = serde::de::value::Error;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Self::Error> {
        Err(Self::Error::custom("only the names of the keys are wanted"))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Self::Error> {
        *self.0 = fields;
        self.deserialize_any(visitor)
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}
