//! Running other programs, and the one error type of this program.

use std::ffi::OsString;
use std::fmt;
use std::io::{BufRead, BufReader, Write};
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::Instant;

/// Why a command stopped: what is wrong, what to do, and the exit code that says it to a script.
#[derive(Debug)]
pub struct Failure {
    /// What is wrong, and where. Empty when it has been printed already.
    pub message: String,
    /// What to do about it.
    pub fix: String,
    /// The exit code of `cargo xtask`.
    pub code: u8,
}

impl Failure {
    /// A finding of a check: exit code 1.
    pub fn finding(message: impl Into<String>, fix: impl Into<String>) -> Self {
        Self::new(message, fix, 1)
    }

    /// Wrong usage: exit code 2.
    pub fn usage(message: impl Into<String>, fix: impl Into<String>) -> Self {
        Self::new(message, fix, 2)
    }

    /// Something that could not be run, read or written: exit code 3.
    pub fn internal(message: impl Into<String>, fix: impl Into<String>) -> Self {
        Self::new(message, fix, 3)
    }

    /// A finding that the output tells already, so that nothing is printed after its closing line.
    pub fn already_told() -> Self {
        Self::finding("", "")
    }

    fn new(message: impl Into<String>, fix: impl Into<String>, code: u8) -> Self {
        Failure { message: message.into(), fix: fix.into(), code }
    }

    /// Prints the failure to standard error, unless the output has told it already.
    pub fn print(&self) {
        if !self.message.is_empty() {
            eprintln!("error: {}\n  fix: {}", self.message, self.fix);
        }
    }
}

/// The folder that holds the workspace's `Cargo.toml`.
pub struct Workspace {
    root: PathBuf,
}

impl Workspace {
    /// Finds the workspace from where cargo says this package lies.
    pub fn find() -> Result<Self, Failure> {
        let package = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
        let root = Path::new(&package).parent().map(Path::to_path_buf);
        root.map(|root| Workspace { root }).ok_or_else(|| {
            Failure::internal("xtask does not lie in the workspace", "start it as `cargo xtask` inside the checkout")
        })
    }

    /// The root itself.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// A call of cargo in the workspace root.
    pub fn cargo<'a>(&'a self, arguments: &[&str]) -> Cargo<'a> {
        Cargo {
            workspace: self,
            variables: Vec::new(),
            arguments: arguments.iter().map(|a| a.to_string()).collect(),
            fix: "correct what it printed above, then run it again",
        }
    }

    /// The one build that every part of the tests takes its programs from: all tests, the command, and the extension
    /// module of Python. `cargo run` and `cargo xtask` build parts of it. With `--package` others would not: a package
    /// alone asks for other features of what the library stands on.
    pub fn build(&self) -> Cargo<'_> {
        self.cargo(&[
            "build",
            "--workspace",
            "--locked",
            "--lib",
            "--tests",
            // Not all programs: this one runs, and Windows lets nobody replace it then.
            "--bin=stiffarm",
            "--bin=stiffarm-fuzz",
        ])
    }

    /// Runs [`Workspace::build`], headed by the line a developer would type.
    pub fn built(&self) -> Result<(), Failure> {
        let build = self.build();
        println!("{build}");
        build.run()
    }
}

/// A call of cargo that can be run, and shown as the line a developer would type.
pub struct Cargo<'a> {
    workspace: &'a Workspace,
    variables: Vec<(&'static str, OsString)>,
    arguments: Vec<String>,
    fix: &'static str,
}

impl Cargo<'_> {
    /// Adds an environment variable.
    pub fn env(mut self, name: &'static str, value: impl Into<OsString>) -> Self {
        self.variables.push((name, value.into()));
        self
    }

    /// Says what to do when it fails.
    pub fn fix(mut self, fix: &'static str) -> Self {
        self.fix = fix;
        self
    }

    /// Runs it with the terminal as its own; an unsuccessful end is a failure with the same exit code.
    pub fn run(&self) -> Result<(), Failure> {
        let status = self.command().status().map_err(|e| self.unstarted(&e))?;
        self.check(status)
    }

    fn check(&self, status: ExitStatus) -> Result<(), Failure> {
        if status.success() {
            return Ok(());
        }
        let code = status.code().and_then(|code| u8::try_from(code).ok());
        Err(Failure::new(format!("`{self}` failed: {status}"), self.fix, code.unwrap_or(3)))
    }

    /// [`stream`] of this call.
    pub fn stream(&self, see: impl FnMut(&str)) -> Result<ExitStatus, Failure> {
        stream(&mut self.command(), see).map_err(|e| self.unstarted(&e))
    }

    /// Whether it succeeds; prints nothing.
    pub fn succeeds(&self) -> bool {
        let mut command = self.command();
        command.stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    }

    fn command(&self) -> Command {
        let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = Command::new(program);
        command
            .args(&self.arguments)
            .current_dir(self.workspace.root())
            .stdin(Stdio::null())
            // `cargo run` sets it for this program, and cargo-machete takes it for a call without cargo.
            .env_remove("CARGO_PKG_NAME");
        for (name, value) in &self.variables {
            command.env(name, value);
        }
        command
    }

    fn unstarted(&self, error: &std::io::Error) -> Failure {
        Failure::internal(
            format!("`{self}` could not be run: {error}"),
            "check that `cargo --version` works in this terminal",
        )
    }
}

impl fmt::Display for Cargo<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, value) in &self.variables {
            write!(f, "{name}={} ", quoted(&value.to_string_lossy()))?;
        }
        write!(f, "cargo")?;
        for argument in &self.arguments {
            write!(f, " {}", quoted(argument))?;
        }
        Ok(())
    }
}

/// `word` as a shell takes it back: in single quotes where it holds more than plain characters.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_=:/.,+@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_string()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// Runs a program, shows its standard output as it comes and hands every line of it to `see`.
pub fn stream(command: &mut Command, see: impl FnMut(&str)) -> std::io::Result<ExitStatus> {
    let mut child = command.stdout(Stdio::piped()).spawn()?;
    if let Some(output) = child.stdout.take() {
        copy_lines(BufReader::new(output), std::io::stdout(), see)?;
    }
    child.wait()
}

/// Copies `from` to `to` line by line, at once, and hands every line without its end to `see`.
fn copy_lines(mut from: impl BufRead, mut to: impl Write, mut see: impl FnMut(&str)) -> std::io::Result<()> {
    let mut line = Vec::new();
    while from.read_until(b'\n', &mut line)? > 0 {
        to.write_all(&line)?;
        to.flush()?;
        see(String::from_utf8_lossy(&line).trim_end_matches(['\r', '\n']));
        line.clear();
    }
    Ok(())
}

/// Prints `heading`, does `work` and prints how long it took.
pub fn step(heading: impl fmt::Display, work: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    println!("\n== {heading}");
    timed("took", work)
}

/// Does both, the first in a thread of its own. Lines of both come as they are said.
pub fn beside<A: Send, B>(first: impl FnOnce() -> A + Send, second: impl FnOnce() -> B) -> (A, B) {
    std::thread::scope(|scope| {
        let first = scope.spawn(first);
        let second = second();
        let first = first.join().unwrap_or_else(|panic| resume_unwind(panic));
        (first, second)
    })
}

/// Does `work` and prints how long it took, after `name`: parts that run beside each other are told apart by it.
pub fn timed<T>(name: impl fmt::Display, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let outcome = work();
    println!("   {name}: {:.1} s", start.elapsed().as_secs_f64());
    outcome
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_copied_unchanged_and_shown_without_their_end() {
        let input: &[u8] = b"one\r\n\xff two\n\nlast";
        let mut copy = Vec::new();
        let mut seen = Vec::new();
        copy_lines(input, &mut copy, |line| seen.push(line.to_string())).unwrap();
        assert_eq!(copy, input);
        assert_eq!(seen, ["one", "\u{fffd} two", "", "last"]);
    }

    #[test]
    fn a_call_is_shown_as_it_would_be_typed() {
        let workspace = Workspace::find().unwrap();
        let call = workspace.cargo(&["doc", "--features=a,b", "it's"]).env("RUSTDOCFLAGS", "-D warnings");
        assert_eq!(call.to_string(), r"RUSTDOCFLAGS='-D warnings' cargo doc --features=a,b 'it'\''s'");
    }

    #[test]
    fn a_failing_call_passes_its_exit_code_on() {
        let workspace = Workspace::find().unwrap();
        let call = workspace.cargo(&["no-such-subcommand-of-cargo"]);
        assert!(!call.succeeds());
        let status = call.command().stderr(Stdio::null()).status().unwrap();
        let failure = call.check(status).unwrap_err();
        assert_eq!(failure.code, 101);
        let start = "`cargo no-such-subcommand-of-cargo` failed";
        assert!(failure.message.starts_with(start));
    }
}
