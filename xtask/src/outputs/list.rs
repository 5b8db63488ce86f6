//! The list of commands: text to [`Call`].

use std::collections::BTreeSet;

use crate::run::Failure;

/// The commands.
pub const COMMANDS: &str = include_str!("commands.txt");

/// Options with which a command writes a file or a folder.
const WRITING: [&str; 6] = ["--output", "--output-dir", "--sheet", "--figure", "--measurements", "--readings"];

/// One run of `stiffarm`.
#[derive(Debug, PartialEq, Eq)]
pub struct Call {
    /// Name of the file that keeps what it prints.
    pub file: String,
    /// Its arguments.
    pub words: Vec<String>,
    /// The file that is its standard input.
    pub input: Option<String>,
    /// Whether wrong usage or wrong input is what it is there for.
    pub is_wrong: bool,
    /// Whether it takes long and tells nothing that shorter ones do not.
    pub is_long: bool,
}

impl Call {
    /// The call as it would be typed.
    pub fn line(&self) -> String {
        let line = format!("stiffarm {}", self.words.join(" "));
        match &self.input {
            Some(file) => format!("{line} < {file}"),
            None => line,
        }
    }

    /// The exit codes that it may end with.
    pub fn codes(&self) -> &'static [i32] {
        if self.is_wrong { &[2] } else { &[0, 1] }
    }
}

/// Every call of a list: one or two for each of its lines.
pub fn calls(list: &str) -> Result<Vec<Call>, Failure> {
    let mut calls: Vec<Call> = Vec::new();
    for (number, line) in (1..).zip(list.lines()) {
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        let added = calls_of(line).map_err(|why| malformed(number, line, why))?;
        if calls.iter().any(|call| call.file == added[0].file) {
            return Err(malformed(number, line, "its name is taken"));
        }
        calls.extend(added);
    }
    Ok(calls)
}

/// The calls that compute: of one that is made twice the one with --json, which has every digit; none
/// that is there to be wrong or takes long, and no text that is always the same.
pub fn brief(calls: Vec<Call>) -> Vec<Call> {
    let files: BTreeSet<String> = calls.iter().map(|call| call.file.clone()).collect();
    let texts = ["--version", "schema", "docs", "man", "completions"];
    let computes = |call: &Call| {
        let asks = call.words.iter().any(|w| w == "--help" || w == "-h");
        let is_text = asks || texts.contains(&call.words[0].as_str());
        let with_json = call.file.replace(".txt", ".json.txt");
        !(call.is_wrong || call.is_long || is_text || files.contains(&with_json))
    };
    calls.into_iter().filter(computes).collect()
}

/// The calls of one line of the list: `KIND NAME WORDS… [< FILE]`.
fn calls_of(line: &str) -> Result<Vec<Call>, &'static str> {
    let (line, input) = match line.split_once(" < ") {
        Some((line, file)) => (line, Some(file.trim().to_string())),
        None => (line, None),
    };
    let words: Vec<&str> = line.split_whitespace().collect();
    let [kind, name, words @ ..] = words.as_slice() else {
        return Err("it has no name");
    };
    let (has_json, is_wrong) = match *kind {
        "once" => (false, false),
        "both" | "long" => (true, false),
        "wrong" => (true, true),
        _ => return Err("it begins with none of once, both, long, wrong"),
    };
    let call = |file: String, added: &[&str]| Call {
        file,
        words: words.iter().chain(added).map(|w| w.to_string()).collect(),
        input: input.clone(),
        is_wrong,
        is_long: *kind == "long",
    };
    let mut calls = vec![call(format!("{name}.txt"), &[])];
    if has_json {
        // What it writes is there already.
        let writes = !is_wrong && words.iter().any(|word| WRITING.contains(word));
        let added: &[&str] = if writes { &["--force", "--json"] } else { &["--json"] };
        calls.push(call(format!("{name}.json.txt"), added));
    }
    Ok(calls)
}

fn malformed(number: usize, line: &str, why: &str) -> Failure {
    Failure::internal(
        format!("line {number} of the list of commands, `{line}`: {why}"),
        "see how its lines are built at the head of xtask/src/outputs/commands.txt",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_one_call_or_two() {
        let list = "# Comment\n\nonce  man  man --output-dir man\nboth  check  check - < cell.toml\n\
                    both  plan  select a --output b\nwrong  slip  check --output b\n";
        let calls = calls(list).unwrap();
        let lines = calls.iter().map(|c| format!("{}: {}", c.file, c.line()));
        assert_eq!(
            lines.collect::<Vec<_>>(),
            [
                "man.txt: stiffarm man --output-dir man",
                "check.txt: stiffarm check - < cell.toml",
                "check.json.txt: stiffarm check - --json < cell.toml",
                "plan.txt: stiffarm select a --output b",
                "plan.json.txt: stiffarm select a --output b --force --json",
                "slip.txt: stiffarm check --output b",
                "slip.json.txt: stiffarm check --output b --json",
            ]
        );
        let codes = [&calls[0], &calls[5]].map(Call::codes);
        assert_eq!(codes, [&[0, 1][..], &[2]]);
    }

    #[test]
    fn a_brief_list_computes_everything_once() {
        let list = "once  help  select --help\nboth  plan  select a --output b\nwrong  slip  check --output b\n\
                    once  plan-sheet  select b --sheet c\nboth  help-me  schema cell\n\
                    long  plan-large  select c\n";
        let brief = brief(calls(list).unwrap());
        let files: Vec<&str> = brief.iter().map(|call| call.file.as_str()).collect();
        assert_eq!(files, ["plan.json.txt", "plan-sheet.txt"]);
    }

    #[test]
    fn slips_in_the_list_are_named_with_their_line() {
        for (list, why) in [
            ("\nboth", "it has no name"),
            ("\ntwice a check", "it begins with none of once, both, long, wrong"),
            ("once a check\nboth a check", "its name is taken"),
        ] {
            let message = calls(list).unwrap_err().message;
            assert!(message.starts_with("line 2 of the list"), "{message}");
            assert!(message.ends_with(why), "{message}");
        }
    }

    #[test]
    fn the_list_repeats_every_command_without_a_clock() {
        let all = calls(COMMANDS).unwrap();
        let begins = |name: &str| all.iter().any(|c| !c.is_wrong && c.words[0] == name);
        for name in "study init check select evaluate simulate register identify validate predict compensate map zones \
                     export capsules robots schema completions man docs"
            .split(' ')
        {
            assert!(begins(name), "{name}");
        }
        // Searches that would go on until nothing improves depend on no clock either, but take long.
        for call in all.iter().filter(|c| !c.is_wrong && c.words[0] == "select") {
            let has = |word: &str| call.words.iter().any(|w| w == word);
            let ends = "--rounds --initial --drop --space-filling --candidates --help -h";
            assert!(ends.split(' ').any(has), "{call:?}");
            assert!(!has("--time-limit"), "{call:?}");
        }
    }
}
