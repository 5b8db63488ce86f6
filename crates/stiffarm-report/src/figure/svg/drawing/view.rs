//! One view: its axes, its marks cut off at the frame, its labels.

use super::ink;
use super::labels;
use crate::figure::Axis;
use crate::figure::drawing::{Mark, Shape, Tone, View};
use crate::figure::svg::canvas::{Anchor, Canvas, Font, Point, Rect, Stroke};
use crate::figure::svg::plan::{NORMAL, SMALL, TICK_GAP};
use crate::figure::svg::scale::{Extent, Kind};
use crate::figure::svg::text;
use crate::figure::svg::ticks;

const GRID: &str = "#ececec";
const FRAME: &str = "#555555";
/// Length of a tick mark.
const TICK: f64 = 4.0;
/// Extents beyond this are none, nor are those shorter than its inverse.
const LARGEST: f64 = 1e9;
/// Nor are those narrower than this part of their distance from zero: their tick labels have more digits than room.
const NARROWEST: f64 = 1e-6;
/// Pixels between ticks to the right and up.
const TICK_STEP: [f64; 2] = [50.0, 40.0];

/// A view and where it goes.
pub(super) struct Placed<'a> {
    view: &'a View,
    area: Rect,
    x: Extent,
    y: Extent,
}

impl<'a> Placed<'a> {
    /// The view on `area`: its extent widened on one side, so that a unit is equally long in both directions.
    pub(super) fn new(view: &'a View, area: Rect) -> Self {
        let extent = |[from, to]: [f64; 2]| {
            let size = from.abs().max(to.abs());
            let sound = size < LARGEST && to - from > (NARROWEST * size).max(LARGEST.recip());
            let (lo, hi) = if sound { (from, to) } else { (0.0, 1.0) };
            Extent { kind: Kind::Linear, lo, hi }
        };
        let (x, y) = (extent(view.extent[0]), extent(view.extent[1]));
        let wide = (x.hi - x.lo) / area.w;
        let high = (y.hi - y.lo) / area.h;
        let unit = wide.max(high);
        Placed { view, area, x: x.widened(unit / wide), y: y.widened(unit / high) }
    }

    pub(super) fn draw(&self, canvas: &mut Canvas) {
        let area = self.area;
        canvas.rect(area, "#ffffff", 1.0, Stroke::solid("none", 0.0));
        if let Some(axes) = &self.view.axes {
            self.axes(canvas, axes);
        }
        let mut places = Vec::new();
        for mark in &self.view.marks {
            self.mark(canvas, mark, &mut places);
        }
        labels::draw(canvas, area, &self.view.labels, |at| self.place(at), &places);
        canvas.rect(area, "none", 1.0, Stroke::solid(FRAME, 0.9));
        let font = Font::new(NORMAL, Anchor::Middle).bold();
        let at = (area.x + 0.5 * area.w, area.y - 7.0);
        let title = text::shorten(&self.view.title, text::BOLD * NORMAL, area.w);
        canvas.text(at, &title, None, font);
    }

    /// Where a place of the view is on the picture.
    fn place(&self, [x, y]: [f64; 2]) -> Option<Point> {
        (x.is_finite() && y.is_finite()).then(|| {
            (self.area.x + self.x.fraction(x) * self.area.w, self.area.y + (1.0 - self.y.fraction(y)) * self.area.h)
        })
    }

    fn mark(&self, canvas: &mut Canvas, mark: &Mark, places: &mut Vec<Point>) {
        match &mark.shape {
            Shape::Area(corners) => {
                let corners: Vec<Point> = corners.iter().filter_map(|c| self.place(*c)).collect();
                let seen = cut(&corners, &self.area);
                if seen.len() > 2 {
                    let fill = ink::fill(mark.tone, mark.caution);
                    canvas.glass(&seen, fill.colour, fill.opacity, fill.edge);
                }
            }
            Shape::Line(points) => self.line(canvas, points, mark),
            Shape::Arrow([from, to]) => {
                self.line(canvas, &[*from, *to], mark);
                let ends = self.place(*from).zip(self.place(*to));
                if let Some((from, to)) = ends.filter(|(_, to)| self.area.contains(*to)) {
                    head(canvas, from, to, ink::stroke(mark.tone, mark.caution));
                }
            }
            Shape::Point(at) => {
                let Some(at) = self.place(*at).filter(|p| self.area.contains(*p)) else {
                    return;
                };
                ink::marker(canvas, at, mark.tone, mark.caution);
                places.push(at);
            }
        }
    }

    fn line(&self, canvas: &mut Canvas, points: &[[f64; 2]], mark: &Mark) {
        let points: Vec<Point> = points.iter().filter_map(|p| self.place(*p)).collect();
        let mut runs: Vec<Vec<Point>> = Vec::new();
        for pair in points.windows(2) {
            let Some((from, to)) = self.area.clip(pair[0], pair[1]) else {
                continue;
            };
            match runs.last_mut() {
                Some(run) if run.last() == Some(&from) => run.push(to),
                _ => runs.push(vec![from, to]),
            }
        }
        let stroke = ink::stroke(mark.tone, mark.caution);
        if mark.tone == Tone::Skeleton {
            // A white rim tells it from the lines below it.
            canvas.path(&runs, Stroke::solid("#ffffff", stroke.width + 2.0));
        }
        canvas.path(&runs, stroke);
    }

    fn axes(&self, canvas: &mut Canvas, [x_axis, y_axis]: &[Axis; 2]) {
        let area = self.area;
        let (right, bottom) = (area.x + area.w, area.y + area.h);
        let most = |length: f64, step: f64| (length / step).max(2.0) as usize;
        let x_ticks = ticks::ticks(&self.x, most(area.w, TICK_STEP[0]));
        let y_ticks = ticks::ticks(&self.y, most(area.h, TICK_STEP[1]));
        let (mut grid, mut marks) = (Vec::new(), Vec::new());
        for tick in &x_ticks {
            let x = area.x + self.x.fraction(tick.value) * area.w;
            grid.push(vec![(x, area.y), (x, bottom)]);
            marks.push(vec![(x, bottom), (x, bottom + TICK)]);
            let at = (x, bottom + TICK_GAP + 0.8 * SMALL);
            canvas.text(at, &tick.text, tick.exponent.as_deref(), Font::new(SMALL, Anchor::Middle));
        }
        for tick in &y_ticks {
            let y = area.y + (1.0 - self.y.fraction(tick.value)) * area.h;
            grid.push(vec![(area.x, y), (right, y)]);
            marks.push(vec![(area.x - TICK, y), (area.x, y)]);
            let at = (area.x - TICK_GAP, y + 0.36 * SMALL);
            canvas.text(at, &tick.text, tick.exponent.as_deref(), Font::new(SMALL, Anchor::End));
        }
        canvas.path(&grid, Stroke::solid(GRID, 0.8));
        canvas.path(&marks, Stroke::solid(FRAME, 0.9));
        let below = (area.x + 0.5 * area.w, bottom + TICK_GAP + 2.1 * SMALL + 4.0);
        let font = Font::new(NORMAL, Anchor::Middle);
        canvas.text(below, &x_axis.heading(), None, font);
        let widest = y_ticks.iter().map(|t| t.width(SMALL)).fold(0.0, f64::max);
        let beside = ((area.x - TICK_GAP - widest - 8.0).max(NORMAL), area.y + 0.5 * area.h);
        canvas.text(beside, &y_axis.heading(), None, font.turned(-90.0));
    }
}

/// The head of an arrow.
pub(super) fn head(canvas: &mut Canvas, from: Point, to: Point, stroke: Stroke) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    if length < 2.0 {
        return;
    }
    let (ux, uy) = (dx / length, dy / length);
    let size = (2.6 * stroke.width + 2.6).min(length);
    let back = (to.0 - size * ux, to.1 - size * uy);
    let half = 0.42 * size;
    let corners = [to, (back.0 - half * uy, back.1 + half * ux), (back.0 + half * uy, back.1 - half * ux)];
    canvas.polygon(&corners, stroke.colour, Stroke::solid(stroke.colour, 0.5));
}

/// The part of a convex area inside a rectangle (Sutherland and Hodgman).
fn cut(corners: &[Point], area: &Rect) -> Vec<Point> {
    let (right, bottom) = (area.x + area.w, area.y + area.h);
    let sides: [&dyn Fn(&Point) -> f64; 4] =
        [&|p| p.0 - area.x, &|p| right - p.0, &|p| p.1 - area.y, &|p| bottom - p.1];
    let mut inner = corners.to_vec();
    for inside in sides {
        let mut next = Vec::with_capacity(inner.len() + 1);
        for (i, here) in inner.iter().enumerate() {
            let before = &inner[(i + inner.len() - 1) % inner.len()];
            let (a, b) = (inside(before), inside(here));
            if (a < 0.0) != (b < 0.0) {
                let t = a / (a - b);
                next.push((before.0 + t * (here.0 - before.0), before.1 + t * (here.1 - before.1)));
            }
            if b >= 0.0 {
                next.push(*here);
            }
        }
        inner = next;
    }
    inner
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_are_cut_off_at_the_frame() {
        let area = Rect { x: 0.0, y: 0.0, w: 10.0, h: 10.0 };
        let around = [(-5.0, -5.0), (15.0, -5.0), (15.0, 15.0), (-5.0, 15.0)];
        let seen = cut(&around, &area);
        assert_eq!(seen.len(), 4, "{seen:?}");
        assert!(seen.iter().all(|p| area.contains(*p)));
        assert!(cut(&[(20.0, 20.0), (30.0, 20.0), (20.0, 30.0)], &area).is_empty());
    }
}
