//! `--drop`: which given postures are least worth their measuring time.

use super::job::Job;
use crate::answer::Answer;
use crate::output::Exit;
use crate::progress::{Progress, announce};
use stiffarm::Result;
use stiffarm::ask::select::plan_drop;
use stiffarm::plan::select::drop_evaluations;
use stiffarm_files::source::read_postures;

/// From so many groups on, their number is said before they are evaluated.
const EVALUATIONS: usize = 10_000;

/// Compares the ways to leave postures out and writes those that stay.
pub(super) fn run(job: &Job<'_>, path: &str, count: usize) -> Result<Answer> {
    let robot = &job.cell().setup.robot;
    let postures = read_postures(job.session, "given", path, robot)?;
    if count < postures.len() {
        let groups = drop_evaluations(postures.len(), count);
        announce(job.session, groups, EVALUATIONS, "groups to evaluate");
    }
    let planned = Progress::new(job.session, "leaving postures out")
        .watch(|control| plan_drop(job.cell(), &postures, &job.args.options, control))?;
    let exit = Exit::of_findings(&planned.result.findings);
    job.answer(planned, exit)
}
