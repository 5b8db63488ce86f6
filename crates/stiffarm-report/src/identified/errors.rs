//! Systematic errors by source, and which unknowns the data tell apart.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::selection::correlation_panel;
use stiffarm::estimate::identify::Estimates;
use stiffarm::estimate::systematic::SystematicErrors;

/// What each source of systematic error leaves in each joint's stiffness.
pub fn errors_figure(systematic: &SystematicErrors) -> Figure {
    let count = systematic.joints.len();
    let series = systematic.sources.iter().map(|source| {
        let bars = source.bounded.iter().enumerate().take(count);
        let bars = bars.filter_map(|(j, c)| Some((j as f64, 100.0 * (*c)?.abs())));
        let (x, y) = bars.unzip();
        let star = if source.declared { "" } else { " *" };
        let label = format!("{}{star}", source.name.replace('-', " "));
        Series::new(label, Style::Bars, x, y)
    });
    let level = systematic.confidence;
    let assumed = systematic.sources.iter().any(|source| !source.declared);
    Figure::one(
        "systematic-errors",
        "Systematic errors by source",
        format!(
            "Relative standard uncertainty of each joint's stiffness by each source, as far as the readings leave it \
             possible: one standard deviation, while the ± of the tables is at {} %{}. The tallest bar of a joint is \
             what to make better first.{}",
            crate::level::level(level),
            match level {
                0.95 => ", about 1.96 times as wide",
                _ => "",
            },
            if assumed { " * Size assumed; [uncertainty] of the cell declares it." } else { "" }
        ),
        Panel::new(
            "",
            Axis::categorical("", systematic.joints.clone()),
            Axis::linear("standard uncertainty", "% of k").from_zero(),
            series.collect(),
        ),
    )
}

/// How far the errors of two unknowns are one error.
pub fn correlation_figure(estimates: &Estimates) -> Figure {
    let names = &estimates.unknowns;
    let of = |row: usize, column: usize| *estimates.correlation.get(row)?.get(column)?;
    let panel = correlation_panel("", "not determined", names, names.len(), of);
    Figure::one(
        "correlations",
        "Which joints the data tell apart",
        "Size of the correlation between the errors of two compliances. A bright square off the diagonal: an error \
         of one is an error of the other, and other postures or loads would separate them.",
        panel,
    )
}
