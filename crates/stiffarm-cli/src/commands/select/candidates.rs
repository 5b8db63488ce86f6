//! `--candidates`: the best postures out of a list.

use super::job::Job;
use crate::answer::Answer;
use crate::numbers::to_usize;
use crate::output::Exit;
use crate::progress::Progress;
use stiffarm::Result;
use stiffarm::plan::planned::{CandidateRequest, plan_candidates};
use stiffarm_files::source::read_candidates;

/// Chooses, and writes plan and sheet.
pub(super) fn run(job: &Job<'_>, list: &str) -> Result<Answer> {
    let (candidates, measured) = read_candidates(job.session, list, job.cell())?;
    let mut request = CandidateRequest::default();
    request.index = job.index;
    request.postures = job.args.count.map_or(request.postures, to_usize);
    request.seed = job.args.budget.seed.unwrap_or(request.seed);
    // The limits of a measured posture are the machine's, which held it.
    request.limits = !measured;
    request.certificate = !job.args.no_certificate;
    let planned = Progress::new(job.session, "choosing postures").watch(|control| {
        let planned = plan_candidates(job.cell(), &candidates, &request, control)?;
        Ok(planned.with_forecast())
    })?;
    let exit = Exit::of_findings(&planned.result.findings);
    job.answer(planned, exit)
}
