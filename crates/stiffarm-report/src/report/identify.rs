//! The page of `identify`: what the result says, with the cell in 3D beside what the fit leaves.

use super::arrows;
use super::context::Context;
use crate::identified::in_order;
use crate::page::{Part, Section};
use crate::tell::{is_clamped, tell};
use stiffarm::Result;
use stiffarm::estimate::clamped::ClampedIdentification;
use stiffarm::estimate::identified::Identified;
use stiffarm::model::posture::{Posture, PostureGroup};

/// The part of a page for a result of `identify`.
pub(super) fn part(context: &Context<'_>) -> Result<Part> {
    let mut part = context.told(tell(&context.given())?);
    let cell = if is_clamped(context.saved) {
        clamped_cell(context, &context.saved.result()?)?
    } else {
        let found: Identified = context.saved.result()?;
        arrows::cell_section(context, &found)?
    };
    let residuals = part.sections.iter().position(|own| own.id == "residuals");
    let after = residuals.map_or(part.sections.len(), |at| at + 1);
    part.sections.splice(after..after, cell);
    Ok(part)
}

/// The postures in which the flange was held, where the result has their angles.
fn clamped_cell(context: &Context<'_>, found: &ClampedIdentification) -> Result<Option<Section>> {
    let of = |name: &str| {
        let own = found.postures.iter().find(|p| p.posture == name)?;
        (!own.angles.is_empty()).then(|| Posture {
            name: name.to_string(),
            q: own.angles.clone(),
        })
    };
    let names = in_order(found.postures.iter().map(|p| p.posture.as_str()));
    let postures: Option<Vec<Posture>> = names.into_iter().map(of).collect();
    let Some(postures) = postures else {
        return Ok(None);
    };
    let group = PostureGroup {
        name: "clamped".to_string(),
        postures,
    };
    let text = "The postures in which the flange was held, in their order. The load shown is the cell's own, not that of the \
                fixture.";
    context.cell_section(&[group], text).map(Some)
}
