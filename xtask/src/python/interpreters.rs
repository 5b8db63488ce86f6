//! The Pythons of a machine. A name says little: the shims of pyenv are there for versions that they then refuse to
//! start, so every one is run.

use std::cmp::Reverse;
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
    places.extend(pyenv_releases(wanted));
    places.into_iter().find(|place| version(place).is_some_and(|version| version == wanted))
}

/// The releases of this version that pyenv has, newest first.
fn pyenv_releases(wanted: &str) -> Vec<PathBuf> {
    let folder = match std::env::var_os("PYENV_ROOT") {
        Some(folder) => PathBuf::from(folder),
        None => std::env::home_dir().unwrap_or_default().join(".pyenv"),
    };
    let versions = folder.join("versions");
    let entries = std::fs::read_dir(&versions).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    newest_first(wanted, names).into_iter().map(|name| versions.join(name).join("bin/python")).collect()
}

/// Those of these releases that are of the version `wanted`: `3.10.12`, `3.10.9`, `3.10.10rc1`.
fn newest_first(wanted: &str, releases: impl Iterator<Item = String>) -> Vec<String> {
    let of_version = format!("{wanted}.");
    let mut all: Vec<String> = releases.filter(|release| release.starts_with(&of_version)).collect();
    // Those that are not final have letters, and no number.
    all.sort_by_cached_key(|release| (Reverse(release[of_version.len()..].parse::<u32>().ok()), release.clone()));
    all
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

    #[test]
    fn the_newest_release_of_a_version_comes_first() {
        let releases = ["3.10.9", "3.9.18", "3.10.12", "3.1.4", "3.10.10rc1", "3.100.1", "pypy3.10-7.3"];
        let sorted = newest_first("3.10", releases.map(String::from).into_iter());
        assert_eq!(sorted, ["3.10.12", "3.10.9", "3.10.10rc1"]);
    }
}
