//! A plan: from a global search, from an initial group, or beside given postures.

use super::job::Job;
use super::load;
use crate::answer::Answer;
use crate::numbers::to_usize;
use crate::output::Exit;
use crate::progress::Progress;
use std::time::Duration;
use stiffarm::plan::planned::{PlanRequest, plan};
use stiffarm::units::min_to_s;
use stiffarm::{Error, Result};
use stiffarm_files::source::read_postures;

/// Selects, bounds and examines the plan, and writes plan and sheet.
pub(super) fn run(job: &Job<'_>) -> Result<Answer> {
    let request = request(job)?;
    let progress = Progress::new(job.session, "selecting postures");
    let planned = progress.watch(|control| {
        let mut watch = |stage| job.tell(&progress, stage);
        Ok(plan(job.cell(), &request, &mut watch, control)?.with_forecast())
    })?;
    drop(progress);
    let exit = Exit::of_findings(&planned.result.findings);
    job.answer(planned, exit)
}

/// What the command line asks for.
fn request(job: &Job<'_>) -> Result<PlanRequest> {
    let (session, args) = (job.session, job.args);
    let robot = &job.cell().setup.robot;
    let read = |role: &str, from: &Option<String>| {
        from.as_deref()
            .map(|from| read_postures(session, role, from, robot))
            .transpose()
    };
    let mut request = PlanRequest::default();
    request.index = job.index;
    request.initial = read("initial", &args.existing.initial)?;
    request.given = read("given", &args.existing.given)?.unwrap_or_default();
    let count = match args.existing.given {
        Some(_) => Some(args.existing.add.unwrap_or(1)),
        None => args.count,
    };
    request.postures = count.map_or(request.postures, to_usize);
    request.measuring_time = args.minutes.map(measuring_time).transpose()?;
    request.repeats = args.repeats;
    let iterations = args.existing.max_iterations;
    request.max_iterations = iterations.unwrap_or(request.max_iterations);
    request.rounds = args.budget.rounds;
    request.time_limit = args.budget.time_limit;
    request.seed = args.budget.seed.unwrap_or(request.seed);
    request.angle_step_deg = job.angle_step();
    request.load = load::design(&args.load);
    request.accept = session.host.accept.clone();
    request.certificate = !args.no_certificate;
    request.sensitivity = args.sensitivity;
    request.prices = args.prices;
    Ok(request)
}

/// Minutes as a time.
fn measuring_time(minutes: f64) -> Result<Duration> {
    Duration::try_from_secs_f64(min_to_s(minutes))
        .map_err(|_| Error::invalid("The number is too large.").key("--minutes"))
}
