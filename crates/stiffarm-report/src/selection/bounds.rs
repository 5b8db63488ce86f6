//! How good plans of each size are and could be.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use stiffarm::plan::index::Index;

/// The best plan of one size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CountPoint {
    /// Number of postures.
    pub postures: usize,
    /// The index of the best plan found; `None` where so few postures cannot determine every joint.
    pub value: Option<f64>,
    /// What no plan of this size goes below.
    pub bound: Option<f64>,
}

/// The best value of an index against the number of postures, with its bound.
pub fn count_figure(index: Index, points: &[CountPoint]) -> Figure {
    let (unit, factor) = index.shown_in();
    let line = |label: &str, style, of: &dyn Fn(&CountPoint) -> Option<f64>| {
        let pairs = points.iter().filter_map(|p| Some((p.postures as f64, factor * of(p)?)));
        let (x, y) = pairs.unzip();
        Series::new(label, style, x, y)
    };
    let mut series = vec![line("best plan found", Style::Line, &|p| p.value)];
    if points.iter().any(|p| p.bound.is_some()) {
        // Where no plan exists its bound would only stretch the axis.
        let bound = |p: &CountPoint| p.value.and(p.bound);
        series.push(line("no plan goes below", Style::Dashed, &bound));
    }
    Figure::one(
        "count",
        "How many postures",
        "Best value found for each number of postures, with the bound that no plan of as many goes below. Where the \
         line flattens, one more posture is hardly worth its time.",
        Panel::new(
            "",
            Axis::linear("number of postures", ""),
            Axis::linear(index.in_words(), unit).from_zero(),
            series,
        ),
    )
}
