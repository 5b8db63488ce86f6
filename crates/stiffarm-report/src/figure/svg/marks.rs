//! Lines, markers and error bars of one series.

use super::canvas::{Canvas, Point, Rect, Stroke};
use super::data::{self, Datum};
use super::scale::Extent;
use super::series_style::SeriesStyle;
use crate::figure::{Series, Style};

/// Radius of a marker.
pub(super) const MARKER: f64 = 3.6;
/// Half the side of a landmark.
pub(super) const LANDMARK: f64 = 5.0;
/// Half width of the cap of an error bar.
const CAP: f64 = 3.0;

/// The plot area and its axes.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub area: Rect,
    pub x: Extent,
    pub y: Extent,
}

impl Frame {
    pub(super) fn px(&self, x: f64) -> f64 {
        self.area.x + self.x.fraction(x) * self.area.w
    }

    pub(super) fn py(&self, y: f64) -> f64 {
        self.area.y + (1.0 - self.y.fraction(y)) * self.area.h
    }

    pub(super) fn place(&self, d: &Datum) -> Point {
        (self.px(d.x), self.py(d.y))
    }

    /// The visible parts of a polyline with gaps.
    pub(super) fn runs(&self, points: &[Option<Point>]) -> Vec<Vec<Point>> {
        let mut runs: Vec<Vec<Point>> = Vec::new();
        for pair in points.windows(2) {
            let [Some(a), Some(b)] = pair else { continue };
            let Some((from, to)) = self.area.clip(*a, *b) else {
                continue;
            };
            match runs.last_mut() {
                Some(run) if run.last() == Some(&from) => run.push(to),
                _ => runs.push(vec![from, to]),
            }
        }
        runs
    }
}

/// What drawing left behind for the rest of the panel.
#[derive(Default)]
pub(super) struct Trace {
    /// Where marks are, to find a free corner for the note.
    pub marks: Vec<Point>,
    /// Accepted values beyond a fixed extent.
    pub outside: usize,
}

impl Trace {
    /// Records a mark; true if it is inside the plot area.
    pub(super) fn add(&mut self, area: &Rect, at: Point) -> bool {
        let inside = area.contains(at);
        if inside {
            self.marks.push(at);
        } else {
            self.outside += 1;
        }
        inside
    }
}

/// Draws a series of any style but bars, boxes and maps.
pub(super) fn draw(canvas: &mut Canvas, frame: &Frame, series: &Series, look: SeriesStyle, trace: &mut Trace) {
    let (points, _) = data::points(series, frame.x.kind, frame.y.kind);
    let places: Vec<Option<Point>> = points.iter().map(|d| d.as_ref().map(|d| frame.place(d))).collect();
    let stroke = |width| Stroke { colour: look.colour, width, dash: look.dash };
    let line = |canvas: &mut Canvas, width| canvas.path(&frame.runs(&places), stroke(width));
    let visible = |p: &&Point| frame.area.contains(**p);
    match series.style {
        Style::Band => return band(canvas, frame, &points, look, trace),
        Style::Strokes => return strokes(canvas, frame, &places, look, trace),
        Style::Outline => return line(canvas, 1.1),
        Style::Dashed | Style::Curve => {
            line(canvas, 1.5);
            trace.marks.extend(places.iter().flatten().filter(visible));
            return;
        }
        Style::Path => {
            line(canvas, 3.0);
            for p in places.iter().flatten().filter(visible) {
                look.marker(canvas, *p, 1.15 * MARKER, false);
                trace.marks.push(*p);
            }
            return;
        }
        Style::Line => line(canvas, 1.5),
        Style::Landmark => {
            for p in places.iter().flatten() {
                if trace.add(&frame.area, *p) {
                    look.landmark(canvas, *p, LANDMARK);
                }
            }
            return;
        }
        Style::Points | Style::Hollow | Style::Bars | Style::Box | Style::Map => {}
    }
    for d in points.iter().flatten() {
        error_bar(canvas, frame, d, frame.px(d.x), stroke(1.1));
    }
    // Markers on a dense line would merge into a band.
    let stride = match series.style {
        Style::Line => (places.len() as f64 * 8.0 / frame.area.w).ceil().max(1.0) as usize,
        _ => 1,
    };
    for (i, p) in places.iter().enumerate() {
        let Some(p) = p else { continue };
        if trace.add(&frame.area, *p) && i % stride == 0 {
            look.marker(canvas, *p, MARKER, series.style == Style::Hollow);
        }
    }
}

/// Opacity of a band, and of its sample in the legend.
pub(super) const FAINT: f64 = 0.22;
/// Widths of a stroke and of the white rim that sets it off.
pub(super) const STROKE: [f64; 2] = [1.2, 2.6];

/// The area between the ends of the error bars, cut at the frame; a gap in the
/// points is one in the band.
fn band(canvas: &mut Canvas, frame: &Frame, points: &[Option<Datum>], look: SeriesStyle, trace: &mut Trace) {
    for run in points.split(Option::is_none) {
        let end = |d: &Datum, y: f64| {
            let place = (frame.px(d.x), frame.py(y));
            frame.area.clamp(place)
        };
        let run = || run.iter().flatten();
        let upper = run().map(|d| end(d, d.ends[1]));
        let lower = run().rev().map(|d| end(d, d.ends[0]));
        let corners: Vec<Point> = upper.chain(lower).collect();
        if corners.len() > 2 {
            canvas.area(&corners, look.colour, FAINT);
        }
    }
    for d in points.iter().flatten() {
        trace.add(&frame.area, frame.place(d));
    }
}

/// Pieces from each even point to the one after it.
fn strokes(canvas: &mut Canvas, frame: &Frame, places: &[Option<Point>], look: SeriesStyle, trace: &mut Trace) {
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    for pair in places.chunks_exact(2) {
        if let [Some(a), Some(b)] = pair
            && let Some((a, b)) = frame.area.clip(*a, *b)
        {
            pieces.push(vec![a, b]);
            trace.marks.push(a);
        }
    }
    canvas.path(&pieces, Stroke::solid("#ffffff", STROKE[1]));
    canvas.path(&pieces, Stroke::solid(look.colour, STROKE[0]));
}

/// An error bar at a horizontal place. An end beyond the frame has no cap, so
/// that a cut bar does not look like a shorter one; an open one has an arrow.
pub(super) fn error_bar(canvas: &mut Canvas, frame: &Frame, d: &Datum, at: f64, stroke: Stroke) {
    let [low, high] = d.ends;
    if low >= high {
        return;
    }
    let is_open = high.is_infinite();
    let top = frame.area.y;
    let (low, high) = (frame.py(low), if is_open { top } else { frame.py(high) });
    let Some((a, b)) = frame.area.clip((at, low), (at, high)) else {
        return;
    };
    let mut runs = vec![vec![a, b]];
    if is_open {
        runs.push(vec![(at - CAP, top + 2.0 * CAP), (at, top), (at + CAP, top + 2.0 * CAP)]);
    }
    for end in [Some(low), (!is_open).then_some(high)].into_iter().flatten() {
        if frame.area.contains((at, end)) {
            runs.push(vec![(at - CAP, end), (at + CAP, end)]);
        }
    }
    canvas.path(&runs, stroke);
}
