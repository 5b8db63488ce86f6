//! `stiffarm evaluate`: all indices and expected errors of given postures.

use crate::answer::Answer;
use crate::args;
use crate::output::Exit;
use crate::session::Session;
use stiffarm::Result;
use stiffarm::plan::characteristic_length::with_length;
use stiffarm::plan::evaluated::{Evaluated, EvaluatedOptions};
use stiffarm_files::source::read_groups;

/// Evaluates the groups.
pub fn run(session: &Session, args: &args::Evaluate) -> Result<Answer> {
    let named = session.read_cell(&args.cell)?;
    let groups = read_groups(session, &args.postures, &named.cell.setup.robot)?;
    let (cell, _) = with_length(named.cell.clone());
    let evaluated = Evaluated::new(&cell, &groups)?.with_forecast(&cell);
    let exit = Exit::of_findings(&evaluated.findings);
    let envelope = session.envelope("evaluate", None, EvaluatedOptions::of(&cell), evaluated);
    Ok(Answer::summary(exit, envelope, named, args.details))
}
