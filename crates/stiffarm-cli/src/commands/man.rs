//! `stiffarm man`: manual pages.

use crate::answer::Answer;
use crate::args;
use crate::args::Cli;
use crate::files::{Files, Said, check_folder};
use crate::output::Exit;
use crate::session::Session;
use clap::CommandFactory;
use clap_mangen::Man;
use stiffarm::{Code, Error, Result};

/// Prints the main page, or writes all pages.
pub fn run(session: &Session, args: &args::Man) -> Result<Answer> {
    let mut main = Cli::command();
    main.build();
    let Some(folder) = &args.output_dir else {
        return Ok(Answer::text(page(main)?));
    };
    let mut commands: Vec<clap::Command> =
        main.get_subcommands().filter(|c| !c.is_hide_set() && c.get_name() != "help").cloned().collect();
    commands.insert(0, main);
    let mut pages = Vec::with_capacity(commands.len());
    for command in commands {
        // Subcommands are called `stiffarm-check` in the manual.
        let name = command.get_display_name().unwrap_or(command.get_name()).to_string();
        pages.push((format!("{name}.1"), page(command)?));
    }
    let names = pages.iter().map(|(name, _)| name.as_str());
    check_folder(session, folder, names, args.force)?;
    let said = format!("{} pages written to {}", pages.len(), folder.display());
    let files = Files::folder(folder, pages, args.force).said(Said::Nothing);
    Ok(Answer::ended(Exit::Done).with(files.then(|| said)))
}

fn page(command: clap::Command) -> Result<String> {
    let mut text = Vec::new();
    let failed = |e: String| Error::new(Code::Internal, format!("The manual page cannot be made: {e}."));
    Man::new(command).render(&mut text).map_err(|e| failed(e.to_string()))?;
    String::from_utf8(text).map_err(|e| failed(e.to_string()))
}
