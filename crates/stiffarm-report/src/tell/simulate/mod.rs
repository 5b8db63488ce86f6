//! The page of `simulate`: what identifications with tracker noise give.

mod elastic;

use super::worth::UNSURE;
use crate::selection::deviation_by_noise_figure;
use crate::tell::Given;
use crate::tell::{Block, DataTable, Section, Text, Told};
use serde_json::Value;
use stiffarm::Result;
use stiffarm::estimate::simulate::{GroupSimulation, LevelResult, Simulation};
use stiffarm::findings::visible;
use stiffarm::model::posture::PostureGroup;

/// Most groups of which the table has the closed form beside the runs.
const SIDE_BY_SIDE: usize = 3;

/// What a result says of `simulate`.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    match context.saved.json.pointer("/result/asked") {
        Some(_) => elastic::told(context),
        None => axes(context),
    }
}

/// A group with its noise level nearest to the cell's own.
struct Shown<'a> {
    /// Its place below `/result`.
    at: String,
    name: String,
    level: &'a LevelResult,
}

/// An arm of which the joint axes alone give way.
fn axes(context: &Given<'_>) -> Result<Told> {
    let mut result: Simulation = context.saved.result()?;
    for group in &mut result.groups {
        group.name = visible(&group.name).into_owned();
    }
    let joints: Vec<String> = result
        .joints
        .iter()
        .map(|j| visible(j).into_owned())
        .collect();
    let shown: Vec<Shown<'_>> = result
        .groups
        .iter()
        .enumerate()
        .filter_map(|(g, group)| {
            let (l, level) = own_level(group)?;
            Some(Shown {
                at: format!("/groups/{g}/levels/{l}"),
                name: group.name.clone(),
                level,
            })
        })
        .collect();
    let best = shown
        .iter()
        .min_by(|a, b| worst(a).1.total_cmp(&worst(b).1));
    let verdict = [
        done(context, &result),
        came(context, &joints, &shown, best),
        next(best),
    ];
    let mut sections = Vec::new();
    sections.extend(cell_section(context, groups(&result.groups))?);
    let figure = deviation_by_noise_figure(&joints, &result.groups, result.runs);
    let mut blocks = vec![Block::Figure(figure)];
    if has_model_errors(context) {
        blocks.push(Block::Text(
            "The runs also draw errors of force, angles or geometry, which the closed form does not count.".into(),
        ));
    }
    sections.push(Section::new(
        "noise",
        "Deviation against noise (the paper's Fig. 8)",
        blocks,
    ));
    let tables = result.groups.iter().enumerate().map(|(g, group)| {
        let table = Block::Table(levels(context, &joints, g, group));
        Block::Details(format!("All noise levels of {}", group.name), vec![table])
    });
    sections.push(Section::new(
        "levels",
        "Every noise level",
        tables.collect(),
    ));
    let key = (!shown.is_empty()).then(|| key(context, &joints, &shown));
    let unsure = is_unsure(best).then_some(UNSURE);
    let told = context.told(
        "Simulated identifications".to_string(),
        verdict,
        key,
        sections,
    );
    Ok(told.caution("simulate", unsure))
}

/// The level nearest to the cell's own noise.
fn own_level(group: &GroupSimulation) -> Option<(usize, &LevelResult)> {
    let distance = |level: &LevelResult| (level.variance_factor - 1.0).abs();
    let levels = group.levels.iter().enumerate();
    levels.min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))
}

/// What stands for a joint: the mean, or the median where single runs dominate that.
fn typical(level: &LevelResult, j: usize) -> (&'static str, f64) {
    match level.beyond_first_order[j] {
        true => ("median_deviation", level.median_deviation[j]),
        false => ("mean_deviation", level.mean_deviation[j]),
    }
}

/// The joint that deviates most.
fn worst(shown: &Shown<'_>) -> (usize, f64) {
    let joints = 0..shown.level.mean_deviation.len();
    let all = joints.map(|j| (j, typical(shown.level, j).1));
    all.max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((0, f64::NAN))
}

fn done(context: &Given<'_>, result: &Simulation) -> Text {
    let levels = result.groups.first().map_or(0, |group| group.levels.len());
    let groups = match result.groups.len() {
        1 => "one group of postures".to_string(),
        count => format!("each of {count} groups of postures"),
    };
    let levels = match levels {
        1 => "at one noise level".to_string(),
        count => format!("at each of {count} noise levels"),
    };
    let errors = match has_model_errors(context) {
        true => " and errors of the model",
        false => "",
    };
    let stopped = match result.interrupted {
        true => " (stopped before all were done)",
        false => "",
    };
    Text::new(format!(
        "{} identifications with fresh tracker noise{errors} were simulated for {groups} {levels}{stopped}.",
        result.runs
    ))
}

fn has_model_errors(context: &Given<'_>) -> bool {
    let errors = context.saved.json.pointer("/options/model_errors");
    let values = errors.and_then(Value::as_object);
    let sizes = values.into_iter().flat_map(|map| map.values());
    sizes.filter_map(Value::as_f64).any(|size| size != 0.0)
}

fn came(
    context: &Given<'_>,
    joints: &[String],
    shown: &[Shown<'_>],
    best: Option<&Shown<'_>>,
) -> Text {
    let Some(best) = best else {
        return Text::new("There are no runs.");
    };
    let (joint, _) = worst(best);
    let (key, _) = typical(best.level, joint);
    let percent = |key: &str| {
        let number = context.number(&format!("{}/{key}/{joint}", best.at));
        number.percent().significant(3)
    };
    let mut text = match shown.len() {
        1 => Text::new("The stiffness that comes out worst, of "),
        _ => Text::default()
            .strong(best.name.clone())
            .words(" does best: the stiffness that comes out worst, of "),
    };
    text = text.words(joints[joint].clone());
    text = match key {
        "median_deviation" => text
            .words(", deviates from the truth by ")
            .number(percent(key))
            .words(" (median)"),
        _ => text
            .words(", deviates from the truth by ")
            .number(percent(key))
            .words(" ")
            .number(percent("standard_error").significant(2).plus_minus())
            .words(" on average"),
    };
    text = text.words(match (best.level.variance_factor - 1.0).abs() < 1e-12 {
        true => " at the cell's own noise".to_string(),
        false => format!(
            " at {} times the cell's noise variance",
            best.level.variance_factor
        ),
    });
    if has_model_errors(context) {
        return text.words(".");
    }
    text.words("; the closed form expects ")
        .number(percent("expected_deviation"))
        .words(".")
}

/// Whether some joint's relative standard error is above 10 %.
fn is_unsure(best: Option<&Shown<'_>>) -> bool {
    best.is_some_and(|best| best.level.beyond_first_order.contains(&true))
}

fn next(best: Option<&Shown<'_>>) -> Text {
    match is_unsure(best) {
        true => Text::new(
            "That is too unsure to rely on: some joint's relative standard error is above 10 %. Choose better postures with ",
        )
        .code("stiffarm select")
        .words(", or measure more points."),
        false => Text::new("Where that is sure enough, measure; ")
            .code("stiffarm select")
            .words(" finds postures that give more. What else may be wrong than the tracker is in ")
            .code("--force-percent")
            .words(", ")
            .code("--joint-angle-deg")
            .words(" and ")
            .code("--loading-point-mm")
            .words("."),
    }
}

/// Deviation of each joint at the cell's own noise.
fn key(context: &Given<'_>, joints: &[String], shown: &[Shown<'_>]) -> DataTable {
    let wide = shown.len() <= SIDE_BY_SIDE && !has_model_errors(context);
    let mut headings = vec!["joint".to_string()];
    for group in shown {
        headings.push(group.name.clone());
        if wide {
            headings.push("closed form".to_string());
        }
    }
    let factor = shown.first().map_or(1.0, |one| one.level.variance_factor);
    let mut table = DataTable::new(
        format!(
            "Mean deviation |k̂ − k|/k [%] at {factor} × the noise variance, ± its Monte Carlo standard error; * median"
        ),
        headings,
    );
    for (j, joint) in joints.iter().enumerate() {
        let mut cells = Vec::new();
        for group in shown {
            let (key, _) = typical(group.level, j);
            let number = |key: &str| {
                let number = context.number(&format!("{}/{key}/{j}", group.at));
                number.percent().bare().decimals(2)
            };
            cells.push(match key {
                "median_deviation" => Text::from(number(key)).words(" *"),
                _ => Text::from(number(key))
                    .words(" ")
                    .number(number("standard_error").plus_minus()),
            });
            if wide {
                cells.push(number("expected_deviation").into());
            }
        }
        table.row(joint.clone(), cells);
    }
    table
}

/// Every level of a group.
fn levels(context: &Given<'_>, joints: &[String], g: usize, group: &GroupSimulation) -> DataTable {
    let mut table = DataTable::new(
        format!("{}: simulated and expected deviation [%]", group.name),
        ["variance".to_string(), String::new()]
            .into_iter()
            .chain(joints.iter().cloned()),
    );
    for (l, level) in group.levels.iter().enumerate() {
        let each = |key: &str| {
            let cells = (0..joints.len()).map(|j| {
                let below = format!("/groups/{g}/levels/{l}/{key}/{j}");
                Text::from(context.number(&below).percent().bare().decimals(2))
            });
            cells.collect::<Vec<Text>>()
        };
        let rows = [
            ("mean", "mean_deviation"),
            ("median", "median_deviation"),
            ("closed form", "expected_deviation"),
        ];
        for (name, key) in rows {
            let cells = [Text::from(name)].into_iter().chain(each(key));
            table.row(format!("× {}", level.variance_factor), cells);
        }
    }
    table
}

fn groups(all: &[GroupSimulation]) -> Vec<PostureGroup> {
    let named = all.iter().map(|group| {
        let angles = group.postures.iter().cloned();
        PostureGroup::named(&group.name, &group.posture_names, angles)
    });
    named.collect()
}

/// The cell at all groups; `None` for a result of a version that did not write the postures.
fn cell_section(context: &Given<'_>, groups: Vec<PostureGroup>) -> Result<Option<Section>> {
    if groups.iter().all(|group| group.postures.is_empty()) {
        return Ok(None);
    }
    let explained =
        "Step through the postures of a group in measuring order, and lay other groups over them.";
    context.cell_section(&groups, explained).map(Some)
}
