//! `[columns]`: keys that are headings, and the list `ignore`.

use super::read::{Node, Reading, TABLE, Value, join};
use super::{Spanned, Text};
use toml::de::DeString;
#[cfg(feature = "schema")]
use {
    crate::cell::profiles::NAMES as PROFILES,
    crate::table::own_headings,
    schemars::{JsonSchema, Schema, SchemaGenerator, json_schema},
    std::borrow::Cow,
};

/// The entries in the order of the file.
#[derive(Debug)]
pub(in crate::cell) struct RawColumns(pub(in crate::cell) Vec<(Text, Spanned<RawColumn>)>);

/// One heading of another software, or a list of them.
#[derive(Debug)]
pub(in crate::cell) enum RawColumn {
    One(String),
    Several(Vec<Text>),
}

impl Value for RawColumns {
    const KIND: &'static str = TABLE;

    fn read(node: &Node<'_>, reading: &mut Reading<'_>) -> Option<Self> {
        let Some(table) = node.value.get_ref().as_table() else {
            return reading.wrong(node, Self::KIND, None);
        };
        let entry = |(key, entry): (&toml::Spanned<DeString<'_>>, _)| {
            let (span, value) = (key.span(), key.get_ref().to_string());
            let read = reading.inner(entry, join(&node.path, &value))?;
            Some((Spanned { span, value }, read))
        };
        Some(RawColumns(table.iter().filter_map(entry).collect()))
    }
}

impl Value for RawColumn {
    const KIND: &'static str = String::KIND;

    fn read(node: &Node<'_>, reading: &mut Reading<'_>) -> Option<Self> {
        if node.value.get_ref().is_array() {
            Vec::read(node, reading).map(RawColumn::Several)
        } else {
            String::read(node, reading).map(RawColumn::One)
        }
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
                    "description": "Headings of columns that do not matter, or their places where no column has that \
                                    heading: \"C\" as in a spreadsheet, or \"3\"; \"\" stands for columns without one.",
                },
                "order": {
                    "type": "array",
                    "items": { "type": "string" },
                    "description": "The columns of a table without a heading, by our headings; \
                                    name, date, and - for one that does not matter.",
                },
                "profile": {
                    "enum": PROFILES,
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
                "encoding": {
                    "enum": ["utf-8", "latin-1"],
                    "description": "Encoding of the text (default: utf-8).",
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
