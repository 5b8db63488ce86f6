//! Developer commands of the stiffarm workspace: `cargo xtask <command>`.
//!
//! They need nothing but Rust, and compile what the command compiles too. `cargo xtask help` lists them; CI runs the
//! same ones.

mod arguments;
mod checked;
mod checks;
mod files;
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

use arguments::{Arguments, Command};
use clap::{CommandFactory, Parser};
use run::{Failure, Workspace};

fn main() -> ExitCode {
    match run(Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print();
            ExitCode::from(failure.code)
        }
    }
}

fn run(command: Option<Command>) -> Result<(), Failure> {
    let workspace = Workspace::find()?;
    match command {
        None => {
            println!("{}", Arguments::command().render_help());
            Ok(())
        }
        Some(Command::Test(options)) => test::run(&workspace, &options),
        Some(Command::Generate { check }) => generate::run(&workspace, check),
        Some(Command::Outputs(options)) => outputs::run(&workspace, &options),
        Some(Command::Robots { folder, check }) => robots::run(&workspace, &folder, check),
        Some(Command::Fuzz { words }) => fuzz::run(&workspace, &words),
        Some(Command::Pages(options)) => pages::alone(&workspace, &options),
        Some(Command::Sheets { install }) => sheets::alone(&workspace, install),
        Some(Command::Python(options)) => python::alone(&workspace, &options),
        Some(Command::Viewer { check }) => viewer::run(&workspace, check),
        Some(Command::Lint) => checks::lint(&workspace),
        Some(Command::Ci(options)) => checks::ci(&workspace, &options),
    }
}
