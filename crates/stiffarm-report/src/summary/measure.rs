//! What `measure` says: how far the day is, how well the joints are known by now, and which posture comes next.

use super::identify::MORE_THAN_NOISE;
use crate::summary::{
    Block, Context, DataTable, Form, Number, Outcome, Quantity, Section, Summarise, Summary, Text, counted,
};
use stiffarm::Result;
use stiffarm::ask::measure::{Goal, Judgement, MeasureOptions};
use stiffarm::estimate::standing::Standing;
use stiffarm::findings::{list, visible};

/// Deflections at the tasks, from m.
const DEFLECTION: Quantity = Quantity::new("mm", 1e3, Form::Significant(2));

impl Summarise<MeasureOptions> for Judgement {
    fn summary(&self, options: &MeasureOptions, context: &Context<'_>) -> Result<Summary> {
        let judgement = self;
        let verdict = [what_was_done(judgement), conclusion(options, judgement), next_step(judgement)];
        let key = judgement.standing.as_ref().map(|standing| joints(judgement, standing));
        let mut sections = Vec::new();
        if !judgement.measured.is_empty() {
            let block = Block::Text(shown(&judgement.measured).into());
            sections.push(Section::new("measured", "Postures measured", vec![block]));
        }
        if !judgement.left.is_empty() {
            let block = Block::Text(shown(&judgement.left).into());
            sections.push(Section::new("left", "Postures left", vec![block]));
        }
        let mut summary = context.summary(judgement.every_finding(), "A day of measuring", verdict, key, sections);
        if judgement.is_missed() || judgement.standing.is_none() {
            summary.outcome = summary.outcome.max(Outcome::Caution);
        }
        Ok(summary)
    }
}

/// Names from files in words.
fn shown(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|n| visible(n).into_owned()).collect();
    list(&names)
}

/// How far the day is.
fn what_was_done(judgement: &Judgement) -> Text {
    let what_was_done = judgement.planned - judgement.left.len();
    let beside = judgement.measured.len().saturating_sub(what_was_done);
    let beside = match beside {
        0 => String::new(),
        count => format!(" and {count} beside the plan"),
    };
    let begun = match judgement.begun.as_slice() {
        [] => String::new(),
        names => format!("; begun: {}", shown(names)),
    };
    Text::new(format!("{what_was_done} of {} planned postures measured{beside}{begun}.", judgement.planned))
}

/// How well the joints are known, and whether that is enough.
fn conclusion(options: &MeasureOptions, judgement: &Judgement) -> Text {
    let text = if judgement.is_serious() {
        Text::default()
            .strong("Something is wrong with the readings")
            .words(": settle it before the next posture. As they are: ")
    } else {
        Text::default()
    };
    let Some(standing) = &judgement.standing else {
        let why = judgement.standing_missing.as_deref();
        let why = visible(why.unwrap_or("No posture is measured yet.")).into_owned();
        return text.words("Nothing can be said of the stiffness yet. ").words(why);
    };
    let joints = standing.joints.iter();
    let unknown = joints.filter(|joint| joint.total.is_none());
    let unknown = unknown.map(|joint| joint.name.clone());
    // What the load never turns never will be known.
    let is_left_out = |name: &String| standing.findings.iter().any(|f| f.subject == *name);
    let (left_out, unknown): (Vec<String>, Vec<String>) = unknown.partition(is_left_out);
    let text = match standing.largest {
        None if left_out.len() + unknown.len() == standing.joints.len() => {
            text.words("No joint is known to better than half of its stiffness yet")
        }
        None => text.words(format!("The stiffness is not known yet of {}", shown(&unknown))),
        Some(_) => text
            .words(if left_out.is_empty() {
                "Every joint is known to ± ".to_string()
            } else {
                format!("Every joint but {} is known to ± ", shown(&left_out))
            })
            .number(Number::new(standing.largest).of(Quantity::PERCENT))
            .words(" at ")
            .number(Number::new(standing.confidence).of(Quantity::PERCENT))
            .words(" confidence, all errors together"),
    };
    text.then(goal(options, judgement, standing)).words(".").then(misfit(standing)).then(at_tasks(options, judgement))
}

/// What the fit leaves, beside the noise.
fn misfit(standing: &Standing) -> Text {
    let Some(left) = standing.residual_std_m else {
        return Text::default();
    };
    let mm = |length: f64| Number::new(length).of(Quantity::LENGTH);
    let text = Text::new(" What the fit leaves has a standard deviation of ")
        .number(mm(left))
        .words(" against ")
        .number(mm(standing.expected_std_m))
        .words(" expected");
    let ratio = left / standing.expected_std_m;
    if standing.expected_std_m > 0.0 && ratio > MORE_THAN_NOISE {
        let ratio = Number::computed(ratio).significant(2);
        text.words(", ").number(ratio).words(" times as much.")
    } else {
        text.words(".")
    }
}

/// How far the goal is, where it is one of the stiffness.
fn goal(options: &MeasureOptions, judgement: &Judgement, standing: &Standing) -> Text {
    let number = Number::new(options.until.and_then(Goal::stiffness));
    if number.value.is_none() {
        return Text::default();
    }
    let number = number.of(Quantity::PERCENT);
    let left = judgement.left.len();
    if standing.reached == Some(true) {
        return Text::new("; ").strong("the goal is reached").words(" (± ").number(number).words(")");
    }
    let text = Text::new("; the goal of ± ").number(number);
    match standing.postures_to_goal {
        Some(count) => text.words(format!(" should take about {} more", counted(count, "posture"))),
        None if left == 0 => text.words(" is not reached with the whole plan"),
        // A forecast of joints that are not determined would be a guess.
        None if standing.largest.is_none() => text.words(" is not reached"),
        None => text.words(format!(" may not be reached with the {} left", counted(left, "posture"))),
    }
}

/// How well the deflection at the tasks is predicted, where that is the goal.
fn at_tasks(options: &MeasureOptions, judgement: &Judgement) -> Text {
    let Some(deflection) = &judgement.deflection else {
        return Text::default();
    };
    let goal = Number::new(options.until.and_then(Goal::deflection)).of(DEFLECTION.digits(3));
    if deflection.largest_m.is_none() {
        return Text::new(" No deflection at the tasks is predicted yet; the goal is ± ").number(goal).words(".");
    }
    let text = Text::new(" The deflection at the tasks is predicted to ± ")
        .number(Number::new(deflection.largest_m).of(DEFLECTION))
        .words(format!(" or better ({} is worst); ", visible(&deflection.task)));
    let text = if deflection.reached {
        text.strong("the goal is reached").words(" (± ")
    } else {
        text.words("the goal is not reached (± ")
    };
    text.number(goal).words(").")
}

/// What to drive to.
fn next_step(judgement: &Judgement) -> Text {
    if judgement.is_serious() {
        return Text::default()
            .strong("Settle what is marked serious")
            .words(": measure that posture again or correct the table.");
    }
    let reached = judgement.reached() == Some(true);
    let text = match &judgement.next {
        _ if reached => return Text::new("Nothing more: the goal is reached."),
        None if judgement.better.is_none() => Text::new("Nothing more: the plan is measured."),
        None => Text::new("The plan is measured."),
        Some(planned) => {
            let again = if judgement.begun.contains(&planned.name) { ", which is begun," } else { "" };
            let name = visible(&planned.name);
            Text::new(format!("Posture {name}{again} at q = ")).then(angles(&planned.angles)).words(".")
        }
    };
    text.then(better(judgement))
}

/// A posture that helps more.
fn better(judgement: &Judgement) -> Text {
    let Some(better) = &judgement.better else {
        return Text::default();
    };
    let text = match judgement.next {
        None => Text::new(" One more would help most: q = "),
        Some(_) => Text::new(" One beside the plan would help more: q = "),
    };
    let text = text.then(angles(&better.angles));
    let joints = judgement.standing.iter().flat_map(|standing| &standing.joints);
    let after = better.after.iter().zip(joints);
    let errors = after.filter_map(|(error, joint)| Some(((*error)?, joint)));
    match errors.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((error, joint)) => text
            .words("; it leaves a standard error of at most ")
            .number(Number::new(error).of(Quantity::PERCENT))
            .words(format!(" ({}) by the scatter of the readings alone.", visible(&joint.name))),
        None => text.words("."),
    }
}

/// Angles of a posture.
fn angles(angles: &[f64]) -> Text {
    let numbers = angles.iter().map(|q| Number::degrees(*q).of(Quantity::ANGLE.bare()));
    Text::new("(").numbers(numbers).words(")°")
}

/// A row for each joint.
fn joints(judgement: &Judgement, standing: &Standing) -> DataTable {
    let all = &standing.joints;
    let names = all.iter().map(|joint| visible(&joint.name).into_owned());
    let table = DataTable::of(
        "Joint stiffness so far with its ±; ≈: what is expected with the postures that are left",
        "joint",
        names,
    )
    .numbers("k", Quantity::STIFFNESS, |j| all[j].stiffness_nm_per_rad.map(Number::new))
    .numbers("± total", Quantity::PERCENT, |j| all[j].total.map(Number::new))
    .numbers("± systematic", Quantity::PERCENT, |j| all[j].systematic.map(Number::new));
    if judgement.left.is_empty() {
        return table;
    }
    table.numbers("with the next ≈", Quantity::PERCENT, |j| all[j].with_next.map(Number::new)).numbers(
        "with all ≈",
        Quantity::PERCENT,
        |j| all[j].with_all.map(Number::new),
    )
}
