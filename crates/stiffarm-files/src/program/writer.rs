//! A program as the files of a language.
//!
//! What stands in a file is a text with places in braces. `{name}` is the program's name, `{moves}` the
//! number of moves, `{what}` what it is, `{base}` the number of the base. A line with `{header}`, `{scales}`, `{tool}`,
//! `{points}` or `{body}` is written once for each line of it, and so not at all where there is none. Lines that begin
//! with `{n}` are numbered; `{count}` is how many they are.

use super::characters::wrapped;
use super::dialect::{Dialect, Syntax, Target};
use super::text::{decimals, fixed, marker};
use super::{Program, ProgramFile, ProgramOptions, Step};
use stiffarm::units::rad_to_deg;

/// The files of `program`.
pub fn write(program: &Program, dialect: &Dialect, syntax: &Syntax, options: &ProgramOptions) -> Vec<ProgramFile> {
    let tool = options.tool.as_deref().or(dialect.tool.default());
    let (body, points) = lines_of_steps(program, dialect, syntax, options, tool.unwrap_or_default());
    let moves = program.moves().count().to_string();
    let lists: [(&str, Vec<String>); 5] = [
        ("{header}", header(program, dialect, syntax.comment_width)),
        ("{scales}", scales(dialect, syntax.comment_width, options)),
        ("{tool}", tool.iter().map(|tool| tool.to_string()).collect()),
        ("{points}", points),
        ("{body}", body),
    ];
    let files = syntax.files.iter();
    files
        .map(|(extension, template)| {
            let words = [("{name}", program.name.as_str()), ("{moves}", &moves), ("{what}", "plan"), ("{base}", "0")];
            let name = if syntax.small_file_names { program.name.to_ascii_lowercase() } else { program.name.clone() };
            ProgramFile { name: format!("{name}.{extension}"), text: filled(template, &words, &lists, syntax.line_end) }
        })
        .collect()
}

/// A template with its words, and with its lines that hold a list once for each line of it.
pub fn filled(template: &str, words: &[(&str, &str)], lists: &[(&str, Vec<String>)], line_end: &str) -> String {
    let lines = template.lines().map(|line| {
        let replaced = |line: String, (place, word): &(&str, &str)| line.replace(place, word);
        words.iter().fold(line.to_string(), replaced)
    });
    let lines = lines.flat_map(|line| match lists.iter().find(|(place, _)| line.contains(place)) {
        Some((place, list)) => list.iter().map(|list_line| line.replace(place, list_line)).collect(),
        None => vec![line],
    });
    let lines = numbered(lines.collect()).into_iter();
    lines.map(|line| line + line_end).collect()
}

/// The lines of all steps, and those of the points that they go to.
fn lines_of_steps(
    program: &Program,
    dialect: &Dialect,
    syntax: &Syntax,
    options: &ProgramOptions,
    tool: &str,
) -> (Vec<String>, Vec<String>) {
    let decimals = decimals(program, dialect.most_decimals);
    let (mut body, mut points) = (Vec::new(), Vec::new());
    let (mut moves, mut speed) = (0, None);
    for step in &program.steps {
        let target = match step {
            Step::Wait(text) => {
                body.extend((syntax.wait)(text));
                continue;
            }
            Step::Move(target) => target,
        };
        moves += 1;
        let degrees = options.to_controller(&target.q).into_iter().map(rad_to_deg);
        let values = match options.pulses_per_degree.as_ref().filter(|_| dialect.in_pulses) {
            Some(scales) => degrees.zip(scales).map(|(angle, scale)| fixed(angle * scale, 0)).collect(),
            None => degrees.map(|angle| fixed(angle, decimals)).collect(),
        };
        let to = Target { label: (syntax.label)(moves), values, speed_percent: target.speed_percent, tool };
        let named = marker(target.kind, &target.name, syntax.name_width);
        body.push((syntax.marker)(&named));
        if speed.replace(to.speed_percent) != Some(to.speed_percent) {
            body.extend(syntax.speed.map(|line| line(to.speed_percent)));
        }
        body.extend((syntax.movement)(&to));
        points.extend((syntax.point)(&to));
    }
    (body, points)
}

/// The header in comment lines of at most `width` characters, with what the language adds.
fn header(program: &Program, dialect: &Dialect, width: usize) -> Vec<String> {
    let speed = format!("A speed of 100 per cent is {}.", dialect.speed_of);
    let lines = program.header.iter().chain([&speed]);
    let lines = lines.flat_map(|line| wrapped(line, width));
    lines.filter(|line| !line.is_empty()).collect()
}

/// Pulses per degree of each axis.
fn scales(dialect: &Dialect, width: usize, options: &ProgramOptions) -> Vec<String> {
    let scales = options.pulses_per_degree.iter().flatten().enumerate();
    scales
        .map(|(axis, scale)| format!("pulses/deg {} {scale}", (dialect.axis_name)(axis)))
        .map(|line| line.chars().take(width).collect())
        .collect()
}

/// Numbers the lines that are to be.
fn numbered(lines: Vec<String>) -> Vec<String> {
    let mut count = 0;
    let lines: Vec<String> = lines
        .into_iter()
        .map(|line| match line.strip_prefix("{n}") {
            Some(rest) => {
                count += 1;
                format!("{count:4}:{rest}")
            }
            None => line,
        })
        .collect();
    let count = count.to_string();
    lines.into_iter().map(|line| line.replace("{count}", &count)).collect()
}
