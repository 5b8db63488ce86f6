//! Changes of cell files: values, keys, lines and headings.

use super::numbers::{WORDS, edge_number};
use crate::random::Random;

/// Ends of keys that name a unit.
const UNITS: [&str; 12] = ["_mm", "_m", "_deg", "_rad", "_n", "_nm", "_kg", "_percent", "_nm_per_rad", "_um", "_x", ""];

/// Values of another kind.
const VALUES: [&str; 18] = [
    "\"x\"",
    "\"\"",
    "[]",
    "[0]",
    "[0, 0, 0]",
    "[1, 2, 3, 4, 5, 6]",
    "[nan, 0, 0]",
    "[inf, -inf, 0]",
    "[[0, 1]]",
    "{}",
    "{ x = 1 }",
    "true",
    "1979-05-27",
    "[1e308, 1e308, 1e308]",
    "[0, 0, 1e-300]",
    "\"\\u0000\"",
    "'''a\nb'''",
    "[\"a\", \"a\"]",
];

/// One change.
pub fn change(text: &str, random: &mut Random) -> String {
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    let keyed: Vec<usize> =
        (0..lines.len()).filter(|i| lines[*i].contains('=') || lines[*i].starts_with('[')).collect();
    let Some(place) = random.place(&keyed) else {
        return format!("{text}\nname = \"x\"\n");
    };
    let at = keyed[place];
    let (key, value) = match lines[at].split_once('=') {
        Some((key, value)) => (key.trim().to_string(), value.trim().to_string()),
        None => (lines[at].clone(), String::new()),
    };
    match random.below(16) {
        0..=3 if !value.is_empty() => {
            lines[at] = format!("{key} = {}", changed_value(&value, random));
        }
        4 if !value.is_empty() => lines[at] = format!("{key} = {}", random.pick(&VALUES)),
        5 if !value.is_empty() => {
            let word = random.pick(&WORDS).replace('"', "\\\"");
            lines[at] = format!("{key} = \"{word}\"");
        }
        6 if !value.is_empty() => {
            let stem = key.rfind('_').map_or(key.as_str(), |at| &key[..at]);
            lines[at] = format!("{stem}{} = {value}", random.pick(&UNITS));
        }
        7 | 8 => {
            lines.remove(at);
        }
        9 => {
            let copy = lines[at].clone();
            let to = keyed[random.below(keyed.len())];
            lines.insert(to, copy);
        }
        10 => {
            let other = keyed[random.below(keyed.len())];
            lines.swap(at, other);
        }
        // What a template offers as a comment.
        11 => {
            let comments: Vec<usize> =
                (0..lines.len()).filter(|i| lines[*i].starts_with('#') && lines[*i].contains('=')).collect();
            if let Some(place) = random.place(&comments) {
                let line = &mut lines[comments[place]];
                *line = line.trim_start_matches(['#', ' ']).to_string();
            }
        }
        12 => lines[at] = format!("# {}", lines[at]),
        13 => {
            // A section twice, from its heading to the next.
            let headings: Vec<usize> = (0..lines.len()).filter(|i| lines[*i].starts_with('[')).collect();
            if let Some(place) = random.place(&headings) {
                let start = headings[place];
                let end = headings.get(place + 1).copied().unwrap_or(lines.len());
                let copy = lines[start..end].to_vec();
                match random.below(2) {
                    0 => lines.extend(copy),
                    _ => {
                        lines.drain(start..end);
                    }
                }
            }
        }
        14 => {
            let word = random.pick(&WORDS).replace('\n', " ");
            lines[at] = lines[at].replacen(char::is_alphabetic, &word, 1);
        }
        _ => lines.truncate(at + 1),
    }
    lines.join("\n") + "\n"
}

/// Another value of the same kind: an element of a list, or a number.
fn changed_value(value: &str, random: &mut Random) -> String {
    let Some((open, close)) = value.find('[').zip(value.rfind(']')) else {
        let number = value.split(['#', ' ']).next().and_then(|v| v.parse().ok());
        return edge_number(number, random);
    };
    if close <= open {
        return edge_number(None, random);
    }
    let mut items: Vec<String> = value[open + 1..close].split(',').map(String::from).collect();
    let at = random.below(items.len());
    match random.below(6) {
        0 => {
            items.remove(at);
        }
        1 => {
            let copy = items[at].clone();
            items.push(copy);
        }
        2 => {
            let other = random.below(items.len());
            items.swap(at, other);
        }
        3 => {
            let all = edge_number(None, random);
            items.iter_mut().for_each(|item| *item = all.clone());
        }
        _ => {
            let trimmed = items[at].trim_matches([' ', '[', ']', '{', '}']);
            let new = edge_number(trimmed.parse().ok(), random);
            items[at] = if trimmed.is_empty() { new } else { items[at].replacen(trimmed, &new, 1) };
        }
    }
    format!("{}{}{}", &value[..=open], items.join(","), &value[close..])
}
