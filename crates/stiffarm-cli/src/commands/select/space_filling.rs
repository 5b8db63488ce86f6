//! `--space-filling`: postures that cover the joint space evenly, as a baseline.

use super::job::Job;
use crate::output::Exit;
use crate::progress::Progress;
use stiffarm::Result;
use stiffarm::ask::select::plan_space_filling;

/// Spreads the postures and writes plan and sheet.
pub(super) fn run(job: &Job<'_>) -> Result<Exit> {
    let planned = Progress::new(job.session, "spreading postures")
        .watch(|control| plan_space_filling(job.cell(), &job.args.options, control))?;
    job.deliver(&planned, &planned.result.findings)
}
