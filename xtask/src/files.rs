//! Files, read and written with a failure that names them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::run::Failure;

pub fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|error| unreadable(path, &error))
}

pub fn text(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| unreadable(path, &error))
}

/// Writes a file, and makes the folder that it lies in.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<(), Failure> {
    let folder = path.parent().unwrap_or(path);
    std::fs::create_dir_all(folder).and_then(|()| std::fs::write(path, content)).map_err(|error| {
        Failure::internal(
            format!("`{}` could not be written: {error}", path.display()),
            "make it writable, or name another folder",
        )
    })
}

/// Every file in `folder` and the folders in it, by its path below `folder` with `/` on every system.
pub fn below(folder: &Path) -> Result<BTreeMap<String, PathBuf>, Failure> {
    let mut files = BTreeMap::new();
    for entry in std::fs::read_dir(folder).map_err(|error| unreadable(folder, &error))? {
        let entry = entry.map_err(|error| unreadable(folder, &error))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = entry.path();
        if path.is_dir() {
            let inside = below(&path)?.into_iter();
            files.extend(inside.map(|(rest, path)| (format!("{name}/{rest}"), path)));
        } else {
            files.insert(name, path);
        }
    }
    Ok(files)
}

/// The number of the first line in which two different contents differ, counted from 1.
pub fn first_difference(left: &[u8], right: &[u8]) -> usize {
    let same = left.iter().zip(right).take_while(|(l, r)| l == r).count();
    1 + left[..same].iter().filter(|byte| **byte == b'\n').count()
}

fn unreadable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::internal(format!("`{}` could not be read: {error}", path.display()), "check that the checkout is complete")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_found_in_every_folder() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b", "a/c/d", "a/e"] {
            write(&folder.path().join(name), name).unwrap();
        }
        let files = below(folder.path()).unwrap();
        assert_eq!(Vec::from_iter(files.keys()), ["a/c/d", "a/e", "b"]);
        assert_eq!(text(&files["a/c/d"]).unwrap(), "a/c/d");
        let none = folder.path().join("none");
        assert_eq!((below(&none).unwrap_err().code, read(&none).unwrap_err().code), (3, 3));
    }

    #[test]
    fn the_first_difference_is_counted_in_lines() {
        assert_eq!(first_difference(b"", b"a"), 1);
        assert_eq!(first_difference(b"a\nb\nc", b"a\nb\nd"), 3);
        assert_eq!(first_difference(b"a\n", b"a\nb\n"), 2);
    }
}
