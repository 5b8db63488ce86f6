//! `stiffarm simulate --elastic`: identifications of an arm that gives way beyond its
//! joint axes, with the axes alone and with the mixed model.

use crate::answer::Answer;
use crate::args;
use crate::files::{Files, only_target};
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use stiffarm::estimate::simulate::{simulate_elastic, simulate_elastic_measurements};
use stiffarm::{Code, Error, Result};
use stiffarm_files::source::read_groups;
use stiffarm_files::table::write_simulated;

/// Runs the simulation.
pub(super) fn run(session: &Session, args: &args::Simulate) -> Result<Answer> {
    let options = args.options.elastic_options()?;
    if args.readings.is_some() {
        let message = "Raw readings are simulated only for an arm of which the joint axes alone give way.";
        let error = Error::new(Code::Conflict, message).key("--readings");
        return Err(error.hint("write displacements with --measurements, or leave --elastic out"));
    }
    let target = only_target(session, args.measurements.as_deref(), args.force)?;
    let named = session.read_cell(&args.cell)?;
    let cell = &named.cell;
    let groups = read_groups(session, &args.postures, &cell.setup.robot)?;
    let result =
        Progress::new(session, "simulating").watch(|control| simulate_elastic(cell, &groups, &options, control))?;
    let mut files = None;
    if let Some(target) = target {
        let measured = simulate_elastic_measurements(cell, &groups[0].postures, args.options.seed)?;
        files = Some(Files::one(target, write_simulated(measured, cell)));
    }
    let exit = Exit::so_far(result.interrupted, &result.findings);
    let envelope = session.envelope("simulate", Some(args.options.seed), options, result);
    Ok(Answer::summary(exit, envelope, named, args.details).with(files))
}
