//! JSON Schema of the cell file, for editors that check and complete TOML.

use super::raw::RawCell;
use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;

/// JSON Schema (draft 2020-12) of `cell.toml`, format 1. The descriptions give
/// unit and axes of each key.
pub fn cell_schema() -> Schema {
    SchemaSettings::draft2020_12()
        .with_transform(RecursiveTransform(drop_null))
        .into_generator()
        .into_root_schema_for::<RawCell>()
}

/// TOML has no null: an optional key is left out. `double` and `int64` are
/// names of Rust's types, not of JSON Schema's formats.
fn drop_null(schema: &mut Schema) {
    schema.remove("format");
    if let Some(kind) = schema.get_mut("type")
        && let Some(kinds) = kind.as_array_mut()
    {
        kinds.retain(|kind| kind != "null");
        if let (1, Some(only)) = (kinds.len(), kinds.pop()) {
            *kind = only;
        }
    }
    let is_null = |option: &_| option == &schemars::json_schema!({ "type": "null" }).to_value();
    if let Some(options) = schema.get_mut("anyOf").and_then(|any| any.as_array_mut())
        && options.iter().any(is_null)
    {
        options.retain(|option| !is_null(option));
        let only = options.pop();
        schema.remove("anyOf");
        for (key, value) in only.iter().filter_map(|only| only.as_object()).flatten() {
            schema.insert(key.clone(), value.clone());
        }
    }
}
