//! `cargo xtask lint` and `cargo xtask ci`: what must hold before a change is taken.

use crate::arguments::TestOptions;
use crate::run::{Failure, Workspace, step};
use crate::{generate, test};

/// Every check that is not a test; stops at the first that fails.
pub fn lint(workspace: &Workspace) -> Result<(), Failure> {
    let format = workspace
        .cargo(&["fmt", "--all", "--check"])
        .fix("run `cargo fmt --all`");
    step(&format, || format.run())?;
    run_step(
        workspace,
        &[
            "clippy",
            "--workspace",
            "--all-targets",
            "--all-features",
            "--locked",
            "--",
            "-D",
            "warnings",
        ],
    )?;
    let doc = workspace
        .cargo(&[
            "doc",
            "--workspace",
            "--no-deps",
            "--all-features",
            "--locked",
        ])
        .env("RUSTDOCFLAGS", "-D warnings");
    step(&doc, || doc.run())?;
    check_features(workspace)?;
    step("cargo xtask generate --check", || {
        generate::run(workspace, true)
    })?;
    run_if_installed(workspace, "deny", &["deny", "check", "licenses", "bans"])?;
    run_if_installed(workspace, "machete", &["machete"])
}

/// [`lint`], then the tests. Their closing line is the last line of all.
pub fn ci(workspace: &Workspace, options: &TestOptions) -> Result<(), Failure> {
    lint(workspace)?;
    println!("\n== cargo xtask test");
    test::run(workspace, options)
}

/// The library compiles without a warning with no feature, with each alone and with all. Clippy and not `cargo check`,
/// because only it can refuse warnings, such as an unused import, without compiling every dependency anew.
fn check_features(workspace: &Workspace) -> Result<(), Failure> {
    let path = "crates/stiffarm/Cargo.toml";
    let manifest = std::fs::read_to_string(workspace.root().join(path)).map_err(|error| {
        Failure::internal(
            format!("`{path}` could not be read: {error}"),
            "check that the checkout is complete",
        )
    })?;
    for selection in feature_selections(&manifest) {
        let mut arguments = vec!["clippy", "--locked", "--package", "stiffarm"];
        arguments.extend(selection.iter().map(String::as_str));
        arguments.extend(["--", "-D", "warnings"]);
        run_step(workspace, &arguments)?;
    }
    Ok(())
}

/// The options that select no feature, each feature of `manifest` alone, and all.
fn feature_selections(manifest: &str) -> Vec<Vec<String>> {
    let none = "--no-default-features".to_string();
    let mut selections = vec![vec![none.clone()]];
    for feature in feature_names(manifest) {
        selections.push(vec![none.clone(), format!("--features={feature}")]);
    }
    selections.push(vec!["--all-features".to_string()]);
    selections
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
# Tables = files.
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
    fn none_each_alone_and_all_are_checked() {
        let manifest = "[features]\nfiles = []\n";
        assert_eq!(
            feature_selections(manifest),
            [
                vec!["--no-default-features"],
                vec!["--no-default-features", "--features=files"],
                vec!["--all-features"],
            ]
        );
    }

    #[test]
    fn the_library_has_features() {
        let workspace = Workspace::find().unwrap();
        let manifest = std::fs::read_to_string(workspace.root().join("crates/stiffarm/Cargo.toml"));
        assert!(feature_names(&manifest.unwrap()).contains(&"files"));
    }
}
