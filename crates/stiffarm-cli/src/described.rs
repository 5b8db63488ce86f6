//! What the command line takes, as data: another language's functions and completions are made of it.

use crate::args::Cli;
use clap::{Arg, ArgAction, Command, CommandFactory, ValueHint};
use serde::Serialize;
use std::any::TypeId;
use std::time::Duration;

/// A command.
#[derive(Debug, Serialize)]
pub struct Described {
    /// Its name.
    pub name: String,
    /// What it does, in one sentence.
    pub about: String,
    /// What it takes, in the order of its help; options of every command are left out.
    pub arguments: Vec<Argument>,
}

/// An argument of a command.
#[derive(Debug, Serialize)]
pub struct Argument {
    /// Its name, words with `_` between them.
    pub name: String,
    /// The option without its dashes; none for what stands by its place.
    pub option: Option<String>,
    /// It has a short form, which is for what one gives nearly always.
    pub short: bool,
    /// What it is.
    pub help: String,
    /// What a value is.
    pub kind: Kind,
    /// Values that may be given.
    pub choices: Vec<String>,
    /// The value where none is given.
    pub default: Option<String>,
    /// Without it the command does not run.
    pub required: bool,
    /// It takes several values.
    pub several: bool,
    /// It may stand without a value.
    pub bare: bool,
}

/// What a value is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Given or not.
    Flag,
    /// A whole number.
    Whole,
    /// A number.
    Number,
    /// Numbers with commas between them.
    Numbers,
    /// A text.
    Text,
    /// A file that is read.
    Input,
    /// A file that is written, or a folder.
    Path,
}

/// All commands that answer with a result.
pub fn described() -> Vec<Described> {
    let mut main = Cli::command();
    main.build();
    let shown = main.get_subcommands().filter(|command| {
        let name = command.get_name();
        !command.is_hide_set() && !["help", "completions", "man"].contains(&name)
    });
    shown.map(command).collect()
}

fn command(command: &Command) -> Described {
    let arguments = command.get_arguments().filter(|argument| {
        let id = argument.get_id().as_str();
        !argument.is_global_set() && !["help", "version"].contains(&id)
    });
    Described {
        name: command.get_name().to_string(),
        about: command.get_about().map(ToString::to_string).unwrap_or_default(),
        arguments: arguments.map(argument).collect(),
    }
}

fn argument(argument: &Arg) -> Argument {
    let values = argument.get_num_args().unwrap_or_default();
    let kind = kind(argument);
    let choices = argument.get_possible_values();
    let defaults = argument.get_default_values().first();
    let of_values = kind != Kind::Flag;
    let help = argument.get_help();
    Argument {
        name: argument.get_id().to_string(),
        option: argument.get_long().map(String::from),
        short: argument.get_short().is_some(),
        help: help.map(ToString::to_string).unwrap_or_default(),
        kind,
        choices: choices.iter().filter(|_| of_values).map(|choice| choice.get_name().to_string()).collect(),
        default: defaults.filter(|_| of_values).map(|value| value.to_string_lossy().into_owned()),
        required: argument.is_required_set(),
        several: values.max_values() > 1 || matches!(argument.get_action(), ArgAction::Append),
        bare: of_values && values.min_values() == 0,
    }
}

fn kind(argument: &Arg) -> Kind {
    if !argument.get_action().takes_values() {
        return Kind::Flag;
    }
    match argument.get_value_hint() {
        ValueHint::FilePath => return Kind::Input,
        ValueHint::AnyPath => return Kind::Path,
        _ => {}
    }
    let parser_type = argument.get_value_parser().type_id();
    let is = |types: &[TypeId]| types.iter().any(|one| parser_type == *one);
    if is(&[TypeId::of::<u64>(), TypeId::of::<usize>(), TypeId::of::<u16>(), TypeId::of::<u8>()]) {
        return Kind::Whole;
    }
    if is(&[TypeId::of::<f64>(), TypeId::of::<Duration>()]) {
        return Kind::Number;
    }
    if is(&[TypeId::of::<[f64; 3]>(), TypeId::of::<[f64; 6]>()]) { Kind::Numbers } else { Kind::Text }
}
