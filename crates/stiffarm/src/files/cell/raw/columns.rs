//! `[columns]`: keys that are headings, and the list `ignore`.

use super::{At, Text};
use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use std::fmt;
#[cfg(feature = "schema")]
use {
    crate::files::table::own_headings,
    schemars::{JsonSchema, Schema, SchemaGenerator, json_schema},
    std::borrow::Cow,
};

/// The entries in the order of the file.
#[derive(Debug)]
pub(in crate::files::cell) struct RawColumns(pub(in crate::files::cell) Vec<(Text, At<RawColumn>)>);

/// One heading of another software, or a list of them.
#[derive(Debug)]
pub(in crate::files::cell) enum RawColumn {
    One(String),
    Several(Vec<Text>),
}

impl<'de> Deserialize<'de> for RawColumns {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries;
        impl<'de> Visitor<'de> for Entries {
            type Value = RawColumns;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<RawColumns, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(RawColumns(entries))
            }
        }
        deserializer.deserialize_map(Entries)
    }
}

impl<'de> Deserialize<'de> for RawColumn {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrSeveral;
        impl<'de> Visitor<'de> for OneOrSeveral {
            type Value = RawColumn;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a string")
            }
            fn visit_str<E>(self, text: &str) -> Result<RawColumn, E> {
                Ok(RawColumn::One(text.to_string()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<RawColumn, A::Error> {
                let mut texts = Vec::new();
                while let Some(text) = list.next_element()? {
                    texts.push(text);
                }
                Ok(RawColumn::Several(texts))
            }
        }
        deserializer.deserialize_any(OneOrSeveral)
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for RawColumns {
    fn schema_name() -> Cow<'static, str> {
        "Columns".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let mut schema = json_schema!({
            "type": "object",
            "description": "Headings of measurement tables and paths that another software writes: \
                            ours, with the unit that the table has, = theirs.",
            "properties": {
                "ignore": {
                    "type": "array",
                    "items": { "type": "string" },
                    "description": "Headings of columns that do not matter.",
                },
                "order": {
                    "type": "array",
                    "items": { "type": "string" },
                    "description": "The columns of a table without a heading, by our headings; \
                                    name, date, and - for one that does not matter.",
                },
                "profile": {
                    "enum": ["spatialanalyzer", "powerinspect"],
                    "description": "Software whose export this is: defaults of the other keys.",
                },
                "name": {
                    "type": "string",
                    "description": "What the table calls the column that name_pattern splits (default: name).",
                },
                "name_pattern": {
                    "type": "string",
                    "description": "How that column holds posture, state and point: \
                                    {posture}::{state}::{point}; {} does not matter.",
                },
                "date": {
                    "type": "string",
                    "description": "What the table calls a column of dates beside one of times.",
                },
                "dates": {
                    "enum": ["day-first", "month-first"],
                    "description": "Order of day and month in dates like 05/11/2026.",
                },
                "separator": {
                    "enum": ["comma", "semicolon", "tab", "space"],
                    "description": "What separates the columns, where the heading does not show it.",
                },
                "comment": {
                    "type": "string",
                    "description": "What a line of remarks begins with, beside #.",
                },
                "sheet": {
                    "type": "string",
                    "description": "Worksheet of a workbook (default: the first).",
                },
            },
            "patternProperties": {
                "^q[1-9][0-9]*_(deg|rad)$": {
                    "type": "string",
                    "description": "What the table calls the controller angle of this joint.",
                },
            },
            "additionalProperties": false,
        });
        let properties = schema.get_mut("properties");
        if let Some(properties) = properties.and_then(|p| p.as_object_mut()) {
            for heading in own_headings(0) {
                let theirs = json_schema!({
                    "type": "string",
                    "description": "What the table calls this column, in any case.",
                });
                properties.insert(heading, theirs.to_value());
            }
        }
        schema
    }
}
