//! `cargo xtask generate`: files that are made from the code, so that they cannot contradict it.

use std::collections::BTreeMap;
use std::path::Path;

use crate::files::{self, first_difference};
use crate::run::{Failure, Workspace};
use crate::tools;

/// Files that the `stiffarm` command prints, and with which arguments. Paths begin at the workspace root.
const PRINTED: [(&str, [&str; 2]); 1] = [("docs/errors.md", ["docs", "errors"])];

/// Folder of the schemas that the command prints, and where that of the cell file is read by people and editors.
const SCHEMAS: (&str, &str) = ("crates/stiffarm-cli/schemas", "docs/cell.schema.json");

/// Copies of files. The licences go into the wheel, which takes nothing from outside its folder.
const COPIES: [(&str, &str); 2] = [
    ("crates/stiffarm-py/LICENSE-APACHE", "LICENSE-APACHE"),
    ("crates/stiffarm-py/LICENSE-MIT", "LICENSE-MIT"),
];

/// A folder that holds the files of another and nothing else.
const FOLDER: (&str, &str) = ("cells", "crates/stiffarm/data/cells");

/// File contents by path relative to the workspace root, with `/` on every system.
type Files = BTreeMap<String, Vec<u8>>;

/// Builds everything, then writes what is generated, or with `check` only compares it.
pub fn run(workspace: &Workspace, check: bool) -> Result<(), Failure> {
    workspace.built()?;
    run_built(workspace, check)
}

/// [`run`] with the `stiffarm` that has been built into the folder of this program.
pub fn run_built(workspace: &Workspace, check: bool) -> Result<(), Failure> {
    let expected = expected(workspace.root(), &tools::stiffarm()?)?;
    compare(workspace.root(), &expected, check)
}

/// What every generated file should hold.
fn expected(root: &Path, stiffarm: &Path) -> Result<Files, Failure> {
    let mut expected = Files::new();
    let fault = |words: [&str; 2], why: &dyn std::fmt::Display| {
        let message = format!("`stiffarm {}` failed: {why}", words.join(" "));
        Failure::internal(message, "correct it, then run it again")
    };
    let printed =
        |words: [&str; 2]| tools::call(stiffarm, &words).map_err(|why| fault(words, &why));
    for (target, words) in PRINTED {
        expected.insert(target.to_string(), printed(words)?.into_bytes());
    }
    let words = ["docs", "schemas"];
    let schemas: BTreeMap<String, String> =
        serde_json::from_str(&printed(words)?).map_err(|why| fault(words, &why))?;
    let (folder, cell) = SCHEMAS;
    for (name, text) in schemas {
        let text = text.into_bytes();
        if name == "cell" {
            expected.insert(cell.to_string(), text.clone());
        }
        expected.insert(format!("{folder}/{name}.json"), text);
    }
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
            println!(
                "{path}: nothing generates it; fix: delete it, or move it to {}",
                FOLDER.1
            );
            faults.push(path);
        }
    }
    if faults.is_empty() {
        println!("{} generated files are up to date", expected.len());
        return Ok(());
    }
    Err(Failure::finding(
        format!(
            "generated files differ from what the code generates: {}",
            faults.join(", ")
        ),
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
        let files = [
            ("cells/comau.toml", "format = 1\n"),
            ("docs/errors.md", "# Errors\n"),
        ];
        let expected = files.map(|(path, text)| (path.to_string(), text.as_bytes().to_vec()));
        let expected = Files::from(expected);
        files::write(&root.join("cells/comau.toml"), "format = 2\n").unwrap();
        let told = |check| compare(root, &expected, check).map_err(|failure| failure.message);
        let both = told(true).unwrap_err();
        assert!(both.ends_with(": cells/comau.toml, docs/errors.md"));
        told(false).unwrap();
        told(true).unwrap();
        for (path, text) in files {
            assert_eq!(files::text(&root.join(path)).unwrap(), text);
        }
        files::write(&root.join("cells/old.toml"), "").unwrap();
        assert!(told(false).unwrap_err().ends_with(": cells/old.toml"));
        assert!(root.join("cells/old.toml").is_file());
    }
}
