//! `simulate --elastic`: an arm that gives way beyond its joint axes.

use super::{cell_section, stopped};
use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::order::places;
use crate::summary::{Block, Context, DataTable, Number, Quantity, Section, Summarise, Summary, Text, with_stopped};
use stiffarm::Result;
use stiffarm::estimate::simulate::{ElasticGroup, ElasticLevel, ElasticModelOutcome, ElasticSimulation};
use stiffarm::findings::visible;
use stiffarm::model::elastic::ElasticClass;
use stiffarm::model::posture::PostureGroup;

/// Errors of predicted deflections, from m.
const PREDICTED: Quantity = Quantity::LENGTH.digits(3);

impl<O> Summarise<O> for ElasticSimulation {
    fn summary(&self, _options: &O, context: &Context<'_>) -> Result<Summary> {
        let mut result = self.clone();
        for group in &mut result.groups {
            group.name = visible(&group.name).into_owned();
        }
        let error = |level: &ElasticLevel| {
            let model = level.mixed.as_ref().unwrap_or(&level.axes);
            model.prediction_rms_m
        };
        let first = result.groups.iter();
        let first = first.filter_map(|group| Some((group, group.levels.first()?)));
        let best = first.min_by(|a, b| error(a.1).total_cmp(&error(b.1)));
        let place = if result.predicted_tasks {
            "at the cell's tasks".to_string()
        } else {
            format!(
                "at random postures inside the cell's limits, under forces as large as its load's in all directions \
                 ({} deflections)",
                result.predicted_count
            )
        };
        let levels = result.groups.iter().flat_map(|group| &group.levels);
        let sizes = ElasticClass::ENTRIES.map(|class| {
            let size = Number::computed(result.sizes.of(class));
            size.significant(2).unit(class.unit()).text()
        });
        let what_was_done = Text::new(format!(
            "In each of {} runs{} an arm was drawn that gives way at joints and base beyond its axes, by springs with \
         {} of {}; it was measured, identified, and its deflections were predicted {place}.",
            result.runs,
            stopped(result.interrupted, levels.map(|level| level.runs)),
            result.sizes_from.in_words(),
            sizes.join(", ")
        ));
        let verdict = [what_was_done, conclusion(&result, best), next_step(best.map(|b| b.1))];
        let groups = result.groups.iter().map(|group| {
            let angles = group.postures.iter().cloned();
            PostureGroup::named(&group.name, &group.posture_names, angles)
        });
        let mut sections = Vec::new();
        sections.extend(cell_section(context, groups.collect())?);
        let blocks = vec![Block::Figure(prediction_figure(&result)), Block::Table(shares(&result))];
        let title = "How well deflections are predicted";
        sections.push(Section::new("prediction", title, blocks).in_summary());
        let mut blocks = vec![Block::Figure(joint_figure(&result))];
        let tables = rows(&result).map(|(name, level)| {
            let table = Block::Table(joints(&result.joints, level));
            Block::Details(format!("Each joint: {name}"), vec![table])
        });
        blocks.extend(tables);
        let title = "How well each joint is identified";
        sections.push(Section::new("joints", title, blocks));
        let key = errors(&result);
        let findings = with_stopped(context, self.findings.clone(), self.interrupted, &[]);
        Ok(context.summary(findings, "Simulated identifications of an elastic arm", verdict, Some(key), sections))
    }
}

fn conclusion(result: &ElasticSimulation, best: Option<(&ElasticGroup, &ElasticLevel)>) -> Text {
    let Some((group, level)) = best else {
        return Text::new("There are no runs.");
    };
    let mm = |length: f64| Number::new(length).of(PREDICTED);
    let from = match result.groups.len() {
        1 => "From ",
        _ => "From the best group, ",
    };
    let text = Text::new(from)
        .strong(group.name.clone())
        .words(", deflections of ")
        .number(mm(level.deflection_rms_m))
        .words(" (RMS) are predicted to ");
    let text = match &level.mixed {
        Some(mixed) => text
            .number(mm(mixed.prediction_rms_m))
            .words(" ")
            .number(mm(mixed.prediction_standard_error_m).significant(2).plus_minus())
            .words(" with the mixed model, and to "),
        None => text,
    };
    text.number(mm(level.axes.prediction_rms_m)).words(" with the joint axes alone.").then(held(level))
}

/// How often the intervals of the joint stiffness hold the true one.
fn held(level: &ElasticLevel) -> Text {
    let share = |model: &ElasticModelOutcome| {
        let share = Number::computed(model.mean_interval_share()?);
        Some(share.of(Quantity::SHARE))
    };
    let mixed = level.mixed.as_ref().and_then(share);
    let (Some(axes), Some(mixed)) = (share(&level.axes), mixed) else {
        return Text::default();
    };
    let confidence = crate::level::level(level.axes.confidence);
    Text::new(format!(" The {confidence} % intervals of joint stiffness hold the true one in "))
        .number(axes)
        .words(" of the cases with the axes alone, in ")
        .number(mixed)
        .words(" with the mixed model.")
}

fn next_step(level: Option<&ElasticLevel>) -> Text {
    let helps = level.and_then(|level| {
        let mixed = level.mixed.as_ref()?;
        Some(mixed.prediction_rms_m < level.axes.prediction_rms_m)
    });
    match helps {
        Some(true) => Text::new("Identify with the mixed model, as ")
            .code("stiffarm identify")
            .words(" does by default, and choose postures with ")
            .code("stiffarm select --index prediction")
            .words(": the axes alone would promise too much."),
        Some(false) => Text::new("The mixed model does not pay with these postures: choose others with ")
            .code("stiffarm select --index prediction")
            .words(", or stay with the joint axes."),
        None => Text::new("Compare with ").code("--elastic mixed").words("."),
    }
}

/// Every level of every group with its name.
fn rows(result: &ElasticSimulation) -> impl Iterator<Item = (String, &ElasticLevel)> {
    result.groups.iter().flat_map(|group| {
        group.levels.iter().map(move |level| {
            let name = match group.levels.len() {
                1 => group.name.clone(),
                _ => format!("{}, variance × {}", group.name, level.variance_factor),
            };
            (name, level)
        })
    })
}

/// What every elastic simulation says of its groups: errors of predictions, and how often bands and intervals hold.
pub(in crate::summary) fn tables(result: &ElasticSimulation) -> [DataTable; 2] {
    [errors(result), shares(result)]
}

fn errors(result: &ElasticSimulation) -> DataTable {
    let rows: Vec<(String, &ElasticLevel)> = rows(result).collect();
    let mm = |length: f64| Number::new(length).of(PREDICTED.bare());
    let both = |model: &ElasticModelOutcome| {
        let error = mm(model.prediction_standard_error_m);
        Text::from(mm(model.prediction_rms_m)).words(" ").number(error.significant(2).plus_minus())
    };
    DataTable::of(
        "RMS error of a predicted deflection, ± its Monte Carlo standard error; expected: the index prediction, the \
         error of the mixed model if its sizes and those of the noise were known",
        "group",
        rows.iter().map(|row| row.0.clone()),
    )
    .words("joint axes alone [mm]", |row| both(&rows[row].1.axes))
    .words("mixed model [mm]", |row| {
        let mixed = rows[row].1.mixed.as_ref();
        mixed.map_or_else(Text::default, both)
    })
    .words("expected [mm]", |row| {
        let expected = rows[row].1.expected_prediction_m;
        expected.map_or_else(Text::default, |error| mm(error).into())
    })
}

/// How often bands and intervals hold the truth, a row for each level.
fn shares(result: &ElasticSimulation) -> DataTable {
    let rows: Vec<(String, &ElasticLevel)> = rows(result).collect();
    type Model = for<'l> fn(&'l ElasticLevel) -> Option<&'l ElasticModelOutcome>;
    let models: [(&str, Model); 2] = [("axes", |level| Some(&level.axes)), ("mixed", |level| level.mixed.as_ref())];
    let mut table = DataTable::of(
        "Share that holds the truth: bands of predicted deflections, intervals of k",
        "group",
        rows.iter().map(|row| row.0.clone()),
    );
    for (name, of) in models {
        table = table
            .numbers(&format!("bands: {name}"), Quantity::SHARE, |row| of(rows[row].1)?.band_share.map(Number::new));
    }
    for (name, of) in models {
        table = table.numbers(&format!("k: {name}"), Quantity::SHARE, |row| {
            of(rows[row].1)?.mean_interval_share().map(Number::computed)
        });
    }
    table.numbers("runs without mixed model", Quantity::COUNT, |row| {
        let without = rows[row].1.without_mixed;
        (without > 0).then(|| Number::count(without))
    })
}

/// Deviation of each joint's stiffness at a level, and how often its interval holds.
fn joints(names: &[String], level: &ElasticLevel) -> DataTable {
    let names = names.iter().map(|name| visible(name).into_owned());
    let caption = "Deviation |k̂ − k|/k of each joint, and share of the intervals of k that hold";
    let mut table = DataTable::of(caption, "joint", names);
    let models = [("axes", Some(&level.axes)), ("mixed", level.mixed.as_ref())];
    for (model, outcome) in models {
        let Some(outcome) = outcome else { continue };
        table = table
            .numbers(&format!("{model}: median"), Quantity::DEVIATION, |j| {
                Some(Number::new(outcome.median_deviation[j]))
            })
            .numbers(&format!("{model}: mean"), Quantity::DEVIATION, |j| Some(Number::new(outcome.mean_deviation[j])))
            .numbers(&format!("{model}: k holds"), Quantity::SHARE, |j| outcome.interval_share[j].map(Number::new));
    }
    table
}

/// RMS error of predicted deflections, by group and model.
fn prediction_figure(result: &ElasticSimulation) -> Figure {
    let all: Vec<(String, &ElasticLevel)> = rows(result).collect();
    let bars = |label: &str, of: &dyn Fn(&ElasticLevel) -> Option<f64>| {
        let y = all.iter().map(|row| of(row.1).map_or(f64::NAN, |m| 1e3 * m));
        let x = places(all.len());
        Series::new(label, Style::Bars, x, y.collect())
    };
    let mut series = vec![bars("joint axes alone", &|l| Some(l.axes.prediction_rms_m))];
    if all.iter().any(|row| row.1.mixed.is_some()) {
        let mixed = |l: &ElasticLevel| l.mixed.as_ref().map(|m| m.prediction_rms_m);
        series.push(bars("mixed model", &mixed));
        series.push(bars("expected of the mixed model", &|l| l.expected_prediction_m));
    }
    Figure::one(
        "prediction-error",
        "Error of predicted deflections",
        "RMS error of a predicted deflection over all runs. The lower, the better; expected: what the mixed model \
         would reach if the sizes of all springs and of the noise were known.",
        Panel::new(
            "",
            Axis::categorical("", all.iter().map(|row| row.0.clone())),
            Axis::linear("RMS error", "mm").from_zero(),
            series,
        ),
    )
}

/// Median deviation of each joint at the first noise level, a panel per group.
fn joint_figure(result: &ElasticSimulation) -> Figure {
    let names: Vec<String> = result.joints.iter().map(|j| visible(j).into_owned()).collect();
    let panels = result.groups.iter().filter_map(|group| {
        let level = group.levels.first()?;
        let models = [("joint axes alone", Some(&level.axes)), ("mixed model", level.mixed.as_ref())];
        let series = models.into_iter().filter_map(|(label, model)| {
            let y = model?.median_deviation.iter().map(|d| 100.0 * d).collect();
            let x = places(names.len());
            Some(Series::new(label, Style::Bars, x, y))
        });
        Some(Panel::new(
            group.name.clone(),
            Axis::categorical("", names.clone()),
            Axis::log("median deviation", "%"),
            series.collect(),
        ))
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
