//! `stiffarm identify`: joint stiffness from measured displacements or raw readings.

mod clamped;

use crate::answer::Answer;
use crate::args;
use crate::files::only_target;
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use stiffarm::Result;
use stiffarm::ask::identify::Identified;
use stiffarm::estimate::identify::Fit;
use stiffarm::measure::prepare;
use stiffarm_files::source::{read_measurements, read_registration};

/// Identifies the joint stiffness.
pub fn run(session: &Session, args: &args::Identify) -> Result<Answer> {
    if args.options.clamped {
        return clamped::run(session, args);
    }
    let target = only_target(session, args.output.as_deref(), args.force)?;
    let named = session.read_cell(&args.cell)?;
    let request = &args.options;
    let options = request.options(&named.cell.setup.robot)?;
    let measurements = read_measurements(session, &args.measurements, args.postures.as_deref(), &named.cell)?;
    let reduce = read_registration(session, args.registration.as_deref())?;
    let mut measured = prepare(&named.cell, measurements, &reduce)?;
    measured.exclude(&request.exclude).map_err(|e| e.key("exclude"))?;
    let progress = Progress::new(session, "examining the identification");
    let fit = Fit::watched(&named.cell, measured, &options, progress.shared())?;
    let result = progress.watch(|control| Identified::new(&fit, request, control))?;
    drop(progress);

    let exit = if result.not_computed.is_empty() {
        Exit::finding(!result.is_complete() || result.is_serious())
    } else {
        Exit::Interrupted
    };
    let envelope = session.envelope("identify", Some(request.seed), request.clone(), result);
    Answer::summary(exit, envelope, named, args.details).with_object(target)
}
