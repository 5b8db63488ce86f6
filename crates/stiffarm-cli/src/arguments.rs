//! The command line that makes a result again: without where results go and how they are shown.

use crate::identity::{FileId, Input};
use std::ffi::OsString;
use std::path::Path;
use stiffarm::findings::visible;
use stiffarm_files::builtin;

/// Options without a value that no result depends on.
const FLAGS: [&str; 5] = ["--json", "--quiet", "-q", "--force", "--details"];
/// Options with a value that no result depends on. Those that name an output file are known by the file.
const WITH_VALUE: [&str; 3] = ["--color", "--threads", "--output-dir"];

/// The words behind the program's name that matter to the result; an input file is written as its role in braces.
pub fn arguments(words: &[OsString], inputs: &[Input], outputs: &[FileId]) -> Vec<String> {
    let texts = words.iter().skip(1).map(|word| word.to_string_lossy());
    let words: Vec<String> = texts.map(|word| visible(&word).into_owned()).collect();
    let reads_stdin = inputs.iter().any(|input| input.is_stdin);
    let is_output = |value: &str| match value {
        "-" => !reads_stdin,
        value => {
            let id = FileId::of(Path::new(value));
            outputs.iter().any(|output| output.is(&id))
        }
    };
    let as_input = |value: &str| {
        if value.starts_with(builtin::PREFIX) {
            return value.to_string();
        }
        let mut inputs = inputs.iter();
        let input = inputs.find(|input| match value {
            "-" => input.is_stdin,
            value => input.name == value,
        });
        input.map_or_else(|| value.to_string(), |input| format!("{{{}}}", input.role.replace(' ', "_")))
    };
    let mut out = Vec::new();
    let mut rest = words.iter().peekable();
    while let Some(word) = rest.next() {
        if FLAGS.contains(&word.as_str()) {
            continue;
        }
        if let Some((option, value)) = word.split_once('=').filter(|_| word.starts_with("--")) {
            if !WITH_VALUE.contains(&option) && !is_output(value) {
                out.push(format!("{option}={}", as_input(value)));
            }
            continue;
        }
        let is_option = word.starts_with("--") && word.len() > 2;
        let value = rest.peek().filter(|_| is_option);
        if WITH_VALUE.contains(&word.as_str()) || value.is_some_and(|value| is_output(value)) {
            rest.next();
            continue;
        }
        out.push(as_input(word));
    }
    out
}
