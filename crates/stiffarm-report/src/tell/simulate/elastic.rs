//! `simulate --elastic`: an arm that gives way beyond its joint axes.

use super::cell_section;
use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::tell::Given;
use crate::tell::{Block, DataTable, Section, Text, Told};
use stiffarm::Result;
use stiffarm::estimate::simulate::{ElasticGroup, ElasticLevel, ElasticSimulation};
use stiffarm::findings::visible;
use stiffarm::model::posture::PostureGroup;

/// The part of a page for an arm that gives way beyond its joint axes.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    let mut result: ElasticSimulation = context.saved.result()?;
    for group in &mut result.groups {
        group.name = visible(&group.name).into_owned();
    }
    let error = |level: &ElasticLevel| {
        let model = level.mixed.as_ref().unwrap_or(&level.axes);
        model.prediction_rms_m
    };
    let first = result.groups.iter().enumerate();
    let first = first.filter_map(|(g, group)| Some((g, group, group.levels.first()?)));
    let best = first.min_by(|a, b| error(a.2).total_cmp(&error(b.2)));
    let place = match result.predicted_tasks {
        true => "at the cell's tasks".to_string(),
        false => format!("at {} random postures", result.predicted_count),
    };
    let done = Text::new(format!(
        "In each of {} runs an arm was drawn that gives way at joints and base beyond its axes, {}; it was measured, identified, \
         and its deflections were predicted {place}.",
        result.runs,
        result.sizes_from.in_words()
    ));
    let verdict = [done, came(context, &result, best), next(best.map(|b| b.2))];
    let groups = result.groups.iter().map(|group| {
        let angles = group.postures.iter().cloned();
        PostureGroup::named(&group.name, &group.posture_names, angles)
    });
    let mut sections = Vec::new();
    sections.extend(cell_section(context, groups.collect())?);
    let blocks = vec![
        Block::Figure(prediction_figure(&result)),
        Block::Table(shares(context, &result)),
    ];
    sections.push(Section::new(
        "prediction",
        "How well deflections are predicted",
        blocks,
    ));
    let blocks = vec![Block::Figure(joint_figure(&result))];
    sections.push(Section::new(
        "joints",
        "How well each joint is identified",
        blocks,
    ));
    let key = errors(context, &result);
    Ok(context.told(
        "Simulated identifications of an elastic arm".to_string(),
        verdict,
        Some(key),
        sections,
    ))
}

fn came(
    context: &Given<'_>,
    result: &ElasticSimulation,
    best: Option<(usize, &ElasticGroup, &ElasticLevel)>,
) -> Text {
    let Some((g, group, level)) = best else {
        return Text::new("There are no runs.");
    };
    let mm = |key: &str| {
        let below = format!("/groups/{g}/levels/0/{key}");
        context.number(&below).mm().significant(3)
    };
    let from = match result.groups.len() {
        1 => "From ",
        _ => "From the best group, ",
    };
    let text = Text::new(from)
        .strong(group.name.clone())
        .words(", deflections of ")
        .number(mm("deflection_rms_m"))
        .words(" (RMS) are predicted to ");
    match level.mixed {
        Some(_) => text
            .number(mm("mixed/prediction_rms_m"))
            .words(" ")
            .number(
                mm("mixed/prediction_standard_error_m")
                    .significant(2)
                    .plus_minus(),
            )
            .words(" with the mixed model, and to ")
            .number(mm("axes/prediction_rms_m"))
            .words(" with the joint axes alone."),
        None => text
            .number(mm("axes/prediction_rms_m"))
            .words(" with the joint axes alone."),
    }
}

fn next(level: Option<&ElasticLevel>) -> Text {
    let helps = level.and_then(|level| {
        let mixed = level.mixed.as_ref()?;
        Some(mixed.prediction_rms_m < level.axes.prediction_rms_m)
    });
    match helps {
        Some(true) => Text::new("Identify with ")
            .code("stiffarm identify --elastic auto")
            .words(" and choose postures with ")
            .code("stiffarm select --index prediction")
            .words(": the axes alone would promise too much."),
        Some(false) => {
            Text::new("The mixed model does not pay with these postures: choose others with ")
                .code("stiffarm select --index prediction")
                .words(", or stay with the joint axes.")
        }
        None => Text::new("Compare with ")
            .code("--elastic mixed")
            .words("."),
    }
}

/// Every level of every group with its place below `/result`.
fn rows(result: &ElasticSimulation) -> impl Iterator<Item = (String, String, &ElasticLevel)> {
    let groups = result.groups.iter().enumerate();
    groups.flat_map(|(g, group)| {
        let levels = group.levels.iter().enumerate();
        levels.map(move |(l, level)| {
            let name = match group.levels.len() {
                1 => group.name.clone(),
                _ => format!("{}, variance × {}", group.name, level.variance_factor),
            };
            (format!("/groups/{g}/levels/{l}"), name, level)
        })
    })
}

fn errors(context: &Given<'_>, result: &ElasticSimulation) -> DataTable {
    let mut table = DataTable::new(
        "RMS error of a predicted deflection [mm], ± its Monte Carlo standard error",
        [
            "group",
            "joint axes alone",
            "mixed model",
            "expected of the mixed model",
        ],
    );
    for (at, name, level) in rows(result) {
        let mm = |key: &str| {
            context
                .number(&format!("{at}/{key}"))
                .mm()
                .bare()
                .significant(3)
        };
        let both = |model: &str| {
            Text::from(mm(&format!("{model}/prediction_rms_m")))
                .words(" ")
                .number(
                    mm(&format!("{model}/prediction_standard_error_m"))
                        .significant(2)
                        .plus_minus(),
                )
        };
        let mixed = match level.mixed {
            Some(_) => both("mixed"),
            None => Text::from("–"),
        };
        table.row(
            name,
            [both("axes"), mixed, mm("expected_prediction_m").into()],
        );
    }
    table
}

fn shares(context: &Given<'_>, result: &ElasticSimulation) -> DataTable {
    let mut table = DataTable::new(
        "Share of the bands of predicted deflections that hold the truth [%]",
        [
            "group",
            "joint axes alone",
            "mixed model",
            "runs without a mixed model",
        ],
    );
    for (at, name, level) in rows(result) {
        let share = |model: &str| {
            let number = context.number(&format!("{at}/{model}/band_share"));
            Text::from(number.percent().bare().decimals(1))
        };
        let without = context.number(&format!("{at}/without_mixed")).decimals(0);
        let mixed = match level.mixed {
            Some(_) => share("mixed"),
            None => Text::from("–"),
        };
        table.row(name, [share("axes"), mixed, without.into()]);
    }
    table
}

/// RMS error of predicted deflections, by group and model.
fn prediction_figure(result: &ElasticSimulation) -> Figure {
    let all: Vec<(String, String, &ElasticLevel)> = rows(result).collect();
    let bars = |label: &str, of: &dyn Fn(&ElasticLevel) -> Option<f64>| {
        let y = all
            .iter()
            .map(|row| of(row.2).map_or(f64::NAN, |m| 1e3 * m));
        let x = (0..all.len()).map(|i| i as f64).collect();
        Series::new(label, Style::Bars, x, y.collect())
    };
    let mut series = vec![bars("joint axes alone", &|l| Some(l.axes.prediction_rms_m))];
    if all.iter().any(|row| row.2.mixed.is_some()) {
        let mixed = |l: &ElasticLevel| l.mixed.as_ref().map(|m| m.prediction_rms_m);
        series.push(bars("mixed model", &mixed));
        series.push(bars("expected of the mixed model", &|l| {
            l.expected_prediction_m
        }));
    }
    Figure {
        id: "prediction-error".into(),
        title: "Error of predicted deflections".into(),
        caption: "RMS error of a predicted deflection over all runs. The lower, the better; expected: what the mixed model would \
                  reach if the sizes of all springs and of the noise were known."
            .into(),
        columns: 1,
        panels: vec![Panel {
            title: String::new(),
            x: Axis::categorical("", all.iter().map(|row| row.1.clone())),
            y: Axis::linear("RMS error", "mm").from_zero(),
            series,
            equal_aspect: false,
        }],
    }
}

/// Median deviation of each joint at the first noise level, a panel per group.
fn joint_figure(result: &ElasticSimulation) -> Figure {
    let names: Vec<String> = result
        .joints
        .iter()
        .map(|j| visible(j).into_owned())
        .collect();
    let panels = result.groups.iter().filter_map(|group| {
        let level = group.levels.first()?;
        let models = [
            ("joint axes alone", Some(&level.axes)),
            ("mixed model", level.mixed.as_ref()),
        ];
        let series = models.into_iter().filter_map(|(label, model)| {
            let y = model?.median_deviation.iter().map(|d| 100.0 * d).collect();
            let x = (0..names.len()).map(|i| i as f64).collect();
            Some(Series::new(label, Style::Bars, x, y))
        });
        Some(Panel {
            title: group.name.clone(),
            x: Axis::categorical("", names.clone()),
            y: Axis::log("median deviation", "%"),
            series: series.collect(),
            equal_aspect: false,
        })
    });
    let panels: Vec<Panel> = panels.collect();
    Figure {
        id: "elastic-joints".into(),
        title: "Deviation of the identified stiffness".into(),
        caption: "Median of |k̂ − k|/k over the runs at the first noise level.".into(),
        columns: panels.len().clamp(1, 2),
        panels,
    }
}
