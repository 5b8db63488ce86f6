//! Colours, widths and markers of the marks of a drawing.

use crate::figure::drawing::{DISTINCT_ITEMS, Tone};
use crate::figure::svg::canvas::{Canvas, INK, Point, Stroke};
use crate::figure::svg::series_style::SeriesStyle;

/// Red that no other mark has; 5.9 to 1 against white.
pub(super) const CAUTION: &str = "#c8102e";
/// Colours of numbered things: those of figures without vermillion, which is too near to [`CAUTION`].
const ITEMS: [&str; 6] = ["#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"];
/// Markers of figures.
const MARKERS: usize = 7;
/// Radius of markers.
pub(super) const MARKER: f64 = 3.6;

/// How areas of a tone are filled and edged.
pub(super) struct Fill {
    pub colour: &'static str,
    pub opacity: f64,
    pub edge: Stroke<'static>,
}

/// The look of an area.
pub(super) fn fill(tone: Tone, caution: bool) -> Fill {
    let (colour, opacity, edge, width) = match tone {
        Tone::Body => ("#9db4cc", 0.55, "#54708e", 0.9),
        Tone::Attached => ("#8cc9b0", 0.6, "#2c7a5c", 0.9),
        Tone::Ground => ("#e6e1d8", 0.75, "#a89f90", 0.9),
        Tone::Fixed => ("#cfc4b0", 0.6, "#857a66", 0.9),
        _ => ("none", 0.0, "#6f6f6f", 0.9),
    };
    let dash = if tone == Tone::Bound { "5 3" } else { "" };
    if caution {
        Fill {
            colour: if tone == Tone::Bound { "none" } else { CAUTION },
            opacity: 0.25,
            edge: Stroke { colour: CAUTION, width: 1.8, dash },
        }
    } else {
        Fill { colour, opacity, edge: Stroke { colour: edge, width, dash } }
    }
}

/// The look of a line.
pub(super) fn stroke(tone: Tone, caution: bool) -> Stroke<'static> {
    let (colour, width, dash) = match tone {
        Tone::Skeleton => (INK, 2.6, ""),
        Tone::Pull => ("#8a4b08", 1.8, ""),
        Tone::Ray => ("#2a7fb8", 0.9, ""),
        Tone::FaintRay => ("#9a9a9a", 0.8, "2 3"),
        Tone::Bound => ("#6f6f6f", 0.9, "5 3"),
        Tone::Ground => ("#857a66", 1.1, ""),
        Tone::Triad => (INK, 1.3, ""),
        Tone::Item(n) if n < DISTINCT_ITEMS => (ITEMS[n % ITEMS.len()], 1.1, ""),
        Tone::Item(_) => ("#b0b0b0", 0.9, ""),
        _ => ("#6f6f6f", 1.0, ""),
    };
    if caution { Stroke { colour: CAUTION, width: f64::max(width, 1.6), dash } } else { Stroke { colour, width, dash } }
}

/// The colour of the marker of a tone.
pub(super) fn marker_colour(tone: Tone, caution: bool) -> &'static str {
    match tone {
        // A ring says that there is a caution.
        Tone::Item(n) => ITEMS[n % ITEMS.len()],
        _ if caution => CAUTION,
        Tone::Skeleton | Tone::Target => INK,
        Tone::Fixed => "#4a4a4a",
        Tone::Pull => "#8a4b08",
        Tone::Ray => "#2a7fb8",
        _ => "#6f6f6f",
    }
}

/// Draws the marker of a tone.
pub(super) fn marker(canvas: &mut Canvas, at: Point, tone: Tone, caution: bool) {
    let ring = |colour| Stroke::solid(colour, 1.4);
    let look = |colour, variant| SeriesStyle { colour, dash: "", variant };
    let colour = marker_colour(tone, caution);
    match tone {
        Tone::Item(n) if n >= DISTINCT_ITEMS => {}
        Tone::Item(n) => {
            // Colour and marker meet again after all pairs of them.
            let variant = (n % ITEMS.len() + n / ITEMS.len()) % MARKERS;
            look(colour, variant).marker(canvas, at, MARKER, false);
        }
        Tone::Skeleton => canvas.circle(at, 2.9, "#ffffff", ring(colour)),
        Tone::Fixed => look(colour, 0).landmark(canvas, at, 4.2),
        Tone::Pull => look(colour, 3).marker(canvas, at, 3.9, false),
        Tone::Ray => look(colour, 2).marker(canvas, at, 4.2, false),
        Tone::Target if caution => canvas.circle(at, 3.4, colour, Stroke::solid("#ffffff", 0.6)),
        Tone::Target => canvas.circle(at, 2.3, "#ffffff", Stroke::solid(colour, 1.1)),
        _ => canvas.circle(at, 2.6, colour, Stroke::solid("#ffffff", 0.6)),
    }
    if caution && matches!(tone, Tone::Item(_) | Tone::Skeleton | Tone::Pull) {
        canvas.circle(at, 6.5, "none", ring(CAUTION));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_two_items_look_alike() {
        let markers: HashSet<String> = (0..DISTINCT_ITEMS)
            .map(|n| {
                let mut canvas = Canvas::default();
                marker(&mut canvas, (0.0, 0.0), Tone::Item(n), false);
                canvas.finish()
            })
            .collect();
        assert_eq!(markers.len(), DISTINCT_ITEMS);
    }
}
