//! What `identify` says: which joints are known to what ±, what stands in the way, and what to do next.

mod basis;
mod clamped;
mod experiment;
mod findings;
mod fit;
mod joints;
pub(super) mod readings;
mod stiffness;
mod story;

pub(super) use story::MORE_THAN_NOISE;

use super::{Context, Outcome, Summarise, Summary, WithCell, arrows, counted, of_saved, shown};
use joints::Joints;
use stiffarm::Result;
use stiffarm::ask::identify::{Identified, IdentifiedOptions};
use stiffarm::estimate::clamped::ClampedIdentification;
use stiffarm::findings::{Severity, codes};

/// What a result of `identify` says.
pub(super) fn summary(with: &WithCell<'_>) -> Result<Summary> {
    // With the flange fixed motors are read.
    if with.saved.json["result"].get("motor_rms_rad").is_some() {
        return of_saved::<ClampedIdentification, IdentifiedOptions>(with);
    }
    of_saved::<Identified, IdentifiedOptions>(with)
}

impl Summarise<IdentifiedOptions> for Identified {
    fn summary(&self, options: &IdentifiedOptions, context: &Context<'_>) -> Result<Summary> {
        let identified = self;
        let findings = findings::of(options, identified);
        let is_serious = |f: &&stiffarm::findings::Finding| f.severity == Severity::Serious;
        let of_data: Vec<_> = findings.data.iter().filter(is_serious).collect();
        let joints = Joints {
            context,
            estimates: &identified.identification.estimates,
            systematic_errors: identified.systematic_errors.as_ref(),
            unusable: !of_data.is_empty(),
        };
        let conclusion = match of_data.as_slice() {
            [] => story::conclusion(options, &joints, identified),
            [first, rest @ ..] => story::unusable(first, rest.len()),
        };
        let verdict =
            [story::what_was_done(options, identified), conclusion, story::next_step(options, &joints, identified)];
        let readings = readings::section(identified.screening(), identified.readings.as_ref());
        // What is wrong with the readings comes first where something is.
        let suspicious = identified.screening().is_some_and(|s| !s.suspicions.is_empty());
        let (first, later) = if suspicious { (readings, None) } else { (None, readings) };
        let sections = [
            first,
            Some(stiffness::section(&joints, &identified.identification.prior_stiffness)),
            stiffness::further(&joints),
            fit::elastic(identified),
            Some(fit::residuals(identified)),
            arrows::cell_section(context, identified)?,
            later,
            fit::errors(identified),
            stiffness::together(&joints),
            stiffness::resampled(identified),
            experiment::states(identified),
            experiment::signals(identified),
            experiment::influence(identified),
            experiment::terms(identified),
            fit::weights(&identified.identification.weights, |w| w.weight, |w| [&w.posture, &w.state, &w.point]),
            experiment::next_step(&joints, identified),
            findings.held_back,
            Some(basis::section(context, identified)),
        ];
        let mut all = joints.estimates.findings();
        // It follows from a set-up that is rejected.
        let is_rejected = identified.rejected().is_some();
        all.retain(|f| !(is_rejected && f.code == codes::NEGATIVE_COMPLIANCE));
        all.extend(findings.data);
        findings::sort(&mut all);
        Ok(Summary {
            heading: "Joint stiffness from measurements".to_string(),
            outcome: joints.outcome(Outcome::of(&all)),
            verdict,
            findings: all,
            key: Some(joints.key()),
            sections: sections.into_iter().flatten().collect(),
        })
    }
}
