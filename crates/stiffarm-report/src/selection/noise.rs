//! Deviation of the joint stiffness against noise (the paper's Fig. 8).

use crate::figure::{Axis, Figure, Panel, Series, Style};
use stiffarm::estimate::simulate::GroupSimulation;

/// Simulated deviation against the noise variance with its closed form, a panel per joint.
pub fn deviation_by_noise_figure(joints: &[String], groups: &[GroupSimulation], runs: usize) -> Figure {
    let panel = |(j, joint): (usize, &String)| {
        Panel::new(
            joint.clone(),
            Axis::linear("multiple of the noise variance", ""),
            Axis::log("mean deviation", "%"),
            groups.iter().flat_map(|group| series(group, j)).collect(),
        )
    };
    let levels = groups.first().map_or(0, |group| group.levels.len());
    let levels = match levels {
        1 => "one noise level".to_string(),
        6 => "six noise levels".to_string(),
        count => format!("{count} noise levels"),
    };
    Figure {
        id: "deviation-by-noise".into(),
        title: format!("Simulated deviation of the joint stiffness at {levels}"),
        caption: format!(
            "Mean of |k̂ − k|/k over {runs} runs with its standard error (markers), closed form (dashed). Hollow: \
             median where the relative standard error passes 10 %; the median of a normal error is 0.85 of its mean.",
        ),
        columns: 3,
        panels: joints.iter().enumerate().map(panel).collect(),
    }
}

/// Mean, closed form, and the median where that has to stand in, of a joint.
fn series(group: &GroupSimulation, j: usize) -> Vec<Series> {
    let factors = || group.levels.iter().map(|l| l.variance_factor);
    let percent = |v: f64| 100.0 * v;
    let pick = |flagged: bool, value: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let levels = group.levels.iter().enumerate();
        let levels = levels.filter(|(_, l)| l.beyond_first_order[j] == flagged);
        levels.map(|(l, _)| value(l)).collect()
    };
    let factor = |l: usize| group.levels[l].variance_factor;
    let mean = Series::new(
        &group.name,
        Style::Line,
        pick(false, &factor),
        pick(false, &|l| percent(group.levels[l].mean_deviation[j])),
    );
    let errors = pick(false, &|l| percent(group.levels[l].standard_error[j]));
    let expected = group.levels.iter().map(|l| percent(l.expected_deviation[j]));
    let mut out = vec![
        mean.with_error(errors),
        Series::new(format!("{}, theory", group.name), Style::Dashed, factors().collect(), expected.collect()),
    ];
    if group.levels.iter().any(|l| l.beyond_first_order[j]) {
        out.push(Series::new(
            format!("{}, median (beyond first order)", group.name),
            Style::Hollow,
            pick(true, &factor),
            pick(true, &|l| percent(group.levels[l].median_deviation[j])),
        ));
    }
    out
}
