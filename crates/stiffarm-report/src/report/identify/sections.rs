//! Pictures and details of an identification.

use super::super::worth::level;
use super::joints::Joints;
use super::story::angles;
use crate::identified::{
    correlation_figure, errors_figure, influence_figure, load_states_figure, residual_figure,
    stiffness_figure,
};
use crate::page::{Block, DataTable, Number, Section, Text};
use crate::report::context::Context;
use crate::study::published_for;
use stiffarm::estimate::identified::Identified;
use stiffarm::estimate::systematic::SystematicSource;
use stiffarm::findings::{list, visible};
use stiffarm::model::robot::catalogue;
use stiffarm::units::rad_to_deg;

/// Postures and unknowns of a picture of correlations at most.
const MOST_UNKNOWNS: usize = 14;

/// Stiffness with its parts beside prior and published values.
pub(super) fn stiffness(joints: &Joints<'_>, found: &Identified) -> Section {
    let own = &found.identification;
    stiffness_section(joints, &own.prior_stiffness)
}

/// The same for any identification.
pub(super) fn stiffness_section(joints: &Joints<'_>, prior: &[f64]) -> Section {
    let context = joints.context;
    let count = joints.all().len();
    let published = published(context, count);
    let series: Vec<(String, Vec<f64>)> = published
        .iter()
        .map(|(label, _, values)| (label.clone(), values.clone()))
        .collect();
    let figure = stiffness_figure(&joints.rows(), prior, &series, joints.estimates.confidence);
    let mut blocks = vec![Block::Figure(figure)];
    if prior.len() == count || !published.is_empty() {
        let mut headings = vec!["joint".to_string(), "identified".to_string()];
        if prior.len() == count {
            headings.extend(["prior", "identified / prior"].map(String::from));
        }
        headings.extend(published.iter().map(|(label, ..)| label.clone()));
        let mut table = DataTable::new(
            "Identified beside prior and published stiffness [10⁶ N·m/rad]",
            headings,
        );
        for j in 0..count {
            let mega = |below: String| Text::from(context.number(&below).mega().bare());
            let mut cells = vec![mega(format!("/joints/{j}/stiffness"))];
            if let Some(k) = prior.get(j).filter(|_| prior.len() == count) {
                cells.push(mega(format!("/prior_stiffness/{j}")));
                let ratio = joints.all()[j].stiffness.map(|own| own / k);
                cells.push(Number::new("", ratio).significant(3).into());
            }
            for (.., values) in &published {
                cells.push(Number::new("", values.get(j).copied()).mega().bare().into());
            }
            table.row(joints.name(j), cells);
        }
        blocks.push(Block::Table(table));
    }
    let sources = published
        .into_iter()
        .map(|(label, source, _)| Text::new(format!("{label}: {source}")));
    let sources: Vec<Text> = sources.collect();
    if !sources.is_empty() {
        blocks.push(Block::List(sources));
    }
    Section::new("stiffness", "Stiffness, joint by joint", blocks)
}

/// Published stiffness of the cell's robot: label, source, values.
fn published(context: &Context<'_>, count: usize) -> Vec<(String, String, Vec<f64>)> {
    let Some(name) = context.cell.map(|cell| cell.setup.robot.name()) else {
        return Vec::new();
    };
    let mut out = Vec::new();
    let entry = catalogue().iter().find(|entry| entry.name == name);
    for (i, own) in entry.iter().flat_map(|e| e.stiffness).enumerate() {
        if own.values.len() == count {
            let label = format!("published {}", i + 1);
            out.push((label, own.source.to_string(), own.values.to_vec()));
        }
    }
    if let (Some(paper), true) = (published_for(name), out.is_empty() && count == 6) {
        let values = paper.stiffness.iter().map(|row| row[2]).collect();
        let source = format!("Table 6, Group 3: {}", crate::study::PAPER);
        out.push(("published".to_string(), source, values));
    }
    out
}

/// What gives way beyond the joint axes, where that was asked.
pub(super) fn elastic(context: &Context<'_>, found: &Identified) -> Option<Section> {
    let elastic = found.elastic.as_ref()?;
    let reasons = elastic.reasons.iter().map(|r| Text::from(r.as_str()));
    let mut blocks = vec![Block::List(reasons.collect())];
    let number = |below: &str| Text::from(context.number(below).mm().bare().decimals(4));
    if elastic.axes_rms_m.is_some() || elastic.mixed_rms_m.is_some() {
        let mut table = DataTable::new(
            "Each posture predicted from the others, RMS of a displacement component",
            ["elastic model", "missed by [mm]"],
        );
        table.row("joint axes alone", [number("/elastic/axes_rms_m")]);
        table.row(
            "mixed: joints and base in all directions",
            [number("/elastic/mixed_rms_m")],
        );
        blocks.push(Block::Table(table));
    }
    if let Some(mixed) = found.mixed().and_then(|elastic| elastic.mixed.as_ref()) {
        let mut table = DataTable::new(
            format!(
                "Joint stiffness as the mixed model has it, interval at {} % with all errors [10⁶ N·m/rad]",
                level(found.identification.estimates.confidence)
            ),
            ["joint", "k", "from", "to"],
        );
        let has_budget = elastic
            .budget
            .as_ref()
            .is_some_and(|b| b.uncertainty.len() == mixed.joints.len());
        for (j, joint) in mixed.joints.iter().enumerate() {
            let mega = |below: String| Text::from(context.number(&below).mega().bare());
            let end = |i: usize| match has_budget {
                true => format!("/elastic/budget/uncertainty/{j}/interval_nm_per_rad/{i}"),
                false => format!("/elastic/mixed/joints/{j}/interval/{i}"),
            };
            let k = format!("/elastic/mixed/joints/{j}/stiffness");
            table.row(
                visible(&joint.name).into_owned(),
                [mega(k), mega(end(0)), mega(end(1))],
            );
        }
        blocks.push(Block::Table(table));
    }
    Some(Section::new(
        "elastic",
        "What gives way beyond the joint axes",
        blocks,
    ))
}

/// Residuals against noise.
pub(super) fn residuals(context: &Context<'_>, found: &Identified) -> Section {
    let own = &found.identification;
    let mm = |below: &str| context.number(below).mm().decimals(4);
    let mut words = Text::new("Residual RMS ")
        .number(mm("/residual_rms_m"))
        .words(", beside a displacement RMS of ")
        .number(mm("/displacement_rms_m"))
        .words(".");
    if own.total_std_m.is_some() && own.expected_std_m > 0.0 {
        words = words.words(
            " The verdict holds the standard deviation of the residuals against noise, not this RMS: it weighs each \
             displacement by its noise and counts the degrees of freedom that the fit has used up.",
        );
    }
    let mut blocks = vec![Block::Text(words), Block::Figure(residual_figure(own))];
    let mut order: Vec<usize> = (0..own.postures.len()).collect();
    let size = |i: &usize| own.postures[*i].residual_rms_m;
    order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let mut table = DataTable::new(
        "Postures and load states with the largest residuals",
        [
            "posture",
            "load state",
            "residual RMS [mm]",
            "displacement RMS [mm]",
            "residual / displacement [%]",
        ],
    );
    for i in order.into_iter().take(5) {
        let posture = &own.postures[i];
        let mm = |key: &str| {
            let number = context.number(&format!("/postures/{i}/{key}"));
            Text::from(number.mm().bare().decimals(4))
        };
        let share = match posture.displacement_rms_m > 0.0 {
            true => Some(posture.residual_rms_m / posture.displacement_rms_m),
            false => None,
        };
        let cells = [
            visible(&posture.state).into_owned().into(),
            mm("residual_rms_m"),
            mm("displacement_rms_m"),
            Number::new("", share)
                .percent()
                .bare()
                .significant(2)
                .into(),
        ];
        table.row(visible(&posture.posture).into_owned(), cells);
    }
    blocks.push(Block::Table(table));
    Section::new("residuals", "What the fit leaves, against noise", blocks)
}

/// Systematic errors by source.
pub(super) fn errors(context: &Context<'_>, found: &Identified) -> Option<Section> {
    let budget = found.budget.as_ref()?;
    let mut blocks = vec![Block::Figure(errors_figure(budget))];
    let mut table = DataTable::new(
        "Sources of systematic error: size as a standard uncertainty, and how much of it the readings leave; 100 %: they say \
         nothing of it, above: they look like more of it",
        [
            "source",
            "size",
            "unit",
            "known from",
            "left by the readings [%]",
        ],
    );
    for (i, source) in budget.sources.iter().enumerate() {
        let at = |key: &str| context.number(&format!("/budget/sources/{i}/{key}"));
        let (size, unit) = shown_size(source, at("size"));
        let declared = match source.declared {
            true => "the cell",
            false => "assumed *",
        };
        let cells = [
            size,
            unit.into(),
            declared.into(),
            at("remaining").percent().bare().significant(3).into(),
        ];
        table.row(source.name.replace('-', " "), cells);
    }
    blocks.push(Block::Table(table));
    Some(Section::new(
        "errors",
        "Errors that all readings share",
        blocks,
    ))
}

/// A size and its unit as cell file and terminal have them.
fn shown_size(source: &SystematicSource, size: Number) -> (Text, &'static str) {
    let shown = |factor: f64| Text::from(size.clone().times(factor).significant(2));
    match source.unit.as_str() {
        "1" => (shown(100.0), "%"),
        "m" => (shown(1e3), "mm"),
        "rad" if source.name == "lost-motion" => (shown(60.0 * rad_to_deg(1.0)), "arcmin"),
        "rad" => (shown(1e3), "mrad"),
        // A compliance in the file, a stiffness to the reader.
        _ if source.size > 0.0 => {
            let stiffness = Number::new("", Some(1.0 / source.size)).significant(2);
            (stiffness.into(), "N·m/rad")
        }
        _ => ("rigid".into(), ""),
    }
}

/// Which unknowns the data tell apart.
pub(super) fn together(context: &Context<'_>, found: &Identified) -> Option<Section> {
    let own = &found.identification.estimates;
    together_section(context, own)
}

/// The same for any identification.
pub(super) fn together_section(
    context: &Context<'_>,
    own: &stiffarm::estimate::identify::Estimates,
) -> Option<Section> {
    if own.unknowns.len() < 2 || own.unknowns.len() > MOST_UNKNOWNS {
        return None;
    }
    let mut blocks = vec![Block::Figure(correlation_figure(own))];
    let text = Text::new("Condition number of the observation matrix with columns of one length: ")
        .number(context.number("/scaled_condition").significant(3))
        .words(". 1 is best: every joint shows by itself.");
    blocks.push(Block::Text(text));
    let sums = own.combinations.iter().map(|sum| {
        let terms = sum.unknowns.iter().zip(&sum.coefficients);
        let terms: Vec<String> = terms
            .map(|(name, c)| format!("{c:.3} · {}", visible(name)))
            .collect();
        Text::new(format!(
            "Determined together: the sum of compliances {}.",
            list(&terms)
        ))
    });
    let sums: Vec<Text> = sums.collect();
    if !sums.is_empty() {
        blocks.push(Block::List(sums));
    }
    Some(Section::new("together", "What the data tell apart", blocks))
}

/// Linearity and hysteresis.
pub(super) fn states(context: &Context<'_>, found: &Identified) -> Option<Section> {
    let states = found.diagnosis.as_ref()?.load_states.as_ref()?;
    let mut table = DataTable::new(
        "Load states of all postures together",
        [
            "what",
            "found",
            "standard error",
            "probability by chance [%]",
        ],
    );
    let mut row = |name: &str, key: &str, is_length: bool, known: bool| {
        if !known {
            return;
        }
        let at = |own: &str| context.number(&format!("/diagnosis/load_states/{key}/{own}"));
        let shown = |number: Number| match is_length {
            true => Text::from(number.mm().decimals(4)),
            false => Text::from(number.percent().significant(2)),
        };
        let chance = at("p_value").percent().bare().significant(2);
        table.row(
            name,
            [
                shown(at("value")),
                shown(at("standard_error")),
                chance.into(),
            ],
        );
    };
    row(
        "offset at zero load (lost motion)",
        "offset",
        true,
        states.offset.is_some(),
    );
    row(
        "curvature (softens where positive)",
        "curvature",
        false,
        states.curvature.is_some(),
    );
    row(
        "loop, down minus up (hysteresis)",
        "hysteresis",
        true,
        states.hysteresis.is_some(),
    );
    let blocks = vec![
        Block::Figure(load_states_figure(states)),
        Block::Table(table),
    ];
    Some(Section::new(
        "load-states",
        "Loads going up and down",
        blocks,
    ))
}

/// What hangs on single postures.
pub(super) fn influence(_: &Context<'_>, found: &Identified) -> Option<Section> {
    let influence = found.diagnosis.as_ref()?.influence.as_ref()?;
    let mut blocks = vec![Block::Figure(influence_figure(influence))];
    let needed = influence.postures.iter().filter(|p| !p.lost.is_empty());
    let needed: Vec<Text> = needed
        .map(|p| {
            let lost: Vec<String> = p.lost.iter().map(|n| visible(n).into_owned()).collect();
            Text::new(format!(
                "Only posture {} shows {}.",
                visible(&p.posture),
                list(&lost)
            ))
        })
        .collect();
    if !needed.is_empty() {
        blocks.push(Block::List(needed));
    }
    Some(Section::new(
        "influence",
        "What hangs on single postures",
        blocks,
    ))
}

/// The next posture, and what it would give.
pub(super) fn next(joints: &Joints<'_>, found: &Identified) -> Option<Section> {
    let context = joints.context;
    let Some(advice) = &found.next_posture else {
        let reason = found.next_posture_missing.as_ref()?;
        let text = Text::new(format!("None can be given: {}", visible(reason)));
        return Some(Section::new(
            "next",
            "The next posture",
            vec![Block::Text(text)],
        ));
    };
    let text = angles(Text::new("q = "), context, advice.angles.len()).words(format!(
        ", measured as posture {} was, {} at the same points and in the same load states.",
        visible(&advice.measured_as),
        match advice.displacements {
            1 => "one displacement".to_string(),
            count => format!("{count} displacements"),
        }
    ));
    let mut table = DataTable::new(
        "Relative standard error of each joint's stiffness by the scatter of the readings [%]",
        ["joint", "now", "with it"],
    );
    for j in 0..joints.all().len() {
        let at = |key: &str| {
            let number = context.number(&format!("/next_posture/{key}/{j}"));
            Text::from(number.percent().bare().significant(3))
        };
        table.row(joints.name(j), [at("before"), at("after")]);
    }
    let mut blocks = vec![Block::Text(text)];
    if let Some(load) = &advice.assumed_load {
        blocks.push(Block::Text(Text::new(format!(
            "Assumed load: {:.0} N as the measured forces act.",
            load.magnitude_n
        ))));
    }
    blocks.push(Block::Table(table));
    Some(Section::new(
        "next",
        "One more posture that would help most",
        blocks,
    ))
}
