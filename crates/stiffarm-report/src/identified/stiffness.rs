//! Joint stiffness with its uncertainty beside prior and published values.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::order::places;
use stiffarm::estimate::identify::LARGEST_HALF_WIDTH;

/// One joint of [`stiffness_figure`].
#[derive(Debug, Clone, PartialEq)]
pub struct StiffnessRow {
    /// Name of the joint.
    pub joint: String,
    /// k \[N·m/rad\].
    pub stiffness: Option<f64>,
    /// Half width by the scatter of the readings (fraction of k).
    pub statistical: Option<f64>,
    /// Half width by systematic errors (fraction of k).
    pub systematic: Option<f64>,
    /// Half width by both (fraction of k).
    pub total: Option<f64>,
    /// Ends of the interval of k \[N·m/rad\], as the table of the joints has them; open above where only a lower
    /// bound is known.
    pub interval: [Option<f64>; 2],
}

/// Stiffness per joint with its interval, beside prior \[N·m/rad\] and published values, and the parts of that ±.
pub fn stiffness_figure(
    rows: &[StiffnessRow],
    prior: &[f64],
    published: &[(String, Vec<f64>)],
    confidence: f64,
) -> Figure {
    let joints: Vec<&str> = rows.iter().map(|row| row.joint.as_str()).collect();
    let level = crate::level::level(confidence);
    let drawn = |label: &str, style: Style, of: &dyn Fn(&StiffnessRow) -> Option<f64>| {
        let rows_with_k = rows.iter().enumerate().filter_map(|(j, row)| {
            let ends = row.interval.map(|end| end.map(|k| 1e-6 * k));
            Some((j as f64, (1e-6 * of(row)?, ends)))
        });
        let (x, k_with_ends): (Vec<f64>, Vec<(f64, _)>) = rows_with_k.unzip();
        let (k, ends): (Vec<f64>, Vec<_>) = k_with_ends.into_iter().unzip();
        Series::new(label, style, x, k).with_interval(ends)
    };
    let beside = |by: f64| places(rows.len()).iter().map(|x| x + by).collect();
    let value = |row: &StiffnessRow| row.stiffness.filter(|k| *k > 0.0);
    let mut series = vec![drawn("identified", Style::Points, &value)];
    // A compliance at or below zero leaves the lower end alone.
    let bound = drawn("lower bound alone", Style::Hollow, &|row| match value(row) {
        Some(_) => None,
        None => row.interval[0],
    });
    series.extend((!bound.y.is_empty()).then_some(bound));
    if prior.len() == rows.len() {
        let values = prior.iter().map(|k| 1e-6 * k).collect();
        series.push(Series::new("prior", Style::Hollow, beside(0.18), values));
    }
    for (i, (label, values)) in published.iter().enumerate() {
        let values = values.iter().map(|k| 1e-6 * k).collect();
        let x = beside(-0.18 * (i + 1) as f64);
        series.push(Series::new(label.clone(), Style::Hollow, x, values));
    }
    let part = |label: &str, most: f64, of: &dyn Fn(&StiffnessRow) -> Option<f64>| {
        let drawable = |row: &StiffnessRow| of(row).filter(|part| *part < most);
        let all = rows.iter().enumerate();
        let shown = all.filter_map(|(j, row)| Some((j as f64, 100.0 * drawable(row)?)));
        let (x, y) = shown.unzip();
        Series::new(label, Style::Bars, x, y)
    };
    let has_both = rows.iter().any(|row| row.systematic.is_some());
    let parts = [
        part("readings", 1.0, &|row| row.statistical),
        part("systematic", 1.0, &|row| row.systematic),
        // As in the table: farther ends are told by the interval.
        part("total", LARGEST_HALF_WIDTH, &|row| row.total),
    ];
    let parts = parts
        .into_iter()
        .filter(|series| !series.y.is_empty())
        // Without systematic errors the total is the readings'.
        .filter(|series| has_both || series.label != "total");
    let parts: Vec<Series> = parts.collect();
    let panel =
        |title: &str, y: Axis, series: Vec<Series>| Panel::new(title, Axis::categorical("", joints.clone()), y, series);
    let mut panels = vec![panel("stiffness", Axis::log("joint stiffness", "10⁶ N·m/rad"), series)];
    let no_longer = format!("{:.0} %", 100.0 * LARGEST_HALF_WIDTH);
    let widths = match (parts.is_empty(), has_both) {
        (true, _) => format!("; no joint is known to better than {no_longer}"),
        (false, true) => format!(
            "; and its ± with the parts, where a joint without a bar of the total is known to no better than \
             {no_longer}"
        ),
        (false, false) => "; and its ± by the readings alone".to_string(),
    };
    if !parts.is_empty() {
        let title = if has_both { "total ± and its parts" } else { "± by the readings" };
        let half = Axis::linear("half width", "% of k").from_zero();
        panels.push(panel(title, half, parts));
    }
    Figure {
        id: "joint-stiffness".into(),
        title: "Joint stiffness and how well it is known".into(),
        caption: format!(
            "Stiffness of each joint with its {level} % interval (an arrow where it is open above: only a lower bound \
             is known){}{widths}.",
            match (prior.is_empty(), published.is_empty()) {
                (true, true) => "",
                (false, true) => ", beside the cell's prior",
                (true, false) => ", beside published values",
                (false, false) => ", beside the cell's prior and published values",
            }
        ),
        columns: panels.len(),
        panels,
    }
}
