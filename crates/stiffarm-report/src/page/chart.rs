//! A chart within a page.

use crate::figure::Figure;
use crate::figure::svg::render_svg;

/// The chart as it fits a wide page, and one for narrow screens.
pub(super) fn chart(figure: &Figure) -> String {
    let class = if figure.columns > 1 {
        "paper broad"
    } else {
        "paper"
    };
    format!("<div class=\"{class}\">{}</div>", render_svg(figure))
}
