//! `stiffarm select`: choose the postures to measure, the next ones, or those
//! to leave out. A file for each of these ways to work.

mod candidates;
mod curve;
mod drop;
mod job;
mod plan;
mod space_filling;

use crate::answer::Answer;
use crate::args;
use crate::output::Exit;
use crate::session::Session;
use job::{Job, Outputs};
use stiffarm::Result;

/// Selects, and writes what was asked for.
pub fn run(session: &Session, args: &args::Select) -> Result<Answer> {
    let outputs = Outputs::new(session, &args.output)?;
    let named = session.read_cell(&args.cell)?;
    outputs.check_states(&named.cell)?;
    let job = Job { session, args, named, outputs };
    let mut answer = if let Some(list) = &args.candidates {
        candidates::run(&job, list)?
    } else if args.options.space_filling {
        space_filling::run(&job)?
    } else if args.options.curve {
        curve::run(&job)?
    } else if let (Some(path), Some(count)) = (&args.given, args.options.drop) {
        drop::run(&job, path, count)?
    } else {
        plan::run(&job)?
    };
    if session.stopped() {
        answer.exit = Exit::Interrupted;
    }
    Ok(answer)
}
