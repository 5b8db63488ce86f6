//! Which joints' errors go together.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use stiffarm::plan::index::GroupEvaluation;

/// Size of the correlation of the joints' errors, a map per group; `None` where no group has one.
pub fn correlation_figure(joints: &[String], groups: &[&GroupEvaluation]) -> Option<Figure> {
    let correlated = groups.iter().filter(|group| !group.correlation.is_empty());
    let panel = |group: &&GroupEvaluation| {
        let (name, all) = (group.name.clone(), &group.correlation);
        correlation_panel(name, "", joints, all.len(), |i, j| all[i].get(j).copied())
    };
    let panels: Vec<Panel> = correlated.map(panel).collect();
    (!panels.is_empty()).then(|| Figure {
        id: "correlation".into(),
        title: "Correlation of the joints' errors".into(),
        caption:
            "Size of the correlation of the errors of two joints' stiffness. Near 1 the readings tell the two joints \
                  apart badly: one may come out too stiff and the other too soft."
                .into(),
        columns: panels.len().min(3),
        panels,
    })
}

/// A map of correlations between `names`, `of` row and column; `label` is that of squares without a value.
pub(crate) fn correlation_panel(
    title: impl Into<String>,
    label: &str,
    names: &[String],
    count: usize,
    of: impl Fn(usize, usize) -> Option<f64>,
) -> Panel {
    let all = || (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
    let values = all().map(|(i, j)| of(i, j).map_or(f64::NAN, f64::abs));
    let (y, x) = all().map(|(i, j)| (i as f64, j as f64)).unzip();
    let axis = Axis::linear("|correlation|", "").with_range(0.0, 1.0);
    Panel::new(
        title,
        Axis::categorical("", names.to_vec()),
        Axis::categorical("", names.to_vec()),
        vec![Series::new(label, Style::Map, x, y).with_colour(axis, values.collect())],
    )
}
