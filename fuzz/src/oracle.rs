//! What must hold for every input.

use serde_json::Value;
use std::fmt::{self, Debug, Write};
use stiffarm::Error;
use stiffarm::findings::is_hidden;

/// An error is the user's to mend: it is no fault of the program, and says
/// something that can be seen.
///
/// # Errors
/// What is wrong with it.
pub fn error_is_sound(error: &Error) -> Result<(), String> {
    let message = error.message();
    if error.code().is_internal() {
        return Err(format!("a fault of the program: {message}"));
    }
    if message.trim().is_empty() {
        return Err("an error without a message".to_string());
    }
    for text in [Some(message), error.hint_text()].into_iter().flatten() {
        if text.chars().any(|c| is_hidden(c) && c != '\n') {
            return Err(format!("hidden characters in an error: {text:?}"));
        }
        if text.len() > 4100 {
            return Err(format!("an error of {} bytes", text.len()));
        }
    }
    Ok(())
}

/// No number in `value` is NaN or infinite.
///
/// # Errors
/// There is one; the text says what stands before it.
pub fn is_finite(value: &impl Debug) -> Result<(), String> {
    let mut watch = Watch::default();
    // A watch that has seen one stops the writing.
    if write!(watch, "{value:?}").is_err() {
        let mut from = watch.before.len().saturating_sub(60);
        while !watch.before.is_char_boundary(from) {
            from += 1;
        }
        Err(format!("not finite: …{}", &watch.before[from..]))
    } else {
        Ok(())
    }
}

/// Looks for `NaN` and `inf` in what [`Debug`] writes; it writes a number in one piece,
/// and the quotes of a text each in a piece of their own.
#[derive(Default)]
struct Watch {
    before: String,
    in_quotes: bool,
}

impl Write for Watch {
    fn write_str(&mut self, piece: &str) -> fmt::Result {
        if piece == "\"" && !self.before.ends_with('\\') {
            self.in_quotes = !self.in_quotes;
        }
        let bare = piece.trim_start_matches('-');
        let is_bad = !self.in_quotes && (bare == "NaN" || bare == "inf");
        if self.before.len() > 400 {
            let mut cut = self.before.len() - 60;
            while !self.before.is_char_boundary(cut) {
                cut += 1;
            }
            self.before.drain(..cut);
        }
        self.before += piece;
        if is_bad { Err(fmt::Error) } else { Ok(()) }
    }
}

/// Both texts are the same but for the last digits of their numbers: degrees and
/// millimetres do not reach every double.
pub fn same_but_digits(a: &str, b: &str) -> bool {
    if a == b {
        return true;
    }
    let fields = |text: &str| -> Vec<String> { text.split([',', ';', '\t', '\n', '\r']).map(String::from).collect() };
    let (a, b) = (fields(a), fields(b));
    let near = |(a, b): (&String, &String)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-13 * a.abs(),
        _ => a == b,
    };
    a.len() == b.len() && a.iter().zip(&b).all(near)
}

/// No word of `text` is a number that is not finite. `input` holds the inputs: a name
/// that came from them may be such a word.
///
/// # Errors
/// There is one; the text is its line.
pub fn text_is_finite(text: &str, input: &str) -> Result<(), String> {
    let bad = |line: &str| {
        line.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| matches!(word, "NaN" | "inf" | "infinity"))
    };
    let input = input.to_lowercase();
    // Words of the command's own: `--exclude`d names, comments.
    if ["nan", "inf"].iter().any(|word| input.contains(word)) {
        return Ok(());
    }
    match text.lines().find(|line| bad(line)) {
        Some(line) => Err(format!("not finite: {}", line.trim())),
        None => Ok(()),
    }
}

/// Text for a terminal has nothing that a reader does not see.
///
/// # Errors
/// There is such a character.
pub fn text_is_plain(text: &str) -> Result<(), String> {
    match text.lines().find(|l| l.chars().any(|c| is_hidden(c) && c != '\t')) {
        Some(line) => Err(format!("hidden characters: {line:?}")),
        None => Ok(()),
    }
}

/// Where `value` has `null` and the schema wants a number: JSON's way to write one
/// that is not finite.
///
/// # Errors
/// There is such a place.
pub fn no_null_number(value: &Value, schema: &Value) -> Result<(), String> {
    walk(value, schema, schema, "")
}

fn walk(value: &Value, schema: &Value, root: &Value, path: &str) -> Result<(), String> {
    let schema = resolved(schema, root);
    if let Some(choices) = schema.get("anyOf").or(schema.get("oneOf")).and_then(Value::as_array) {
        // Null is right where one choice takes it; a value is judged by the choice it fits.
        let fits: Vec<&Value> = choices.iter().filter(|c| takes(value, resolved(c, root))).collect();
        let results: Vec<_> = fits.iter().map(|c| walk(value, c, root, path)).collect();
        if results.is_empty() || results.iter().any(Result::is_ok) {
            return Ok(());
        }
        return results.into_iter().next().unwrap_or(Ok(()));
    }
    match value {
        Value::Null if !takes(value, schema) => Err(format!("not finite: {path} is null")),
        Value::Object(entries) => {
            let other = schema.get("additionalProperties").filter(|o| o.is_object());
            let properties = schema.get("properties");
            entries.iter().try_for_each(|(key, value)| {
                match properties.and_then(|properties| properties.get(key)).or(other) {
                    Some(inner) => walk(value, inner, root, &format!("{path}.{key}")),
                    None => Ok(()),
                }
            })
        }
        Value::Array(items) => {
            let each = schema.get("items").filter(|items| items.is_object());
            let fixed = schema.get("prefixItems").and_then(Value::as_array);
            items.iter().enumerate().try_for_each(|(i, value)| match fixed.and_then(|fixed| fixed.get(i)).or(each) {
                Some(inner) => walk(value, inner, root, &format!("{path}[]")),
                None => Ok(()),
            })
        }
        _ => Ok(()),
    }
}

fn resolved<'s>(schema: &'s Value, root: &'s Value) -> &'s Value {
    let reference = schema.get("$ref").and_then(Value::as_str);
    let target = reference.and_then(|r| root.pointer(r.strip_prefix('#')?));
    target.unwrap_or(schema)
}

/// Whether the schema's type is the value's.
fn takes(value: &Value, schema: &Value) -> bool {
    let kind = match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(_) => "number",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    };
    let is_kind =
        |name: &Value| name.as_str().is_some_and(|name| name == kind || name == "integer" && kind == "number");
    match schema.get("type") {
        Some(Value::Array(names)) => names.iter().any(is_kind),
        Some(name) => is_kind(name),
        // References, choices and anything.
        None => schema.get("const").is_none_or(|c| c == value),
    }
}

/// Whether a result holds a serious finding, wherever it stands; what is sealed says again what stands elsewhere.
pub fn holds_serious(value: &Value) -> bool {
    match value {
        Value::Array(items) => items.iter().any(holds_serious),
        Value::Object(map) => {
            let members = map.iter().filter(|(key, _)| *key != "sealed");
            let mut members = members.map(|(_, item)| item);
            map.get("severity").is_some_and(|weight| weight == "serious") || members.any(holds_serious)
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn numbers_that_are_not_finite_are_seen_and_names_are_not() {
        assert!(is_finite(&("inf NaN", "inf", "a\"", "NaN", [1.0, 1e308])).is_ok());
        assert!(same_but_digits("a,1.5\n2", "a,1.5000000000000002\n2"));
        assert!(!same_but_digits("a,1.5", "b,1.5") && !same_but_digits("1,2", "1"));
        assert!(is_finite(&("a", vec![Some(f64::NEG_INFINITY)])).is_err());
        assert!(is_finite(&[f64::NAN]).is_err());
        assert!(text_is_finite("inferred 2\ninfo", "").is_ok());
        assert!(text_is_finite("bends inf mm", "").is_err());
        assert!(text_is_finite("posture inf", "posture\ninf").is_ok());
    }

    #[test]
    fn null_is_a_fault_where_a_number_is_promised() {
        let schema = json!({
            "$defs": {"A": {"type": "object", "properties": {"x": {"type": "number"}, "y": {"type": ["number", "null"]}}}},
            "properties": {"list": {"items": {"anyOf": [{"$ref": "#/$defs/A"}, {"type": "null"}]}}},
            "type": "object",
        });
        assert!(no_null_number(&json!({"list": [null, {"x": 1.0, "y": null}]}), &schema).is_ok());
        let fault = no_null_number(&json!({"list": [{"x": null}]}), &schema).unwrap_err();
        assert_eq!(fault, "not finite: .list[].x is null");
    }

    #[test]
    fn what_is_serious_is_found_wherever_it_stands() {
        let finding = json!({"severity": "serious", "sentence": "One."});
        assert!(holds_serious(&json!({"x": [{"finding": finding}]})));
        assert!(!holds_serious(&json!({"sealed": {"doubts": [finding]}, "x": 1})));
    }
}
