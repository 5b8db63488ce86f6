//! What the renderer decides of a drawing from its data alone, for another renderer of the same drawing.

use super::ink;
use crate::figure::drawing::{Drawing, Tone};
use crate::figure::svg::canvas::Stroke;
use serde::Serialize;

/// A drawing with the look of each kind of mark in it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShownDrawing<'a> {
    /// The drawing.
    #[serde(flatten)]
    pub drawing: &'a Drawing,
    /// The looks, one for each tone with and without caution.
    pub inks: Vec<Ink>,
}

/// Colour, width in pixels of a picture 800 px wide, and lengths of dashes.
type Line = (&'static str, f64, &'static str);

/// How marks of a tone look.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ink {
    /// The tone.
    pub tone: Tone,
    /// In the colour of cautions.
    pub caution: bool,
    /// Colour and opacity of an area.
    pub area: (&'static str, f64),
    /// Its edge.
    pub edge: Line,
    /// A line, and an arrow.
    pub line: Line,
    /// Colour of a marker.
    pub marker: &'static str,
}

/// A drawing with all that is decided of it.
pub fn shown_drawing(drawing: &Drawing) -> ShownDrawing<'_> {
    let mut kinds: Vec<(Tone, bool)> = Vec::new();
    let marks = drawing.views.iter().flat_map(|view| &view.marks);
    let marks = marks.map(|mark| (mark.tone, mark.caution));
    for kind in marks.chain(drawing.key.iter().map(|entry| (entry.tone, entry.caution))) {
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let line = |stroke: Stroke<'static>| (stroke.colour, stroke.width, stroke.dash);
    let inks = kinds.into_iter().map(|(tone, caution)| {
        let fill = ink::fill(tone, caution);
        let stroke = ink::stroke(tone, caution);
        let marker = ink::marker_colour(tone, caution);
        Ink { tone, caution, area: (fill.colour, fill.opacity), edge: line(fill.edge), line: line(stroke), marker }
    });
    ShownDrawing { drawing, inks: inks.collect() }
}
