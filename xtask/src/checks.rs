//! `cargo xtask lint` and `cargo xtask ci`: what must hold before a change is taken.

use crate::arguments;
use crate::run::{Failure, Workspace, beside, step, timed};
use crate::{fuzz, generate, outputs, structure, test, tools};

/// Every check that is not a test; stops at the first that fails.
pub fn lint(workspace: &Workspace) -> Result<(), Failure> {
    check_code(workspace)?;
    step("cargo xtask generate --check", || generate::run(workspace, true))?;
    check_dependencies(workspace)
}

/// What [`lint`] does, a little fuzzing, all commands on 1 and 4 threads, then the tests. Their closing line is the
/// last line of all. What neither a compiler nor a search keeps busy runs beside other work.
pub fn ci(workspace: &Workspace, options: &arguments::Test) -> Result<(), Failure> {
    check_code(workspace)?;
    check_dependencies(workspace)?;
    let build = workspace.build();
    step(&build, || build.run())?;
    let threads = arguments::Outputs {
        folder: workspace.root().join("target/outputs"),
        threads: vec![1, 4],
        binary: Some(tools::stiffarm()?),
        is_brief: true,
        ..arguments::Outputs::default()
    };
    println!("\n== cargo xtask generate --check, outputs and fuzz");
    let generate = || timed("generate", || generate::run(workspace, true));
    let fuzz = || timed("fuzz", fuzz::smoke);
    let outputs = || timed("outputs", || outputs::run(workspace, &threads));
    let (generated, (fuzzed, same)) = beside(generate, || beside(fuzz, outputs));
    generated.and(fuzzed).and(same)?;
    println!("\n== cargo xtask test");
    test::run(workspace, options)
}

/// Format, structure, clippy and documentation.
fn check_code(workspace: &Workspace) -> Result<(), Failure> {
    let format = workspace.cargo(&["fmt", "--all", "--check"]).fix("run `cargo fmt --all`");
    step(&format, || format.run())?;
    step("structure of the code", || structure::check(workspace))?;
    let clippy = ["clippy", "--locked", "--workspace", "--all-targets"];
    run_step(workspace, &[&clippy[..], &["--", "-D", "warnings"]].concat())?;
    document(workspace)
}

/// Licences and unused dependencies.
fn check_dependencies(workspace: &Workspace) -> Result<(), Failure> {
    run_if_installed(workspace, "deny", &["deny", "check", "licenses", "bans"])?;
    run_if_installed(workspace, "machete", &["machete"])
}

fn document(workspace: &Workspace) -> Result<(), Failure> {
    let doc = workspace.cargo(&["doc", "--workspace", "--no-deps", "--locked"]).env("RUSTDOCFLAGS", "-D warnings");
    step(&doc, || doc.run())
}

/// Runs cargo with `arguments` as one step, headed by the line a developer would type.
fn run_step(workspace: &Workspace, arguments: &[&str]) -> Result<(), Failure> {
    let call = workspace.cargo(arguments);
    step(&call, || call.run())
}

/// [`run_step`] where `cargo <subcommand>` is installed, and one line where it is not.
fn run_if_installed(workspace: &Workspace, subcommand: &str, arguments: &[&str]) -> Result<(), Failure> {
    if workspace.cargo(&[subcommand, "--version"]).succeeds() {
        run_step(workspace, arguments)
    } else {
        println!("\n== cargo {subcommand}: not installed, left out (cargo install --locked cargo-{subcommand})");
        Ok(())
    }
}
