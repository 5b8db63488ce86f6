//! What the stiffness rests on.

use super::findings::is_noted;
use super::shown;
use crate::order::in_order;
use crate::summary::{Block, Context, Form, Number, Quantity, Section, Text};
use stiffarm::ask::identify::Identified;
use stiffarm::estimate::identify::{Estimates, Estimator};
use stiffarm::estimate::systematic::SystematicSource;
use stiffarm::findings::list;
use stiffarm::model::cell::Cell;

/// What the numbers rest on: postures, estimator, assumed sizes, and what the intervals do not hold.
pub(super) fn section(context: &Context<'_>, identified: &Identified) -> Section {
    let identification = &identified.identification;
    let screening = identified.screening().into_iter().flat_map(|s| &s.findings);
    let reduction = identified.readings.iter().flat_map(|r| &r.reduction.findings);
    let noted = screening.chain(reduction).filter(|f| is_noted(f));
    let mut texts: Vec<Text> = noted.map(|f| f.sentence.clone().into()).collect();
    let several = identification.postures.iter().any(|p| p.residuals.len() > 1);
    let estimates = &identification.estimates;
    if let Some(cell) = context.cell {
        if several && estimates.degrees_of_freedom > 0 && estimates.independent_rows {
            texts.push(independent(cell, estimates.estimator));
        }
        let names = in_order(identification.postures.iter().map(|p| p.posture.as_str()));
        let is_validation = |name: &&str| cell.validation.iter().any(|v| v.name == *name);
        let validation_names: Vec<String> = names.into_iter().filter(is_validation).map(String::from).collect();
        let validation_names = shown(&validation_names);
        if !validation_names.is_empty() {
            let said = format!(
                "{} of the cell's [validation] took part in this identification; leave out with ",
                list(&validation_names)
            );
            let option = format!("--exclude {}", validation_names.join(","));
            texts.push(Text::new(said).code(option).words("."));
        }
    }
    let assumed = identified.systematic_errors.iter().flat_map(|systematic| &systematic.sources);
    let assumed = assumed.filter(|source| !source.declared);
    let sizes: Vec<String> =
        assumed.map(|source| format!("{} {}", source.name.replace('-', " "), size(source).plain())).collect();
    if !sizes.is_empty() {
        texts.push(Text::new(format!("* Assumed, not declared in [uncertainty]: {}.", list(&sizes))));
    }
    texts.push(estimator(estimates));
    Section::new("basis", "What it rests on", vec![Block::List(texts)]).in_summary()
}

/// How the stiffness comes from the readings.
pub(super) fn estimator(estimates: &Estimates) -> Text {
    let of = |count: usize| match count {
        1 => "1 degree of freedom".to_string(),
        count => format!("{count} degrees of freedom"),
    };
    let quantile = match estimates.interval_degrees_of_freedom {
        None => "the stated noise, normal quantiles".to_string(),
        Some(dof) => format!("t with {dof}"),
    };
    Text::new(format!(
        "Estimator: {}; {} left; {quantile}.",
        estimates.estimator.as_str(),
        of(estimates.degrees_of_freedom)
    ))
}

/// What a posture's points share and an estimator with independent rows ignores.
fn independent(cell: &Cell, estimator: Estimator) -> Text {
    let declared = cell.noise.posture_common_std;
    match estimator {
        Estimator::Weighted if declared > 0.0 => Text::new("The points of a posture share a shift of ")
            .number(Number::computed(declared).of(Quantity::LENGTH))
            .words(
                " by the cell's noise, and the intervals hold that. What else they share (the size of the load, \
                 geometry) is not in them.",
            ),
        Estimator::Ordinary | Estimator::Weighted | Estimator::Huber => Text::new(
            "The intervals take the errors of all displacements as independent. Where the points of a posture share \
             one (load, rope, drift) they are too narrow; ",
        )
        .code("--estimator two-variance")
        .words(" holds that."),
        _ => Text::new(
            "There are too few postures to tell what their points share: the intervals take the errors of all \
             displacements as independent, and are too narrow where they are not.",
        ),
    }
}

/// Size of a source of systematic error with its unit.
pub(super) fn size(source: &SystematicSource) -> Text {
    let (size, two) = (source.size, |unit, factor| Quantity::new(unit, factor, Form::Significant(2)));
    let quantity = match source.unit.as_str() {
        _ if source.free => return "identified".into(),
        "1" if source.name == "springs" => return "half".into(),
        // Places and turns together have no one size.
        "m, rad" => return "as asked".into(),
        "1" => Quantity::PERCENT,
        "N" => two("N", 1.0),
        "m" => two("mm", 1e3),
        "rad" if source.name == "lost-motion" => Quantity::GAP,
        "rad" => two("mrad", 1e3),
        // A compliance in the file, a stiffness to the reader.
        _ if size > 0.0 => {
            return Number::computed(1.0 / size).of(two("N·m/rad", 1.0)).into();
        }
        _ => return "rigid".into(),
    };
    Number::computed(size).of(quantity).into()
}

/// Postures that were left out, as a sentence behind another one; empty where there are none.
pub(super) fn left_out(excluded: &[String]) -> String {
    match excluded {
        [] => String::new(),
        names => format!(" Left out: {}.", list(&shown(names))),
    }
}
