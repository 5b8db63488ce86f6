//! Figures as SVG.
//!
//! The renderer is our own. The plotting crate `kuva` was tried: it moves
//! non-positive values of a logarithmic axis to its lower end instead of
//! leaving them out, has neither boxes side by side nor whiskers at chosen
//! quantiles, knows no markers on lines, and stacks its shared legend
//! vertically; hardly any of what it offers would have been used.

mod areas;
mod canvas;
mod data;
mod drawing;
mod hits;
mod legend;
mod map;
mod marks;
mod palette;
mod panel;
mod plan;
mod scale;
mod series_style;
mod shared;
mod shown;
mod text;
mod ticks;

pub use drawing::{Ink, ShownDrawing, render_drawing, render_drawing_with, shown_drawing};
pub use palette::series_colour;
pub use shared::share_axes;
pub use shown::{ShownFigure, ShownPanel, shown_figure};

pub use canvas::escape;
use canvas::{Anchor, Canvas, Font, Rect, num};
use legend::Legend;
use plan::{LEADING, Plan, Shown};
use series_style::SeriesStyles;

use crate::figure::layout::{self, Layout, Size};
use crate::figure::{Figure, Panel};

/// Outer margin of the picture.
const MARGIN: f64 = 12.0;
/// Distance between panels.
const GUTTER: f64 = 20.0;
/// Least width of a plot area.
const NARROWEST: f64 = 60.0;
/// Least width of a plot area beside others in a picture of stated width.
const COMFORTABLE: f64 = 150.0;
/// Height of a plot area by its width in a picture of stated width, and its limits.
const SHAPE: f64 = 0.66;
const HEIGHTS: [f64; 2] = [150.0, 300.0];
/// Most lines of a legend entry in a picture of stated width.
const ENTRY_LINES: usize = 4;
/// Font size of the figure title.
const HEADING: f64 = 15.0;

/// Renders a figure as a stand-alone SVG document.
///
/// Equal figures give equal bytes. Values an axis cannot show (not finite, of
/// absurd magnitude, not positive on a logarithmic axis, without a category or
/// without a partner coordinate) are left out and counted in a note in the
/// panel; so are points beyond a fixed range. The caption becomes the
/// description of the picture and is not drawn. The document contains no ids,
/// so several can be embedded in one page.
///
/// ```
/// use stiffarm_report::{Axis, Figure, Panel, Series, Style, render_svg};
///
/// let figure = Figure {
///     id: "deviation".into(),
///     title: "Deviation".into(),
///     caption: "Deviation grows with noise.".into(),
///     columns: 1,
///     panels: vec![Panel {
///         title: String::new(),
///         x: Axis::linear("noise level", ""),
///         y: Axis::log("mean deviation", "%"),
///         series: vec![Series::new("Group 1", Style::Line, vec![1.0, 2.0], vec![0.5, 0.0])],
///         equal_aspect: false,
///     }],
/// };
/// let svg = render_svg(&figure);
/// assert!(svg.contains("mean deviation [%]"));
/// assert!(svg.contains("1 value not drawn"));
/// ```
pub fn render_svg(figure: &Figure) -> String {
    render(figure, None)
}

/// The same picture at a stated width and in a stated typeface. Panels that do
/// not fit side by side go below each other.
///
/// ```
/// use stiffarm_report::{Figure, Layout, render_svg_with};
///
/// let figure = Figure {
///     id: "empty".into(),
///     title: String::new(),
///     caption: String::new(),
///     columns: 1,
///     panels: Vec::new(),
/// };
/// let svg = render_svg_with(&figure, &Layout::paper(88.0, 8.0));
/// assert!(svg.contains(r#"width="88mm""#));
/// ```
pub fn render_svg_with(figure: &Figure, layout: &Layout) -> String {
    render(figure, Some(layout))
}

fn render(figure: &Figure, layout: Option<&Layout>) -> String {
    let columns = figure.columns.clamp(1, figure.panels.len().max(1));
    let width = match (layout, columns) {
        (Some(layout), _) => layout.drawn_width(),
        (None, 1) => 560.0,
        (None, 2) => 800.0,
        (None, n) => 320.0 * n as f64,
    };
    let styles = SeriesStyles::of(figure);
    let title = match layout {
        Some(layout) if !layout.title => Vec::new(),
        _ => text::wrap(&figure.title, text::BOLD * HEADING, width - 2.0 * MARGIN, 3),
    };
    let title_height = title.len() as f64 * HEADING * LEADING;
    let top = MARGIN + title_height + if title.is_empty() { 0.0 } else { 10.0 };
    let (grid, entry_lines) = match layout {
        Some(_) => (Grid::fitting(&figure.panels, columns, width, top), ENTRY_LINES),
        None => {
            let usual = match columns {
                1 => 300.0,
                2 => 230.0,
                _ => 190.0,
            };
            let grid = Grid::new(&figure.panels, columns, width, top, |_| usual);
            (grid, 1)
        }
    };
    let width = grid.width;
    let legend = Legend::of(figure, width, entry_lines);
    let legend_top = grid.bottom + 10.0;
    let height = if legend.height() > 0.0 { legend_top + legend.height() + MARGIN } else { grid.bottom + MARGIN };

    let is_screen = |layout: &Layout| matches!(layout.size, Size::Screen { .. });
    let mut canvas = Canvas::answering(layout.is_some_and(is_screen));
    open(&mut canvas, figure, (width, height), layout);
    for (i, line) in title.iter().enumerate() {
        let at = (0.5 * width, MARGIN + (i as f64 + 0.85) * HEADING * LEADING);
        canvas.text(at, line, None, Font::new(HEADING, Anchor::Middle).bold());
    }
    for ((panel, plan), place) in figure.panels.iter().zip(&grid.plans).zip(&grid.places) {
        panel::draw(&mut canvas, panel, plan, &styles, place.area, place.left);
    }
    if figure.panels.is_empty() {
        let at = (0.5 * width, top + 30.0);
        canvas.text(at, "no data", None, Font::new(plan::NORMAL, Anchor::Middle));
    }
    legend.draw(&mut canvas, &styles, legend_top);
    canvas.raw("</g>");
    canvas.raw("</svg>");
    canvas.finish()
}

/// Root element, description and background.
fn open(canvas: &mut Canvas, figure: &Figure, size: (f64, f64), layout: Option<&Layout>) {
    let texts = (&figure.id[..], &figure.title[..], &figure.caption[..]);
    open_document(canvas, texts, size, layout);
}

/// The same for any picture, by its id, title and caption.
fn open_document(
    canvas: &mut Canvas,
    (id, title, caption): (&str, &str, &str),
    (width, height): (f64, f64),
    layout: Option<&Layout>,
) {
    let (w, h) = (num(width), num(height.ceil()));
    let [outer_w, outer_h] = match layout {
        Some(layout) => layout.attributes([width, height.ceil()]),
        None => [w.clone(), h.clone()],
    };
    let families = match layout {
        Some(layout) => layout.families(),
        None => layout::USUAL_FAMILIES.to_owned(),
    };
    // What answers is no single image; and its title would stand at the pointer wherever that is.
    let role = if canvas.answers() {
        format!(r#"role="group" aria-label="{}""#, escape(title))
    } else {
        r#"role="img""#.to_string()
    };
    canvas.raw(&format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{outer_w}" height="{outer_h}" viewBox="0 0 {w} {h}" {role} data-figure="{}">"#,
        escape(id)
    ));
    if !canvas.answers() {
        canvas.raw(&format!("<title>{}</title>", escape(title)));
    }
    canvas.raw(&format!("<desc>{}</desc>", escape(caption)));
    canvas.raw(&format!(r##"<rect width="{w}" height="{h}" fill="#ffffff"/>"##));
    canvas.raw(&format!(r#"<g font-family="{families}" fill="{}">"#, canvas::INK));
}

/// Where a panel goes.
struct Place {
    area: Rect,
    left: f64,
}

/// The panels on the page. All plot areas have the same width, those of one
/// row the same height.
struct Grid {
    plans: Vec<Plan>,
    places: Vec<Place>,
    bottom: f64,
    width: f64,
    /// Width of every plot area.
    plot: f64,
}

impl Grid {
    /// As many columns, up to `most`, as fit into the width with plot areas that can be read.
    fn fitting(panels: &[Panel], most: usize, width: f64, top: f64) -> Self {
        let usual = |plot: f64| (SHAPE * plot).clamp(HEIGHTS[0], HEIGHTS[1]);
        let mut columns = most.min((width / COMFORTABLE) as usize).max(1);
        loop {
            let grid = Self::new(panels, columns, width, top, usual);
            if columns == 1 || (grid.plot >= COMFORTABLE && grid.width <= width) {
                return grid;
            }
            columns -= 1;
        }
    }

    /// Panels in so many columns; `usual` is the height of a plot area by its width.
    fn new(panels: &[Panel], columns: usize, width: f64, top: f64, usual: impl Fn(f64) -> f64) -> Self {
        let inner = width - 2.0 * MARGIN - GUTTER * (columns - 1) as f64;
        // The room for labels depends on the ticks, the ticks on the size of
        // the plot area, and that on the room. The room only ever grows, so a
        // few rounds settle it.
        let mut sides = vec![(0.0_f64, 0.0_f64); columns];
        let mut plot;
        let mut heights: Vec<f64>;
        let mut plans: Vec<Plan>;
        let mut rounds = 0;
        loop {
            let taken: f64 = sides.iter().map(|(left, right)| left + right).sum();
            plot = ((inner - taken) / columns as f64).max(NARROWEST);
            heights = panels
                .chunks(columns)
                .map(|row| row.iter().map(|p| plan::suitable_height(p, plot, usual(plot))).fold(0.0, f64::max))
                .collect();
            plans = panels
                .iter()
                .enumerate()
                .map(|(i, p)| Plan::new(p, shown(panels, columns, i), plot, heights[i / columns]))
                .collect();
            let before = sides.clone();
            for (i, plan) in plans.iter().enumerate() {
                let (left, right) = &mut sides[i % columns];
                *left = left.max(plan.left);
                *right = right.max(plan.right);
            }
            rounds += 1;
            if sides == before || rounds == 8 {
                break;
            }
        }
        let mut x = MARGIN;
        let mut lefts = Vec::new();
        for (left, right) in sides {
            lefts.push((x, x + left));
            x += left + plot + right + GUTTER;
        }
        let mut y = top;
        let mut places = Vec::new();
        for (row, height) in plans.chunks(columns).zip(&heights) {
            let above = row.iter().map(|p| p.top).fold(0.0, f64::max);
            let below = row.iter().map(|p| p.bottom).fold(0.0, f64::max);
            for (_, (left, from)) in row.iter().zip(&lefts) {
                places.push(Place { area: Rect { x: *from, y: y + above, w: plot, h: *height }, left: *left });
            }
            y += above + height + below + 12.0;
        }
        let bottom = if panels.is_empty() { top + 50.0 } else { y - 12.0 };
        Self {
            plans,
            places,
            bottom,
            plot,
            // Only labels of excessive width exceed the intended one.
            width: width.max(x - GUTTER + MARGIN),
        }
    }
}

/// A label that the panel below (x) or to the left (y) repeats is drawn once.
fn shown(panels: &[Panel], columns: usize, i: usize) -> Shown {
    let below = panels.get(i + columns);
    let left = (!i.is_multiple_of(columns)).then(|| &panels[i - 1]);
    Shown {
        x_label: below.is_none_or(|p| p.x.heading() != panels[i].x.heading()),
        y_label: left.is_none_or(|p| p.y.heading() != panels[i].y.heading()),
    }
}
