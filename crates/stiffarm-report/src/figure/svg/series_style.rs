//! Markers, dashes and hatches of series.
//!
//! Grey printing and colour blindness need a second sign beside the
//! [colour](super::palette); it too starts from the label, and moves on within
//! a figure when another label of the same colour already uses it.

use super::canvas::{Canvas, INK, Point, Rect, Stroke};
use super::palette::{PALETTE, Places};
use crate::figure::{Figure, Style};

/// Grey of outlines.
const GREY: &str = "#8a8a8a";

/// Dark grey of landmarks.
const DARK_GREY: &str = "#4a4a4a";

const MARKERS: [Marker; 7] =
    [Marker::Circle, Marker::Square, Marker::Up, Marker::Diamond, Marker::Down, Marker::Cross, Marker::Star];

const DASHES: [&str; 7] = ["7 3", "3 2", "8 2 2 2", "1.5 2", "10 4", "5 2 1.5 2 1.5 2", "4 4"];

const OUTLINE_DASHES: [&str; 3] = ["", "5 3", "1.5 2.5"];

/// Directions of hatch lines as (x, y) steps.
const HATCHES: [&[(f64, f64)]; 7] = [
    &[],
    &[(1.0, -1.0)],
    &[(1.0, 1.0)],
    &[(1.0, -1.0), (1.0, 1.0)],
    &[(1.0, 0.0)],
    &[(0.0, 1.0)],
    &[(1.0, 0.0), (0.0, 1.0)],
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Marker {
    Circle,
    Square,
    Up,
    Diamond,
    Down,
    Cross,
    Star,
}

/// Kinds of marks that can be confused with each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Family {
    Marks,
    Hollow,
    Dashes,
    Areas,
    Outlines,
    Landmarks,
    Maps,
    Bands,
    Strokes,
}

fn family(style: Style) -> Family {
    match style {
        Style::Line | Style::Curve | Style::Points | Style::Path => Family::Marks,
        Style::Hollow => Family::Hollow,
        Style::Dashed => Family::Dashes,
        Style::Bars | Style::Box => Family::Areas,
        Style::Outline => Family::Outlines,
        Style::Landmark => Family::Landmarks,
        Style::Map => Family::Maps,
        Style::Band => Family::Bands,
        Style::Strokes => Family::Strokes,
    }
}

/// How the marks of one series look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SeriesStyle {
    pub colour: &'static str,
    pub dash: &'static str,
    pub variant: usize,
}

/// The styles of all series of a figure.
pub(super) struct SeriesStyles {
    entries: Vec<(String, Family, usize)>,
    places: Places,
}

impl SeriesStyles {
    pub(super) fn of(figure: &Figure) -> Self {
        let places = Places::of(figure);
        let mut entries: Vec<(String, Family, usize)> = Vec::new();
        for series in figure.panels.iter().flat_map(|p| &p.series) {
            let kind = family(series.style);
            let label = &series.label;
            if entries.iter().any(|(l, k, _)| l == label && *k == kind) {
                continue;
            }
            let variant = if matches!(kind, Family::Outlines | Family::Maps) {
                // Maps without a legend entry have a value everywhere.
                let counts = |l: &str| kind == Family::Outlines || !l.is_empty();
                let same = entries.iter().filter(|(l, k, _)| *k == kind && counts(l));
                same.count()
            } else if kind == Family::Areas && places.is_plain(label) {
                0
            } else {
                let base = places.get(label);
                let taken = |v: usize| entries.iter().any(|(l, k, w)| *k == kind && *w == v && places.get(l) == base);
                (base..base + PALETTE.len()).map(|v| v % PALETTE.len()).find(|v| !taken(*v)).unwrap_or(base)
            };
            entries.push((label.clone(), kind, variant));
        }
        Self { entries, places }
    }

    pub(super) fn look(&self, label: &str, style: Style) -> SeriesStyle {
        let kind = family(style);
        let variant = self.entries.iter().find(|(l, k, _)| l == label && *k == kind).map_or(0, |(_, _, v)| *v);
        match kind {
            Family::Outlines => {
                SeriesStyle { colour: GREY, dash: OUTLINE_DASHES[variant % OUTLINE_DASHES.len()], variant }
            }
            Family::Landmarks => SeriesStyle { colour: DARK_GREY, dash: "", variant },
            // On a map only black is told apart from every colour.
            Family::Strokes => SeriesStyle { colour: INK, dash: "", variant },
            Family::Dashes => {
                SeriesStyle { colour: PALETTE[self.places.get(label)], dash: DASHES[variant % DASHES.len()], variant }
            }
            _ => SeriesStyle { colour: PALETTE[self.places.get(label)], dash: "", variant },
        }
    }
}

impl SeriesStyle {
    /// Draws the marker of this look, filled or hollow.
    pub(super) fn marker(&self, canvas: &mut Canvas, at: Point, r: f64, hollow: bool) {
        // A white rim separates filled markers that touch.
        let (fill, stroke) = if hollow {
            ("#ffffff", Stroke::solid(self.colour, 1.4))
        } else {
            (self.colour, Stroke::solid("#ffffff", 0.6))
        };
        let corners: &[(f64, f64)] = match MARKERS[self.variant % MARKERS.len()] {
            Marker::Circle => return canvas.circle(at, r, fill, stroke),
            Marker::Square => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            Marker::Up => &[(0.0, -1.25), (1.1, 0.8), (-1.1, 0.8)],
            Marker::Down => &[(0.0, 1.25), (1.1, -0.8), (-1.1, -0.8)],
            Marker::Diamond => &[(0.0, -1.3), (1.15, 0.0), (0.0, 1.3), (-1.15, 0.0)],
            Marker::Cross => &[
                (-0.42, -1.2),
                (0.42, -1.2),
                (0.42, -0.42),
                (1.2, -0.42),
                (1.2, 0.42),
                (0.42, 0.42),
                (0.42, 1.2),
                (-0.42, 1.2),
                (-0.42, 0.42),
                (-1.2, 0.42),
                (-1.2, -0.42),
                (-0.42, -0.42),
            ],
            Marker::Star => &[
                (0.0, -1.4),
                (0.35, -0.49),
                (1.33, -0.43),
                (0.57, 0.19),
                (0.82, 1.13),
                (0.0, 0.6),
                (-0.82, 1.13),
                (-0.57, 0.19),
                (-1.33, -0.43),
                (-0.35, -0.49),
            ],
        };
        let corners: Vec<Point> = corners.iter().map(|(dx, dy)| (at.0 + r * dx, at.1 + r * dy)).collect();
        canvas.polygon(&corners, fill, stroke);
    }

    /// Draws the marker of a landmark.
    pub(super) fn landmark(&self, canvas: &mut Canvas, at: Point, r: f64) {
        let corner = |dx: f64, dy: f64| (at.0 + r * dx, at.1 + r * dy);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let stroke = Stroke::solid(self.colour, 1.4);
        canvas.polygon(&corners, "#ffffff", stroke);
        let diagonals = [vec![corners[0], corners[2]], vec![corners[1], corners[3]]];
        canvas.path(&diagonals, stroke);
    }

    /// Fills a rectangle: solid for bars, light for boxes, hatched unless
    /// this is the plain variant.
    pub(super) fn area(&self, canvas: &mut Canvas, rect: Rect, light: bool) {
        let none = Stroke::solid("none", 0.0);
        canvas.rect(rect, self.colour, if light { 0.22 } else { 0.92 }, none);
        let lines = if light { self.colour } else { "#ffffff" };
        let mut runs = Vec::new();
        for (dx, dy) in HATCHES[self.variant % HATCHES.len()] {
            hatch(rect, (*dx, *dy), &mut runs);
        }
        canvas.path(&runs, Stroke::solid(lines, if light { 0.6 } else { 1.0 }));
        canvas.rect(rect, "none", 1.0, Stroke::solid(self.colour, 1.0));
    }
}

/// Adds parallel lines across a rectangle. They sit on a common raster of the
/// picture, so that neighbouring bars have the same texture.
pub(super) fn hatch(rect: Rect, (dx, dy): (f64, f64), runs: &mut Vec<Vec<Point>>) {
    const GAP: f64 = 5.0;
    // Lines of direction (dx, dy) are the level sets of x·dy − y·dx.
    let level = |p: Point| p.0 * dy - p.1 * dx;
    let levels = [
        level((rect.x, rect.y)),
        level((rect.x + rect.w, rect.y)),
        level((rect.x, rect.y + rect.h)),
        level((rect.x + rect.w, rect.y + rect.h)),
    ];
    let low = levels.iter().copied().fold(f64::INFINITY, f64::min);
    let high = levels.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let reach = rect.w + rect.h;
    let middle = (rect.x + 0.5 * rect.w, rect.y + 0.5 * rect.h);
    let squared = dx * dx + dy * dy;
    let spacing = GAP * squared.sqrt();
    let first = (low / spacing).ceil() as i64;
    let last = (high / spacing).floor() as i64;
    for k in first..=last {
        let shift = (k as f64 * spacing - level(middle)) / squared;
        let on_line = (middle.0 + shift * dy, middle.1 - shift * dx);
        let from = (on_line.0 - reach * dx, on_line.1 - reach * dy);
        let to = (on_line.0 + reach * dx, on_line.1 + reach * dy);
        if let Some((a, b)) = rect.clip(from, to) {
            runs.push(vec![a, b]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::palette::series_colour;
    use super::*;
    use crate::figure::{Axis, Panel, Series};

    fn figure(labels: &[&str]) -> Figure {
        Figure::one(
            "",
            "",
            "",
            Panel::new(
                "",
                Axis::default(),
                Axis::default(),
                labels.iter().map(|l| Series::new(*l, Style::Line, vec![], vec![])).collect(),
            ),
        )
    }

    #[test]
    fn known_labels_have_their_own_colours() {
        let labels = ["Group 1", "Group 2 (classical)", "Group 3 (novel)", "scaled", "expected error"];
        for (i, a) in labels.iter().enumerate() {
            for b in &labels[..i] {
                assert_ne!(series_colour(a), series_colour(b), "{a} and {b}");
            }
        }
        assert_eq!(series_colour("Group 1"), "#0072B2");
        assert_eq!(series_colour("Group 2"), series_colour(labels[1]));
        assert_eq!(series_colour("Group 3 (novel), theory"), "#009E73");
    }

    #[test]
    fn numbered_labels_differ_from_their_neighbours() {
        let colours: Vec<_> = (1..=7).map(|n| series_colour(&format!("Posture {n}"))).collect();
        for (i, a) in colours.iter().enumerate() {
            assert!(!colours[..i].contains(a));
        }
        assert_eq!(series_colour("42"), series_colour("42"));
        assert_eq!(series_colour("Posture 99999999999999999999999"), {
            series_colour("Posture 99999999999999999999999")
        });
    }

    #[test]
    fn labels_of_one_colour_get_different_markers() {
        let styles = SeriesStyles::of(&figure(&["Joint 1", "Joint 8", "Joint 1, again", "Joint 2"]));
        let look = |l| styles.look(l, Style::Line);
        assert_eq!(look("Joint 1").colour, look("Joint 8").colour);
        assert_ne!(look("Joint 1"), look("Joint 8"));
        assert_ne!(look("Joint 1, again"), look("Joint 8"));
        assert_ne!(look("Joint 1, again"), look("Joint 1"));
    }

    fn bars(labels: &[&str]) -> SeriesStyles {
        let mut figure = figure(labels);
        let series = figure.panels.iter_mut().flat_map(|p| &mut p.series);
        series.for_each(|s| s.style = Style::Bars);
        SeriesStyles::of(&figure)
    }

    #[test]
    fn series_of_a_figure_have_colours_of_their_own() {
        let sources = ["anchor", "base tilt", "lost motion", "rope angle", "Group 2", "tilt, again"];
        let styles = bars(&sources);
        let colour = |l: &str| styles.look(l, Style::Bars).colour;
        for (i, a) in sources.iter().enumerate() {
            for b in &sources[..i] {
                assert_ne!(colour(a), colour(b), "{a} and {b}");
            }
        }
        assert_eq!(colour("Group 2"), series_colour("Group 2"));
        // Beyond the palette colours return, and a second sign tells them apart.
        let names: Vec<String> = (0..12).map(|i| format!("source {i} of error")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let styles = bars(&names);
        for (i, a) in names.iter().enumerate() {
            for b in &names[..i] {
                let look = |l: &str| styles.look(l, Style::Bars);
                assert_ne!(look(a), look(b), "{a} and {b}");
            }
        }
    }

    #[test]
    fn lone_bars_are_plain() {
        let look = bars(&["residual RMS"]).look("residual RMS", Style::Bars);
        assert_eq!((look.colour, look.variant), (PALETTE[0], 0));
        let measured = bars(&["measured"]).look("measured", Style::Bars);
        assert_eq!(measured.colour, series_colour("measured"));
    }

    #[test]
    fn colour_does_not_depend_on_company_of_other_colours() {
        let alone = SeriesStyles::of(&figure(&["a series"]));
        let others = ["Group 1", "Group 2", "Group 3"];
        let others = others.iter().filter(|l| series_colour(l) != series_colour("a series"));
        let among: Vec<&str> = others.copied().chain(["a series"]).collect();
        let among = SeriesStyles::of(&figure(&among));
        let colour = |styles: &SeriesStyles| styles.look("a series", Style::Line).colour;
        assert_eq!(colour(&alone), colour(&among));
        assert_eq!(colour(&alone), series_colour("a series"));
    }
}
