//! A chart within a page.

use crate::figure::Figure;
use crate::figure::layout::Layout;
use crate::figure::svg::render_svg_with;

/// Widths of charts with one panel in a row, with two, with more, and on narrow screens \[px\].
const WIDTHS: [f64; 3] = [660.0, 960.0, 1120.0];
const NARROW: f64 = 360.0;
/// Smallest text \[px\].
const TEXT: f64 = 12.0;

/// The chart as it fits a wide page, and one for narrow screens.
pub(super) fn chart(figure: &Figure) -> String {
    let width = WIDTHS[figure.columns.clamp(1, WIDTHS.len()) - 1];
    let wide = render_svg_with(figure, &Layout::screen(width, TEXT));
    let narrow = render_svg_with(figure, &Layout::screen(NARROW, TEXT));
    format!(
        "<div class=\"forms\"><div class=\"paper narrow\">{narrow}</div><div class=\"paper wide\">{wide}</div></div>"
    )
}
