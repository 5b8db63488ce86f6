//! The one legend of a figure.

use super::canvas::{Anchor, Canvas, Font, Point, Rect, Stroke};
use super::map;
use super::marks::{FAINT, LANDMARK, MARKER, STROKE};
use super::plan::{LEADING, SMALL};
use super::series_style::SeriesStyles;
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
    /// The lines of every entry's label.
    lines: Vec<Vec<String>>,
    places: Vec<Point>,
    height: f64,
}

impl Legend {
    /// Collects the labels in order of appearance and fits them into a width;
    /// one that is wider takes up to `most` lines.
    pub(super) fn of(figure: &Figure, width: f64, most: usize) -> Self {
        let mut entries: Vec<(String, Vec<Style>)> = Vec::new();
        for series in figure.panels.iter().flat_map(|p| &p.series) {
            if series.label.is_empty() || map::is_full(series) {
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
        let limit = width - KEY - KEY_GAP - 2.0 * ENTRY_GAP;
        let lines: Vec<Vec<String>> = entries
            .iter()
            .map(|(label, _)| match most {
                1 => vec![text::shorten(label, SMALL, limit)],
                _ => text::wrap(label, SMALL, limit, most),
            })
            .collect();
        let (places, height) = arrange(&lines, width);
        Self { entries, lines, places, height }
    }

    pub(super) fn height(&self) -> f64 {
        self.height
    }

    /// Draws the legend with its upper edge at `top`.
    pub(super) fn draw(&self, canvas: &mut Canvas, series_styles: &SeriesStyles, top: f64) {
        let all = self.entries.iter().zip(&self.lines).zip(&self.places);
        for (((label, styles), lines), (x, y)) in all {
            let middle = top + y + 0.5 * ROW;
            canvas.begin_switch(label);
            for style in styles {
                sample(canvas, series_styles, label, *style, (*x, middle));
            }
            for (i, line) in lines.iter().enumerate() {
                let down = i as f64 * SMALL * LEADING;
                let at = (x + KEY + KEY_GAP, middle + 0.36 * SMALL + down);
                canvas.text(at, line, None, Font::new(SMALL, Anchor::Start));
            }
            // What is clicked: the entry as a whole, the gap between its sample and its text too.
            let long = lines.iter().map(|line| text::width(line, SMALL));
            canvas.target(Rect {
                x: x - 3.0,
                y: top + y,
                w: KEY + KEY_GAP + long.fold(0.0, f64::max) + 6.0,
                h: ROW + lines.len().saturating_sub(1) as f64 * SMALL * LEADING,
            });
            canvas.end();
        }
    }
}

/// Fewest rows whose columns fit, read column by column, so that a series and
/// its variant listed after it stay together. Returns the upper left corner
/// of every entry relative to the legend, and its height.
fn arrange(entries: &[Vec<String>], width: f64) -> (Vec<Point>, f64) {
    let room = width - 2.0 * ENTRY_GAP;
    let long = |lines: &Vec<String>| {
        let widths = lines.iter().map(|l| text::width(l, SMALL));
        widths.fold(0.0, f64::max)
    };
    let widths: Vec<f64> = entries.iter().map(|lines| (KEY + KEY_GAP + long(lines)).min(room)).collect();
    for rows in 1..=entries.len() {
        let columns: Vec<f64> = widths.chunks(rows).map(|column| column.iter().copied().fold(0.0, f64::max)).collect();
        let total = columns.iter().sum::<f64>() + ENTRY_GAP * (columns.len() - 1) as f64;
        if total > room && columns.len() > 1 {
            continue;
        }
        // Where each row begins, and the last one ends.
        let mut tops = vec![0.0];
        for row in 0..rows {
            let most = entries.iter().skip(row).step_by(rows).map(Vec::len).max();
            let further = most.unwrap_or(1).saturating_sub(1) as f64 * SMALL * LEADING;
            tops.push(tops[row] + ROW + further);
        }
        let mut left = 0.5 * (width - total);
        let mut places = Vec::new();
        for (c, column) in columns.iter().enumerate() {
            for top in &tops[..rows.min(entries.len() - c * rows)] {
                places.push((left, *top));
            }
            left += column + ENTRY_GAP;
        }
        return (places, tops[rows]);
    }
    (Vec::new(), 0.0)
}

/// A short piece of the mark of a series, centred on its left edge's height.
fn sample(canvas: &mut Canvas, series_styles: &SeriesStyles, label: &str, style: Style, left: Point) {
    let look = series_styles.look(label, style);
    let ends = [left, (left.0 + KEY, left.1)];
    let centre = (left.0 + 0.5 * KEY, left.1);
    let line = |width| Stroke { colour: look.colour, width, dash: look.dash };
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
            let swatch = Rect { x: left.0 + 4.0, y: left.1 - 6.5, w: KEY - 8.0, h: 13.0 };
            look.area(canvas, swatch, style == Style::Box);
        }
        Style::Map => {
            let swatch = Rect { x: left.0 + 4.0, y: left.1 - 6.5, w: KEY - 8.0, h: 13.0 };
            map::missing(canvas, swatch, look);
        }
        Style::Band => {
            let swatch = Rect { x: left.0, y: left.1 - 6.5, w: KEY, h: 13.0 };
            canvas.rect(swatch, look.colour, FAINT, Stroke::solid("none", 0.0));
        }
        Style::Strokes => {
            canvas.path(&[ends.to_vec()], line(STROKE[0]));
        }
    }
}
