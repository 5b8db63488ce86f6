//! What is known about the exports of named software: defaults of `[columns]`.
//!
//! A profile stands here only where the maker describes the format in public; docs/readings.md
//! cites it. Any key of `[columns]` overrides its default.

use crate::model::cell::{Columns, NamePattern, Separator};

/// The names of the profiles.
pub(super) const NAMES: [&str; 2] = ["spatialanalyzer", "powerinspect"];

/// The defaults of a profile.
pub(super) fn profile(name: &str) -> Option<Columns> {
    let order = |names: &[&str]| names.iter().map(|name| (*name).to_string()).collect();
    let pattern = |text: &str| NamePattern::parse(text).ok();
    match name {
        // "Exporting ASCII Formatted Points": with the point name "Collection Group Target" a line is
        // collection, group, target, x, y, z, separated by spaces or commas; remarks begin with //.
        "spatialanalyzer" => Some(Columns {
            order: order(&["posture", "state", "point", "x_mm", "y_mm", "z_mm"]),
            name_pattern: pattern("{posture}::{state}::{point}"),
            comment: Some("//".to_string()),
            ..Columns::default()
        }),
        // "To export dynamic points to an ASCII file": name, position, normal, offset, low and high
        // tolerance, type, separated by spaces; names in quotation marks.
        "powerinspect" => Some(Columns {
            order: order(&[
                "name", "x_mm", "y_mm", "z_mm", "-", "-", "-", "-", "-", "-", "-",
            ]),
            separator: Some(Separator::Space),
            ..Columns::default()
        }),
        _ => None,
    }
}
