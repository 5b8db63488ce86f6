//! `--candidates`: the best postures out of a list.

use super::job::Job;
use crate::answer::Answer;
use crate::output::Exit;
use crate::progress::Progress;
use stiffarm::Result;
use stiffarm::ask::select::plan_candidates;
use stiffarm_files::source::read_candidates;

/// Chooses, and writes plan and sheet.
pub(super) fn run(job: &Job<'_>, list: &str) -> Result<Answer> {
    let (candidates, measured) = read_candidates(job.session, list, job.cell())?;
    let options = &job.args.options;
    // The limits of a measured posture are the machine's, which held it.
    let planned = Progress::new(job.session, "choosing postures")
        .watch(|control| plan_candidates(job.cell(), &candidates, !measured, options, control))?;
    let exit = Exit::of_findings(&planned.result.findings);
    job.answer(planned, exit)
}
