//! `stiffarm select`: choose the postures to measure, the next ones, or those
//! to leave out. A file for each of these ways to work.

mod candidates;
mod curve;
mod drop;
mod job;
mod load;
mod plan;
mod space_filling;

use crate::answer::Answer;
use crate::args::SelectArgs;
use crate::output::Exit;
use crate::session::Session;
use job::{Job, Outputs};
use stiffarm::Result;
use stiffarm::plan::index::Index;

/// Selects, and writes what was asked for.
pub fn run(session: &Session, args: &SelectArgs) -> Result<Answer> {
    let index = match &args.index {
        Some(name) => Index::from_name(name)?,
        // That index counts one load, which is known.
        None if !load::design(&args.load).is_empty() => Index::ExpectedError,
        None => Index::Prediction,
    };
    let outputs = Outputs::new(session, &args.output)?;
    let named = session.read_cell(&args.cell)?;
    outputs.check_states(&named.cell)?;
    let job = Job {
        session,
        args,
        index,
        named,
        outputs,
    };
    let mut answer = if let Some(list) = &args.candidates {
        candidates::run(&job, list)?
    } else if args.space_filling {
        space_filling::run(&job)?
    } else if args.curve {
        curve::run(&job)?
    } else if let (Some(given), Some(count)) = (&args.existing.given, args.existing.drop) {
        drop::run(&job, given, count)?
    } else {
        plan::run(&job)?
    };
    if session.stopped() {
        answer.exit = Exit::Interrupted;
    }
    Ok(answer)
}
