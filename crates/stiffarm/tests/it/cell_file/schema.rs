//! The JSON Schema of the cell file agrees with its parser. `cargo xtask
//! generate --check` holds that it is the one of the types.

use serde_json::Value;
use stiffarm_files::builtin;
use stiffarm_files::cell::template;

const SCHEMA: &str = include_str!("../../../../../docs/cell.schema.json");

type Check = Result<(), Box<dyn std::error::Error>>;

/// The schema of the value `schema` stands for, references followed.
fn resolve<'s>(root: &'s Value, schema: &'s Value) -> &'s Value {
    match schema.get("$ref").and_then(Value::as_str) {
        Some(path) => root.pointer(path.trim_start_matches('#')).expect("a valid reference"),
        None => schema,
    }
}

/// Checks what JSON Schema says of keys, kinds and lengths.
fn check(root: &Value, schema: &Value, value: &toml::Value, path: &str) {
    let described = schema.get("description").is_some() || path.ends_with(']');
    let schema = resolve(root, schema);
    assert!(described || schema.get("description").is_some(), "{path} has no description");
    let kind = schema["type"].as_str().unwrap_or_else(|| panic!("{path}: {schema}"));
    match value {
        toml::Value::Table(table) => {
            assert_eq!(kind, "object", "{path}");
            assert_eq!(schema["additionalProperties"], false, "{path}");
            for required in schema["required"].as_array().into_iter().flatten() {
                let name = required.as_str().unwrap_or_default();
                assert!(table.contains_key(name), "{path}.{name}");
            }
            for (key, value) in table {
                let mut child = &schema["properties"][key];
                if child.is_null() && key.starts_with('q') {
                    // The angles of any number of joints.
                    child = &schema["patternProperties"]["^q[1-9][0-9]*_(deg|rad)$"];
                }
                assert!(child.is_object(), "{path}.{key} is not in the schema");
                check(root, child, value, &format!("{path}.{key}"));
            }
        }
        toml::Value::Array(entries) => {
            assert_eq!(kind, "array", "{path}");
            for (bound, wrong) in [("minItems", true), ("maxItems", false)] {
                if let Some(bound) = schema[bound].as_u64() {
                    let short = (entries.len() as u64) < bound;
                    let long = (entries.len() as u64) > bound;
                    assert!(if wrong { !short } else { !long }, "{path}");
                }
            }
            for (i, entry) in entries.iter().enumerate() {
                check(root, &schema["items"], entry, &format!("{path}[{}]", i + 1));
            }
        }
        toml::Value::Integer(_) => assert!(["integer", "number"].contains(&kind), "{path}"),
        toml::Value::Float(_) => assert_eq!(kind, "number", "{path}"),
        toml::Value::Boolean(_) => assert_eq!(kind, "boolean", "{path}"),
        toml::Value::String(_) => assert_eq!(kind, "string", "{path}"),
        toml::Value::Datetime(_) => panic!("{path}: a date"),
    }
}

#[test]
fn shipped_cells_and_templates_follow_the_schema() -> Check {
    let root: &Value = &serde_json::from_str(SCHEMA)?;
    let mut texts = vec![super::FULL.to_string()];
    for name in builtin::cell_names() {
        texts.push(builtin::cell_text(name).unwrap_or_default().to_string());
    }
    for entry in stiffarm::model::robot::catalogue() {
        texts.push(template(entry.key)?);
    }
    for text in texts {
        let table: toml::Table = toml::from_str(&text)?;
        check(root, root, &toml::Value::Table(table), "");
    }
    Ok(())
}

#[test]
fn the_schema_has_no_null_and_no_rust_names() {
    for word in ["null", "Raw", "anyOf", "\"double\"", "\"int64\""] {
        assert!(!SCHEMA.contains(word), "{word}");
    }
}
