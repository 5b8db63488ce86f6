//! JSON of saved results as values: every key once.

use super::text::{decode, is_table};
use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::fmt;
use stiffarm::error::{Code, Error, Result};

/// The value of a JSON text. A key that stands twice is a fault: of two values
/// only one would count, and nobody would see which.
///
/// # Errors
/// Text that is not JSON, or a key twice, with line and column.
pub(super) fn parse(bytes: &[u8]) -> Result<Value> {
    let text = decode(bytes)?;
    let text = text.trim_start_matches('\u{feff}');
    let strict: StrictJson = serde_json::from_str(text).map_err(|e| {
        let said = e.to_string();
        let said = said.split(" at line ").next().unwrap_or_default();
        let message = if e.is_data() || said.contains("out of range") {
            format!("This is not a saved result: {said}.")
        } else {
            what_it_is(text, e.is_eof()).to_string()
        };
        let error = Error::new(Code::ResultFile, message);
        match e.line() {
            0 => error,
            line => error.line(line, Some(e.column().max(1))),
        }
    })?;
    Ok(strict.0)
}

/// What a text that cannot be read as JSON looks like.
fn what_it_is(text: &str, ends_early: bool) -> &'static str {
    match text.chars().find(|c| !c.is_ascii_whitespace()) {
        None => "The file is empty.",
        Some('{' | '[') if ends_early => "This JSON ends too early: a part of the file is missing.",
        Some('{' | '[') => "This is not JSON: it begins like it and has a fault here.",
        Some(_) if is_table(text) => "This is a table and not JSON: are two files in each other's place?",
        Some(_) => "This is not JSON.",
    }
}

struct StrictJson(Value);

impl<'de> Deserialize<'de> for StrictJson {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(StrictVisitor)
    }
}

struct StrictVisitor;

impl<'de> Visitor<'de> for StrictVisitor {
    type Value = StrictJson;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_bool<E>(self, value: bool) -> Result<StrictJson, E> {
        Ok(StrictJson(value.into()))
    }

    fn visit_i64<E>(self, value: i64) -> Result<StrictJson, E> {
        Ok(StrictJson(value.into()))
    }

    fn visit_u64<E>(self, value: u64) -> Result<StrictJson, E> {
        Ok(StrictJson(value.into()))
    }

    fn visit_f64<E>(self, value: f64) -> Result<StrictJson, E> {
        Ok(StrictJson(value.into()))
    }

    fn visit_str<E>(self, value: &str) -> Result<StrictJson, E> {
        Ok(StrictJson(value.into()))
    }

    fn visit_unit<E>(self) -> Result<StrictJson, E> {
        Ok(StrictJson(Value::Null))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<StrictJson, A::Error> {
        let mut out = Vec::new();
        while let Some(StrictJson(item)) = items.next_element()? {
            out.push(item);
        }
        Ok(StrictJson(out.into()))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<StrictJson, A::Error> {
        let mut out = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            if out.contains_key(&key) {
                return Err(A::Error::custom(format!("the key \"{key}\" stands twice")));
            }
            let StrictJson(value) = entries.next_value()?;
            out.insert(key, value);
        }
        Ok(StrictJson(out.into()))
    }
}
