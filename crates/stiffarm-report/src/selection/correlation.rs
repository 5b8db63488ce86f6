//! Which joints' errors go together.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use stiffarm::plan::index::GroupEvaluation;

/// Size of the correlation of the joints' errors, a map per group; `None` where no group has one.
pub fn correlation_figure(joints: &[String], groups: &[&GroupEvaluation]) -> Option<Figure> {
    let known = groups.iter().filter(|group| !group.correlation.is_empty());
    let panels: Vec<Panel> = known.map(|group| panel(joints, group)).collect();
    (!panels.is_empty()).then(|| Figure {
        id: "correlation".into(),
        title: "Correlation of the joints' errors".into(),
        caption: "Size of the correlation of the errors of two joints' stiffness. Near 1 the readings tell the two joints \
                  apart badly: one may come out too stiff and the other too soft."
            .into(),
        columns: panels.len().min(3),
        panels,
    })
}

fn panel(joints: &[String], group: &GroupEvaluation) -> Panel {
    let n = group.correlation.len();
    let all = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let values = all().map(|(i, j)| group.correlation[i].get(j).map_or(f64::NAN, |c| c.abs()));
    let map = Series::new(
        "",
        Style::Map,
        all().map(|(_, j)| j as f64).collect(),
        all().map(|(i, _)| i as f64).collect(),
    );
    let axis = Axis::linear("|correlation|", "").with_range(0.0, 1.0);
    Panel::new(
        group.name.clone(),
        Axis::categorical("", joints.to_vec()),
        Axis::categorical("", joints.to_vec()),
        vec![map.with_colour(axis, values.collect())],
    )
}
