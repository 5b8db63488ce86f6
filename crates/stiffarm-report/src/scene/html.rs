//! A scene as part of a page.

use super::data::Scene;
use crate::figure::svg::escape;
use std::fmt::Write as _;

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
    let json = serde_json::to_string(scene).unwrap_or_else(|_| "null".into());
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

/// JSON that ends no script element and begins no comment, whatever its strings say.
fn inert(json: &str) -> String {
    json.replace('<', "\\u003c")
}
