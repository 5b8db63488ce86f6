//! The one legend of a figure.

use super::canvas::{Anchor, Canvas, Font, Point, Rect, Stroke};
use super::look::Looks;
use super::map;
use super::marks::{FAINT, LANDMARK, MARKER, STROKE};
use super::plan::SMALL;
use super::text;
use crate::figure::{Figure, Style};

/// Width of the sample mark.
const KEY: f64 = 30.0;
/// Distance between the sample mark and its text.
const KEY_GAP: f64 = 6.0;
/// Distance between entries.
const ENTRY_GAP: f64 = 20.0;
/// Height of one row.
const ROW: f64 = 19.0;

/// The entries of a figure and where they go.
pub(super) struct Legend {
    entries: Vec<(String, Vec<Style>)>,
    places: Vec<Point>,
    rows: usize,
}

impl Legend {
    /// Collects the labels in order of appearance and fits them into a width.
    pub(super) fn of(figure: &Figure, width: f64) -> Self {
        let mut entries: Vec<(String, Vec<Style>)> = Vec::new();
        for series in figure.panels.iter().flat_map(|p| &p.series) {
            if series.label.is_empty() {
                continue;
            }
            match entries.iter_mut().find(|(l, _)| *l == series.label) {
                None => entries.push((series.label.clone(), vec![series.style])),
                Some((_, styles)) if !styles.contains(&series.style) => styles.push(series.style),
                Some(_) => {}
            }
        }
        for (_, styles) in &mut entries {
            // Drawn on top of each other in one sample: a hollow marker would
            // hide the filled one, and areas lie below lines.
            if styles.len() > 1 {
                styles.retain(|s| *s != Style::Hollow);
            }
            let area = |s: &Style| matches!(s, Style::Bars | Style::Box | Style::Map | Style::Band);
            styles.sort_by_key(|s| !area(s));
        }
        let (places, rows) = arrange(&entries, width);
        Self {
            entries,
            places,
            rows,
        }
    }

    pub(super) fn height(&self) -> f64 {
        self.rows as f64 * ROW
    }

    /// Draws the legend with its upper edge at `top`.
    pub(super) fn draw(&self, canvas: &mut Canvas, looks: &Looks, width: f64, top: f64) {
        for ((label, styles), (x, y)) in self.entries.iter().zip(&self.places) {
            let middle = top + y + 0.5 * ROW;
            for style in styles {
                sample(canvas, looks, label, *style, (*x, middle));
            }
            let at = (x + KEY + KEY_GAP, middle + 0.36 * SMALL);
            let limit = width - KEY - KEY_GAP - 2.0 * ENTRY_GAP;
            let shown = text::shorten(label, SMALL, limit);
            canvas.text(at, &shown, None, Font::new(SMALL, Anchor::Start));
        }
    }
}

/// Fewest rows whose columns fit, read column by column, so that a series and
/// its variant listed after it stay together. Returns the upper left corner
/// of every entry relative to the legend, and the number of rows.
fn arrange(entries: &[(String, Vec<Style>)], width: f64) -> (Vec<Point>, usize) {
    let room = width - 2.0 * ENTRY_GAP;
    let widths: Vec<f64> = entries
        .iter()
        .map(|(l, _)| (KEY + KEY_GAP + text::width(l, SMALL)).min(room))
        .collect();
    for rows in 1..=entries.len() {
        let columns: Vec<f64> = widths
            .chunks(rows)
            .map(|column| column.iter().copied().fold(0.0, f64::max))
            .collect();
        let total = columns.iter().sum::<f64>() + ENTRY_GAP * (columns.len() - 1) as f64;
        if total > room && columns.len() > 1 {
            continue;
        }
        let mut left = 0.5 * (width - total);
        let mut places = Vec::new();
        for (c, column) in columns.iter().enumerate() {
            for r in 0..rows.min(entries.len() - c * rows) {
                places.push((left, r as f64 * ROW));
            }
            left += column + ENTRY_GAP;
        }
        return (places, rows);
    }
    (Vec::new(), 0)
}

/// A short piece of the mark of a series, centred on its left edge's height.
fn sample(canvas: &mut Canvas, looks: &Looks, label: &str, style: Style, left: Point) {
    let look = looks.look(label, style);
    let ends = [left, (left.0 + KEY, left.1)];
    let centre = (left.0 + 0.5 * KEY, left.1);
    let line = |width| Stroke {
        colour: look.colour,
        width,
        dash: look.dash,
    };
    match style {
        Style::Line => {
            canvas.path(&[ends.to_vec()], line(1.5));
            look.marker(canvas, centre, MARKER, false);
        }
        Style::Dashed | Style::Curve => canvas.path(&[ends.to_vec()], line(1.5)),
        Style::Outline => canvas.path(&[ends.to_vec()], line(1.1)),
        Style::Points => look.marker(canvas, centre, MARKER, false),
        Style::Hollow => look.marker(canvas, centre, MARKER, true),
        Style::Landmark => look.landmark(canvas, centre, LANDMARK),
        Style::Path => {
            let ends = [(left.0 + 4.0, left.1), (left.0 + KEY - 4.0, left.1)];
            canvas.path(&[ends.to_vec()], line(3.0));
            for end in ends {
                look.marker(canvas, end, 1.15 * MARKER, false);
            }
        }
        Style::Bars | Style::Box => {
            let swatch = Rect {
                x: left.0 + 4.0,
                y: left.1 - 6.5,
                w: KEY - 8.0,
                h: 13.0,
            };
            look.area(canvas, swatch, style == Style::Box);
        }
        Style::Map => {
            let swatch = Rect {
                x: left.0 + 4.0,
                y: left.1 - 6.5,
                w: KEY - 8.0,
                h: 13.0,
            };
            map::missing(canvas, swatch, look);
        }
        Style::Band => {
            let swatch = Rect {
                x: left.0,
                y: left.1 - 6.5,
                w: KEY,
                h: 13.0,
            };
            canvas.rect(swatch, look.colour, FAINT, Stroke::solid("none", 0.0));
        }
        Style::Strokes => {
            canvas.path(&[ends.to_vec()], line(STROKE[0]));
        }
    }
}
