//! The pictures of the page.

use crate::novel::NovelIndex;
use crate::plans::{Band, Plan};
use crate::questions::CountPoint;
use stiffarm::model::cell::Cell;
use stiffarm::plan::zones::Zones;
use stiffarm_report::{Axis, Figure, Panel, Series, Style, zones_figure};

fn percent(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    values.into_iter().map(|v| 100.0 * v).collect()
}

/// Expected deviation per joint: the paper's and the literature's indices
/// beside those that are made of errors.
pub fn deviation(cell: &Cell, plans: &[Plan], random: &Band) -> Figure {
    let joints = cell.setup.robot.spring_names();
    let x = || (0..joints.len()).map(|j| j as f64).collect::<Vec<f64>>();
    let panel = |title: &str, names: &[(&str, &str)]| {
        let band = |at: usize, label: &str| {
            let y = percent(random.expected_deviation.iter().map(|d| d[at]));
            Series::new(label, Style::Outline, x(), y)
        };
        let mut series = vec![band(0, "random groups: 5 % and 95 %"), band(2, "random groups: 5 % and 95 %")];
        for (name, label) in names {
            for plan in plans.iter().filter(|p| p.name == *name) {
                let y = percent(plan.expected_deviation.iter().copied());
                series.push(Series::new(*label, Style::Line, x(), y));
            }
        }
        Panel {
            title: title.into(),
            x: Axis::categorical("", joints.clone()),
            y: Axis::log("expected deviation", "%").with_range(0.08, 40.0),
            series,
            equal_aspect: false,
        }
    };
    Figure {
        id: "selecting-deviation".into(),
        title: "What six postures give under each index (default cell)".into(),
        caption: "Expected deviation of each joint's stiffness at variance factor 1; grey: 5 % and 95 % quantile of \
                  200 random groups. Best of a global search under each index."
            .into(),
        columns: 2,
        panels: vec![
            panel(
                "indices of shape",
                &[
                    ("Group 1", "Group 1"),
                    ("classical", "classical"),
                    ("condition", "cond(Ψ)"),
                    ("novel", "novel (the paper's)"),
                    ("scaled", "scaled"),
                ],
            ),
            panel(
                "indices of error",
                &[
                    ("expected-error", "expected error"),
                    ("worst-joint", "worst joint"),
                    ("drop-one", "drop one"),
                    ("d", "d"),
                    ("task", "task index"),
                    ("prediction", "prediction"),
                ],
            ),
        ],
    }
}

/// The paper's index against what the plan gives, one panel per cell.
pub fn novel(cells: &[NovelIndex]) -> Figure {
    let titles = ["default cell", "reference cell (joint bounds only)"];
    let panels = cells.iter().zip(titles).map(|(cell, title)| {
        let one = |label: &str, plan: &Plan| {
            Series::new(
                label,
                Style::Points,
                vec![plan.indices.novel.unwrap_or(f64::NAN)],
                percent([plan.mean_expected_deviation]),
            )
        };
        let many = |label: &str, style: Style, points: Vec<(f64, f64)>| {
            let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
            Series::new(label, style, x, percent(y))
        };
        let last = cell.global.iter().map(|s| s.rounds).max().unwrap_or(0);
        let found = |end: bool| {
            let stages = cell.global.iter().filter(|s| (s.rounds == last) == end);
            stages.map(|s| (s.novel, s.mean_expected_deviation)).collect()
        };
        Panel {
            title: title.into(),
            x: Axis::log("novel index", "").with_range(5.0, 1e6),
            y: Axis::log("mean expected deviation", "%").with_range(0.4, 20.0),
            series: vec![
                many(
                    "random group",
                    Style::Hollow,
                    cell.random.iter().map(|p| (p.novel, p.mean_expected_deviation)).collect(),
                ),
                many(
                    "local minima",
                    Style::Points,
                    cell.local.iter().map(|p| (p.novel, p.mean_expected_deviation)).collect(),
                ),
                many("global search, on the way", Style::Hollow, found(false)),
                many("global search, end", Style::Points, found(true)),
                one("Group 1", &cell.group1),
                one("Group 3 (novel from Group 1)", &cell.from_group1),
                one("expected error", &cell.expected_error),
            ],
            equal_aspect: false,
        }
    });
    Figure {
        id: "selecting-novel".into(),
        title: "The paper's index against the error of the estimate".into(),
        caption:
            "Each mark is a group of six postures. To the left the paper's index is better, below the estimate is."
                .into(),
        columns: 2,
        panels: panels.collect(),
    }
}

/// Expected error against the number of postures.
pub fn count(points: &[CountPoint]) -> Figure {
    let series = |label: &str, style: Style, value: &dyn Fn(&CountPoint) -> Option<f64>| {
        let (x, y): (Vec<f64>, Vec<f64>) =
            points.iter().filter_map(|p| Some((p.postures as f64, 100.0 * value(p)?))).unzip();
        Series::new(label, style, x, y)
    };
    Figure {
        id: "selecting-count".into(),
        title: "How many postures (default cell)".into(),
        caption: "RMS over joints of the relative standard error against the number of postures, with the bound no \
                  group of that many postures goes below."
            .into(),
        columns: 1,
        panels: vec![Panel {
            title: String::new(),
            x: Axis::log("number of postures", "").with_range(0.9, 33.0),
            y: Axis::log("expected error", "%").with_range(0.3, 6.0),
            series: vec![
                series("random, median of 200 groups", Style::Line, &|p| p.random_median),
                series("space-filling", Style::Line, &|p| p.space_filling),
                series("expected error", Style::Line, &|p| Some(p.expected_error)),
                series("bound", Style::Dashed, &|p| Some(p.bound)),
            ],
            equal_aspect: false,
        }],
    }
}

/// Dumas' zones.
pub fn zones(maps: &Zones) -> Figure {
    Figure { id: "selecting-zones".into(), ..zones_figure(maps) }
}
