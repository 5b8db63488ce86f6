//! `--space-filling`: postures that cover the joint space evenly, as a baseline.

use super::job::Job;
use crate::answer::Answer;
use crate::numbers::to_usize;
use crate::output::Exit;
use crate::progress::Progress;
use stiffarm::Result;
use stiffarm::plan::planned::{SpaceFillingRequest, plan_space_filling};

/// Spreads the postures and writes plan and sheet.
pub(super) fn run(job: &Job<'_>) -> Result<Answer> {
    let mut request = SpaceFillingRequest::default();
    request.postures = job.args.count.map_or(request.postures, to_usize);
    request.seed = job.args.budget.seed.unwrap_or(request.seed);
    request.angle_step_deg = job.angle_step();
    let planned = Progress::new(job.session, "spreading postures")
        .watch(|control| plan_space_filling(job.cell(), &request, control))?;
    let exit = Exit::of_findings(&planned.result.findings);
    job.answer(planned, exit)
}
