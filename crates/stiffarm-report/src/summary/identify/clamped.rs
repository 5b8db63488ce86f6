//! What `identify --clamped` says: the flange fixed, angles instead of displacements.

use super::basis::{estimator, left_out};
use super::joints::{Joints, is_within};
use super::story::certainty;
use super::{counted, findings, fit, stiffness};
use crate::identified::clamped_residual_figure;
use crate::order::in_order;
use crate::summary::{Block, Context, DataTable, Number, Outcome, Quantity, Section, Summarise, Summary, Text};
use stiffarm::Result;
use stiffarm::ask::identify::IdentifiedOptions;
use stiffarm::estimate::clamped::ClampedIdentification;
use stiffarm::findings::{Severity, visible};
use stiffarm::model::posture::{Posture, PostureGroup};

impl Summarise<IdentifiedOptions> for ClampedIdentification {
    fn summary(&self, options: &IdentifiedOptions, context: &Context<'_>) -> Result<Summary> {
        let identification = self;
        let estimates = &identification.estimates;
        let joints = Joints {
            context,
            estimates,
            systematic_errors: None,
            unusable: identification.findings.iter().any(|f| f.severity == Severity::Serious),
        };
        let postures = in_order(identification.postures.iter().map(|p| p.posture.as_str()));
        let what_was_done = Text::new(format!(
            "With the flange fixed, the stiffness of {} joints was identified from motor angles and wrenches at {} in \
         {} ({} combinations of angles), without a tracker.{}",
            estimates.joints.len(),
            counted(postures.len(), "posture"),
            counted(identification.postures.len(), "load state"),
            estimates.rows,
            left_out(&options.exclude)
        ));
        let mdeg = |angle: f64| Number::new(angle).of(Quantity::AXIS);
        let conclusion = certainty(&joints)
            .words(" The fit leaves ")
            .number(mdeg(identification.residual_rms_rad))
            .words(" of angles of ")
            .number(mdeg(identification.motor_rms_rad))
            .then(fit::share(identification.residual_rms_rad, identification.motor_rms_rad))
            .words(" that the flange holds (RMS).");
        let missing = joints.of(|verdict| !is_within(verdict));
        let next_step = match (joints.unusable, missing.is_empty()) {
            (true, _) => Text::default().strong("Settle what is marked serious first").words(", then identify again."),
            (_, false) => {
                Text::new("Push in other directions or postures to show ").strong(joints.names(&missing)).words(".")
            }
            _ => Text::new("The ± holds the scatter of the angles alone. Compare with displacements under load: ")
                .code("stiffarm validate")
                .words(" with the flange free shows what the fixture and friction have changed."),
        };
        let weights = fit::weights(&identification.weights, |w| w.weight, |w| [&w.posture, &w.state, ""]);
        // What no interval shows stands in the summary.
        let (notes, more): (Vec<_>, Vec<_>) =
            identification.findings.iter().cloned().partition(|finding| finding.severity == Severity::Note);
        let mut basis: Vec<Text> = notes.into_iter().map(|f| f.sentence.into()).collect();
        basis.push(estimator(estimates));
        let basis = Section::new("basis", "What it rests on", vec![Block::List(basis)]);
        let sections = [
            Some(stiffness::section(&joints, &identification.prior_stiffness)),
            stiffness::further(&joints),
            Some(residuals(identification)),
            cell_section(context, identification)?,
            friction(identification),
            stiffness::together(&joints),
            weights,
            Some(basis.in_summary()),
        ];
        let mut all = estimates.findings();
        all.extend(more);
        findings::sort(&mut all);
        Ok(Summary {
            heading: "Joint stiffness with the flange fixed".to_string(),
            outcome: joints.outcome(Outcome::of(&all)),
            verdict: [what_was_done, conclusion, next_step],
            findings: all,
            key: Some(joints.key()),
            sections: sections.into_iter().flatten().collect(),
        })
    }
}

/// Residual angles, the largest first.
fn residuals(identification: &ClampedIdentification) -> Section {
    let (order, table) = fit::largest(&identification.postures, |p| p.residual_rms_rad, |p| [&p.posture, &p.state]);
    let posture = |row: usize| &identification.postures[order[row]];
    let table = table
        .numbers("residual RMS", Quantity::AXIS, |row| Some(Number::new(posture(row).residual_rms_rad)))
        .numbers("angle RMS", Quantity::AXIS, |row| Some(Number::new(posture(row).motor_rms_rad)))
        .numbers("residual / mean", Quantity::RATIO, |row| {
            let mean = identification.residual_rms_rad;
            (mean > 0.0).then(|| Number::computed(posture(row).residual_rms_rad / mean))
        });
    let blocks = vec![Block::Figure(clamped_residual_figure(identification)), Block::Table(table)];
    Section::new("residuals", "Residuals", blocks)
}

/// Friction, where loads went up and down.
fn friction(identification: &ClampedIdentification) -> Option<Section> {
    let joint = |j: usize| &identification.friction[j];
    let table = DataTable::of(
        "Half of the loop of each joint, and the torque that would hold it",
        "joint",
        identification.friction.iter().map(|joint| visible(&joint.joint).into_owned()),
    )
    .numbers("half loop", Quantity::AXIS, |j| Some(Number::new(joint(j).half_loop_rad)))
    .numbers("friction", Quantity::TORQUE, |j| Some(Number::new(joint(j).torque_nm)))
    .numbers("torque RMS", Quantity::TORQUE, |j| Some(Number::new(joint(j).load_rms_nm)))
    .words("pairs", |j| joint(j).pairs.to_string().into());
    let section = Section::new("friction", "Loads going up and down", vec![Block::Table(table)]);
    (!identification.friction.is_empty()).then(|| section.in_summary())
}

/// The postures in which the flange was held, where the result has their angles.
fn cell_section(context: &Context<'_>, identification: &ClampedIdentification) -> Result<Option<Section>> {
    let of = |name: &str| {
        let posture = identification.postures.iter().find(|p| p.posture == name)?;
        (!posture.angles.is_empty()).then(|| Posture { name: name.to_string(), q: posture.angles.clone() })
    };
    let names = in_order(identification.postures.iter().map(|p| p.posture.as_str()));
    let postures: Option<Vec<Posture>> = names.into_iter().map(of).collect();
    let Some(postures) = postures else {
        return Ok(None);
    };
    let group = PostureGroup { name: "clamped".to_string(), postures };
    let text = "The postures in which the flange was held, in their order. The load shown is the cell's own, not that \
                of the fixture.";
    context.cell_section(&[group], text).map(Some)
}
