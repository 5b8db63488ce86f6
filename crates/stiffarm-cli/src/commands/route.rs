//! `stiffarm route`: the order of a plan's postures, and the moves between them.

use crate::answer::Answer;
use crate::args;
use crate::files::{Files, only_target};
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use stiffarm::Result;
use stiffarm::ask::route::Routed;
use stiffarm_files::source::read_postures;
use stiffarm_files::table::write_postures;

/// Finds the route of a plan.
pub fn run(session: &Session, args: &args::Route) -> Result<Answer> {
    let target = only_target(session, args.output.as_deref(), args.force)?;
    let named = session.read_cell(&args.cell)?;
    let (cell, options) = (&named.cell, &args.options);
    let plan = read_postures(session, "plan", &args.plan, &cell.setup.robot)?;
    let (result, stops) =
        Progress::new(session, "finding the route").watch(|control| Routed::new(cell, &plan, options, control))?;
    let table = target.map(|target| Files::one(target, write_postures(&stops)));
    let exit = Exit::of_findings(&result.findings);
    let envelope = session.envelope("route", Some(options.seed), options.clone(), result);
    Ok(Answer::summary(exit, envelope, named, args.details).with(table))
}
