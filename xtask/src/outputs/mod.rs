//! `cargo xtask outputs`: everything that `stiffarm` prints and writes, to compare before with after.

mod compare;
mod folder;
mod list;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Instant;

use crate::arguments;
use crate::files;
use crate::run::{Failure, Workspace};
use crate::tools;
use compare::Comparison;
use list::{COMMANDS, Call, brief, calls};

/// Variables that change what a command prints or how it works.
const UNSET: [&str; 5] = ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "COLUMNS", "RAYON_NUM_THREADS"];
/// How many runs pass between two signs of life.
const TOLD_EVERY: usize = 100;

/// Fills the folder, and compares it where that is asked for. The closing line is the last one.
pub fn run(workspace: &Workspace, options: &arguments::Outputs) -> Result<(), Failure> {
    let folder = absolute(&options.folder)?;
    folder::check(&folder)?;
    let against = options.against.as_deref();
    let mut against = against.map(|other| folder::other(other, &folder)).transpose()?;
    let mut calls = calls(COMMANDS)?;
    if options.is_brief {
        calls = brief(calls);
    }
    let binary = binary(workspace, options.binary.as_deref())?;
    // The first wish fills the folder itself. Without one it runs once, with the machine's own number of threads.
    let mut passes = vec![Pass { folder: folder.clone(), threads: options.threads.first().copied() }];
    for threads in options.threads.iter().skip(1) {
        let mut beside = folder.clone().into_os_string();
        beside.push(format!("-{threads}"));
        passes.push(Pass { folder: beside.into(), threads: Some(*threads) });
    }
    for pass in &passes {
        folder::check(&pass.folder)?;
        folder::prepare(workspace, &pass.folder)?;
    }
    // Each has a folder of its own, so they need not wait for each other.
    let start = Instant::now();
    let ran: Vec<_> = std::thread::scope(|scope| {
        let (binary, calls) = (&binary, &calls);
        let run = |pass| scope.spawn(move || run_all(binary, pass, calls));
        let running: Vec<_> = passes.iter().map(run).collect();
        running.into_iter().map(|pass| pass.join()).collect()
    });
    println!("{:.1} s", start.elapsed().as_secs_f64());
    let mut ended = Ok(());
    for (pass, unexpected) in passes.iter().zip(ran) {
        let unexpected = unexpected.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        println!("{} runs of stiffarm{}", calls.len(), pass.on());
        ended = ended.and(report(&pass.folder, against.as_deref(), &unexpected));
        // Every other number of threads gives the same bytes as the first.
        against = Some(folder.clone());
    }
    ended
}

/// All calls in one folder.
struct Pass {
    folder: PathBuf,
    /// None leaves it to the machine.
    threads: Option<u16>,
}

impl Pass {
    fn on(&self) -> String {
        let threads = self.threads;
        threads.map_or(String::new(), |threads| format!(" on {threads} threads"))
    }
}

/// The given executable, or the one that is built for release.
fn binary(workspace: &Workspace, path: Option<&Path>) -> Result<PathBuf, Failure> {
    let Some(path) = path else {
        let words = ["build", "--release", "--locked", "--bin", "stiffarm"];
        workspace.cargo(&words).run()?;
        let name = format!("release/stiffarm{}", std::env::consts::EXE_SUFFIX);
        return Ok(tools::target(workspace).join(name));
    };
    if path.is_file() {
        absolute(path)
    } else {
        Err(Failure::usage(
            format!("`--binary {}`: there is no such file", path.display()),
            "name the executable, for example target/release/stiffarm",
        ))
    }
}

/// Prints what differs, what ended unexpectedly, and the closing line.
fn report(folder: &Path, against: Option<&Path>, unexpected: &[String]) -> Result<(), Failure> {
    let comparison = match against {
        Some(other) => compare::compare(folder, other)?,
        None => Comparison { changes: Vec::new(), closing: format!("outputs: {} files", files::below(folder)?.len()) },
    };
    for line in &comparison.changes {
        println!("{line}");
    }
    for line in unexpected {
        println!("UNEXPECTED {line}");
    }
    println!("{}", comparison.closing);
    if unexpected.is_empty() && comparison.changes.is_empty() { Ok(()) } else { Err(Failure::already_told()) }
}

/// Runs the calls in their order and keeps what they print. The result names those that ended with another exit code
/// than the list expects.
fn run_all(binary: &Path, pass: &Pass, calls: &[Call]) -> Result<Vec<String>, Failure> {
    let mut unexpected = Vec::new();
    for (done, call) in (1..).zip(calls) {
        let output = run_one(binary, pass, call).map_err(|error| {
            Failure::internal(
                format!("`{}` could not be run: {error}", call.line()),
                "check that it is an executable of this system",
            )
        })?;
        let code = output.status.code();
        if !code.is_some_and(|code| call.codes().contains(&code)) {
            let (line, status) = (call.line(), output.status);
            unexpected.push(format!("{}: `{line}`: {status}", call.file));
        }
        let path = pass.folder.join("printed").join(&call.file);
        files::write(&path, transcript(call, &output))?;
        if done % TOLD_EVERY == 0 {
            println!("{done} of {} runs{}", calls.len(), pass.on());
        }
    }
    Ok(unexpected)
}

/// Runs one call in the folder, in surroundings that are always the same.
fn run_one(binary: &Path, pass: &Pass, call: &Call) -> std::io::Result<Output> {
    let mut command = Command::new(binary);
    // Its usage lines show the name it was called by.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::arg0(&mut command, "stiffarm");
    command.args(&call.words).current_dir(&pass.folder).env("TERM", "dumb").stdin(Stdio::null());
    for name in UNSET {
        command.env_remove(name);
    }
    if let Some(threads) = pass.threads {
        // Not as an option, which would stand in what is printed.
        command.env("RAYON_NUM_THREADS", threads.to_string());
    }
    // Without a file that an earlier command should have written, this one fails and is named too.
    if let Some(input) = &call.input
        && let Ok(input) = std::fs::File::open(pass.folder.join(input))
    {
        command.stdin(input);
    }
    command.output()
}

/// What one run left on both streams, and its exit code.
fn transcript(call: &Call, output: &Output) -> Vec<u8> {
    let mut text = format!("$ {}\n", call.line()).into_bytes();
    text.extend(&output.stdout);
    if !output.stderr.is_empty() {
        text.extend(b"-- standard error\n");
        text.extend(&output.stderr);
    }
    let code = output.status.code();
    let code = code.map_or("none".to_string(), |code| code.to_string());
    text.extend(format!("-- exit code {code}\n").into_bytes());
    text
}

fn absolute(path: &Path) -> Result<PathBuf, Failure> {
    std::path::absolute(path)
        .map_err(|error| Failure::usage(format!("`{}` is no path: {error}", path.display()), "name a folder or file"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn a_transcript_holds_both_streams_and_the_exit_code() {
        let call = &calls("wrong slip -c 'echo'").unwrap()[0];
        let script = "echo said; echo complained >&2; exit 2";
        let output = Command::new("sh").args(["-c", script]).output().unwrap();
        assert_eq!(
            String::from_utf8(transcript(call, &output)).unwrap(),
            "$ stiffarm -c 'echo'\nsaid\n-- standard error\ncomplained\n-- exit code 2\n"
        );
    }

    #[cfg(unix)]
    #[test]
    fn an_unexpected_end_is_named_and_the_rest_still_runs() {
        let root = tempfile::tempdir().unwrap();
        let pass = Pass { folder: root.path().to_path_buf(), threads: None };
        files::write(&pass.folder.join("input.sh"), "exit 7").unwrap();
        let list = "once seven -s < input.sh\nwrong well -c true\n";
        let ended = run_all(Path::new("/bin/sh"), &pass, &calls(list).unwrap());
        let printed = files::below(&pass.folder.join("printed")).unwrap().len();
        let names: Vec<String> =
            ended.unwrap().iter().map(|line| line.split(':').next().unwrap().to_string()).collect();
        assert_eq!(names, ["seven.txt", "well.txt", "well.json.txt"]);
        assert_eq!(printed, 3);
    }
}
