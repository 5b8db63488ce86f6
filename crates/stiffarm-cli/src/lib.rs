//! The command `stiffarm` as a function: parses the command line and runs one command.
//!
//! The program calls [`run_process`]; fuzzer and Python package call [`run_captured`] many times in one process.
//! Nothing else is promised, the library to build on is `stiffarm`.

mod answer;
mod args;
mod arguments;
mod commands;
mod deliver;
mod described;
mod error;
mod examples;
mod excerpt;
mod files;
mod finding;
mod host;
mod identity;
mod input;
mod interrupt;
mod numbers;
mod output;
mod page;
mod path;
mod picture;
mod progress;
mod saved;
mod screen;
mod session;
mod table;
mod target;
mod text;

#[cfg(feature = "schema")]
pub use commands::generated::generated as schemas;
pub use described::{Argument, Described, Kind, described};
pub use host::Host;
pub use saved::{SummaryForm, drawing, figures, page, summary};

use answer::Answer;
use args::{Cli, Command};
use clap::{CommandFactory, FromArgMatches};
use session::Session;
use std::cell::RefCell;
use std::ffi::OsString;
use std::process::ExitCode;
use std::rc::Rc;

/// Runs the command line of this process.
pub fn run_process() -> ExitCode {
    let words: Vec<OsString> = std::env::args_os().collect();
    interrupt::listen();
    let code = error::without_panic_text(|| run_words(&words, None, Host::default()));
    ExitCode::from(code)
}

/// What a run in this process printed, and its exit code.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Captured {
    /// Exit code.
    pub code: u8,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
    /// The error beside a result that was printed, as `--json` prints errors.
    pub failure: Option<String>,
}

/// Runs a command line, the program's name first, and keeps what it prints.
///
/// Files are read and written as ever; what goes to standard output and standard error
/// is in the answer. The hook for panics stays the caller's.
pub fn run_captured(words: &[OsString], host: Host) -> Captured {
    let printed = Rc::<RefCell<Captured>>::default();
    let code = run_words(words, Some(Rc::clone(&printed)), host);
    Captured { code, ..printed.take() }
}

/// Runs one command line and gives its exit code.
fn run_words(words: &[OsString], captured: Option<Rc<RefCell<Captured>>>, host: Host) -> u8 {
    // What help and usage errors need before the words are parsed.
    let color = args::color_of(words);
    let mut command = args::grouped(Cli::command()).color(color);
    let parsed = command.try_get_matches_from_mut(words);
    let named = parsed.as_ref().ok().and_then(|matches| matches.subcommand_name());
    let named = named.unwrap_or_default().to_string();
    let cli = match parsed.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(stop) => return error::usage(&stop, args::wants_json(words), captured.as_deref()),
    };
    let session = Session::new(words, &cli.global, captured, host);
    let ran = error::catch_panic(|| {
        session.set_threads(&cli.global)?;
        let page = match cli.command.page() {
            Some((page, force)) => page::page_target(&session, page.path(), force)?,
            None => None,
        };
        session.deliver(page, run(&session, &cli.command)?)
    });
    ran.unwrap_or_else(|fault| {
        let subcommand = command.find_subcommand(&named).unwrap_or(&command);
        error::report(&session, &error::into_option_error(fault, subcommand))
    })
}

/// What a command answers: a function of what it reads and of what it was asked. Only `measure` beside the robot prints
/// while it runs, and a rehearsal of `simulate` writes.
fn run(session: &Session, command: &Command) -> stiffarm::Result<Answer> {
    match command {
        Command::Study(args) => commands::study::run(session, args),
        Command::Init(args) => commands::init::run(session, args),
        Command::Check(args) => commands::check::run(session, args),
        Command::Select(args) => commands::select::run(session, args),
        Command::Evaluate(args) => commands::evaluate::run(session, args),
        Command::Simulate(args) => commands::simulate::run(session, args),
        Command::Coverage(args) => commands::coverage::run(session, args),
        Command::Register(args) => commands::register::run(session, args),
        Command::Measure(args) => commands::measure::run(session, args),
        Command::Identify(args) => commands::identify::run(session, args),
        Command::Validate(args) => commands::validate::run(session, args),
        Command::Predict(args) => commands::predict::run(session, args),
        Command::Compensate(args) => commands::compensate::run(session, args),
        Command::Map(args) => commands::map::run(session, args),
        Command::Zones(args) => commands::zones::run(session, args),
        Command::Report(args) => commands::report::run(session, args),
        Command::Pose(args) => commands::pose::run(session, args),
        Command::Route(args) => commands::route::run(session, args),
        Command::Export(args) => commands::export::run(session, args),
        Command::Capsules(args) => commands::capsules::run(session, args),
        Command::Robots(args) => commands::robots::run(session, args),
        Command::Schema(args) => commands::schema::run(args),
        Command::Completions(args) => commands::completions::run(args),
        Command::Man(args) => commands::man::run(session, args),
        Command::Docs(args) => commands::docs::run(args),
    }
}
