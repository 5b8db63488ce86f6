//! `--candidates`: the best postures out of a list.

use super::certificate::efficient;
use super::job::{Job, shown, statistic, to_usize};
use super::table::told;
use crate::commands::{evaluate, posture_table};
use crate::numbers::counted;
use crate::progress::Progress;
use crate::screen::{columns, wrapped};
use crate::table::{title, yellow};
use stiffarm::files::source::Source;
use stiffarm::model::measurement::Candidate;
use stiffarm::model::posture::Posture;
use stiffarm::plan::planned::{CandidateRequest, Chosen, plan_candidates};
use stiffarm::plan::select::CandidateSelection;
use stiffarm::{Result, Termination};

/// Forbidden candidates that are named.
const FORBIDDEN: usize = 5;

/// Chooses, and writes plan and sheet.
pub(super) fn run(job: &Job<'_>, list: &str) -> Result<()> {
    let (candidates, measured) = job.session.read_candidates(list, job.cell())?;
    let mut request = CandidateRequest::default();
    request.index = job.index;
    request.postures = job.args.postures.map_or(request.postures, to_usize);
    request.seed = job.args.budget.seed.unwrap_or(request.seed);
    // The limits of a measured posture are the machine's, which held it.
    request.limits = !measured;
    request.certificate = !job.args.no_certificate;
    let progress = Progress::new(job.session, "choosing postures");
    let planned = progress.watch(|control| {
        let planned = plan_candidates(job.cell(), &candidates, &request, control)?;
        Ok(planned.with_forecast())
    })?;
    drop(progress);
    let (chosen, result) = (&planned.postures, &planned.result);
    job.deliver(&planned, || table(job, &candidates, chosen, result))
}

fn table(job: &Job<'_>, candidates: &[Candidate], chosen: &[Posture], result: &Chosen) -> String {
    let (cell, found) = (job.cell(), &result.selection);
    let mut out = job.heading();
    out += &evaluate::undetermined(std::slice::from_ref(&found.evaluation));
    out += &format!(
        "{} of {}{}: {}\n",
        counted(chosen.len(), "posture"),
        match candidates.len() {
            1 => "1 candidate".to_string(),
            count => format!("{count} candidates"),
        },
        match result.measured_wrenches {
            true => " under their measured wrenches",
            false => "",
        },
        result.posture_names.join(", ")
    );
    out += &format!(
        "index: {} = {}{}\n",
        found.index.as_str(),
        shown(found.index, found.value),
        statistic(found.index)
    );
    out += &certificate(found);
    if found.termination == Termination::Interrupted {
        out += "interrupted: the best so far\n";
    }
    let left_out = &found.forbidden;
    for own in left_out.iter().take(FORBIDDEN) {
        let name = &candidates[own.candidate].name;
        let sentence = format!(
            "{}: left out: candidate {name} {}",
            yellow("note"),
            own.because
        );
        out += &(wrapped(&sentence, columns()) + "\n");
    }
    if left_out.len() > FORBIDDEN {
        out += &format!(
            "{}: left out: {} further candidates outside bounds or limits\n",
            yellow("note"),
            left_out.len() - FORBIDDEN
        );
    }
    out += &told(&result.findings);
    out += &title("Postures");
    out += &posture_table(cell, chosen).to_string();
    let names = vec![result.posture_names.iter().map(String::as_str).collect()];
    out + &evaluate::tables(cell, std::slice::from_ref(&found.evaluation), &names)
}

/// How good any other group of the list could be.
fn certificate(found: &CandidateSelection) -> String {
    let (Some(bound), Some(efficiency)) = (found.bound, found.efficiency) else {
        return String::new();
    };
    if found.exact {
        return "certificate: no other group of this list is better\n".to_string();
    }
    let side = match found.index.larger_is_better() {
        true => "above",
        false => "below",
    };
    format!(
        "certificate: no group of this list can have {} {side} {}; this one is {} efficient\n",
        found.index.as_str(),
        shown(found.index, bound),
        efficient(efficiency)
    )
}
