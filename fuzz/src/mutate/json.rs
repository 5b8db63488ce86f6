//! Changes of saved results: values, keys and lists anywhere in the tree.

use super::numbers::{WORDS, edge_number};
use crate::random::Random;
use serde_json::{Value, json};

/// Stands for a number that JSON's own type cannot hold, until the text is written.
const HOLE: &str = "number goes here";

/// One change.
pub fn change(text: &str, random: &mut Random) -> String {
    let Ok(mut tree) = serde_json::from_str::<Value>(text) else {
        return text.replacen('1', &edge_number(None, random), 1);
    };
    let count = count(&tree);
    let mut number = String::new();
    let mut at = random.below(count);
    visit(&mut tree, &mut at, &mut |value| {
        number = changed(value, random);
    });
    let text = if random.one_in(2) { serde_json::to_string_pretty(&tree) } else { serde_json::to_string(&tree) };
    text.unwrap_or_default().replacen(&format!("\"{HOLE}\""), &number, 1)
}

fn count(value: &Value) -> usize {
    1 + match value {
        Value::Array(items) => items.iter().map(count).sum(),
        Value::Object(entries) => entries.values().map(count).sum(),
        _ => 0usize,
    }
}

/// Calls `change` for value number `at`, the tree counted from its root.
fn visit(value: &mut Value, at: &mut usize, change: &mut impl FnMut(&mut Value)) {
    if *at == 0 {
        change(value);
        *at = usize::MAX;
        return;
    }
    *at -= 1;
    match value {
        Value::Array(items) => {
            for item in items {
                if *at != usize::MAX {
                    visit(item, at, change);
                }
            }
        }
        Value::Object(entries) => {
            for item in entries.values_mut() {
                if *at != usize::MAX {
                    visit(item, at, change);
                }
            }
        }
        _ => {}
    }
}

/// Changes one value; gives the number that goes where it is a hole.
fn changed(value: &mut Value, random: &mut Random) -> String {
    let number = value.as_f64();
    match value {
        Value::Array(items) if !items.is_empty() && !random.one_in(5) => {
            let (at, other) = (random.below(items.len()), random.below(items.len()));
            match random.below(5) {
                0 => {
                    items.remove(at);
                }
                1 => {
                    let copy = items[at].clone();
                    items.push(copy);
                }
                2 => items.swap(at, other),
                3 => items.clear(),
                _ => {
                    items[at] = json!(HOLE);
                    return edge_number(None, random);
                }
            }
        }
        Value::Object(entries) if !entries.is_empty() && !random.one_in(5) => {
            let keys: Vec<String> = entries.keys().cloned().collect();
            let (key, other) = (random.pick(&keys), random.pick(&keys));
            match random.below(5) {
                0 => {
                    entries.remove(key);
                }
                1 => {
                    let copy = entries[key].clone();
                    entries.insert(format!("{key}x"), copy);
                }
                2 => {
                    let (a, b) = (entries[key].clone(), entries[other].clone());
                    entries.insert(key.clone(), b);
                    entries.insert(other.clone(), a);
                }
                3 => {
                    entries.insert("stiffness_nm_per_rad".to_string(), json!([1e6, 1e6]));
                }
                _ => {
                    entries.insert(key.clone(), json!(HOLE));
                    return edge_number(None, random);
                }
            }
        }
        _ => match random.below(10) {
            0 => *value = Value::Null,
            1 => *value = json!(*random.pick(&WORDS)),
            2 => *value = json!([]),
            3 => *value = json!({}),
            4 => *value = json!(true),
            _ => {
                *value = json!(HOLE);
                return edge_number(number, random);
            }
        },
    }
    String::new()
}
