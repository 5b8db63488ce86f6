//! Stiffness joint by joint: intervals, prior and published values, and what the data tell apart.

use super::joints::Joints;
use crate::identified::{correlation_figure, stiffness_figure};
use crate::level::level;
use crate::study::published_for;
use crate::summary::{Block, Context, DataTable, Form, Number, Quantity, Section, Text};
use stiffarm::ask::identify::Identified;
use stiffarm::estimate::coverage::{Intervals, MeasuredCoverage, measured};
use stiffarm::estimate::identify::JointEstimate;
use stiffarm::findings::visible;
use stiffarm::model::robot::catalogue;

/// Unknowns of a picture of correlations at most.
const MOST_UNKNOWNS: usize = 14;

/// Stiffness with its parts and intervals beside prior and published values \[N·m/rad\].
pub(super) fn section(joints: &Joints<'_>, prior: &[f64]) -> Section {
    let count = joints.all().len();
    let published = published(joints.context, count);
    let series: Vec<(String, Vec<f64>)> =
        published.iter().map(|(label, _, values)| (label.clone(), values.clone())).collect();
    let figure = stiffness_figure(&joints.rows(), prior, &series, joints.estimates.confidence);
    let mut blocks = vec![
        Block::Figure(figure),
        Block::Table(intervals(joints.all(), joints.estimates.confidence, "joint").numbers(
            "systematic errors",
            Quantity::PERCENT,
            |j| Some(Number::new(*joints.systematic_errors?.combined.get(j)?)),
        )),
    ];
    let has_prior = prior.len() == count;
    let mut table = DataTable::of(
        format!("Identified beside prior and published stiffness [{}]", Quantity::STIFFNESS.unit),
        "joint",
        joints.row_names(),
    )
    .words("identified", |j| {
        let stiffness = Number::new(joints.all()[j].stiffness);
        stiffness.of(Quantity::STIFFNESS.bare()).into()
    })
    .words("prior", |j| {
        let k = prior.get(j).filter(|_| has_prior);
        k.map_or_else(Text::default, |k| Number::new(*k).of(Quantity::STIFFNESS.bare()).into())
    })
    .numbers("identified / prior", Quantity::RATIO, |j| {
        let k = prior.get(j).filter(|_| has_prior)?;
        Some(Number::computed(joints.all()[j].stiffness? / k))
    });
    for (label, _, values) in &published {
        table = table.words(label.clone(), |j| {
            let stiffness = Number::computed(values[j]).of(Quantity::STIFFNESS);
            stiffness.bare().into()
        });
    }
    if table.headings.len() > 2 {
        blocks.push(Block::Table(table));
    }
    let sources = published.into_iter().map(|(label, source, _)| Text::new(format!("{label}: {source}")));
    let sources: Vec<Text> = sources.collect();
    if !sources.is_empty() {
        blocks.push(Block::List(sources));
    }
    Section::new("stiffness", "Stiffness, joint by joint", blocks)
}

/// Springs with their intervals by the scatter of the readings.
fn intervals(springs: &[JointEstimate], confidence: f64, heading: &str) -> DataTable {
    let caption = format!(
        "Standard errors and {} % intervals by the scatter of the readings [{}]",
        level(confidence),
        Quantity::STIFFNESS.unit
    );
    let bare = Quantity::STIFFNESS.bare();
    DataTable::of(caption, heading, springs.iter().map(|s| visible(&s.name).into_owned()))
        .numbers("k", bare, |j| Some(Number::new(springs[j].stiffness)))
        .numbers("standard error", bare, |j| Some(Number::new(springs[j].readings_standard_error)))
        .numbers("from", bare, |j| Some(Number::new(springs[j].readings_interval[0])))
        .numbers("to", bare, |j| Some(Number::new(springs[j].readings_interval[1])))
        .numbers("relative error", Quantity::PERCENT, |j| {
            let (error, k) = (springs[j].readings_standard_error?, springs[j].stiffness?);
            Some(Number::computed(error / k.abs()))
        })
}

/// Extra springs, lost motion, and combinations that are determined; `None` where there are none.
pub(super) fn further(joints: &Joints<'_>) -> Option<Section> {
    let estimates = joints.estimates;
    let mut blocks = Vec::new();
    if !estimates.extra_springs.is_empty() {
        let table = intervals(&estimates.extra_springs, estimates.confidence, "extra spring");
        blocks.push(Block::Table(table));
    }
    if !estimates.lost_motion.is_empty() {
        let gap = |j: usize| &estimates.lost_motion[j];
        let names = estimates.lost_motion.iter().map(|l| visible(&l.name).into_owned());
        let caption = format!("Lost motion with its {} % interval", level(estimates.confidence));
        let quantity = Quantity::GAP.digits(3);
        blocks.push(Block::Table(
            DataTable::of(caption, "lost motion", names)
                .numbers("half gap", quantity, |j| Some(Number::new(gap(j).angle)))
                .numbers("from", quantity, |j| Some(Number::new(gap(j).interval[0])))
                .numbers("to", quantity, |j| Some(Number::new(gap(j).interval[1]))),
        ));
    }
    if !estimates.combinations.is_empty() {
        let names = estimates.combinations.iter().map(|sum| {
            let terms = sum.unknowns.iter().zip(&sum.coefficients).enumerate();
            let terms = terms.map(|(i, (name, c))| term(i, name, *c));
            visible(&terms.collect::<String>()).into_owned()
        });
        let sum = |j: usize| &estimates.combinations[j];
        let compliance = Quantity::new("rad/(N·m)", 1.0, Form::Significant(4));
        blocks.push(Block::Table(
            DataTable::of("What the data determine together", "determined together", names)
                .numbers("compliance", compliance, |j| Some(Number::new(sum(j).compliance)))
                .numbers("standard error", compliance.digits(2), |j| Some(Number::new(sum(j).standard_error))),
        ));
    }
    let section = Section::new("further", "Beside the joints", blocks).in_summary();
    (!section.blocks.is_empty()).then_some(section)
}

/// One term of a sum of compliances: `1/k(joint 4) + 0.5/k(joint 6)`.
fn term(position: usize, name: &str, coefficient: f64) -> String {
    let size = match coefficient.abs() {
        c if (c - 1.0).abs() < 5e-4 => "1".to_string(),
        c => Number::computed(c).significant(3).text(),
    };
    let sign = match (position, coefficient < 0.0) {
        (0, false) => "",
        (0, true) => "-",
        (_, false) => " + ",
        (_, true) => " - ",
    };
    format!("{sign}{size}/k({name})")
}

/// Intervals from resampled postures, where they were asked for, and how often intervals that are not exact hold the
/// truth.
pub(super) fn resampled(identified: &Identified) -> Option<Section> {
    let mut blocks = Vec::new();
    let estimates = &identified.identification.estimates;
    if let Some(bootstrap) = &identified.bootstrap {
        let names = bootstrap.joints.iter().map(|j| visible(&j.name).into_owned());
        let end = |j: usize, i: usize| Some(Number::new(bootstrap.joints[j].interval[i]));
        let caption = format!("Bootstrap: {} % intervals", level(bootstrap.confidence));
        blocks.push(Block::Table(
            DataTable::of(caption, "joint", names).numbers("from", Quantity::STIFFNESS, |j| end(j, 0)).numbers(
                "to",
                Quantity::STIFFNESS,
                |j| end(j, 1),
            ),
        ));
        let skipped = match bootstrap.skipped {
            0 => String::new(),
            count => format!(", {count} of them skipped because they do not determine every joint"),
        };
        let dof = bootstrap.degrees_of_freedom;
        let covered = measured(Intervals::Bootstrap, dof);
        blocks.push(Block::Text(Text::new(format!(
            "Bootstrap: {} resamples of {} postures{skipped}. {}",
            bootstrap.resamples,
            bootstrap.postures,
            held("the bootstrap", dof, covered.as_ref())
        ))));
    }
    let dof = estimates.interval_degrees_of_freedom;
    if let (Some(_), Some(dof)) = (Intervals::of(estimates.estimator), dof) {
        let name = format!("the {} estimator", estimates.estimator.as_str());
        let said = held(&name, dof, identified.measured_coverage.as_ref());
        blocks.push(Block::Text(Text::new(said)));
    }
    let section = Section::new("coverage", "How often such intervals hold the truth", blocks);
    let section = match identified.bootstrap {
        Some(_) => section.in_summary(),
        None => section,
    };
    (!section.blocks.is_empty()).then_some(section)
}

fn held(name: &str, dof: usize, measured: Option<&MeasuredCoverage>) -> String {
    let Some(measured) = measured else {
        return format!(
            "How often intervals of {name} hold the truth with {dof} degrees of freedom was not measured: no coverage \
             is claimed (docs/coverage.md)."
        );
    };
    let mut text = format!(
        "In simulation the 95 % intervals of {name} held the truth in {:.2} ± {:.2} % ({} experiments, {} degrees of \
         freedom)",
        100.0 * measured.coverage,
        100.0 * measured.standard_error,
        measured.experiments,
        measured.degrees_of_freedom
    );
    for adverse in &measured.adverse {
        text += &format!("; {}: {:.2} %", adverse.situation, 100.0 * adverse.coverage);
    }
    text + " (docs/coverage.md)."
}

/// Which unknowns the data tell apart.
pub(super) fn together(joints: &Joints<'_>) -> Option<Section> {
    let estimates = joints.estimates;
    if estimates.unknowns.len() < 2 || estimates.unknowns.len() > MOST_UNKNOWNS {
        return None;
    }
    let condition = Number::new(estimates.scaled_condition).significant(3);
    let text = Text::new("Condition number of the observation matrix with columns of one length: ")
        .number(condition)
        .words(". 1 is best: every joint shows by itself.");
    let blocks = vec![Block::Figure(correlation_figure(estimates)), Block::Text(text)];
    Some(Section::new("together", "What the data tell apart", blocks))
}

/// Published stiffness of the cell's robot: label, source, values.
fn published(context: &Context<'_>, count: usize) -> Vec<(String, String, Vec<f64>)> {
    let Some(name) = context.cell.map(|cell| cell.setup.robot.name()) else {
        return Vec::new();
    };
    let mut out = Vec::new();
    let entry = catalogue().iter().find(|entry| entry.name == name);
    for (i, stiffness) in entry.iter().flat_map(|e| e.stiffness).enumerate() {
        if stiffness.values.len() == count {
            let label = format!("published {}", i + 1);
            out.push((label, stiffness.source.to_string(), stiffness.values.to_vec()));
        }
    }
    if let (Some(paper), true) = (published_for(name), out.is_empty() && count == 6) {
        let values = paper.stiffness.iter().map(|row| row[2]).collect();
        let source = format!("Table 6, Group 3: {}", crate::study::PAPER);
        out.push(("published".to_string(), source, values));
    }
    out
}
