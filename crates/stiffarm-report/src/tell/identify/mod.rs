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

use super::{Given, Outcome, Telling, Told, WithCell, arrows, counted, of_saved, shown};
use joints::Joints;
use stiffarm::Result;
use stiffarm::ask::identify::{Identified, IdentifiedOptions};
use stiffarm::estimate::clamped::ClampedIdentification;
use stiffarm::findings::{Severity, codes};

/// What a result of `identify` says.
pub(super) fn told(with: &WithCell<'_>) -> Result<Told> {
    // With the flange fixed motors are read.
    if with.saved.json["result"].get("motor_rms_rad").is_some() {
        return of_saved::<ClampedIdentification, IdentifiedOptions>(with);
    }
    of_saved::<Identified, IdentifiedOptions>(with)
}

impl Telling<IdentifiedOptions> for Identified {
    fn told(&self, options: &IdentifiedOptions, given: &Given<'_>) -> Result<Told> {
        let found = self;
        let findings = findings::of(options, found);
        let is_serious = |f: &&stiffarm::findings::Finding| f.severity == Severity::Serious;
        let of_data: Vec<_> = findings.data.iter().filter(is_serious).collect();
        let joints = Joints {
            given,
            estimates: &found.identification.estimates,
            systematic_errors: found.systematic_errors.as_ref(),
            unusable: !of_data.is_empty(),
        };
        let came = match of_data.as_slice() {
            [] => story::came(options, &joints, found),
            [first, rest @ ..] => story::unusable(first, rest.len()),
        };
        let verdict = [story::done(options, found), came, story::next(options, &joints, found)];
        let readings = readings::section(found.screening(), found.readings.as_ref());
        // What is wrong with the readings comes first where something is.
        let suspicious = found.screening().is_some_and(|s| !s.suspicions.is_empty());
        let (first, later) = if suspicious { (readings, None) } else { (None, readings) };
        let sections = [
            first,
            Some(stiffness::section(&joints, &found.identification.prior_stiffness)),
            stiffness::further(&joints),
            fit::elastic(found),
            Some(fit::residuals(found)),
            arrows::cell_section(given, found)?,
            later,
            fit::errors(found),
            stiffness::together(&joints),
            stiffness::resampled(found),
            experiment::states(found),
            experiment::signals(found),
            experiment::influence(found),
            experiment::terms(found),
            fit::weights(&found.identification.weights, |w| w.weight, |w| [&w.posture, &w.state, &w.point]),
            experiment::next(&joints, found),
            findings.held_back,
            Some(basis::section(given, found)),
        ];
        let mut all = joints.estimates.findings();
        // It follows from a set-up that is rejected.
        let is_rejected = found.rejected().is_some();
        all.retain(|f| !(is_rejected && f.code == codes::NEGATIVE_COMPLIANCE));
        all.extend(findings.data);
        findings::sort(&mut all);
        Ok(Told {
            heading: "Joint stiffness from measurements".to_string(),
            outcome: joints.outcome(Outcome::of(&all)),
            verdict,
            findings: all,
            key: Some(joints.key()),
            sections: sections.into_iter().flatten().collect(),
        })
    }
}
