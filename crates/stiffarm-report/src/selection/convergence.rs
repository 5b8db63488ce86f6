//! How a search came to its plan.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use stiffarm::plan::select::Selection;

/// Rounds up to which each has its own mark on the axis.
const FEW: u64 = 16;

/// The best value after each round of a global search, with the plan's own and what no plan goes below; `None` for a
/// search of fewer than two rounds.
pub fn convergence_figure(selection: &Selection, bound: Option<f64>) -> Option<Figure> {
    let index = selection.index;
    let (unit, factor) = index.shown_in();
    let all = selection.rounds.filter(|rounds| *rounds > 1)?;
    // Category i lies at i, round 1 is the first.
    let (axis, before) = if all <= FEW {
        let names = (1..=all).map(|round| round.to_string());
        (Axis::categorical("round", names), 1.0)
    } else {
        (Axis::linear("round", ""), 0.0)
    };
    let rounds = all as f64 - before;
    let improvements: Vec<(f64, f64)> = selection
        .improvements
        .iter()
        .filter_map(|report| Some((report.rounds as f64 - before, factor * report.value?)))
        .collect();
    let (first, last) = (improvements.first()?, improvements.last()?);
    // A value holds until a better one is found.
    let mut steps = vec![*first];
    for pair in improvements.windows(2) {
        steps.extend([(pair[1].0, pair[0].1), pair[1]]);
    }
    steps.push((rounds, last.1));
    let line = |label: &str, style, points: &[(f64, f64)]| {
        let (x, y) = points.iter().copied().unzip();
        Series::new(label, style, x, y)
    };
    let across = |value: f64| [(1.0 - before, factor * value), (rounds, factor * value)];
    let mut series = vec![
        line("best so far", Style::Curve, &steps),
        line("better plan found", Style::Points, &improvements),
        line("the plan", Style::Dashed, &across(selection.value)),
    ];
    if let Some(bound) = bound {
        series.push(line("no plan goes below", Style::Outline, &across(bound)));
    }
    Some(Figure::one(
        "convergence",
        "How the search converged",
        "Best value of the index after each round of local searches. The plan itself is searched to the end once more, \
         and its angles are rounded. A line that is level for long says that more rounds would hardly help.",
        Panel::new("", axis, Axis::linear(index.in_words(), unit), series),
    ))
}
