//! What `simulate` says: what identifications with tracker noise give.

mod elastic;

pub(super) use elastic::tables as elastic_tables;

use super::worth::UNSURE;
use crate::selection::deviation_by_noise_figure;
use crate::summary::{
    Block, Context, DataTable, Number, Quantity, Section, Summarise, Summary, Text, WithCell, of_saved, with_stopped,
};
use serde::de::IgnoredAny;
use stiffarm::Result;
use stiffarm::ask::simulate::Options;
use stiffarm::estimate::simulate::{ElasticSimulation, GroupSimulation, LevelResult, Simulation};
use stiffarm::findings::visible;
use stiffarm::model::posture::PostureGroup;

/// Most groups of which the table has the closed form beside the runs.
const SIDE_BY_SIDE: usize = 3;

/// What a result says of `simulate`.
pub(super) fn summary(with: &WithCell<'_>) -> Result<Summary> {
    match with.saved.json["result"].get("asked") {
        Some(_) => of_saved::<ElasticSimulation, IgnoredAny>(with),
        None => of_saved::<Simulation, Options>(with),
    }
}

/// A group with its noise level nearest to the cell's own.
struct Shown<'a> {
    name: String,
    level: &'a LevelResult,
}

/// Why the median stands for the mean.
const BEYOND: &str = "Where a joint's relative standard error is above 10 %, single runs near a compliance of zero \
                      dominate the mean, and the closed form no longer holds: read the median. The expectation of |k̂ \
                      − k|/k is infinite at every noise level; means are truncated, of the runs made.";

impl Summarise<Options> for Simulation {
    fn summary(&self, options: &Options, context: &Context<'_>) -> Result<Summary> {
        let has_errors = !options.model_errors.is_exact();
        let mut result = self.clone();
        for group in &mut result.groups {
            group.name = visible(&group.name).into_owned();
        }
        let joints: Vec<String> = result.joints.iter().map(|j| visible(j).into_owned()).collect();
        let shown: Vec<Shown<'_>> = result
            .groups
            .iter()
            .filter_map(|group| Some(Shown { name: group.name.clone(), level: own_level(group)? }))
            .collect();
        let best = shown.iter().min_by(|a, b| worst(a).1.total_cmp(&worst(b).1));
        let verdict =
            [what_was_done(has_errors, &result), conclusion(has_errors, &joints, &shown, best), next_step(best)];
        let mut sections = Vec::new();
        sections.extend(cell_section(context, groups(&result.groups))?);
        let figure = deviation_by_noise_figure(&joints, &result.groups, result.runs);
        let mut blocks = vec![Block::Figure(figure)];
        if has_errors {
            blocks.push(Block::Text(
                "The runs also draw errors of force, angles or geometry, which the closed form does not count.".into(),
            ));
        }
        let noise = "Deviation against noise (the paper's Fig. 8)";
        sections.push(Section::new("noise", noise, blocks).in_summary());
        let mut blocks = Vec::new();
        let all = result.groups.iter().flat_map(|group| &group.levels);
        if all.clone().any(is_beyond) {
            blocks.push(Block::Text(BEYOND.into()));
        }
        let tables = result.groups.iter().map(|group| {
            let table = Block::Table(levels(context, &joints, group));
            Block::Details(format!("All noise levels of {}", group.name), vec![table])
        });
        blocks.extend(tables);
        sections.push(Section::new("levels", "Every noise level", blocks));
        let key = (!shown.is_empty()).then(|| key(has_errors, &joints, &shown));
        let unsure = is_unsure(best).then_some(UNSURE);
        let findings = with_stopped(context, self.findings.clone(), self.interrupted, &[]);
        let summary = context.summary(findings, "Simulated identifications".to_string(), verdict, key, sections);
        Ok(summary.caution("simulate", unsure))
    }
}

/// The level nearest to the cell's own noise.
fn own_level(group: &GroupSimulation) -> Option<&LevelResult> {
    let distance = |level: &LevelResult| (level.variance_factor - 1.0).abs();
    let levels = group.levels.iter();
    levels.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// What stands for a joint: the mean with its standard error, or the median where single runs dominate that.
fn typical(level: &LevelResult, j: usize) -> (f64, Option<f64>) {
    if level.beyond_first_order[j] {
        (level.median_deviation[j], None)
    } else {
        (level.mean_deviation[j], Some(level.standard_error[j]))
    }
}

/// The joint that deviates most.
fn worst(shown: &Shown<'_>) -> (usize, f64) {
    let joints = 0..shown.level.mean_deviation.len();
    let all = joints.map(|j| (j, typical(shown.level, j).0));
    all.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::NAN))
}

fn what_was_done(has_errors: bool, result: &Simulation) -> Text {
    let levels = result.groups.first().map_or(0, |group| group.levels.len());
    let groups = match result.groups.len() {
        1 => "one group of postures".to_string(),
        count => format!("each of {count} groups of postures"),
    };
    let levels = match levels {
        1 => "at one noise level".to_string(),
        count => format!("at each of {count} noise levels"),
    };
    let errors = if has_errors { " and errors of the model" } else { "" };
    let fewest = result.groups.iter().flat_map(|group| &group.levels);
    let stopped = stopped(result.interrupted, fewest.map(|level| level.runs));
    Text::new(format!(
        "{} identifications with fresh tracker noise{errors} were simulated for {groups} {levels}{stopped}.",
        result.runs
    ))
}

/// How far a simulation came that the user stopped; nothing where it is complete.
fn stopped(is_stopped: bool, runs: impl Iterator<Item = usize>) -> String {
    if !is_stopped {
        return String::new();
    }
    let fewest = runs.min().unwrap_or(0);
    format!(" (stopped after {fewest} of them at the level with the fewest)")
}

fn conclusion(has_errors: bool, joints: &[String], shown: &[Shown<'_>], best: Option<&Shown<'_>>) -> Text {
    let Some(best) = best else {
        return Text::new("There are no runs.");
    };
    let (joint, _) = worst(best);
    let (deviation, error) = typical(best.level, joint);
    let percent = |value: f64| Number::new(value).of(Quantity::DEVIATION);
    let mut text = match shown.len() {
        1 => Text::new("The stiffness that comes out worst, of "),
        _ => Text::default().strong(best.name.clone()).words(" does best: the stiffness that comes out worst, of "),
    };
    text = text.words(joints[joint].clone());
    text = text.words(", deviates from the truth by ").number(percent(deviation));
    text = match error {
        None => text.words(" (median)"),
        Some(error) => text.words(" ").number(percent(error).plus_minus()).words(" on average"),
    };
    text = text.words(if (best.level.variance_factor - 1.0).abs() < 1e-12 {
        " at the cell's own noise".to_string()
    } else {
        format!(" at {} times the cell's noise variance", best.level.variance_factor)
    });
    if has_errors {
        return text.words(".");
    }
    text.words("; the closed form expects ").number(percent(best.level.expected_deviation[joint])).words(".")
}

/// Whether some joint's relative standard error is above 10 %.
fn is_unsure(best: Option<&Shown<'_>>) -> bool {
    best.is_some_and(|best| is_beyond(best.level))
}

/// The same of one level.
fn is_beyond(level: &LevelResult) -> bool {
    level.beyond_first_order.contains(&true)
}

fn next_step(best: Option<&Shown<'_>>) -> Text {
    if is_unsure(best) {
        Text::new(
            "That is too unsure to rely on: some joint's relative standard error is above 10 %. Choose better postures \
             with ",
        )
        .code("stiffarm select")
        .words(", or measure more points.")
    } else {
        Text::new("If that is sure enough, measure; if not, ")
            .code("stiffarm select")
            .words(" finds postures that tell more. Errors beside the tracker's are simulated with ")
            .code("--force-error-percent")
            .words(", ")
            .code("--joint-angle-error-deg")
            .words(" and ")
            .code("--loading-point-error-mm")
            .words(".")
    }
}

/// Deviation of each joint at the cell's own noise.
fn key(has_errors: bool, joints: &[String], shown: &[Shown<'_>]) -> DataTable {
    let is_wide = shown.len() <= SIDE_BY_SIDE && !has_errors;
    let factor = shown.first().map_or(1.0, |one| one.level.variance_factor);
    let caption =
        format!("Mean deviation |k̂ − k|/k at {factor} × the noise variance, ± its Monte Carlo standard error");
    // The last row holds their means.
    let names = joints.iter().map(|joint| Text::new(joint.clone()));
    let names = names.chain([Text::default().strong("mean")]);
    let mut table = DataTable::of(caption, "joint", names);
    for group in shown {
        let number = |value: f64| Number::new(value).of(Quantity::DEVIATION.bare());
        table = table.words(format!("{} [%]", group.name), |row| {
            if row == joints.len() {
                return if is_beyond(group.level) { Text::default() } else { mean(&group.level.mean_deviation).into() };
            }
            let (deviation, error) = typical(group.level, row);
            let text = Text::from(number(deviation));
            match error {
                None => text.words(" (median)"),
                Some(error) => text.words(" ").number(number(error).plus_minus()),
            }
        });
        if is_wide {
            table = table.words("closed form [%]", |row| {
                if row < joints.len() {
                    number(group.level.expected_deviation[row]).into()
                } else {
                    mean(&group.level.expected_deviation).into()
                }
            });
        }
    }
    table
}

fn mean(values: &[f64]) -> Number {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    Number::computed(mean).of(Quantity::DEVIATION.bare())
}

/// Every level of a group.
fn levels(context: &Context<'_>, joints: &[String], group: &GroupSimulation) -> DataTable {
    type Deviation = fn(&LevelResult) -> &[f64];
    let kinds: [(&str, Deviation); 3] = [
        ("mean", |level| &level.mean_deviation),
        ("median", |level| &level.median_deviation),
        ("closed form", |level| &level.expected_deviation),
    ];
    let count = kinds.len();
    let names =
        group.levels.iter().flat_map(|level| kinds.map(|(kind, _)| format!("× {}, {kind}", level.variance_factor)));
    let level = |row: usize| &group.levels[row / count];
    let caption = format!("{}: simulated and expected deviation [%]", group.name);
    let noise = context.cell.map(|cell| cell.noise.displacement_std());
    let mut table = DataTable::of(caption, "variance", names)
        .numbers("noise", Quantity::LENGTH, |row| Some(Number::computed(noise? * level(row).variance_factor.sqrt())));
    for (j, joint) in joints.iter().enumerate() {
        table = table.words(joint.clone(), |row| {
            let number = |all: &[f64]| Number::new(all[j]).of(Quantity::DEVIATION.bare());
            let text = Text::from(number(kinds[row % count].1(level(row))));
            match row % count {
                0 => text.words(" ").number(number(&level(row).standard_error).plus_minus()),
                _ => text,
            }
        });
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
fn cell_section(context: &Context<'_>, groups: Vec<PostureGroup>) -> Result<Option<Section>> {
    if groups.iter().all(|group| group.postures.is_empty()) {
        return Ok(None);
    }
    let explained = "Step through the postures of a group in measuring order, and lay other groups over them.";
    context.cell_section(&groups, explained).map(Some)
}
