//! Heat maps: cells of a grid coloured by a value, and their colour bar.
//!
//! Each point of a series is the centre of a cell that reaches half-way to its
//! neighbours. Colours are those of viridis, whose lightness grows evenly with
//! the value, so that the map reads in grey and with any colour vision.

use super::canvas::{Anchor, Canvas, Font, Point, Rect, Stroke};
use super::data;
use super::marks::{Frame, Trace};
use super::plan::{BAR, BAR_GAP, ColourPlan, NORMAL, SMALL, TICK_GAP};
use super::scale::{Extent, Kind};
use super::series_style::{SeriesStyle, hatch};
use crate::figure::{Panel, Series, Style};
use std::collections::BTreeMap;

/// Viridis at nine equal steps (S. van der Walt, N. Smith; CC0).
const VIRIDIS: [[u8; 3]; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2d, 0x7b],
    [0x3b, 0x52, 0x8b],
    [0x2c, 0x72, 0x8e],
    [0x21, 0x90, 0x8c],
    [0x27, 0xad, 0x81],
    [0x5d, 0xc8, 0x63],
    [0xaa, 0xdc, 0x32],
    [0xfd, 0xe7, 0x25],
];
/// Colours that are told apart; more would only make the file larger.
const LEVELS: usize = 64;
/// The look of cells without a value.
struct Missing {
    fill: &'static str,
    /// Colour of the hatch.
    ink: &'static str,
    /// Its directions.
    hatch: &'static [(f64, f64)],
}

/// Those of the maps of a panel, one after the other.
const MISSING: [Missing; 4] = [
    Missing { fill: "#e2e2e2", ink: "#a0a0a0", hatch: &[(1.0, -1.0)] },
    Missing { fill: "#f1f1f1", ink: "#f1f1f1", hatch: &[] },
    Missing { fill: "#cdcdcd", ink: "#8c8c8c", hatch: &[(1.0, -1.0), (1.0, 1.0)] },
    Missing { fill: "#f6f6f6", ink: "#b4b4b4", hatch: &[(1.0, 1.0)] },
];
/// Length of a tick mark.
const TICK: f64 = 4.0;

/// The grid that the maps of a panel share.
pub(super) struct Grid {
    columns: Steps,
    rows: Steps,
}

impl Grid {
    pub(super) fn of(frame: &Frame, panel: &Panel) -> Self {
        let maps = panel.series.iter().filter(|s| s.style == Style::Map);
        let all: Vec<Point> = maps.flat_map(|s| places(frame, s)).flatten().collect();
        Self {
            columns: Steps::of(all.iter().map(|p| p.0), frame.area.w),
            rows: Steps::of(all.iter().map(|p| p.1), frame.area.h),
        }
    }
}

/// Where the points of a series are, `None` where one cannot be drawn.
fn places(frame: &Frame, series: &Series) -> Vec<Option<Point>> {
    let (points, _) = data::points(series, frame.x.kind, frame.y.kind);
    let place = |d: &Option<data::Datum>| d.as_ref().map(|d| frame.place(d));
    points.iter().map(place).collect()
}

/// Whether every point of a map has a value. The key of a map is its cells without one.
pub(super) fn is_full(series: &Series) -> bool {
    let Some(colour) = &series.colour else {
        return false;
    };
    let kind = Kind::of(&colour.axis);
    let count = series.x.len().min(series.y.len());
    let accepted = |value: &f64| kind.accepts(*value);
    series.style == Style::Map && count <= colour.values.len() && colour.values[..count].iter().all(accepted)
}

/// Draws the cells of a map. `extent` is that of the colour bar.
pub(super) fn draw(
    canvas: &mut Canvas,
    frame: &Frame,
    Grid { columns, rows }: &Grid,
    (series, look): (&Series, SeriesStyle),
    extent: Option<&Extent>,
    trace: &mut Trace,
) {
    let places = places(frame, series);
    // Level of each cell, `None` without a value; the last of equal places counts.
    let mut cells: BTreeMap<(usize, usize), Option<usize>> = BTreeMap::new();
    for (i, place) in places.iter().enumerate() {
        let Some(p) = place else { continue };
        if trace.add(&frame.area, *p) {
            cells.insert((rows.index(p.1), columns.index(p.0)), level(series, i, extent));
        }
    }
    // Neighbours of one colour in a row are one rectangle.
    let mut runs: Vec<(usize, usize, usize, Option<usize>)> = Vec::new();
    for ((row, column), level) in cells {
        match runs.last_mut() {
            Some((r, _, last, l)) if *r == row && *last + 1 == column && *l == level => {
                *last = column;
            }
            _ => runs.push((row, column, column, level)),
        }
    }
    let mut shapes: BTreeMap<Option<usize>, Vec<Rect>> = BTreeMap::new();
    for (row, first, last, level) in runs {
        let (left, right) = (columns.edges(first).0, columns.edges(last).1);
        let (top, bottom) = rows.edges(row);
        let a = frame.area.clamp((left, top));
        let b = frame.area.clamp((right, bottom));
        shapes.entry(level).or_default().push(Rect::spanning(a, b));
    }
    for (level, rects) in shapes {
        match level {
            Some(level) => canvas.cells(&rects, &colour(level)),
            None => rects.iter().for_each(|rect| missing(canvas, *rect, look)),
        }
    }
}

/// The look of a cell without a value.
pub(super) fn missing(canvas: &mut Canvas, rect: Rect, look: SeriesStyle) {
    let kind = &MISSING[look.variant % MISSING.len()];
    canvas.cells(&[rect], kind.fill);
    let mut lines = Vec::new();
    for direction in kind.hatch {
        hatch(rect, *direction, &mut lines);
    }
    canvas.path(&lines, Stroke::solid(kind.ink, 0.7));
}

/// Draws the colour bar to the right of the plot area.
pub(super) fn bar(canvas: &mut Canvas, area: Rect, plan: &ColourPlan, frame_colour: &str) {
    let left = area.x + area.w + BAR_GAP;
    let step = area.h / LEVELS as f64;
    for level in 0..LEVELS {
        let rect = Rect { x: left, y: area.y + area.h - (level + 1) as f64 * step, w: BAR, h: step };
        canvas.cells(&[rect], &colour(turned(level, plan.small_is_bright)));
    }
    let frame = Rect { x: left, w: BAR, ..area };
    canvas.rect(frame, "none", 1.0, Stroke::solid(frame_colour, 0.9));
    let right = left + BAR;
    let mut marks = Vec::new();
    for tick in &plan.ticks {
        let y = area.y + (1.0 - plan.extent.fraction(tick.value)) * area.h;
        marks.push(vec![(right, y), (right + TICK, y)]);
        let at = (right + TICK_GAP, y + 0.36 * SMALL);
        let font = Font::new(SMALL, Anchor::Start);
        canvas.text(at, &tick.text, tick.exponent.as_deref(), font);
    }
    canvas.path(&marks, Stroke::solid(frame_colour, 0.9));
    let middle = area.y + 0.5 * area.h;
    let font = Font::new(NORMAL, Anchor::Middle).turned(-90.0);
    for (i, line) in plan.label.iter().enumerate() {
        canvas.text((area.x + area.w + plan.baseline(i), middle), line, None, font);
    }
}

/// Level of the colour of point `i`, `None` where it has no value.
fn level(series: &Series, i: usize, extent: Option<&Extent>) -> Option<usize> {
    let (colour, extent) = (series.colour.as_ref()?, extent?);
    let value = *colour.values.get(i)?;
    extent.kind.accepts(value).then(|| {
        let fraction = extent.fraction(value).clamp(0.0, 1.0);
        let level = ((fraction * LEVELS as f64) as usize).min(LEVELS - 1);
        turned(level, colour.small_is_bright)
    })
}

/// A level, or where small values are bright the one as far from the other end.
fn turned(level: usize, small_is_bright: bool) -> usize {
    if small_is_bright { LEVELS - 1 - level } else { level }
}

/// Colour of a level as `#rrggbb`.
fn colour(level: usize) -> String {
    let at = (level as f64 + 0.5) / LEVELS as f64 * (VIRIDIS.len() - 1) as f64;
    let below = (at as usize).min(VIRIDIS.len() - 2);
    let part = at - below as f64;
    let mix = |c: usize| {
        let (a, b) = (f64::from(VIRIDIS[below][c]), f64::from(VIRIDIS[below + 1][c]));
        (a + part * (b - a)).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// The columns or rows of a grid in pixels, ascending.
struct Steps {
    centres: Vec<f64>,
    /// Half the width of a single column.
    half: f64,
}

impl Steps {
    fn of(values: impl Iterator<Item = f64>, room: f64) -> Self {
        let mut centres: Vec<f64> = values.collect();
        centres.sort_by(f64::total_cmp);
        centres.dedup();
        Self { centres, half: 0.125 * room }
    }

    fn index(&self, value: f64) -> usize {
        self.centres.partition_point(|c| *c < value)
    }

    /// Half-way to the neighbours; the outermost are as wide outside as inside.
    fn edges(&self, i: usize) -> (f64, f64) {
        let c = &self.centres;
        let below = (i > 0).then(|| 0.5 * (c[i] - c[i - 1]));
        let above = (i + 1 < c.len()).then(|| 0.5 * (c[i + 1] - c[i]));
        (c[i] - below.or(above).unwrap_or(self.half), c[i] + above.or(below).unwrap_or(self.half))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE lightness of a colour.
    fn lightness(colour: &str) -> f64 {
        let part = |at: usize| {
            let c = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap()) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        let luminance = 0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5);
        if luminance > 0.008856 { 116.0 * luminance.cbrt() - 16.0 } else { 903.3 * luminance }
    }

    #[test]
    fn lightness_grows_evenly_with_the_value() {
        let values: Vec<f64> = (0..LEVELS).map(|l| lightness(&colour(l))).collect();
        let mean = (values[LEVELS - 1] - values[0]) / (LEVELS - 1) as f64;
        assert!(mean > 1.0, "{mean}");
        for pair in values.windows(2) {
            let step = pair[1] - pair[0];
            assert!((0.5 * mean..1.6 * mean).contains(&step), "{step} of {mean}");
        }
    }

    #[test]
    fn cells_meet_half_way() {
        let steps = Steps::of([10.0, 30.0, 20.0, 10.0, 50.0].into_iter(), 80.0);
        assert_eq!(steps.edges(0), (5.0, 15.0));
        assert_eq!(steps.edges(2), (25.0, 40.0));
        assert_eq!(steps.edges(3), (40.0, 60.0));
        assert_eq!(steps.index(20.0), 1);
        assert_eq!(Steps::of([7.0].into_iter(), 80.0).edges(0), (-3.0, 17.0));
    }
}
