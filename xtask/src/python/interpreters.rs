//! The Pythons of a machine. A name says little: the shims of pyenv are there for versions that they then refuse to
//! start, so every one is run.

use std::path::{Path, PathBuf};

use crate::tools::{self, call};

/// Every Python that the package supports and that there is today, oldest first.
pub const SUPPORTED: [&str; 5] = ["3.10", "3.11", "3.12", "3.13", "3.14"];

/// What the script prints: `3.11`.
const VERSION: &str = "import sys; print('%d.%d' % sys.version_info[:2])";

/// The version of the Python that the tests run on; none where there is no Python 3.10 or newer.
pub fn of_this_machine() -> Option<String> {
    version(Path::new(tools::interpreter()?))
}

/// A Python of this version: the one on the path, or one that pyenv keeps.
pub fn of_version(wanted: &str) -> Option<PathBuf> {
    let on_path = PathBuf::from(format!("python{wanted}"));
    let mut places = vec![on_path];
    places.extend(kept_by_pyenv(wanted));
    places.into_iter().find(|place| version(place).is_some_and(|version| version == wanted))
}

/// Where pyenv keeps releases of this version.
fn kept_by_pyenv(wanted: &str) -> Vec<PathBuf> {
    let folder = match std::env::var_os("PYENV_ROOT") {
        Some(folder) => PathBuf::from(folder),
        None => std::env::home_dir().unwrap_or_default().join(".pyenv"),
    };
    let Ok(entries) = std::fs::read_dir(folder.join("versions")) else {
        return Vec::new();
    };
    let release = format!("{wanted}.");
    let mut pythons: Vec<PathBuf> = entries
        .flatten()
        .filter(|entry| entry.file_name().to_string_lossy().starts_with(&release))
        .map(|entry| entry.path().join("bin/python"))
        .collect();
    pythons.sort();
    pythons
}

/// `3.11` of a Python that runs.
fn version(python: &Path) -> Option<String> {
    let said = call(python, &["-c", VERSION]).ok()?;
    Some(said.trim().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_python_is_one_that_runs_and_says_its_version() {
        assert_eq!(version(Path::new("no-such-python-of-stiffarm")), None);
        assert_eq!(of_version("2.0"), None);
        if let Some(version) = of_this_machine() {
            assert!(version.starts_with("3."), "{version}");
            assert!(version.split('.').nth(1).unwrap().parse::<u32>().unwrap() >= 10);
        }
    }
}
