//! What the renderer decides of a figure from its data alone, so that another renderer of the same figure decides
//! nothing a second time: colours, signs beside the colour, and extents of axes.

use super::plan::{ColourPlan, natural};
use super::scale::Extent;
use super::series_style::SeriesStyles;
use crate::figure::{Figure, Panel};
use serde::Serialize;

/// A figure with the styles of its series and the extents of its axes, for another renderer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShownFigure<'a> {
    /// The figure.
    #[serde(flatten)]
    pub figure: &'a Figure,
    /// What is decided of each panel, in their order.
    pub shown: Vec<ShownPanel>,
}

/// What is decided of a panel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShownPanel {
    /// Ends of the horizontal axis.
    pub x: [f64; 2],
    /// Ends of the vertical axis.
    pub y: [f64; 2],
    /// Ends of the colour bar, where the panel has a map with values.
    pub colour: Option<[f64; 2]>,
    /// Values that cannot be drawn on these axes.
    pub lost: usize,
    /// Colour of each series as `#rrggbb`, the lengths of its dashes, and the number of its marker or hatch.
    pub series: Vec<(&'static str, &'static str, usize)>,
}

/// A figure with all that is decided of it.
pub fn shown_figure(figure: &Figure) -> ShownFigure<'_> {
    let styles = SeriesStyles::of(figure);
    let ends = |extent: &Extent| [extent.lo, extent.hi];
    let shown = |panel: &Panel| {
        let (x, y, covered) = natural(panel);
        let series = panel.series.iter().map(|series| {
            let look = styles.look(&series.label, series.style);
            (look.colour, look.dash, look.variant)
        });
        ShownPanel {
            x: ends(&x),
            y: ends(&y),
            colour: ColourPlan::extent_of(panel).map(|extent| ends(&extent)),
            lost: covered.lost,
            series: series.collect(),
        }
    };
    ShownFigure { figure, shown: figure.panels.iter().map(shown).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Axis, Series, Style};

    #[test]
    fn what_is_shown_is_what_is_drawn() {
        let bars = |label: &str| Series::new(label, Style::Bars, vec![0.0, 1.0], vec![2.0, -1.0]);
        let series = vec![bars("Group 1"), bars("Group 2")];
        let panel = Panel::new("", Axis::categorical("", ["a", "b"]), Axis::log("y", ""), series);
        let figure = Figure::one("f", "", "", panel);
        let shown = shown_figure(&figure);
        let svg = super::super::render_svg(&figure);
        assert!(shown.shown[0].series.iter().all(|(colour, ..)| svg.contains(colour)));
        assert_eq!(shown.shown[0].x, [-0.5, 1.5]);
        // Values that a logarithmic axis cannot show.
        assert_eq!(shown.shown[0].lost, 2);
    }
}
