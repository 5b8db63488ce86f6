//! Drawings as SVG: views with axes below each other at the left, the others
//! with key and notes at the right.

mod ink;
mod key;
mod labels;
mod shown;
mod view;

pub use shown::{Ink, ShownDrawing, shown_drawing};

use super::canvas::{self, Anchor, Canvas, Font, Point, Rect};
use super::plan::{LEADING, SMALL};
use super::{HEADING, MARGIN, text};
use crate::figure::drawing::{Drawing, View};
use crate::figure::layout::Layout;
use key::Key;
use view::Placed;

/// Usual width of a drawing.
const WIDTH: f64 = 800.0;
/// Least width of a drawing with two columns; in a narrower one everything is below each other.
const TWO_COLUMNS: f64 = 600.0;
/// Highest and lowest plot area.
const HIGHEST: f64 = 420.0;
const LOWEST: f64 = 150.0;
/// Lowest that the highest views are made where a drawing would be too high, and the steps on the way.
const LOWERED: f64 = 210.0;
const STEP: f64 = 10.0;
/// Room for tick labels and the label of a vertical axis.
const LEFT: f64 = 62.0;
/// Room for tick labels and the label of a horizontal axis.
const BELOW: f64 = 44.0;
/// Room for the title of a view.
const ABOVE: f64 = 22.0;
/// Distance between views.
const GAP: f64 = 14.0;

/// Renders a drawing as a stand-alone SVG document.
///
/// Equal drawings give equal bytes. Marks beyond a view are cut off at its frame; marks with
/// coordinates that are not finite are left out. The caption becomes the description of the
/// picture. The document contains no ids, so several can be embedded in one page.
pub fn render_drawing(drawing: &Drawing) -> String {
    render(drawing, None)
}

/// The same picture at a stated width and in a stated typeface. In a narrow one all views are
/// below each other, the key and the notes last; without its title it has no notes either. On
/// paper it is at most 220 mm high: the views are lower, or those without axes are left out.
pub fn render_drawing_with(drawing: &Drawing, layout: &Layout) -> String {
    render(drawing, Some(layout))
}

fn render(drawing: &Drawing, layout: Option<&Layout>) -> String {
    let width = layout.map_or(WIDTH, Layout::drawn_width);
    let mut canvas = Canvas::default();
    let is_told = layout.is_none_or(|layout| layout.title);
    let title =
        if is_told { text::wrap(&drawing.title, text::BOLD * HEADING, width - 2.0 * MARGIN, 3) } else { Vec::new() };
    let top = MARGIN + title.len() as f64 * HEADING * LEADING + 6.0;
    let tallest = layout.and_then(Layout::tallest).unwrap_or(f64::INFINITY);
    let placed = fitting(drawing, is_told, (width, top), tallest);

    open(&mut canvas, drawing, (width, placed.height), layout);
    for (i, line) in title.iter().enumerate() {
        let at = (0.5 * width, MARGIN + (i as f64 + 0.85) * HEADING * LEADING);
        canvas.text(at, line, None, Font::new(HEADING, Anchor::Middle).bold());
    }
    for view in &placed.views {
        view.draw(&mut canvas);
    }
    let (right, key_top) = placed.key_at;
    placed.key.draw(&mut canvas, (right, key_top));
    for (i, (line, caution)) in placed.notes.iter().enumerate() {
        let at: Point = (right, placed.notes_top + (i as f64 + 0.9) * SMALL * LEADING);
        let colour = if *caution { ink::CAUTION } else { canvas::INK };
        canvas.coloured_text(at, line, Font::new(SMALL, Anchor::Start), colour);
    }
    canvas.raw("</g>");
    canvas.raw("</svg>");
    canvas.finish()
}

/// Where everything of a drawing goes.
struct Arrangement<'a> {
    views: Vec<Placed<'a>>,
    key: Key<'a>,
    key_at: Point,
    notes: Vec<(String, bool)>,
    notes_top: f64,
    height: f64,
}

/// The arrangement with the highest views that is no higher than `tallest`: with all views; where
/// they would be too low, with those that have axes alone.
fn fitting<'a>(drawing: &'a Drawing, has_notes: bool, room: (f64, f64), tallest: f64) -> Arrangement<'a> {
    let all: Vec<&View> = drawing.views.iter().collect();
    let scaled: Vec<&View> = all.iter().copied().filter(|v| v.axes.is_some()).collect();
    let mut choices = vec![all];
    if !scaled.is_empty() {
        choices.push(scaled);
    }
    let arrange = |views: &[&'a View], highest| arrange(drawing, views, has_notes, room, highest);
    let mut heights = vec![HIGHEST];
    while heights[heights.len() - 1] > LOWERED {
        heights.push(heights[heights.len() - 1] - STEP);
    }
    let mut arrangement = arrange(&choices[0], HIGHEST);
    for views in &choices {
        for highest in &heights {
            if arrangement.height <= tallest {
                return arrangement;
            }
            arrangement = arrange(views, *highest);
        }
    }
    arrangement
}

/// These views, none higher than `highest`, with the key and the notes.
fn arrange<'a>(
    drawing: &'a Drawing,
    views: &[&'a View],
    has_notes: bool,
    (width, top): (f64, f64),
    highest: f64,
) -> Arrangement<'a> {
    let (with_axes, without): (Vec<&View>, Vec<&View>) = views.iter().partition(|view| view.axes.is_some());
    let two = width >= TWO_COLUMNS;
    let plot = if two {
        0.5 * (width - 2.0 * MARGIN - LEFT - GAP - 8.0) - 1.0
    } else {
        // The last tick label reaches beyond the frame.
        width - 2.0 * MARGIN - LEFT - 6.0
    };
    let column = |views: &[&'a View], top, across, below| column(views, top, across, (below, highest));
    let (mut placed, left_end) = column(&with_axes, top, (MARGIN + LEFT, plot), BELOW);
    let (right, right_top) = if two {
        (MARGIN + LEFT + plot + GAP + 8.0, top)
    } else if with_axes.is_empty() {
        (MARGIN, top)
    } else {
        (MARGIN, left_end + GAP)
    };
    let right_width = width - MARGIN - right;
    let (right_views, right_end) = column(&without, right_top, (right, right_width), 4.0);
    placed.extend(right_views);
    let key = Key::of(&drawing.key, right_width);
    let key_top = right_end + 4.0;
    let notes = if has_notes { note_lines(drawing, right_width) } else { Vec::new() };
    let notes_top = key_top + key.height() + 8.0;
    let right_end = notes_top + notes.len() as f64 * SMALL * LEADING;
    Arrangement {
        views: placed,
        key,
        key_at: (right, key_top),
        notes,
        notes_top,
        height: left_end.max(right_end) + MARGIN,
    }
}

/// Views below each other from `top` on, and where they end.
fn column<'a>(
    views: &[&'a View],
    top: f64,
    (left, width): (f64, f64),
    (below, highest): (f64, f64),
) -> (Vec<Placed<'a>>, f64) {
    let mut y = top;
    let mut placed = Vec::new();
    for view in views {
        let [x_span, y_span] = view.extent.map(|[from, to]| to - from);
        let wanted = width * y_span / x_span;
        let height = if wanted.is_finite() { wanted.clamp(LOWEST, highest) } else { LOWEST };
        let area = Rect { x: left, y: y + ABOVE, w: width, h: height };
        placed.push(Placed::new(view, area));
        y += ABOVE + height + below + GAP;
    }
    (placed, y - GAP)
}

/// All notes in lines that fit.
fn note_lines(drawing: &Drawing, width: f64) -> Vec<(String, bool)> {
    let lines = drawing.notes.iter().flat_map(|note| {
        let lines = text::wrap(&note.text, SMALL, width, 8);
        lines.into_iter().map(|line| (line, note.caution))
    });
    lines.collect()
}

/// Root element, description and background.
fn open(canvas: &mut Canvas, drawing: &Drawing, size: (f64, f64), layout: Option<&Layout>) {
    let texts = (&drawing.id[..], &drawing.title[..], &drawing.caption[..]);
    super::open_document(canvas, texts, size, layout);
}
