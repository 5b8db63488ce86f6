//! The page of `identify`: which joints are known to what ±, and what to do next.

mod arrows;
mod clamped;
mod joints;
mod readings;
mod sections;
mod story;
mod warnings;

pub(super) use arrows::{Residuals, residual_section};

use super::context::Context;
use crate::page::{Outcome, Part, Section};
use joints::Joints;
use stiffarm::Result;
use stiffarm::estimate::clamped::ClampedIdentification;
use stiffarm::estimate::identified::Identified;
use stiffarm::estimate::identify::implausible_scale;
use stiffarm::findings::Severity;

/// The part of a page for a result of `identify`.
pub(super) fn part(context: &Context<'_>) -> Result<Part> {
    if context.saved.json["result"].get("motor_rms_rad").is_some() {
        let found: ClampedIdentification = context.saved.result()?;
        return clamped::part(context, &found);
    }
    let mut found: Identified = context.saved.result()?;
    found.hold_all_errors();
    // A scale that no screening could name, where the cell is at hand.
    let named = found
        .screening()
        .is_some_and(|s| s.scales().next().is_some());
    let implausible = context.cell.filter(|_| !named);
    let implausible = implausible.and_then(|cell| implausible_scale(cell, &found.identification));
    let serious = context
        .saved
        .findings()
        .into_iter()
        .chain(implausible.clone());
    let mut serious: Vec<_> = serious
        .filter(|f| f.severity == Severity::Serious)
        .collect();
    warnings::sort(&mut serious, &found);
    let joints = Joints {
        context,
        estimates: &found.identification.estimates,
        budget: found.budget.as_ref(),
        serious: !serious.is_empty(),
    };
    let came = match serious.as_slice() {
        [] => story::came(&joints, &found),
        [first, rest @ ..] => story::unusable(first, rest.len()),
    };
    let verdict = [
        story::done(context, &found),
        came,
        story::next(&joints, &found),
    ];
    let cell = arrows::cell_section(context, &found)?;
    let mut all: Vec<Option<Section>> = Vec::new();
    // What is wrong with the readings comes first where something is.
    let readings = readings::section(context, &found);
    let suspicious = found.screening().is_some_and(|s| !s.suspicions.is_empty());
    let mut readings = Some(readings);
    if suspicious {
        all.push(readings.take().flatten());
    }
    all.push(Some(sections::stiffness(&joints, &found)));
    all.push(sections::elastic(context, &found));
    all.push(Some(sections::residuals(context, &found)));
    all.push(cell);
    all.push(readings.flatten());
    all.push(sections::errors(context, &found));
    all.push(sections::together(context, &found));
    all.push(sections::states(context, &found));
    all.push(sections::influence(context, &found));
    all.push(sections::next(&joints, &found));
    let sections = all.into_iter().flatten().collect();
    let heading = "Joint stiffness from measurements".to_string();
    let mut part = context.part(heading, verdict, Some(joints.key()), sections);
    part.warnings.extend(implausible);
    part.warnings.extend(warnings::no_budget(context, &found));
    warnings::sort(&mut part.warnings, &found);
    part.outcome = joints.outcome(Outcome::of(&part.warnings));
    let held_back = warnings::held_back(&mut part.warnings, &found);
    part.sections.extend(held_back);
    Ok(part)
}
