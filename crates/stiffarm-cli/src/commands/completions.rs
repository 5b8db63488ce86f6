//! `stiffarm completions`.

use crate::args::{Cli, CompletionsArgs};
use crate::output::Exit;
use crate::session::Session;
use clap::CommandFactory;
use stiffarm::{Code, Error, Result};

/// Prints the completions of one shell.
pub fn run(session: &Session, args: &CompletionsArgs) -> Result<Exit> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "stiffarm", &mut script);
    let script = String::from_utf8(script)
        .map_err(|_| Error::new(Code::Internal, "The completions are not text."))?;
    session.print_exact(&script)?;
    Ok(Exit::Done)
}
