//! What is known about the exports of named software: defaults of `[columns]`.
//!
//! A profile stands here only where the maker describes the format in public, or a file of it is
//! public; docs/readings.md cites it. Any key of `[columns]` overrides its default.

use stiffarm::model::cell::{Columns, NamePattern, Separator};

/// The names of the profiles.
pub(super) const NAMES: [&str; 3] = ["spatialanalyzer", "powerinspect", "leica"];

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
            order: order(&["name", "x_mm", "y_mm", "z_mm", "-", "-", "-", "-", "-", "-", "-"]),
            separator: Some(Separator::Space),
            ..Columns::default()
        }),
        // The CSV of an AT960 with T-Mac: a heading with units, uncertainties of 95 %, attitude, weather.
        "leica" => Some(Columns {
            names: [("u95x_mm", "x"), ("u95y_mm", "y"), ("u95z_mm", "z")]
                .map(|(ours, axis)| (ours.to_string(), format!("U(95) {axis} [mm]")))
                .into_iter()
                .chain([("time_s".to_string(), "Time Stamp".to_string())])
                .collect(),
            ignore: order(&[
                "U(95) [mm]",
                "Tilt [deg]",
                "Q0",
                "Q1",
                "Q2",
                "Q3",
                "Image RMS [µm]",
                "Target",
                "Pressure [mBar]",
                "Humidity [%]",
                "OTG Applied",
                "Delete",
            ]),
            is_latin_1: true,
            ..Columns::default()
        }),
        _ => None,
    }
}
