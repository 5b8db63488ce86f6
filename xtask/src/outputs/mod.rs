//! `cargo xtask outputs`: everything that `stiffarm` prints and writes, to compare before with after.

mod binary;
mod compare;
pub mod fanuc;
mod folder;
mod list;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Instant;

use crate::arguments::OutputsOptions;
use crate::reference::{REFERENCE_VARIABLE, reference_folder};
use crate::run::{Failure, Workspace};
use list::{COMMANDS, Call, FANUC, brief, calls};

/// The folder of what the commands print.
const PRINTED: &str = "printed";
/// Variables that change what a command prints or how it works.
const UNSET: [&str; 5] = [
    "NO_COLOR",
    "CLICOLOR",
    "CLICOLOR_FORCE",
    "COLUMNS",
    "RAYON_NUM_THREADS",
];
/// How many runs pass between two signs of life.
const TOLD_EVERY: usize = 100;

/// Fills the folder, and compares it where that is asked for. The closing line is the last one.
pub fn run(workspace: &Workspace, options: &OutputsOptions) -> Result<(), Failure> {
    let folder = absolute(&options.folder)?;
    folder::check(&folder)?;
    let against = options.against.as_deref();
    let against = against
        .map(|other| folder::other(other, &folder))
        .transpose()?;
    let robot = fanuc::folder(reference_folder(std::env::var_os(REFERENCE_VARIABLE)));
    let mut calls = match &robot {
        Ok(_) => calls(&format!("{COMMANDS}{FANUC}"))?,
        Err(why) => {
            println!("without the measured robot: {why}");
            calls(COMMANDS)?
        }
    };
    if options.is_brief {
        calls = brief(calls);
    }
    let binary = match &options.binary {
        Some(binary) => binary::given(binary)?,
        None => binary::built(workspace)?,
    };
    // Without a wish once, with the machine's own number of threads.
    let wishes = match options.threads.as_slice() {
        [] => vec![None],
        threads => threads.iter().copied().map(Some).collect(),
    };
    let mut passes = Vec::new();
    for (i, threads) in wishes.into_iter().enumerate() {
        let filled = match threads.filter(|_| i > 0) {
            Some(threads) => beside(&folder, threads),
            None => folder.clone(),
        };
        folder::check(&filled)?;
        folder::prepare(workspace, &filled)?;
        if let Ok(robot) = &robot {
            fanuc::write(robot, &filled.join("fanuc.csv"))?;
        }
        passes.push((filled, threads));
    }
    // Each has a folder of its own, so they need not wait for each other.
    let start = Instant::now();
    let ran: Vec<_> = std::thread::scope(|scope| {
        let run = |(filled, threads): &(PathBuf, Option<u16>)| {
            let (binary, calls, filled, threads) = (&binary, &calls, filled.clone(), *threads);
            scope.spawn(move || run_all(binary, &filled, calls, threads))
        };
        let running: Vec<_> = passes.iter().map(run).collect();
        running.into_iter().map(|pass| pass.join()).collect()
    });
    println!("{:.1} s", start.elapsed().as_secs_f64());
    let mut against = against;
    let mut ended = Ok(());
    for ((filled, threads), unexpected) in passes.iter().zip(ran) {
        let unexpected = unexpected.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        let on = threads.map_or(String::new(), |threads| format!(" on {threads} threads"));
        println!("{} runs of stiffarm{on}", calls.len());
        let reported = report(filled, against.as_deref(), &unexpected);
        ended = ended.and(reported);
        // Every other number of threads gives the same bytes as the first.
        against = Some(folder.clone());
    }
    ended
}

/// The folder of the same outputs on `threads` threads.
fn beside(folder: &Path, threads: u16) -> PathBuf {
    let mut name = folder.as_os_str().to_owned();
    name.push(format!("-{threads}"));
    PathBuf::from(name)
}

/// Prints what differs, what ended unexpectedly, and the closing line.
fn report(folder: &Path, against: Option<&Path>, unexpected: &[String]) -> Result<(), Failure> {
    let comparison = against.map(|other| compare::compare(folder, other));
    let comparison = comparison.transpose()?;
    if let Some(comparison) = &comparison {
        print!("{}", comparison.details());
    }
    for line in unexpected {
        println!("UNEXPECTED {line}");
    }
    match &comparison {
        Some(comparison) => println!("{}", comparison.closing()),
        None => println!("outputs: {} files", compare::count(folder)?),
    }
    if unexpected.is_empty() && comparison.is_none_or(|comparison| comparison.is_same()) {
        Ok(())
    } else {
        Err(Failure::already_told())
    }
}

/// Runs the calls in their order and keeps what they print. The result names those that ended with another exit code
/// than the list expects.
fn run_all(
    binary: &Path,
    folder: &Path,
    calls: &[Call],
    threads: Option<u16>,
) -> Result<Vec<String>, Failure> {
    let mut unexpected = Vec::new();
    for (done, call) in (1..).zip(calls) {
        let output = run_one(binary, folder, call, threads)?;
        let code = output.status.code();
        if !code.is_some_and(|code| call.codes().contains(&code)) {
            unexpected.push(format!(
                "{}: `{}`: {}",
                call.file,
                call.line(),
                output.status
            ));
        }
        let path = folder.join(PRINTED).join(&call.file);
        std::fs::write(&path, transcript(call, &output)).map_err(|e| unwritable(&path, &e))?;
        if done % TOLD_EVERY == 0 {
            let on = threads.map_or(String::new(), |threads| format!(" on {threads} threads"));
            println!("{done} of {} runs{on}", calls.len());
        }
    }
    Ok(unexpected)
}

/// Runs one call in the folder, in surroundings that are always the same.
fn run_one(
    binary: &Path,
    folder: &Path,
    call: &Call,
    threads: Option<u16>,
) -> Result<Output, Failure> {
    let error = |error: std::io::Error| {
        Failure::internal(
            format!("`{}` could not be run: {error}", call.line()),
            "check that it is an executable of this system",
        )
    };
    let mut command = Command::new(binary);
    // Its usage lines show the name it was called by.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::arg0(&mut command, "stiffarm");
    command
        .args(&call.words)
        .current_dir(folder)
        .env("TERM", "dumb")
        .stdin(Stdio::null());
    for name in UNSET {
        command.env_remove(name);
    }
    if let Some(threads) = threads {
        // Not as an option, which would stand in what is printed.
        command.env("RAYON_NUM_THREADS", threads.to_string());
    }
    // Without a file that an earlier command should have written, this one fails and is named too.
    if let Some(input) = &call.input
        && let Ok(input) = std::fs::File::open(folder.join(input))
    {
        command.stdin(input);
    }
    command.output().map_err(error)
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
    std::path::absolute(path).map_err(|error| {
        Failure::usage(
            format!("`{}` is no path: {error}", path.display()),
            "name a folder or file",
        )
    })
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::internal(
        format!("`{}` could not be written: {error}", path.display()),
        "make it writable, or name another folder",
    )
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
        let folder = std::env::temp_dir().join(format!("xtask-outputs-{}", std::process::id()));
        std::fs::create_dir_all(folder.join(PRINTED)).unwrap();
        std::fs::write(folder.join("input.sh"), "exit 7").unwrap();
        let list = "once seven -s < input.sh\nwrong well -c true\n";
        let ended = run_all(Path::new("/bin/sh"), &folder, &calls(list).unwrap(), None);
        let printed = std::fs::read_dir(folder.join(PRINTED)).unwrap().count();
        std::fs::remove_dir_all(&folder).unwrap();
        let names: Vec<String> = ended
            .unwrap()
            .iter()
            .map(|line| line.split(':').next().unwrap().to_string())
            .collect();
        assert_eq!(names, ["seven.txt", "well.txt", "well.json.txt"]);
        assert_eq!(printed, 3);
    }
}
