//! `cargo xtask generate`: files that are made from the code, so that they cannot contradict it.

use std::collections::BTreeMap;
use std::env::consts::EXE_SUFFIX;
use std::path::Path;

use crate::files::{self, first_difference};
use crate::run::{Failure, Workspace};
use crate::tools;

/// The example of the command that prints every file made from the code.
const EXAMPLE: &str = "generated";

/// Copies of files. The licences go into the wheel, which takes nothing from outside its folder.
const COPIES: [(&str, &str); 2] =
    [("crates/stiffarm-py/LICENSE-APACHE", "LICENSE-APACHE"), ("crates/stiffarm-py/LICENSE-MIT", "LICENSE-MIT")];

/// A folder that holds the files of another and nothing else.
const FOLDER: (&str, &str) = ("cells", "crates/stiffarm-files/data/cells");

/// File contents by path relative to the workspace root, with `/` on every system.
type Files = BTreeMap<String, Vec<u8>>;

/// Writes what is generated, or with `check` only compares it.
pub fn run(workspace: &Workspace, check: bool) -> Result<(), Failure> {
    // The schemas' code runs for a moment, and is a fifth of the library: not optimised, a build of a minute.
    let profile = ["--config", "profile.dev.package.stiffarm.opt-level=0"];
    let example = ["--example", EXAMPLE, "--features", "stiffarm-cli/schema"];
    let build = [&["build", "--quiet", "--locked"][..], &profile, &example].concat();
    workspace.cargo(&build).run()?;
    let example = tools::built(&format!("examples/{EXAMPLE}{EXE_SUFFIX}"))?;
    let printed: BTreeMap<String, String> = tools::call(&example, &[])
        .and_then(|text| serde_json::from_str(&text).map_err(|why| why.to_string()))
        .map_err(|why| Failure::internal(format!("`{}`: {why}", example.display()), "correct it"))?;
    compare(workspace.root(), &expected(workspace.root(), printed)?, check)
}

/// What every generated file should hold, with those that the example has `printed`.
fn expected(root: &Path, printed: BTreeMap<String, String>) -> Result<Files, Failure> {
    let bytes = |(path, text): (String, String)| (path, text.into_bytes());
    let mut expected: Files = printed.into_iter().map(bytes).collect();
    for (target, original) in COPIES {
        expected.insert(target.to_string(), files::read(&root.join(original))?);
    }
    let (folder, originals) = FOLDER;
    for (name, path) in files::below(&root.join(originals))? {
        expected.insert(format!("{folder}/{name}"), files::read(&path)?);
    }
    Ok(expected)
}

/// Writes every file below `root` that is not as expected, or with `check` tells it. What nothing generates is left for
/// a person to judge.
fn compare(root: &Path, expected: &Files, check: bool) -> Result<(), Failure> {
    let mut faults = Vec::new();
    for (path, content) in expected {
        let target = root.join(path);
        let present = std::fs::read(&target).unwrap_or_default();
        if present == *content {
            continue;
        }
        if check {
            let line = first_difference(&present, content);
            println!("{path}:{line}: out of date from this line on; fix: cargo xtask generate");
            faults.push(path.clone());
        } else {
            files::write(&target, content)?;
            println!("wrote {path}");
        }
    }
    for name in files::below(&root.join(FOLDER.0))?.into_keys() {
        let path = format!("{}/{name}", FOLDER.0);
        if !expected.contains_key(&path) {
            println!("{path}: nothing generates it; fix: delete it, or move it to {}", FOLDER.1);
            faults.push(path);
        }
    }
    if faults.is_empty() {
        println!("{} generated files are up to date", expected.len());
        return Ok(());
    }
    Err(Failure::finding(
        format!("generated files differ from what the code generates: {}", faults.join(", ")),
        "run `cargo xtask generate`, look at the change with `git diff` and commit it",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_compared_and_repaired_and_strays_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        let files = [("cells/comau.toml", "format = 1\n"), ("docs/errors.md", "# Errors\n")];
        let expected = files.map(|(path, text)| (path.to_string(), text.as_bytes().to_vec()));
        let expected = Files::from(expected);
        files::write(&root.join("cells/comau.toml"), "format = 2\n").unwrap();
        let compared = |check| compare(root, &expected, check).map_err(|failure| failure.message);
        let both = compared(true).unwrap_err();
        assert!(both.ends_with(": cells/comau.toml, docs/errors.md"));
        compared(false).unwrap();
        compared(true).unwrap();
        for (path, text) in files {
            assert_eq!(files::text(&root.join(path)).unwrap(), text);
        }
        files::write(&root.join("cells/old.toml"), "").unwrap();
        assert!(compared(false).unwrap_err().ends_with(": cells/old.toml"));
        assert!(root.join("cells/old.toml").is_file());
    }
}
