//! `cargo xtask fuzz`, and the half minute of it that is part of CI.

use std::env::consts::EXE_SUFFIX;
use std::process::Command;

use crate::run::{Failure, Workspace};
use crate::tools;

/// How long CI looks for faults \[s\].
pub const SMOKE_SECONDS: u32 = 30;

/// Inputs of one seed, so that a change is judged by what it did and not by chance.
const SMOKE_SEED: u32 = 1;

/// Builds the fuzzer for release and runs it with `words`.
pub fn run(workspace: &Workspace, words: &[String]) -> Result<(), Failure> {
    let mut arguments = vec!["run", "--quiet", "--release", "--bin", "stiffarm-fuzz", "--"];
    arguments.extend(words.iter().map(String::as_str));
    let call = workspace.cargo(&arguments).fix("mend the fault, keep its input in fuzz/regressions, then run it again");
    call.run()
}

/// Runs the fuzzer that a build of the tests has left beside this program, for [`SMOKE_SECONDS`].
pub fn smoke() -> Result<(), Failure> {
    let program = tools::built(&format!("stiffarm-fuzz{EXE_SUFFIX}"))?;
    let status = Command::new(program)
        .args(["--seconds", &SMOKE_SECONDS.to_string()])
        .args(["--seed", &SMOKE_SEED.to_string()])
        .status();
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(Failure::finding(
            format!("the fuzzer found a fault ({status})"),
            "run the line below the fault, mend it and keep its input in fuzz/regressions",
        )),
        Err(error) => Err(Failure::internal(
            format!("the fuzzer could not be run: {error}"),
            "run `cargo xtask ci`, which builds it",
        )),
    }
}
