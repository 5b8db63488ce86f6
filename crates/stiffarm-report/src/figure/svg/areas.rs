//! Bars and boxes, side by side where several series share a position.

use super::canvas::{Canvas, INK, Point, Rect, Stroke};
use super::data::{self, Datum};
use super::marks::{Frame, Trace, error_bar};
use super::scale::Kind;
use super::series_style::{SeriesStyle, SeriesStyles};
use crate::figure::{Panel, Series, Style};

/// Share of the distance between positions that bars and boxes take up.
const FILLED: f64 = 0.8;
/// Widest bar or box in pixels.
const WIDEST: f64 = 44.0;
/// Half the side of what stands for a bar on a logarithmic axis, in pixels.
const SQUARE: f64 = 6.0;

/// Horizontal room of one series at every position.
#[derive(Clone, Copy)]
struct Slot {
    offset: f64,
    width: f64,
}

/// Draws all bars and boxes of a panel.
pub(super) fn draw(canvas: &mut Canvas, frame: &Frame, panel: &Panel, styles: &SeriesStyles, trace: &mut Trace) {
    for (series, slot) in slots(frame, panel) {
        let look = styles.look(&series.label, series.style);
        let (points, _) = data::points(series, frame.x.kind, frame.y.kind);
        canvas.begin(&series.label);
        if series.style == Style::Box {
            boxes(canvas, frame, &points, look, slot, trace);
        } else {
            bars(canvas, frame, &points, look, slot, trace);
        }
        canvas.end();
    }
}

/// Series of bars and boxes with their room.
fn slots<'a>(frame: &Frame, panel: &'a Panel) -> Vec<(&'a Series, Slot)> {
    let chosen: Vec<&Series> = panel.series.iter().filter(|s| matches!(s.style, Style::Bars | Style::Box)).collect();
    let step = spacing(frame, &chosen);
    let count = chosen.len().max(1) as f64;
    let pitch = (FILLED * step / count).min(WIDEST);
    let slots = chosen.iter().enumerate().map(|(i, series)| {
        let slot = Slot { offset: (i as f64 - 0.5 * (count - 1.0)) * pitch, width: 0.88 * pitch };
        (*series, slot)
    });
    slots.collect()
}

/// The points of a series of bars with their bars.
pub(super) fn columns(frame: &Frame, panel: &Panel, series: &Series) -> Vec<(Datum, Rect)> {
    let slots = slots(frame, panel);
    let Some((_, slot)) = slots.iter().find(|(with_slot, _)| std::ptr::eq(*with_slot, series)) else {
        return Vec::new();
    };
    let (points, _) = data::points(series, frame.x.kind, frame.y.kind);
    let bars = points.iter().flatten().map(|d| {
        let body = bar(frame, d, *slot);
        (*d, body)
    });
    bars.collect()
}

/// A bar from zero; a logarithmic axis has no zero, and so a square at the value.
fn bar(frame: &Frame, d: &Datum, slot: Slot) -> Rect {
    let centre = frame.px(d.x) + slot.offset;
    let (half, base, top) = match frame.y.kind {
        Kind::Linear => (0.5 * slot.width, frame.py(0.0), frame.py(d.y)),
        _ => {
            let (half, at) = ((0.5 * slot.width).min(SQUARE), frame.py(d.y));
            (half, at + half, at - half)
        }
    };
    Rect::spanning(frame.area.clamp((centre - half, base)), frame.area.clamp((centre + half, top)))
}

/// Smallest distance in pixels between two positions in use.
fn spacing(frame: &Frame, chosen: &[&Series]) -> f64 {
    if let Kind::Category(n) = frame.x.kind {
        return frame.area.w / n.max(1) as f64;
    }
    let mut places: Vec<f64> = chosen
        .iter()
        .flat_map(|s| data::points(s, frame.x.kind, frame.y.kind).0)
        .flatten()
        .map(|d| frame.px(d.x))
        .collect();
    places.sort_by(f64::total_cmp);
    let closest = places.windows(2).map(|p| p[1] - p[0]).filter(|d| *d > 0.5).fold(f64::INFINITY, f64::min);
    closest.min(0.25 * frame.area.w)
}

fn bars(
    canvas: &mut Canvas,
    frame: &Frame,
    points: &[Option<Datum>],
    look: SeriesStyle,
    slot: Slot,
    trace: &mut Trace,
) {
    for d in points.iter().flatten() {
        let centre = frame.px(d.x) + slot.offset;
        let top = frame.py(d.y);
        let body = bar(frame, d, slot);
        if body.w > 0.0 {
            look.area(canvas, body, false);
            error_bar(canvas, frame, d, centre, Stroke::solid(INK, 1.1));
        }
        trace.add(&frame.area, (centre, top));
    }
    if frame.y.kind != Kind::Linear {
        return;
    }
    let base = frame.py(0.0);
    let ends = ((frame.area.x, base), (frame.area.x + frame.area.w, base));
    if let Some((a, b)) = frame.area.clip(ends.0, ends.1) {
        canvas.line(a, b, Stroke::solid(INK, 0.9));
    }
}

fn boxes(
    canvas: &mut Canvas,
    frame: &Frame,
    points: &[Option<Datum>],
    look: SeriesStyle,
    slot: Slot,
    trace: &mut Trace,
) {
    let half = 0.5 * slot.width;
    for (x, values) in data::samples(points) {
        let centre = frame.px(x) + slot.offset;
        let at = |p: f64| frame.py(data::quantile(&values, p));
        let [low, first, median, third, high] = [0.05, 0.25, 0.5, 0.75, 0.95].map(at);
        let body = Rect::spanning(frame.area.clamp((centre - half, first)), frame.area.clamp((centre + half, third)));
        let stem = Stroke::solid(look.colour, 1.2);
        let cap = 0.5 * half;
        let whiskers = [
            ((centre, low), (centre, first)),
            ((centre, third), (centre, high)),
            ((centre - cap, low), (centre + cap, low)),
            ((centre - cap, high), (centre + cap, high)),
        ];
        let seen: Vec<Vec<Point>> =
            whiskers.iter().filter_map(|(a, b)| frame.area.clip(*a, *b)).map(|(a, b)| vec![a, b]).collect();
        look.area(canvas, body, true);
        canvas.path(&seen, stem);

        // A fixed spread by rank separates equal samples without random
        // numbers; steps of the golden ratio keep neighbours apart.
        let mut dots = Vec::new();
        for (i, y) in values.iter().enumerate() {
            let spread = ((i as f64 + 1.0) * 0.618_033_988_749_895).fract() - 0.5;
            let p = (centre + 0.8 * spread * slot.width, frame.py(*y));
            if trace.add(&frame.area, p) {
                dots.push(p);
            }
        }
        canvas.dots(&dots, 2.6, look.colour, 0.45);
        if let Some((a, b)) = frame.area.clip((centre - half, median), (centre + half, median)) {
            canvas.line(a, b, Stroke::solid(INK, 2.0));
        }
    }
}
