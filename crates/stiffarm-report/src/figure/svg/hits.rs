//! Places that answer the pointer in a picture on a screen: invisible marks with what is drawn there in words.

use super::areas::columns;
use super::canvas::{Canvas, Rect};
use super::data;
use super::marks::Frame;
use crate::figure::{Axis, Panel, Series, Style};

/// Radius of a place in pixels.
const REACH: f64 = 9.0;
/// Most places of a series; of more points every so many has one.
const MOST: usize = 120;

/// Adds the places of a panel, on top of everything else.
pub(super) fn draw(canvas: &mut Canvas, frame: &Frame, panel: &Panel) {
    if !canvas.answers() {
        return;
    }
    for series in &panel.series {
        let is_quiet = matches!(series.style, Style::Map | Style::Band | Style::Strokes | Style::Outline | Style::Box);
        if is_quiet || series.label.is_empty() {
            continue;
        }
        canvas.begin(&series.label);
        match series.style {
            Style::Bars => bars(canvas, frame, panel, series),
            _ => points(canvas, frame, panel, series),
        }
        canvas.end();
    }
}

fn points(canvas: &mut Canvas, frame: &Frame, panel: &Panel, series: &Series) {
    let (points, _) = data::points(series, frame.x.kind, frame.y.kind);
    let every = points.len().div_ceil(MOST).max(1);
    for d in points.iter().step_by(every).flatten() {
        let at = frame.place(d);
        if frame.area.contains(at) {
            let around = Rect { x: at.0 - REACH, y: at.1 - REACH, w: 2.0 * REACH, h: 2.0 * REACH };
            canvas.hit(around, &words(panel, series, d));
        }
    }
}

fn bars(canvas: &mut Canvas, frame: &Frame, panel: &Panel, series: &Series) {
    for (d, body) in columns(frame, panel, series) {
        // A low bar is as easy to meet as a high one.
        let body = Rect { y: frame.area.y, h: frame.area.h, ..body };
        canvas.hit(body, &words(panel, series, &d));
    }
}

/// `Group 1 · joint 2: 22.1 % ± 0.3`
fn words(panel: &Panel, series: &Series, d: &data::Datum) -> String {
    let error = match d.ends {
        [low, high] if low >= high => String::new(),
        [low, high] if high.is_infinite() => format!(" (above {})", short(low)),
        [low, high] if !series.interval.is_empty() => {
            format!(" ({} to {})", short(low), short(high))
        }
        [_, high] => format!(" ± {}", short(high - d.y)),
    };
    let unit = if panel.y.unit.is_empty() { String::new() } else { format!(" {}", panel.y.unit) };
    format!("{} · {}: {}{error}{unit}", series.label, place(&panel.x, d.x), place(&panel.y, d.y))
}

/// A coordinate: the name of its category, or a number, on the horizontal axis with its unit.
fn place(axis: &Axis, value: f64) -> String {
    match axis.categories.get(value.round().max(0.0) as usize) {
        Some(name) => name.clone(),
        None => short(value),
    }
}

/// Four significant digits.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    rounded.to_string().replace('-', "−")
}
