//! The figures of a study, as data.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::order::places;
use crate::selection::{Deviations, deviation_by_noise_figure, expected_deviation_figure};
use stiffarm::study::{Study, StudyGroup};

/// All figures of a study, in the order of the page.
pub fn figures(study: &Study) -> Vec<Figure> {
    let mut out = vec![expected_deviation(study)];
    out.extend(study.groups.iter().enumerate().map(|(g, group)| postures(study, g, group)));
    out.push(deviation_by_noise_figure(&study.joints, &study.simulation.groups, study.simulation.runs));
    out.extend(other_starts(study));
    out.extend(q1_range(study));
    out.extend(validation(study));
    out
}

/// Bars per joint and group: what each group can be expected to give.
fn expected_deviation(study: &Study) -> Figure {
    let groups =
        study.groups.iter().map(|group| Deviations { name: &group.name, each: &group.evaluation.expected_deviation });
    let groups: Vec<Deviations<'_>> = groups.collect();
    expected_deviation_figure(&study.joints, &groups, &[], Some(study.noise_std_m))
}

/// Stick figures of one group, from above and from the side (Figs. 5–7).
fn postures(study: &Study, number: usize, group: &StudyGroup) -> Figure {
    let view = |title: &str, a: usize, b: usize, x: &str, y: &str| {
        let mut series = Vec::new();
        if let Some([low, high]) = study.tool_box_m {
            let (x, y) = ([low[a], high[a]], [low[b], high[b]]);
            series.push(Series::new(
                "box for the tool",
                Style::Outline,
                vec![x[0], x[1], x[1], x[0], x[0]],
                vec![y[0], y[0], y[1], y[1], y[0]],
            ));
        }
        for (p, arm) in group.arms_m.iter().enumerate() {
            series.push(Series::new(
                format!("Posture {}", p + 1),
                Style::Path,
                arm.iter().map(|o| o[a]).collect(),
                arm.iter().map(|o| o[b]).collect(),
            ));
        }
        if !study.anchors_m.is_empty() {
            series.push(Series::new(
                "anchor",
                Style::Landmark,
                study.anchors_m.iter().map(|anchor| anchor[a]).collect(),
                study.anchors_m.iter().map(|anchor| anchor[b]).collect(),
            ));
        }
        Panel { title: title.into(), x: Axis::linear(x, "m"), y: Axis::linear(y, "m"), series, equal_aspect: true }
    };
    Figure {
        id: format!("postures-{}", slug(&group.name)),
        title: format!("Postures: {}", group.name),
        caption: format!("Arms from base to measuring point 1, group {} of the study, side and top view.", number + 1),
        columns: 2,
        panels: vec![view("side", 0, 2, "x", "z"), view("top", 0, 1, "x", "y")],
    }
}

/// Boxes over all other initial groups, by kind.
fn other_starts(study: &Study) -> Option<Figure> {
    if study.starts.kinds.is_empty() {
        return None;
    }
    let rows = study.starts.kinds.first().map_or(&[][..], |kind| &kind.rows);
    let names: Vec<String> =
        rows.iter().map(|row| row.index.map_or("start".into(), |i| i.as_str().replace('_', " "))).collect();
    let series = study
        .starts
        .kinds
        .iter()
        .map(|kind| {
            let (mut x, mut y) = (Vec::new(), Vec::new());
            for (r, row) in kind.rows.iter().enumerate() {
                for value in row.mean_expected_deviation.iter().flatten() {
                    x.push(r as f64);
                    y.push(100.0 * value);
                }
            }
            Series::new(format!("{} starts ({})", kind.kind, kind.count), Style::Box, x, y)
        })
        .collect();
    Some(Figure::one(
        "other-starts",
        "What other initial groups lead to",
        "Mean over the joints of the expected deviation after selection under each index; box: quartiles, \
         whiskers: 5 to 95 %.",
        Panel::new("", Axis::categorical("", names), Axis::log("mean expected deviation", "%"), series),
    ))
}

/// Distribution of the classical group's outcome over q1.
fn q1_range(study: &Study) -> Option<Figure> {
    let range = study.classical_q1.as_ref().filter(|r| r.matters())?;
    let count = range.draws as f64;
    let x: Vec<f64> = range.mean_expected_deviation.iter().map(|d| 100.0 * d).collect();
    let y: Vec<f64> = (1..=x.len()).map(|i| 100.0 * i as f64 / count).collect();
    let marker = |label: &str, value: Option<f64>| {
        let v = 100.0 * value.unwrap_or(f64::NAN);
        Series::new(label, Style::Dashed, vec![v, v], vec![0.0, 100.0])
    };
    let deviation =
        |name: &str| study.groups.iter().find(|g| g.name == name).and_then(|g| g.evaluation.mean_expected_deviation());
    let mut series = vec![Series::new("Group 2 (classical), q1 drawn anew", Style::Dashed, x, y)];
    for group in study.groups.iter().filter(|g| !g.name.starts_with("Group 2")) {
        series.push(marker(&group.name, deviation(&group.name)));
    }
    Some(Figure::one(
        "classical-q1",
        "The classical group as a range over q1",
        format!(
            "Share of {} draws of q1 with at most this mean expected deviation; k(J_N) is the same for all of them. \
             Vertical: the other groups.",
            range.draws
        ),
        Panel::new(
            "",
            Axis::log("mean expected deviation", "%"),
            Axis::linear("share of draws", "%").with_range(0.0, 100.0),
            series,
        ),
    ))
}

/// Eq. (22) at the validation postures (Fig. 10).
fn validation(study: &Study) -> Option<Figure> {
    let labels: Vec<String> =
        study.groups.iter().find_map(|g| g.validation.as_ref())?.points.iter().map(|p| p.label.clone()).collect();
    let mut series: Vec<Series> = study
        .groups
        .iter()
        .filter_map(|g| {
            let y = g.validation.as_ref()?.points.iter().map(|p| 1e3 * p.deviation_m).collect();
            Some(Series::new(&g.name, Style::Line, places(labels.len()), y))
        })
        .collect();
    let noise = study.groups.iter().find_map(|g| g.validation.as_ref())?.noise_expectation_m;
    series.push(Series::new(
        "tracker noise alone (mean)",
        Style::Outline,
        vec![0.0, labels.len() as f64 - 1.0],
        vec![1e3 * noise; 2],
    ));
    Some(Figure::one(
        "validation",
        "Deviation at the validation postures, Eq. (22)",
        "Simulated measurement with tracker noise as the only error; m-n is measuring point n of posture m.",
        Panel::new("", Axis::categorical("measuring point", labels), Axis::log("deviation δb", "mm"), series),
    ))
}

/// A group's name as its files have it: `Group 2 (classical)` → `group-2-classical`.
pub fn slug(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars() {
        if c.is_ascii_alphanumeric() {
            out.push(c.to_ascii_lowercase());
        } else if !out.ends_with('-') && !out.is_empty() {
            out.push('-');
        }
    }
    out.trim_end_matches('-').to_string()
}

/// The deviation of each group at the illustration level, with its name.
pub(super) fn illustration(study: &Study) -> Vec<(&str, &stiffarm::estimate::simulate::LevelResult)> {
    let level = illustration_level(study);
    study.simulation.groups.iter().map(|g| (g.name.as_str(), &g.levels[level])).collect()
}

/// Index of the noise level nearest to variance factor 1, the one of Table 4.
fn illustration_level(study: &Study) -> usize {
    let factors = &study.options.simulation.variance_factors;
    let distance = |l: &usize| (factors[*l] - 1.0).abs();
    (0..factors.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}
