//! `stiffarm coverage`: how often the intervals of `identify` hold the truth, counted in simulated experiments.

use crate::answer::Answer;
use crate::args;
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use stiffarm::Result;
use stiffarm::estimate::coverage::coverage;
use stiffarm_files::source::read_postures;

/// Counts.
pub fn run(session: &Session, args: &args::Coverage) -> Result<Answer> {
    let named = session.read_cell(&args.cell)?;
    let case = args.options.case(&named.cell)?;
    let robot = &named.cell.setup.robot;
    let postures = read_postures(session, "postures", &args.postures, robot)?;
    let coverage =
        Progress::new(session, "counting").watch(|control| coverage(&named.cell, &postures, &case, control))?;
    let exit = Exit::of_findings(&coverage.findings);
    let envelope = session.envelope("coverage", Some(case.seed), args.options.clone(), coverage);
    Ok(Answer::summary(exit, envelope, named, false))
}
