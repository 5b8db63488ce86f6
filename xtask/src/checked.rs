//! What checks come to that other programs run: the lines of a script that prints each of its checks, added up.

use std::process::{Command, Stdio};

use crate::run::{Failure, stream};

/// What came of the checks.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Checked {
    /// How many passed.
    pub passed: usize,
    /// Name, check and reason of each that failed.
    pub failures: Vec<String>,
    /// What was not looked at, the reason, and the fix.
    pub skips: Vec<[String; 3]>,
    /// The script's last line, which counts the others.
    closing: String,
}

/// A script that prints `ok …`, `FAILED …` and `SKIPPED name: reason; fix: …`, and last `word: N passed, N failed, N
/// skipped`.
pub struct Script {
    /// Its name in messages.
    pub name: &'static str,
    /// The word that its last line begins with.
    pub word: &'static str,
    /// What to do about a skip that does not say it.
    pub fix: &'static str,
}

impl Checked {
    /// Adds a check by its name, and says what came of it.
    pub fn note<T>(&mut self, name: &str, outcome: &Result<T, String>) {
        match outcome {
            Ok(_) => {
                println!("ok {name}");
                self.passed += 1;
            }
            Err(why) => {
                println!("FAILED {name}: {why}");
                self.failures.push(format!("{name}: {why}"));
            }
        }
    }

    /// Adds what was not looked at.
    pub fn skip(&mut self, name: impl Into<String>, reason: impl Into<String>, fix: &str) {
        self.skips.push([name.into(), reason.into(), fix.to_string()]);
    }

    /// Adds what other checks came to.
    pub fn add(&mut self, other: Checked) {
        self.passed += other.passed;
        self.failures.extend(other.failures);
        self.skips.extend(other.skips);
    }

    /// Runs the script and takes in what it prints. One that dies on its way is a failure.
    pub fn run(script: &Script, call: &mut Command) -> Result<Self, Failure> {
        let program = call.get_program().to_string_lossy().into_owned();
        let mut checked = Checked::default();
        call.env("PYTHONDONTWRITEBYTECODE", "1").env("PYTHONIOENCODING", "utf-8").stdin(Stdio::null());
        let status = stream(call, |line| checked.see(script, line)).map_err(|error| {
            Failure::internal(
                format!("`{program}` could not be run: {error}"),
                "delete its folder in target, and run it again",
            )
        })?;
        checked.close(script, &status.to_string());
        Ok(checked)
    }

    /// Prints what was skipped and what failed; a failure where anything has failed.
    pub fn tell(&self) -> Result<(), Failure> {
        println!();
        for [name, reason, fix] in &self.skips {
            println!("SKIPPED {name}: {reason}; fix: {fix}");
        }
        for failure in &self.failures {
            println!("FAILED {failure}");
        }
        if self.failures.is_empty() { Ok(()) } else { Err(Failure::already_told()) }
    }

    /// Takes in one line of the script.
    fn see(&mut self, script: &Script, line: &str) {
        if line.starts_with("ok ") {
            self.passed += 1;
        } else if let Some(failure) = line.strip_prefix("FAILED ") {
            self.failures.push(failure.to_string());
        } else if let Some(skip) = line.strip_prefix("SKIPPED ") {
            let (name, rest) = skip.split_once(": ").unwrap_or((skip, ""));
            let (reason, fix) = rest.split_once("; fix: ").unwrap_or((rest, script.fix));
            self.skip(name, reason, fix);
        } else if line.starts_with(script.word) {
            self.closing = line.to_string();
        }
    }

    /// What the script ended with: its last line must count what the others said.
    fn close(&mut self, script: &Script, status: &str) {
        let (passed, failed) = (self.passed, self.failures.len());
        let closing = format!("{}: {passed} passed, {failed} failed, ", script.word);
        if !self.closing.starts_with(&closing) {
            let why = format!("{}: it came not to its end ({status})", script.name);
            self.failures.push(why);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCRIPT: Script = Script { name: "pages.py", word: "pages", fix: "install it" };

    const LINES: [&str; 6] = [
        "ok sample: size (0.01 MB)",
        "pictures of sample in look",
        "FAILED study: steps: scene cell: no list",
        "SKIPPED page fanuc: there are no data; fix: set it",
        "SKIPPED page map: no browser",
        "pages: 1 passed, 1 failed, 2 skipped",
    ];

    fn seen(lines: &[&str]) -> Checked {
        let mut checked = Checked::default();
        lines.iter().for_each(|line| checked.see(&SCRIPT, line));
        checked.close(&SCRIPT, "exit status: 1");
        checked
    }

    #[test]
    fn lines_of_the_script_add_up() {
        let mut checked = seen(&LINES);
        assert_eq!(checked.passed, 1);
        assert_eq!(checked.failures, ["study: steps: scene cell: no list"]);
        let skips = [["page fanuc", "there are no data", "set it"], ["page map", "no browser", "install it"]];
        assert_eq!(checked.skips, skips.map(|skip| skip.map(String::from)));

        checked.add(seen(&LINES));
        assert_eq!((checked.passed, checked.failures.len(), checked.skips.len()), (2, 2, 4));
    }

    #[test]
    fn a_script_that_dies_or_counts_otherwise_is_a_failure() {
        for lines in [&LINES[..5], &[], &LINES[1..]] {
            let last = seen(lines).failures.pop().unwrap();
            assert_eq!(last, "pages.py: it came not to its end (exit status: 1)");
        }
    }

    #[test]
    fn a_script_is_run_and_what_it_leaves_out_is_told() {
        // A program that is there wherever these tests run, and prints no counts.
        let checked = Checked::run(&SCRIPT, Command::new("cargo").arg("--version")).unwrap();
        assert_eq!(checked.passed, 0);
        assert!(checked.failures[0].starts_with("pages.py: it came not to its end"));
        assert!(checked.tell().is_err());
        let none = Checked::run(&SCRIPT, &mut Command::new("no-such-program-of-stiffarm"));
        assert_eq!(none.unwrap_err().code, 3);
    }
}
