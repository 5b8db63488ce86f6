//! How the model fits: what gives way beyond the axes, residuals against noise, errors that all readings share.

use super::basis::size;
use super::counted;
use crate::identified::{errors_figure, residual_figure};
use crate::level::level;
use crate::summary::{Block, DataTable, Number, Quantity, Section, Text};
use stiffarm::ask::identify::Identified;
use stiffarm::findings::visible;
use stiffarm::model::elastic::ElasticClass;

/// Postures whose residuals the table shows.
const SHOWN_RESIDUALS: usize = 5;
/// Displacements whose weights the table shows.
const SHOWN_WEIGHTS: usize = 10;

/// What gives way beyond the joint axes, where that was asked.
pub(super) fn elastic(identified: &Identified) -> Option<Section> {
    let elastic = identified.elastic.as_ref()?;
    let reasons = elastic.reasons.iter().map(|r| Text::from(r.as_str()));
    let mut blocks = vec![Block::List(reasons.collect())];
    if let Some(mixed) = &elastic.mixed {
        let caption = format!(
            "Joint stiffness if the axes alone gave way, with its {} % interval [{}]",
            level(identified.identification.estimates.confidence),
            Quantity::STIFFNESS.unit
        );
        let axis = |j: usize| &elastic.axes[j];
        let bare = Quantity::STIFFNESS.bare();
        let names = elastic.axes.iter().map(|j| visible(&j.name).into_owned());
        let table = DataTable::of(caption, "joint", names)
            .numbers("k", bare, |j| Some(Number::new(axis(j).stiffness)))
            .numbers("from", bare, |j| Some(Number::new(axis(j).interval[0])))
            .numbers("to", bare, |j| Some(Number::new(axis(j).interval[1])));
        let sizes = mixed.sizes.iter().map(|size| {
            let what = match size.class {
                ElasticClass::Shift => "shifts by forces",
                ElasticClass::Turn => "turns by moments",
                ElasticClass::Coupling => "shifts by moments",
                ElasticClass::Bearing => "bearings and base that tilt",
                ElasticClass::Beam => "links that bend and twist",
                ElasticClass::Drawing => "what a drawing knows",
            };
            let std = Number::computed(size.std).significant(2).plus_minus();
            format!("{what} {}", std.unit(size.class.unit()).text())
        });
        let sizes: Vec<String> = sizes.collect();
        let said = Text::new(format!(
            "Beyond the axes joints and base give way by: {}. k is the stiffness with which axes alone best reproduce \
             this arm over the cell under its load: the one for a calculation with joint stiffnesses alone.",
            sizes.join(", ")
        ));
        let both = vec![Block::Table(table), Block::Text(said)];
        blocks.push(Block::Details("The axes alone, and what else gives way".into(), both));
    }
    let title = "What gives way beyond the joint axes";
    let section = Section::new("elastic", title, blocks);
    // Where both models say the same, one of them is enough to read.
    if elastic.mixed.is_none() || elastic.is_better() { Some(section.in_summary()) } else { Some(section) }
}

/// Residuals against noise.
pub(super) fn residuals(identified: &Identified) -> Section {
    let identification = &identified.identification;
    let mm = |length: f64| Number::new(length).of(Quantity::LENGTH);
    let mut words = Text::new(match identified.mixed() {
        Some(_) => "Of the joint axes alone: residual RMS ",
        None => "Residual RMS ",
    })
    .number(mm(identification.residual_rms_m))
    .words(", beside a displacement RMS of ")
    .number(mm(identification.displacement_rms_m))
    .then(share(identification.residual_rms_m, identification.displacement_rms_m))
    .words(".");
    if identification.total_std_m.is_some() && identification.expected_std_m > 0.0 && identified.mixed().is_none() {
        words = words.words(
            " The verdict holds the standard deviation of the residuals against noise, not this RMS: it weighs each \
             displacement by its noise and counts the degrees of freedom that the fit has used up.",
        );
    }
    let mut blocks = vec![Block::Text(words)];
    if let (Some(sigma), Some(common)) = (identification.residual_std_m, identification.posture_common_std_m) {
        let sigma = mm(sigma);
        let text = if common > 0.0 {
            Text::new("Within a posture the displacements scatter by ")
                .number(sigma)
                .words("; what its points share (load, rope, drift, what the model misses) by ")
                .number(mm(common))
                .words(".")
        } else {
            Text::new("The displacements scatter by ")
                .number(sigma)
                .words("; nothing shows that the points of a posture share more than that.")
        };
        blocks.push(Block::Text(text));
    }
    blocks.push(Block::Figure(residual_figure(identification)));
    let (order, table) = largest(&identification.postures, |p| p.residual_rms_m, |p| [&p.posture, &p.state]);
    let posture = |row: usize| &identification.postures[order[row]];
    let influence = identified.diagnosis.as_ref().and_then(|d| d.influence.as_ref());
    let table = table
        .numbers("residual RMS", Quantity::LENGTH, |row| Some(Number::new(posture(row).residual_rms_m)))
        .numbers("displacement RMS", Quantity::LENGTH, |row| Some(Number::new(posture(row).displacement_rms_m)))
        .numbers("residual / displacement", Quantity::PERCENT, |row| {
            let posture_residual = posture(row);
            let moves = posture_residual.displacement_rms_m > 0.0;
            moves.then(|| Number::computed(posture_residual.residual_rms_m / posture_residual.displacement_rms_m))
        })
        .numbers("residual / mean", Quantity::RATIO, |row| {
            let mean = identification.residual_rms_m;
            (mean > 0.0).then(|| Number::computed(posture(row).residual_rms_m / mean))
        })
        .numbers("missed by the others", Quantity::LENGTH, |row| {
            let all = &influence?.postures;
            let of_posture = all.iter().find(|p| p.posture == posture(row).posture)?;
            of_posture.prediction_rms_m.map(Number::new)
        });
    blocks.push(Block::Table(table));
    Section::new("residuals", "Residuals against noise", blocks)
}

/// A residual as a part of what was measured, in brackets; empty where nothing moved.
pub(super) fn share(residual: f64, measured: f64) -> Text {
    if measured <= 0.0 {
        return Text::default();
    }
    let share = Number::computed(residual / measured);
    Text::new(" (").number(share.of(Quantity::PERCENT)).words(")")
}

/// Which postures and load states have the largest residuals, and a table with their names in the same order; `name`
/// gives posture and load state.
pub(super) fn largest<P>(
    all: &[P],
    residual: impl Fn(&P) -> f64,
    name: impl Fn(&P) -> [&String; 2],
) -> (Vec<usize>, DataTable) {
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|a, b| residual(&all[*b]).total_cmp(&residual(&all[*a])));
    order.truncate(SHOWN_RESIDUALS);
    let part = |row: usize, i: usize| visible(name(&all[order[row]])[i]).into_owned();
    let table = DataTable::of(
        "Postures and load states with the largest residuals",
        "posture",
        (0..order.len()).map(|row| part(row, 0)),
    )
    .words("load state", |row| part(row, 1).into());
    (order, table)
}

/// Systematic errors by source: size, what the readings leave of it, and what it does to each joint.
pub(super) fn errors(identified: &Identified) -> Option<Section> {
    let systematic = identified.systematic_errors.as_ref()?;
    let sources = &systematic.sources;
    // The last row holds all of them together.
    let names = sources.iter().map(|source| source.name.replace('-', " "));
    let names = names.chain(["all that is left".to_string()]);
    let source = |row: usize| sources.get(row);
    let mut table = DataTable::of(
        "Sources of systematic error: size as a standard uncertainty, how much of it the readings leave (100 %: they \
         say nothing of it, above: they look like more of it), and by how much the whole size changes each k",
        "source",
        names,
    )
    .words("size", |row| source(row).map(size).unwrap_or_default())
    .words("known from", |row| match source(row) {
        Some(source) if source.free || source.doubtful => "these readings".into(),
        Some(source) if source.name == "springs" => "both models".into(),
        Some(source) if source.declared => "the cell".into(),
        Some(_) => "assumed *".into(),
        None => Text::default(),
    })
    .numbers("left", Quantity::PERCENT.digits(3), |row| Some(Number::new(source(row)?.remaining)));
    for (j, joint) in systematic.joints.iter().enumerate() {
        table = table.numbers(&visible(joint), Quantity::PERCENT, |row| {
            let change = source(row).map_or(&systematic.combined, |source| &source.change);
            change.get(j).map(|change| Number::new(*change))
        });
    }
    let blocks = vec![Block::Figure(errors_figure(systematic)), Block::Table(table)];
    let title = "Systematic errors";
    Some(Section::new("errors", title, blocks))
}

/// Huber's smallest weights; `name` gives posture, load state and point.
pub(super) fn weights<W>(all: &[W], weight: impl Fn(&W) -> f64, name: impl Fn(&W) -> [&str; 3]) -> Option<Section> {
    if all.is_empty() {
        return None;
    }
    // They come sorted, the smallest first.
    let low = all.iter().take_while(|displacement| weight(displacement) < 1.0).count();
    let part = |row: usize, i: usize| visible(name(&all[row])[i]).into_owned();
    let shown = low.min(SHOWN_WEIGHTS);
    let table = DataTable::of(
        "The smallest weights of Huber's estimator; 1 counts fully",
        "posture",
        (0..shown).map(|row| part(row, 0)),
    )
    .words("state", |row| part(row, 1).into())
    .words("point", |row| part(row, 2).into())
    .numbers("weight", Quantity::RATIO.digits(2), |row| Some(Number::new(weight(&all[row]))));
    let text = Text::new(format!("{low} of {} count less than the others.", counted(all.len(), "displacement")));
    let mut blocks = vec![Block::Text(text)];
    if shown > 0 {
        blocks.push(Block::Table(table));
    }
    let title = "Displacements that count less";
    Some(Section::new("weights", title, blocks))
}
