//! The command `stiffarm`: parses the command line, runs one command, exits.

mod args;
mod commands;
mod error;
mod examples;
mod excerpt;
mod files;
mod identity;
mod input;
mod interrupt;
mod numbers;
mod output;
mod path;
mod progress;
mod saved;
mod screen;
mod session;
mod table;

use args::{Cli, Command};
use clap::{CommandFactory, FromArgMatches};
use output::Exit;
use session::Session;
use std::ffi::OsString;
use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<OsString> = std::env::args_os().collect();
    // What help and usage errors need before the words are parsed.
    let color = args::color_of(&words);
    let command = Cli::command().color(color);
    let parsed = command.try_get_matches_from(&words);
    let cli = match parsed.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(stop) => return error::usage(&stop, args::wants_json(&words)),
    };
    let session = Session::new(&cli.global);
    let ran = error::catch_panic(|| {
        session.set_threads(&cli.global)?;
        run(&session, &cli.command)
    });
    match ran {
        Ok(exit) => match session.failure() {
            // The result is on standard output already.
            Some(error) => error::report_beside(&session, &error),
            None => ExitCode::from(exit.code()),
        },
        Err(fault) => error::report(&session, &fault),
    }
}

fn run(session: &Session, command: &Command) -> stiffarm::Result<Exit> {
    match command {
        Command::Study(args) => commands::study::run(session, args),
        Command::Init(args) => commands::init::run(session, args),
        Command::Check(args) => commands::check::run(session, args),
        Command::Select(args) => commands::select::run(session, args),
        Command::Evaluate(args) => commands::evaluate::run(session, args),
        Command::Simulate(args) => commands::simulate::run(session, args),
        Command::Register(args) => commands::register::run(session, args),
        Command::Identify(args) => commands::identify::run(session, args),
        Command::Validate(args) => commands::validate::run(session, args),
        Command::Predict(args) => commands::predict::run(session, args),
        Command::Compensate(args) => commands::compensate::run(session, args),
        Command::Map(args) => commands::map::run(session, args),
        Command::Zones(args) => commands::zones::run(session, args),
        Command::Robots(args) => commands::robots::run(session, args),
        Command::Schema(args) => commands::schema::run(session, args),
        Command::Completions(args) => commands::completions::run(session, args),
        Command::Man(args) => commands::man::run(session, args),
        Command::Docs(args) => commands::docs::run(session, args),
    }
}
