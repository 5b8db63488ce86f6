//! What to write into `[columns]` for the headings of a file.

mod words;

use crate::table::grid::Heading;
use crate::table::naming::{NAME, joint_number};
use crate::table::quantity::Quantity;
use words::{HeadingMeaning, said, stem, words};

/// Headings that a hint lists before it is cut.
const MOST_HEADINGS: usize = 12;

/// Names that a column of its own may hold.
const OURS: [&str; 3] = ["posture", "state", "point"];

/// Keys of `[columns]` that would make these headings known, as far as their words tell;
/// `None` where nothing in them looks like a position or a name.
pub(in crate::table) fn suggestion(headings: &[Heading], is_known: impl Fn(&str) -> bool) -> Option<String> {
    let mut keys: Vec<(String, &str)> = Vec::new();
    let mut taken: Vec<String> = Vec::new();
    let mut rest: Vec<String> = Vec::new();
    for heading in headings.iter().filter(|heading| !heading.ignored) {
        if is_known(&heading.name) || heading.shown.is_empty() {
            let ours = OURS.iter().find(|ours| **ours == heading.name);
            taken.extend(ours.map(|ours| ours.to_string()));
            continue;
        }
        let there = |key: &str| {
            taken.iter().any(|taken_key| taken_key == key)
                || headings.iter().any(|h| h.name == key && h.name != heading.name)
        };
        match key(&heading.name).filter(|key| (is_known(key) || !key.contains('_')) && !there(key)) {
            Some(key) => {
                taken.push(key.clone());
                keys.push((key, heading.shown.as_str()));
            }
            None => rest.push(format!("\"{}\"", heading.shown)),
        }
    }
    if keys.is_empty() || keys.len() + rest.len() > MOST_HEADINGS {
        return None;
    }
    // Where posture and state have columns, a name is that of the point.
    let has = |name: &str| taken.iter().any(|key| key == name);
    let apart = ["posture", "state"].into_iter().all(has);
    let mut out: Vec<String> = Vec::new();
    for (key, shown) in keys {
        let key = if apart && key == NAME { "point" } else { &key };
        out.push(format!("{key} = \"{shown}\""));
        if key == NAME {
            let pattern = match ["posture", "state", "point"].map(has) {
                [false, true, true] => "{posture}",
                [false, false, true] => "{posture}::{state}",
                [true, _, _] => "{state}::{point}",
                _ => "{posture}::{state}::{point}",
            };
            out.push(format!("name_pattern = \"{pattern}\""));
        }
    }
    if !rest.is_empty() {
        out.push(format!("ignore = [{}]", rest.join(", ")));
    }
    Some(out.join(", "))
}

/// The key that a heading's words point to.
fn key(name: &str) -> Option<String> {
    let words = words(name);
    let has = |wanted: &[&str]| words.iter().any(|word| wanted.contains(&word.as_str()));
    if let Some((joint, unit)) = joint_number(name) {
        let letters: String = unit.chars().filter(|c| c.is_alphanumeric()).collect();
        let suffix = match letters.as_str() {
            "" | "deg" | "degrees" => "deg",
            "rad" => "rad",
            _ => return None,
        };
        return Some(format!("q{joint}_{suffix}"));
    }
    let named = match said(&words) {
        HeadingMeaning::Measured(quantity, axis, unit) => {
            return stem(quantity, axis).map(|stem| format!("{stem}_{unit}"));
        }
        HeadingMeaning::Counts(..) | HeadingMeaning::Other => return None,
        HeadingMeaning::Nothing if has(&["nominal", "dev", "deviation", "delta", "error", "rms", "sigma"]) => {
            return None;
        }
        HeadingMeaning::Nothing => match () {
            () if has(&["station", "instrument"]) => "station",
            () if has(&["time", "timestamp", "datetime", "zeit", "heure"]) => "time_s",
            () if has(&["date", "datum"]) => "date",
            () if has(&["collection", "pose", "workpiece"]) => "posture",
            () if has(&["group", "load"]) => "state",
            () if has(&["target", "reflector", "smr", "point"]) && !has(&["name"]) => "point",
            () if has(&["name", "label", "feature", "object", "id"]) => NAME,
            () => return None,
        },
    };
    Some(named.to_string())
}

/// Headings whose numbers are counts of a sensor, with the column that the forces behind them would have.
pub(in crate::table) fn counts(headings: &[Heading]) -> Option<String> {
    let of = |heading: &&Heading| match said(&words(&heading.name)) {
        HeadingMeaning::Counts(quantity, axis) => stem(quantity, axis).map(|stem| (quantity, stem)),
        _ => None,
    };
    let mut all = headings.iter().filter(|heading| !heading.ignored);
    let (heading, (quantity, stem)) = all.find_map(|heading| Some((heading, of(&heading)?)))?;
    let unit = match quantity {
        Quantity::Moment => ["N·m", "nm"],
        _ => ["N", "n"],
    };
    Some(format!(
        "\"{}\" holds counts, whose size only the sensor's calibration tells: divide them by its counts per {}, and \
         name the column {stem}_{}",
        heading.shown, unit[0], unit[1]
    ))
}
