//! `stiffarm man`: manual pages.

use crate::args::{Cli, ManArgs};
use crate::files::{make_folder, write_all};
use crate::output::Exit;
use crate::session::Session;
use crate::target::Target;
use clap::CommandFactory;
use clap_mangen::Man;
use stiffarm::{Code, Error, Result};

/// Prints the main page, or writes all pages.
pub fn run(session: &Session, args: &ManArgs) -> Result<Exit> {
    let mut main = Cli::command();
    main.build();
    let Some(folder) = &args.output_dir else {
        session.print_exact(&page(main)?)?;
        return Ok(Exit::Done);
    };
    make_folder(folder)?;
    let mut commands: Vec<clap::Command> = main
        .get_subcommands()
        .filter(|c| !c.is_hide_set() && c.get_name() != "help")
        .cloned()
        .collect();
    commands.insert(0, main);
    let mut pages = Vec::with_capacity(commands.len());
    for command in commands {
        // Subcommands are called `stiffarm-check` in the manual.
        let name = command
            .get_display_name()
            .unwrap_or(command.get_name())
            .to_string();
        let file = folder.join(format!("{name}.1"));
        pages.push((Target::file(&file, args.force)?, page(command)?));
    }
    write_all(session, &pages)?;
    session.remark(&format!(
        "{} pages written to {}",
        pages.len(),
        folder.display()
    ));
    Ok(Exit::Done)
}

fn page(command: clap::Command) -> Result<String> {
    let mut text = Vec::new();
    let failed = |e: String| {
        Error::new(
            Code::Internal,
            format!("The manual page cannot be made: {e}."),
        )
    };
    Man::new(command)
        .render(&mut text)
        .map_err(|e| failed(e.to_string()))?;
    String::from_utf8(text).map_err(|e| failed(e.to_string()))
}
