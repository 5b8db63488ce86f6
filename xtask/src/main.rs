//! Developer commands of the stiffarm workspace: `cargo xtask <command>`.
//!
//! Standard library only, so that they compile in seconds and need nothing but Rust. `cargo xtask help` lists the
//! commands; CI runs the same ones.

mod arguments;
mod checked;
mod checks;
mod fuzz;
mod generate;
mod outputs;
mod pages;
mod python;
mod reference;
mod robots;
mod run;
mod sheets;
mod structure;
mod tally;
mod test;
mod tools;
mod viewer;

use std::process::ExitCode;

use arguments::Command;
use run::{Failure, Workspace};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match dispatch(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print();
            ExitCode::from(failure.code)
        }
    }
}

/// Parses `arguments` and runs the command they name.
fn dispatch(arguments: &[String]) -> Result<(), Failure> {
    let command = arguments::parse(arguments)?;
    let workspace = Workspace::find()?;
    match command {
        Command::Help => {
            print!("{}", arguments::HELP);
            Ok(())
        }
        Command::Test(options) => test::run(&workspace, &options),
        Command::Generate { check } => generate::run(&workspace, check),
        Command::Outputs(options) => outputs::run(&workspace, &options),
        Command::Robots { folder, check } => robots::run(&workspace, &folder, check),
        Command::Fuzz(words) => fuzz::run(&workspace, &words),
        Command::Pages(options) => pages::alone(&workspace, &options),
        Command::Sheets { install } => sheets::alone(&workspace, install),
        Command::Python(options) => python::alone(&workspace, &options),
        Command::Viewer { check } => viewer::run(&workspace, check),
        Command::Lint => checks::lint(&workspace),
        Command::Ci(options) => checks::ci(&workspace, &options),
    }
}
