//! What to write into `[columns]` for the headings of a file.

use crate::table::grid::Heading;
use crate::table::naming::NAME;

/// Headings that a hint lists before it is cut.
const MOST: usize = 12;

/// Names that a column of its own may hold.
const OURS: [&str; 3] = ["posture", "state", "point"];

/// Keys of `[columns]` that would make these headings known, as far as their words tell;
/// `None` where nothing in them looks like a position or a name.
pub(in crate::table) fn suggestion(
    headings: &[Heading],
    is_known: impl Fn(&str) -> bool,
) -> Option<String> {
    let mut keys: Vec<(&'static str, &str)> = Vec::new();
    let mut taken: Vec<&'static str> = Vec::new();
    let mut rest: Vec<String> = Vec::new();
    for heading in headings.iter().filter(|heading| !heading.ignored) {
        if is_known(&heading.name) || heading.shown.is_empty() {
            taken.extend(OURS.iter().find(|own| **own == heading.name));
            continue;
        }
        let there = |key: &str| {
            taken.contains(&key)
                || headings
                    .iter()
                    .any(|h| h.name == key && h.name != heading.name)
        };
        match key(&heading.name).filter(|key| !there(key)) {
            Some(key) => {
                taken.push(key);
                keys.push((key, heading.shown.as_str()));
            }
            None => rest.push(format!("\"{}\"", heading.shown)),
        }
    }
    if keys.is_empty() || keys.len() + rest.len() > MOST {
        return None;
    }
    // Where posture and state have columns, a name is that of the point.
    let apart = ["posture", "state"].iter().all(|own| taken.contains(own));
    let mut out: Vec<String> = Vec::new();
    for (key, shown) in keys {
        let key = if apart && key == NAME { "point" } else { key };
        out.push(format!("{key} = \"{shown}\""));
        if key == NAME {
            let pattern = match ["posture", "state", "point"].map(|own| taken.contains(&own)) {
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
fn key(name: &str) -> Option<&'static str> {
    let words: Vec<&str> = name
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect();
    let has = |wanted: &[&str]| words.iter().any(|word| wanted.contains(word));
    let unit = match () {
        () if has(&["m", "metres", "meters"]) => 1,
        () if has(&["um", "microns"]) => 2,
        () if has(&["in", "inch", "inches"]) => 3,
        // No unit of ours: nothing to map it to.
        () if has(&["cm", "dm", "km", "ft", "feet"]) => return None,
        () => 0,
    };
    let deviation = has(&[
        "nominal",
        "dev",
        "deviation",
        "delta",
        "error",
        "rms",
        "sigma",
        "i",
        "j",
        "k",
    ]);
    match () {
        () if deviation => None,
        () if has(&["x", "x1"]) => Some(["x_mm", "x_m", "x_um", "x_in"][unit]),
        () if has(&["y", "y1"]) => Some(["y_mm", "y_m", "y_um", "y_in"][unit]),
        () if has(&["z", "z1"]) => Some(["z_mm", "z_m", "z_um", "z_in"][unit]),
        () if has(&["station", "instrument"]) => Some("station"),
        () if has(&["time", "timestamp", "datetime", "zeit", "heure"]) => Some("time_s"),
        () if has(&["date", "datum"]) => Some("date"),
        () if has(&["collection", "pose", "workpiece"]) => Some("posture"),
        () if has(&["group", "load"]) => Some("state"),
        () if has(&["target", "reflector", "smr", "point"]) && !has(&["name"]) => Some("point"),
        () if has(&["name", "label", "feature", "object", "id"]) => Some(NAME),
        () => None,
    }
}
