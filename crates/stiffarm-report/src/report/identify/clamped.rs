//! The page of `identify --clamped`: the flange fixed, angles instead of displacements.

use super::joints::{Joints, is_within};
use super::sections::{stiffness_section, together_section};
use super::story::known;
use crate::identified::{clamped_residual_figure, in_order};
use crate::page::{Block, DataTable, Part, Section, Text};
use crate::report::context::Context;
use stiffarm::Result;
use stiffarm::estimate::clamped::ClampedIdentification;
use stiffarm::findings::{Severity, visible};
use stiffarm::model::posture::{Posture, PostureGroup};
use stiffarm::units::rad_to_deg;

/// The part of a page.
pub(super) fn part(context: &Context<'_>, found: &ClampedIdentification) -> Result<Part> {
    let findings = context.saved.findings();
    let joints = Joints {
        context,
        estimates: &found.estimates,
        budget: None,
        serious: findings.iter().any(|f| f.severity == Severity::Serious),
    };
    let names = in_order(found.postures.iter().map(|p| p.posture.as_str()));
    let done = Text::new(format!(
        "With the flange fixed, the stiffness of {} joints was identified from motor angles and wrenches at {} postures in \
         {} load states, without a tracker.",
        found.estimates.joints.len(),
        names.len(),
        found.postures.len()
    ));
    // Thousandths of a degree, in which such angles are a few.
    let mdeg = |below: &str| {
        let number = context.number(below).times(1e3 * rad_to_deg(1.0));
        number.unit("mdeg").significant(3)
    };
    let came = known(&joints)
        .words(" The fit leaves ")
        .number(mdeg("/residual_rms_rad"))
        .words(" of angles of ")
        .number(mdeg("/motor_rms_rad"))
        .words(" (RMS).");
    let missing = joints.of(|verdict| !is_within(verdict));
    let next = match (joints.serious, missing.is_empty()) {
        (true, _) => Text::default()
            .strong("Settle what is marked serious first")
            .words(", then identify again."),
        (_, false) => Text::new("Push in other directions or postures to show ")
            .strong(joints.names(&missing))
            .words("."),
        _ => Text::new(
            "The ± holds the scatter of the angles alone. Compare with displacements under load: ",
        )
        .code("stiffarm validate")
        .words(" with the flange free shows what the fixture and friction have changed."),
    };
    let mut residuals = vec![Block::Figure(clamped_residual_figure(found))];
    residuals.extend(friction(context, found).map(Block::Table));
    let mut sections = vec![
        stiffness_section(&joints, &found.prior_stiffness),
        Section::new("residuals", "What the fit leaves", residuals),
    ];
    sections.extend(cell(context, found, &names)?);
    sections.extend(together_section(context, &found.estimates));
    let heading = "Joint stiffness with the flange fixed".to_string();
    let verdict = [done, came, next];
    let mut part = context.part(heading, verdict, Some(joints.key()), sections);
    part.outcome = joints.outcome(part.outcome);
    Ok(part)
}

/// Friction, where loads went up and down.
fn friction(context: &Context<'_>, found: &ClampedIdentification) -> Option<DataTable> {
    let mut table = DataTable::new(
        "Loads going up and down: half of the loop of each joint, and the torque that would hold it",
        [
            "joint",
            "half loop [mdeg]",
            "friction [N·m]",
            "torque RMS [N·m]",
        ],
    );
    for (i, joint) in found.friction.iter().enumerate() {
        let at = |key: &str| context.number(&format!("/friction/{i}/{key}"));
        let cells = [
            at("half_loop_rad")
                .times(1e3 * rad_to_deg(1.0))
                .significant(3)
                .into(),
            at("torque_nm").significant(3).into(),
            at("load_rms_nm").significant(3).into(),
        ];
        table.row(visible(&joint.joint).into_owned(), cells);
    }
    (!found.friction.is_empty()).then_some(table)
}

/// The postures in the cell, where the result has their angles.
fn cell(
    context: &Context<'_>,
    found: &ClampedIdentification,
    names: &[&str],
) -> Result<Option<Section>> {
    let of = |name: &&str| {
        let own = found.postures.iter().find(|p| p.posture == *name)?;
        (!own.angles.is_empty()).then(|| Posture {
            name: (*name).to_string(),
            q: own.angles.clone(),
        })
    };
    let Some(postures) = names.iter().map(of).collect::<Option<Vec<Posture>>>() else {
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
