//! Names beside their places, so that no two overlap.

use super::ink;
use crate::figure::drawing::Label;
use crate::figure::svg::canvas::{Anchor, Canvas, Font, INK, Point, Rect, Stroke};
use crate::figure::svg::text;

/// Font size of names.
const SIZE: f64 = 11.0;
/// Labels of a cluster share a text where their places are nearer than this.
const NEAR: f64 = 22.0;
/// Distances of a name from its place that are tried, one after the other.
const DISTANCES: [f64; 5] = [7.0, 14.0, 24.0, 38.0, 56.0];
/// From this distance on a thin line leads to the place.
const LED: f64 = 13.0;
/// Most names of a shared text.
const MOST: usize = 6;

/// A text and where it belongs.
struct Name {
    at: Point,
    text: String,
    caution: bool,
}

/// Draws all labels; `places` are markers that they keep off.
pub(super) fn draw(
    canvas: &mut Canvas,
    area: Rect,
    labels: &[Label],
    place: impl Fn([f64; 2]) -> Option<Point>,
    places: &[Point],
) {
    let mut taken: Vec<Rect> = Vec::new();
    for name in shared(labels, place) {
        if !area.contains(name.at) {
            continue;
        }
        let shown = text::shorten(&name.text, SIZE, 0.6 * area.w);
        let (rect, distance) = best(&name, &shown, area, places, &taken);
        let colour = if name.caution { ink::CAUTION } else { INK };
        if distance >= LED {
            let to = rect.clamp(name.at);
            canvas.line(name.at, to, Stroke::solid(colour, 0.5));
        }
        // Lines below the name would make it hard to read.
        canvas.rect(rect, "#ffffff", 0.72, Stroke::solid("none", 0.0));
        let at = (rect.x + 0.5 * rect.w, rect.y + 0.5 * rect.h + 0.36 * SIZE);
        canvas.coloured_text(at, &shown, Font::new(SIZE, Anchor::Middle), colour);
        taken.push(rect);
    }
}

/// Labels with those of a cluster that nearly meet joined.
fn shared(labels: &[Label], place: impl Fn([f64; 2]) -> Option<Point>) -> Vec<Name> {
    let mut names: Vec<(Name, &str, Vec<&str>)> = Vec::new();
    for label in labels {
        let Some(at) = place(label.at) else { continue };
        let near = |name: &Name| (name.at.0 - at.0).hypot(name.at.1 - at.1) < NEAR;
        let joined = names.iter_mut().find(|(name, cluster, _)| {
            !label.cluster.is_empty() && *cluster == label.cluster && name.caution == label.caution && near(name)
        });
        match joined {
            Some((_, _, texts)) => texts.push(&label.text),
            None => names.push((
                Name { at, text: String::new(), caution: label.caution },
                &label.cluster,
                vec![&label.text],
            )),
        }
    }
    let joined = names.into_iter().map(|(mut name, _, texts)| {
        name.text = if texts.len() > MOST { format!("{}, …", texts[..MOST].join(", ")) } else { texts.join(", ") };
        name
    });
    joined.collect()
}

/// The place of a name that hides least, nearest first, and its distance.
fn best(name: &Name, shown: &str, area: Rect, places: &[Point], taken: &[Rect]) -> (Rect, f64) {
    let (w, h) = (text::width(shown, SIZE) + 3.0, 1.15 * SIZE);
    let directions =
        [(1.0, -0.6), (-1.0, -0.6), (1.0, 0.6), (-1.0, 0.6), (0.0, -1.0), (0.0, 1.0), (1.0, 0.0), (-1.0, 0.0)];
    let mut cheapest: Option<(Rect, f64, f64)> = None;
    for distance in DISTANCES {
        for (dx, dy) in directions {
            let x = name.at.0 + dx * (distance + 0.5 * w) - 0.5 * w;
            let y = name.at.1 + dy * (distance + 0.5 * h) - 0.5 * h;
            let rect = Rect {
                x: x.min(area.x + area.w - w - 2.0).max(area.x + 2.0),
                y: y.min(area.y + area.h - h - 2.0).max(area.y + 2.0),
                w,
                h,
            };
            let over = taken.iter().filter(|other| overlap(&rect, other)).count();
            let hidden = places.iter().filter(|p| near(&rect, **p)).count();
            let cost = 50.0 * over as f64 + 4.0 * hidden as f64 + distance / 10.0;
            if cheapest.as_ref().is_none_or(|(_, before, _)| cost < *before) {
                cheapest = Some((rect, cost, distance));
            }
        }
    }
    cheapest.map_or((Rect { x: name.at.0, y: name.at.1, w, h }, 0.0), |(rect, _, distance)| (rect, distance))
}

fn overlap(a: &Rect, b: &Rect) -> bool {
    a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h
}

/// Whether a marker at `p` would be touched.
fn near(rect: &Rect, p: Point) -> bool {
    let off = rect.clamp(p);
    (off.0 - p.0).hypot(off.1 - p.1) < 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label(x: f64, text: &str, cluster: &str) -> Label {
        Label { at: [x, 0.0], text: text.into(), caution: false, cluster: cluster.into() }
    }

    #[test]
    fn near_labels_of_a_cluster_share_a_text() {
        let place = |[x, y]: [f64; 2]| Some((x, y));
        let labels = [
            label(0.0, "1", "points"),
            label(5.0, "2", "points"),
            label(100.0, "3", "points"),
            label(0.0, "table", ""),
        ];
        let names: Vec<String> = shared(&labels, place).into_iter().map(|n| n.text).collect();
        assert_eq!(names, ["1, 2", "3", "table"]);
    }

    #[test]
    fn names_of_one_place_do_not_overlap() {
        let area = Rect { x: 0.0, y: 0.0, w: 300.0, h: 300.0 };
        let mut taken = Vec::new();
        for _ in 0..6 {
            let name = Name { at: (150.0, 150.0), text: "measuring".into(), caution: false };
            let (rect, _) = best(&name, &name.text, area, &[], &taken);
            assert!(taken.iter().all(|other| !overlap(&rect, other)));
            taken.push(rect);
        }
    }
}
