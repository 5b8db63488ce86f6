//! The commands as `stiffarm --help` lists them: by what a day's work asks for.

use crate::screen::{columns, lines};
use clap::{Arg, Command, ValueHint};
use stiffarm::ask::rules::NotWith;
use stiffarm::ask::{identify, map, predict, select};

/// Groups of commands, in the order of the work.
const GROUPS: [(&str, &[&str]); 5] = [
    ("Plan", &["init", "check", "select", "evaluate", "simulate", "coverage", "zones", "robots", "capsules"]),
    ("Measure", &["route", "export", "pose", "register", "measure"]),
    ("Identify", &["identify", "validate"]),
    ("Work", &["predict", "compensate", "map"]),
    ("Show", &["study", "report", "schema", "completions", "man"]),
];

/// Of commands with many options those that `-h` shows; `--help` shows all.
const EVERYDAY: [(&str, &[&str]); 2] = [
    (
        "select",
        &[
            "index",
            "count",
            "curve",
            "candidates",
            "given",
            "add",
            "time_limit",
            "seed",
            "output",
            "sheet",
            "report",
            "force",
            "details",
        ],
    ),
    (
        "identify",
        &[
            "postures",
            "registration",
            "exclude",
            "elastic",
            "estimator",
            "noise",
            "output",
            "report",
            "force",
            "details",
        ],
    ),
];

/// What is not asked beside what, by command.
const NOT_WITH: [(&str, NotWith); 4] = [
    ("identify", identify::NOT_WITH),
    ("map", map::NOT_WITH),
    ("predict", predict::NOT_WITH),
    ("select", select::NOT_WITH),
];

/// Columns before what a command does.
const NAMES: usize = 15;

/// The command with its help by groups; a command that stands in none is not listed.
pub fn grouped(command: Command) -> Command {
    let header = command.get_styles().get_header();
    let between = format!("\n{}", " ".repeat(NAMES));
    let mut listed = String::new();
    for (heading, names) in GROUPS {
        listed += &format!("{header}{heading}:{header:#}\n");
        for name in names {
            let about = command.find_subcommand(name).and_then(Command::get_about);
            let about = about.map(ToString::to_string).unwrap_or_default();
            let about = lines(&about, columns().saturating_sub(NAMES)).join(&between);
            listed += &format!("  {name:<width$}{about}\n", width = NAMES - 2);
        }
    }
    // "-3" is a value that is out of range, and said to be.
    let numbers = |arg: Arg| {
        let is_path = arg.get_value_hint() != ValueHint::Unknown;
        if is_path || arg.is_positional() || !arg.get_action().takes_values() {
            arg
        } else {
            arg.allow_negative_numbers(true)
        }
    };
    let command = command.mut_args(numbers);
    let command = command.mut_subcommands(|one| one.mut_args(numbers));
    let command = NOT_WITH
        .iter()
        .fold(command, |command, (name, rules)| command.mut_subcommand(name, |one| excluding(one, rules)));
    EVERYDAY
        .iter()
        .fold(command, |command, (name, options)| {
            command.mut_subcommand(name, |one| {
                one.mut_args(|arg| {
                    let shown = arg.is_positional() || options.contains(&arg.get_id().as_str());
                    arg.hide_short_help(!shown)
                })
            })
        })
        .mut_subcommands(|one| one.hide(true))
        .override_usage("stiffarm [OPTIONS] <COMMAND>")
        .before_help(listed)
        .help_template("{about-with-newline}\n{usage-heading} {usage}\n\n{before-help}{all-args}{after-help}")
}

/// The command that refuses what `rules` exclude, as far as it has it.
fn excluding(command: Command, rules: NotWith) -> Command {
    let ids: Vec<String> = command.get_arguments().map(|arg| arg.get_id().to_string()).collect();
    let there = |other: &&&str| ids.iter().any(|id| id == **other);
    command.mut_args(|arg| {
        let rule = rules.iter().find(|(name, _)| arg.get_id() == name);
        let others = rule.map_or(&[][..], |(_, others)| others);
        let others: Vec<&str> = others.iter().filter(there).copied().collect();
        arg.conflicts_with_all(others)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn every_command_stands_in_one_group() {
        let command = crate::args::Cli::command();
        let shown = command.get_subcommands().filter(|one| !one.is_hide_set());
        let mut shown: Vec<&str> = shown.map(Command::get_name).collect();
        let mut listed: Vec<&str> = GROUPS.iter().flat_map(|(_, names)| *names).copied().collect();
        shown.sort_unstable();
        listed.sort_unstable();
        assert_eq!(shown, listed);
    }

    #[test]
    fn everyday_options_are_options() {
        let command = crate::args::Cli::command();
        for (name, options) in EVERYDAY {
            let one = command.find_subcommand(name).unwrap();
            for option in options {
                let mut arguments = one.get_arguments();
                assert!(arguments.any(|arg| arg.get_id() == option), "{name} {option}");
            }
        }
    }
}
