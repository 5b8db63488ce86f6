//! Drawing one panel: grid, frame, labels, series and the note.

use super::areas;
use super::canvas::{Anchor, Canvas, Font, Point, Rect, Stroke};
use super::hits;
use super::map;
use super::marks::{self, Frame, Trace};
use super::plan::{LEADING, NORMAL, Plan, SLANT, SMALL, TICK_GAP, TITLE_GAP, has_areas};
use super::scale::Kind;
use super::series_style::SeriesStyles;
use super::text;
use super::ticks;
use crate::figure::{Panel, Style};

const GRID: &str = "#e4e4e4";
const FRAME: &str = "#555555";
/// Length of a tick mark.
const TICK: f64 = 4.0;

/// Draws a panel whose plot area is `area`; `left` is the left edge of the
/// room for its vertical labels.
pub(super) fn draw(canvas: &mut Canvas, panel: &Panel, plan: &Plan, styles: &SeriesStyles, area: Rect, left: f64) {
    let frame = Frame { area, x: plan.x, y: plan.y };
    grid(canvas, &frame, panel, plan);
    let mut trace = Trace::default();
    // From the background to the foreground, whatever the order of the data.
    let layers: [&[Style]; 7] = [
        &[Style::Map, Style::Band],
        &[Style::Strokes],
        &[Style::Outline],
        &[Style::Bars, Style::Box],
        &[Style::Dashed, Style::Curve],
        &[Style::Line, Style::Path, Style::Points, Style::Hollow],
        &[Style::Landmark],
    ];
    let cells = map::Grid::of(&frame, panel);
    for layer in layers {
        if layer.contains(&Style::Bars) {
            areas::draw(canvas, &frame, panel, styles, &mut trace);
            // Markers on the edge lie above the frame, bars stand on it.
            canvas.rect(area, "none", 1.0, Stroke::solid(FRAME, 0.9));
            continue;
        }
        for series in panel.series.iter().filter(|s| layer.contains(&s.style)) {
            let look = styles.look(&series.label, series.style);
            canvas.begin(&series.label);
            if series.style == Style::Map {
                let extent = plan.colour.as_ref().map(|colour| &colour.extent);
                map::draw(canvas, &frame, &cells, (series, look), extent, &mut trace);
            } else {
                marks::draw(canvas, &frame, series, look, &mut trace);
            }
            canvas.end();
        }
    }
    x_axis(canvas, &frame, panel, plan);
    y_axis(canvas, &frame, plan, left);
    if let Some(colour) = &plan.colour {
        map::bar(canvas, area, colour, FRAME);
    }
    let font = Font::new(NORMAL, Anchor::Middle).bold();
    let middle = area.x + 0.5 * area.w;
    let first = area.y - TITLE_GAP - (plan.title.len() as f64 - 1.0) * NORMAL * LEADING;
    stack(canvas, (middle, first), &plan.title, font);
    if plan.empty {
        let at = (middle, area.y + 0.5 * area.h + 0.36 * NORMAL);
        canvas.text(at, "no data", None, Font::new(NORMAL, Anchor::Middle));
    }
    note(canvas, &frame, plan.lost, &trace);
    hits::draw(canvas, &frame, panel);
}

/// Lines of text below each other.
fn stack(canvas: &mut Canvas, first: Point, lines: &[String], font: Font) {
    let turn = font.turn.to_radians();
    for (i, line) in lines.iter().enumerate() {
        let down = i as f64 * font.size * LEADING;
        let at = (first.0 - down * turn.sin(), first.1 + down * turn.cos());
        canvas.text(at, line, None, font);
    }
}

fn grid(canvas: &mut Canvas, frame: &Frame, panel: &Panel, plan: &Plan) {
    let area = frame.area;
    let (right, bottom) = (area.x + area.w, area.y + area.h);
    let mut runs = Vec::new();
    let columns: Vec<f64> = match frame.x.kind {
        // Bars and boxes stand between boundaries, points on grid lines.
        Kind::Category(n) if has_areas(panel) => (1..n).map(|i| i as f64 - 0.5).collect(),
        Kind::Category(n) => (0..n).map(|i| i as f64).collect(),
        _ => plan.x_ticks.iter().map(|t| t.value).collect(),
    };
    for x in columns {
        let x = frame.px(x);
        runs.push(vec![(x, area.y), (x, bottom)]);
    }
    let rows: Vec<f64> = match frame.y.kind {
        Kind::Category(n) => (0..n).map(|i| i as f64).collect(),
        _ => plan.y_ticks.iter().map(|t| t.value).collect(),
    };
    for y in rows {
        let y = frame.py(y);
        runs.push(vec![(area.x, y), (right, y)]);
    }
    canvas.path(&runs, Stroke::solid(GRID, 0.8));
}

fn x_axis(canvas: &mut Canvas, frame: &Frame, panel: &Panel, plan: &Plan) {
    let area = frame.area;
    let bottom = area.y + area.h;
    let mut runs = Vec::new();
    let baseline = bottom + TICK_GAP + 0.8 * SMALL;
    for tick in &plan.x_ticks {
        let x = frame.px(tick.value);
        runs.push(vec![(x, bottom), (x, bottom + TICK)]);
        // The exponent hangs to the right of the centre of its base.
        let font = Font::new(SMALL, Anchor::Middle);
        canvas.text((x, baseline), &tick.text, tick.exponent.as_deref(), font);
    }
    for value in ticks::minor(&frame.x) {
        let x = frame.px(value);
        runs.push(vec![(x, bottom), (x, bottom + 0.5 * TICK)]);
    }
    let names = &plan.x_names;
    for (i, lines) in names.lines.iter().enumerate().step_by(names.every) {
        let x = frame.px(i as f64);
        if names.slanted {
            // Lines of one name follow each other across the slant.
            let across = (lines.len() as f64 - 1.0) * 0.5 * SMALL * LEADING;
            let at = (x + 0.3 * SMALL - 0.7 * across, bottom + TICK_GAP + 0.5 * SMALL);
            stack(canvas, at, lines, Font::new(SMALL, Anchor::End).turned(-SLANT));
        } else {
            stack(canvas, (x, baseline), lines, Font::new(SMALL, Anchor::Middle));
        }
        if !has_areas(panel) {
            runs.push(vec![(x, bottom), (x, bottom + TICK)]);
        }
    }
    canvas.path(&runs, Stroke::solid(FRAME, 0.9));
    let first = bottom + plan.bottom - (plan.x_label.len() as f64 - 0.8) * NORMAL * LEADING;
    let middle = area.x + 0.5 * area.w;
    stack(canvas, (middle, first), &plan.x_label, Font::new(NORMAL, Anchor::Middle));
}

fn y_axis(canvas: &mut Canvas, frame: &Frame, plan: &Plan, left: f64) {
    let area = frame.area;
    let mut runs = Vec::new();
    let font = Font::new(SMALL, Anchor::End);
    for tick in &plan.y_ticks {
        let y = frame.py(tick.value);
        runs.push(vec![(area.x - TICK, y), (area.x, y)]);
        let at = (area.x - TICK_GAP, y + 0.36 * SMALL);
        canvas.text(at, &tick.text, tick.exponent.as_deref(), font);
    }
    for value in ticks::minor(&frame.y) {
        let y = frame.py(value);
        runs.push(vec![(area.x - 0.5 * TICK, y), (area.x, y)]);
    }
    for (i, name) in plan.y_names.iter().enumerate() {
        let at = (area.x - TICK_GAP, frame.py(i as f64) + 0.36 * SMALL);
        canvas.text(at, name, None, font);
    }
    canvas.path(&runs, Stroke::solid(FRAME, 0.9));
    let middle = area.y + 0.5 * area.h;
    let first = (left + 0.8 * NORMAL * LEADING, middle);
    let font = Font::new(NORMAL, Anchor::Middle).turned(-90.0);
    stack(canvas, first, &plan.y_label, font);
}

/// States in the emptiest corner what the panel does not show.
fn note(canvas: &mut Canvas, frame: &Frame, lost: usize, trace: &Trace) {
    let values = |n: usize| if n == 1 { "value" } else { "values" };
    let mut lines = Vec::new();
    if lost > 0 {
        lines.push(format!("{lost} {} not drawn", values(lost)));
    }
    if trace.outside > 0 {
        let n = trace.outside;
        lines.push(format!("{n} {} beyond the axes", values(n)));
    }
    if lines.is_empty() {
        return;
    }
    let size = SMALL - 1.0;
    let area = frame.area;
    let w = lines.iter().map(|l| text::width(l, size)).fold(0.0, f64::max) + 8.0;
    let h = lines.len() as f64 * size * LEADING + 5.0;
    let corner = |right: bool, low: bool| Rect {
        x: if right { area.x + area.w - w - 3.0 } else { area.x + 3.0 },
        y: if low { area.y + area.h - h - 3.0 } else { area.y + 3.0 },
        w,
        h,
    };
    let corners = [corner(true, false), corner(false, false), corner(true, true), corner(false, true)];
    let crowd = |r: &Rect| trace.marks.iter().filter(|p| r.contains(**p)).count();
    let Some(best) = corners.into_iter().min_by_key(crowd) else {
        return;
    };
    canvas.rect(best, "#ffffff", 0.85, Stroke::solid("#bbbbbb", 0.6));
    let first = (best.x + 0.5 * w, best.y + 1.5 + size);
    stack(canvas, first, &lines, Font::new(size, Anchor::Middle));
}
