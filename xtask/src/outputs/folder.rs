//! The folder that is filled, and the one it is compared with.

use std::path::{Path, PathBuf};

use super::absolute;
use crate::files;
use crate::run::{Failure, Workspace};

/// The file by which a folder of outputs is known, and what it holds.
const MARK: &str = "outputs.txt";
const MARK_TEXT: &str = "Made by `cargo xtask outputs`; the next run into this folder empties it first.\n";
/// Folders of inputs in the workspace, and their names among the outputs.
const INPUTS: [(&str, &str); 2] = [("xtask/inputs", "inputs"), ("cells", "cells")];

/// Refuses a folder that holds something else than outputs.
pub fn check(folder: &Path) -> Result<(), Failure> {
    let is_empty = match std::fs::read_dir(folder) {
        Ok(mut entries) => entries.next().is_none(),
        Err(_) => !folder.exists(),
    };
    let is_marked = std::fs::read_to_string(folder.join(MARK)).is_ok_and(|text| text == MARK_TEXT);
    if is_empty || is_marked {
        return Ok(());
    }
    Err(Failure::usage(
        format!("`{}` holds something else than the outputs of an earlier run", folder.display()),
        "name a new folder, or an empty one",
    ))
}

/// The folder to compare with; it is neither the one that is filled nor inside it.
pub fn other(other: &Path, folder: &Path) -> Result<PathBuf, Failure> {
    let other = absolute(other)?;
    let real = |path: &Path| std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    if !other.join(MARK).is_file() {
        return Err(Failure::usage(
            format!("`--against {}` holds no outputs", other.display()),
            "fill it first: `cargo xtask outputs` with this folder, before the change",
        ));
    }
    if real(&other).starts_with(real(folder)) || real(folder).starts_with(real(&other)) {
        return Err(Failure::usage(
            format!("`{}` and `--against {}` lie one in the other", folder.display(), other.display()),
            "name two folders side by side",
        ));
    }
    Ok(other)
}

/// Empties the folder and puts the inputs into it.
pub fn prepare(workspace: &Workspace, folder: &Path) -> Result<(), Failure> {
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(|error| {
            Failure::internal(
                format!("`{}` could not be emptied: {error}", folder.display()),
                "make it writable, or name another folder",
            )
        })?;
    }
    files::write(&folder.join(MARK), MARK_TEXT)?;
    for (from, to) in INPUTS {
        for (name, path) in files::below(&workspace.root().join(from))? {
            files::write(&folder.join(to).join(name), files::read(&path)?)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_outputs_are_emptied() {
        let root = tempfile::tempdir().unwrap();
        let workspace = Workspace::find().unwrap();
        let folder = root.path().join("outputs");
        check(&folder).unwrap();
        prepare(&workspace, &folder).unwrap();
        assert!(folder.join("cells/comau.toml").is_file());
        assert!(folder.join("inputs/full.toml").is_file());
        std::fs::write(folder.join("old.csv"), "old").unwrap();
        check(&folder).unwrap();
        prepare(&workspace, &folder).unwrap();
        assert!(!folder.join("old.csv").exists());

        std::fs::remove_file(folder.join(MARK)).unwrap();
        let failure = check(&folder).unwrap_err();
        assert_eq!(failure.code, 2);
        assert!(failure.message.contains("something else than the outputs"));
    }

    #[test]
    fn a_comparison_needs_outputs_beside_the_folder() {
        let root = tempfile::tempdir().unwrap();
        let workspace = Workspace::find().unwrap();
        let [first, second] = ["first", "second"].map(|name| root.path().join(name));
        assert_eq!(other(&first, &second).unwrap_err().code, 2);
        prepare(&workspace, &first).unwrap();
        assert_eq!(other(&first, &second).unwrap(), first);
        for folder in [&first, root.path(), &first.join("inside")] {
            let failure = other(&first, folder).unwrap_err();
            assert!(failure.message.ends_with("lie one in the other"));
        }
    }
}
