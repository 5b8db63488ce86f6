//! A plan: from a global search, from an initial group, or beside given postures.

use super::job::Job;
use crate::answer::Answer;
use crate::output::Exit;
use crate::progress::Progress;
use stiffarm::Result;
use stiffarm::ask::select::{SelectInputs, plan};
use stiffarm_files::source::read_postures;

/// Selects, bounds and examines the plan, and writes plan and sheet.
pub(super) fn run(job: &Job<'_>) -> Result<Answer> {
    let (session, args) = (job.session, job.args);
    let robot = &job.cell().setup.robot;
    let read = |role: &str, from: &Option<String>| {
        from.as_deref().map(|from| read_postures(session, role, from, robot)).transpose()
    };
    let mut inputs = SelectInputs::default();
    inputs.initial = read("initial", &args.initial)?;
    inputs.given = read("given", &args.given)?.unwrap_or_default();
    inputs.accept = session.host.accept.clone();
    let progress = Progress::new(session, "selecting postures");
    let planned = progress.watch(|control| {
        let mut watch = |stage| job.show(&progress, stage);
        plan(job.cell(), &inputs, &args.options, &mut watch, control)
    })?;
    drop(progress);
    let exit = Exit::of_findings(&planned.result.findings);
    job.answer(planned, exit)
}
