//! `stiffarm completions`.

use crate::answer::Answer;
use crate::args;
use crate::args::Cli;
use clap::CommandFactory;
use stiffarm::{Code, Error, Result};

/// Prints the completions of one shell.
pub fn run(args: &args::Completions) -> Result<Answer> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "stiffarm", &mut script);
    let script = String::from_utf8(script).map_err(|_| Error::new(Code::Internal, "The completions are not text."))?;
    Ok(Answer::text(script))
}
