//! `cargo xtask lint` and `cargo xtask ci`: what must hold before a change is taken.

use crate::arguments::{OutputsOptions, TestOptions};
use crate::run::{Failure, Workspace, step};
use crate::{fuzz, generate, outputs, structure, test};

/// Every check that is not a test; stops at the first that fails.
pub fn lint(workspace: &Workspace) -> Result<(), Failure> {
    check_code(workspace)?;
    step("cargo xtask generate --check", || {
        generate::run(workspace, true)
    })?;
    check_dependencies(workspace)
}

/// What [`lint`] does, a little fuzzing, all commands on 1, 2 and 4 threads, then the tests. Their closing line is the last line of all.
pub fn ci(workspace: &Workspace, options: &TestOptions) -> Result<(), Failure> {
    check_code(workspace)?;
    let build = workspace.build();
    step(&build, || build.run())?;
    step("cargo xtask generate --check", || {
        generate::run_built(workspace, true)
    })?;
    check_dependencies(workspace)?;
    let seconds = fuzz::SMOKE_SECONDS;
    step(format!("cargo xtask fuzz --seconds {seconds}"), fuzz::smoke)?;
    let threads = OutputsOptions {
        folder: workspace.root().join("target/outputs"),
        threads: vec![1, 2, 4],
        is_brief: true,
        ..OutputsOptions::default()
    };
    let same = "cargo xtask outputs target/outputs --threads 1,2,4 --brief";
    step(same, || outputs::run(workspace, &threads))?;
    println!("\n== cargo xtask test");
    test::run(workspace, options)
}

/// Format, structure, clippy and documentation.
fn check_code(workspace: &Workspace) -> Result<(), Failure> {
    let format = workspace
        .cargo(&["fmt", "--all", "--check"])
        .fix("run `cargo fmt --all`");
    step(&format, || format.run())?;
    step("structure of the code", || structure::check(workspace))?;
    // All features of everything first: the other two combinations that matter leave parts of the library out, and
    // the nightly workflow checks every one. Clippy and not `cargo check`, because only it can refuse warnings
    // without compiling every dependency anew.
    for selection in [
        &["--workspace", "--all-targets", "--all-features"][..],
        &["--package", "stiffarm"],
        &["--package", "stiffarm", "--no-default-features"],
    ] {
        clippy(workspace, selection)?;
    }
    document(workspace)
}

/// Licences and unused dependencies.
fn check_dependencies(workspace: &Workspace) -> Result<(), Failure> {
    run_if_installed(workspace, "deny", &["deny", "check", "licenses", "bans"])?;
    run_if_installed(workspace, "machete", &["machete"])
}

/// The library with every set of its features: what [`lint`] leaves to the nightly workflow.
pub fn features(workspace: &Workspace) -> Result<(), Failure> {
    let path = "crates/stiffarm/Cargo.toml";
    let manifest = std::fs::read_to_string(workspace.root().join(path)).map_err(|error| {
        Failure::internal(
            format!("`{path}` could not be read: {error}"),
            "check that the checkout is complete",
        )
    })?;
    for names in subsets(&feature_names(&manifest)) {
        let features = format!("--features={}", names.join(","));
        let mut selection = vec!["--package", "stiffarm", "--no-default-features"];
        selection.extend((!names.is_empty()).then_some(features.as_str()));
        clippy(workspace, &selection)?;
    }
    Ok(())
}

fn clippy(workspace: &Workspace, selection: &[&str]) -> Result<(), Failure> {
    let arguments = [
        &["clippy", "--locked"],
        selection,
        &["--", "-D", "warnings"],
    ]
    .concat();
    run_step(workspace, &arguments)
}

fn document(workspace: &Workspace) -> Result<(), Failure> {
    let doc = workspace
        .cargo(&[
            "doc",
            "--workspace",
            "--no-deps",
            "--all-features",
            "--locked",
        ])
        .env("RUSTDOCFLAGS", "-D warnings");
    step(&doc, || doc.run())
}

/// Every set of `names`, the empty one first.
fn subsets<'a>(names: &[&'a str]) -> Vec<Vec<&'a str>> {
    let mut sets = vec![Vec::new()];
    for name in names {
        let with: Vec<Vec<&str>> = sets
            .iter()
            .map(|set| [set, &[*name][..]].concat())
            .collect();
        sets.extend(with);
    }
    sets
}

/// The names in the `[features]` table of a Cargo.toml, without `default`. Read from the manifest, so that a new
/// feature is checked from its first day.
fn feature_names(manifest: &str) -> Vec<&str> {
    let table = manifest
        .lines()
        .skip_while(|line| line.trim() != "[features]")
        .skip(1)
        .take_while(|line| !line.starts_with('['));
    let assignments = table.filter(|line| !line.starts_with(['#', ' ', ']']));
    let names = assignments.filter_map(|line| Some(line.split_once('=')?.0.trim()));
    names.filter(|name| *name != "default").collect()
}

/// Runs cargo with `arguments` as one step, headed by the line a developer would type.
fn run_step(workspace: &Workspace, arguments: &[&str]) -> Result<(), Failure> {
    let call = workspace.cargo(arguments);
    step(&call, || call.run())
}

/// [`run_step`] where `cargo <subcommand>` is installed, and one line where it is not.
fn run_if_installed(
    workspace: &Workspace,
    subcommand: &str,
    arguments: &[&str],
) -> Result<(), Failure> {
    if workspace.cargo(&[subcommand, "--version"]).succeeds() {
        run_step(workspace, arguments)
    } else {
        println!(
            "\n== cargo {subcommand}: not installed, left out (cargo install --locked cargo-{subcommand})"
        );
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MANIFEST: &str = r#"
[package]
name = "stiffarm"

[features]
default = ["files", "parallel"]
# Reading = files.
files = ["dep:toml", "dep:csv"]
long = [
    "dep:a",
    "dep:b",
]
schema = ["dep:schemars"]

[dependencies]
nalgebra = "1"
"#;

    #[test]
    fn features_are_read_from_the_manifest() {
        assert_eq!(feature_names(MANIFEST), ["files", "long", "schema"]);
        assert!(feature_names("[package]\nname = \"a\"\n").is_empty());
    }

    #[test]
    fn every_set_of_features_is_checked() {
        assert_eq!(
            subsets(&["a", "b"]),
            [vec![], vec!["a"], vec!["b"], vec!["a", "b"]]
        );
        assert_eq!(subsets(&["a", "b", "c", "d"]).len(), 16);
    }

    #[test]
    fn the_library_has_features() {
        let workspace = Workspace::find().unwrap();
        let manifest = std::fs::read_to_string(workspace.root().join("crates/stiffarm/Cargo.toml"));
        assert!(feature_names(&manifest.unwrap()).contains(&"files"));
    }
}
