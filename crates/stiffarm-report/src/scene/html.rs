//! A scene as part of a page.

use super::data::Scene;
use crate::figure::svg::escape;
use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::Formatter;
use std::fmt::Write as _;
use std::io;
use stiffarm::units::significant;

/// The script of every page with scenes: three.js and the viewer. It adds one global, `stiffarm`.
pub const VIEWER_SCRIPT: &str = concat!(
    "(() => {\n\"use strict\";\n",
    include_str!("../../assets/three.min.js"),
    include_str!("../../assets/viewer/shapes.js"),
    include_str!("../../assets/viewer/lines.js"),
    include_str!("../../assets/viewer/camera.js"),
    include_str!("../../assets/viewer/labels.js"),
    include_str!("../../assets/viewer/around.js"),
    include_str!("../../assets/viewer/picture.js"),
    include_str!("../../assets/viewer/panel.js"),
    include_str!("../../assets/viewer/viewer.js"),
    "})();\n"
);

/// The style of every page with scenes; all its selectors are below `.scene`.
pub const VIEWER_STYLE: &str = include_str!("../../assets/viewer/viewer.css");

/// A scene as part of a page that has [`VIEWER_SCRIPT`] behind it and [`VIEWER_STYLE`] in its head.
///
/// `id` names its element in the page, `title` says what it is. `fallback` is HTML, a picture of the same: what is
/// seen on paper, and where the browser cannot draw in three dimensions.
pub fn scene_html(scene: &Scene, id: &str, title: &str, fallback: &str) -> String {
    let json = short_json(scene).unwrap_or_else(|| "null".into());
    let mut html = String::new();
    let _ = write!(
        html,
        "<div class=\"scene\" id=\"{id}\" data-title=\"{title}\">\n<div class=\"scene-fallback\">{fallback}</div>\n\
         <script type=\"application/json\">{json}</script>\n</div>\n",
        id = escape(id),
        title = escape(title),
        json = inert(&json),
    );
    html
}

/// JSON with numbers so short that many postures stay a small file.
fn short_json(scene: &Scene) -> Option<String> {
    let mut json = Vec::new();
    scene.serialize(&mut Serializer::with_formatter(&mut json, ShortNumbers)).ok()?;
    String::from_utf8(json).ok()
}

/// Seven significant digits, and zero below 1e-12.
struct ShortNumbers;

impl Formatter for ShortNumbers {
    fn write_f64<W: ?Sized + io::Write>(&mut self, writer: &mut W, value: f64) -> io::Result<()> {
        let short = if value.abs() < 1e-12 { 0.0 } else { significant(value, 7) };
        write!(writer, "{short}")
    }
}

/// JSON that ends no script element and begins no comment, whatever its strings say.
fn inert(json: &str) -> String {
    json.replace('<', "\\u003c")
}
