//! Joint stiffness with its uncertainty beside prior and published values.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::order::places;

/// Half widths from this share of k on are no ±: 1/H is far from linear there.
const NO_LONGER: f64 = 0.95;

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
}

/// Stiffness per joint with its total ±, beside prior \[N·m/rad\] and published values, and the parts of that ±.
pub fn stiffness_figure(
    rows: &[StiffnessRow],
    prior: &[f64],
    published: &[(String, Vec<f64>)],
    confidence: f64,
) -> Figure {
    let joints: Vec<&str> = rows.iter().map(|row| row.joint.as_str()).collect();
    let level = crate::tell::level(confidence);
    let known = rows.iter().enumerate().filter_map(|(j, row)| {
        let k = 1e-6 * row.stiffness.filter(|k| *k > 0.0)?;
        let half = row.total.filter(|total| *total < NO_LONGER);
        Some((j as f64, (k, half.map_or(0.0, |total| total * k))))
    });
    let (x, known): (Vec<f64>, Vec<(f64, f64)>) = known.unzip();
    let (k, half): (Vec<f64>, Vec<f64>) = known.into_iter().unzip();
    let beside = |by: f64| places(rows.len()).iter().map(|x| x + by).collect();
    let identified = Series::new("identified", Style::Points, x, k);
    let mut series = vec![identified.with_error(half)];
    if prior.len() == rows.len() {
        let values = prior.iter().map(|k| 1e-6 * k).collect();
        series.push(Series::new("prior", Style::Hollow, beside(0.18), values));
    }
    for (i, (label, values)) in published.iter().enumerate() {
        let values = values.iter().map(|k| 1e-6 * k).collect();
        let x = beside(-0.18 * (i + 1) as f64);
        series.push(Series::new(label.clone(), Style::Hollow, x, values));
    }
    let part = |label: &str, of: &dyn Fn(&StiffnessRow) -> Option<f64>| {
        let known = |row: &StiffnessRow| of(row).filter(|part| *part < 1.0);
        let all = rows.iter().enumerate();
        let shown = all.filter_map(|(j, row)| Some((j as f64, 100.0 * known(row)?)));
        let (x, y) = shown.unzip();
        Series::new(label, Style::Bars, x, y)
    };
    let has_both = rows.iter().any(|row| row.systematic.is_some());
    let parts = [
        part("readings", &|row| row.statistical),
        part("systematic", &|row| row.systematic),
        part("total", &|row| row.total),
    ];
    let parts = parts
        .into_iter()
        .filter(|series| !series.y.is_empty())
        // Without systematic errors the total is the readings'.
        .filter(|series| has_both || series.label != "total");
    let parts: Vec<Series> = parts.collect();
    let panel = |title: &str, y: Axis, series: Vec<Series>| {
        Panel::new(title, Axis::categorical("", joints.clone()), y, series)
    };
    let mut panels = vec![panel(
        "stiffness",
        Axis::log("joint stiffness", "10⁶ N·m/rad"),
        series,
    )];
    let widths = match (parts.is_empty(), has_both) {
        (true, _) => "; no joint is known to better than its own size",
        (false, true) => {
            "; and that ± with its parts, where a joint without a bar of the total is known to no better than its own size"
        }
        (false, false) => {
            "; and that ±, by the readings alone, where a joint without a bar is known to no better than its own size"
        }
    };
    if !parts.is_empty() {
        let title = if has_both {
            "total ± and its parts"
        } else {
            "± by the readings"
        };
        let half = Axis::linear("half width", "% of k").from_zero();
        panels.push(panel(title, half, parts));
    }
    Figure {
        id: "joint-stiffness".into(),
        title: "Joint stiffness and how well it is known".into(),
        caption: format!(
            "Stiffness of each joint with its ± at {level} % (none where the interval is open){}{widths}.",
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
