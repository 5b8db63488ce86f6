//! `--space-filling`: postures that cover the joint space evenly, as a baseline.

use super::job::Job;
use crate::answer::Answer;
use crate::output::Exit;
use crate::progress::Progress;
use stiffarm::Result;
use stiffarm::ask::select::plan_space_filling;

/// Spreads the postures and writes plan and sheet.
pub(super) fn run(job: &Job<'_>) -> Result<Answer> {
    let planned = Progress::new(job.session, "spreading postures")
        .watch(|control| plan_space_filling(job.cell(), &job.args.options, control))?;
    let exit = Exit::of_findings(&planned.result.findings);
    job.answer(planned, exit)
}
