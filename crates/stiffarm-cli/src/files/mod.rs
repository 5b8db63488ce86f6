//! Writing files: never over existing ones unasked, and never half.

use crate::session::Session;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use stiffarm::{Code, Error, Result};

/// A place to write to that was checked beforehand.
#[derive(Debug, Clone)]
pub enum Target {
    /// Standard output.
    Stdout,
    /// A file that may be made or replaced.
    File(PathBuf),
    /// A device or pipe: written in place.
    Device(PathBuf),
}

impl Target {
    /// Checks `path` (`-` is standard output) before any work is done for it.
    ///
    /// # Errors
    /// The file exists and `force` is not given, or its folder is missing.
    pub fn new(path: &str, force: bool) -> Result<Self> {
        if path == "-" {
            return Ok(Target::Stdout);
        }
        Target::file(Path::new(path), force)
    }

    /// As [`Target::new`], without a meaning for `-`.
    ///
    /// # Errors
    /// As [`Target::new`].
    pub fn file(path: &Path, force: bool) -> Result<Self> {
        let shown = path.display().to_string();
        match fs::metadata(path) {
            Ok(meta) if meta.is_dir() => Err(Error::new(
                Code::FileWrite,
                "This is a folder; the output is a file.",
            )
            .file(shown)
            .hint("give a file name inside it")),
            Ok(meta) if !meta.is_file() => Ok(Target::Device(path.to_path_buf())),
            Ok(_) if !force => Err(Error::new(Code::FileExists, "The file exists already.")
                .file(shown)
                .hint("add --force to overwrite it, or choose another name")),
            // A link stays a link: what it points to is replaced.
            Ok(_) => Ok(Target::File(
                fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf()),
            )),
            Err(_) => {
                let folder = folder_of(path);
                if folder.is_dir() {
                    return Ok(Target::File(path.to_path_buf()));
                }
                Err(Error::new(
                    Code::FileWrite,
                    format!("There is no folder {}.", folder.display()),
                )
                .file(shown)
                .hint("make the folder first"))
            }
        }
    }

    /// True for standard output.
    pub fn is_stdout(&self) -> bool {
        matches!(self, Target::Stdout)
    }
}

/// The file of a command that writes one result, where it is asked for.
///
/// # Errors
/// As [`Target::new`] and [`check_one_stdout`].
pub fn only_target(session: &Session, path: Option<&str>, force: bool) -> Result<Option<Target>> {
    let target = path.map(|path| Target::new(path, force)).transpose()?;
    check_one_stdout(session, &[target.as_ref()])?;
    Ok(target)
}

/// Refuses a second use of standard output.
///
/// # Errors
/// More than one of `targets`, or one of them and `--json`, is standard output.
pub fn check_one_stdout(session: &Session, targets: &[Option<&Target>]) -> Result<()> {
    for (i, target) in targets.iter().enumerate() {
        let (Some(Target::File(path)), rest) = (target, &targets[..i]) else {
            continue;
        };
        if rest
            .iter()
            .flatten()
            .any(|other| matches!(other, Target::File(p) if p == path))
        {
            return Err(
                Error::new(Code::Usage, "Two results would go to the same file.")
                    .file(path.display().to_string())
                    .hint("give each a name of its own"),
            );
        }
    }
    let used = targets
        .iter()
        .flatten()
        .filter(|target| target.is_stdout())
        .count();
    if used + usize::from(session.json) > 1 {
        return Err(
            Error::new(Code::Usage, "Standard output can take one result only.")
                .hint("write one of them to a file"),
        );
    }
    Ok(())
}

/// Writes all files, or none: each is complete under a temporary name beside
/// its target before the first gets its own.
///
/// # Errors
/// A file cannot be written.
pub fn write_all(session: &Session, files: &[(Target, String)]) -> Result<()> {
    for (target, _) in files {
        let Target::File(path) = target else { continue };
        if session.has_read(path) {
            return Err(Error::new(
                Code::Conflict,
                "This file is an input of the same command, and it is not overwritten even with --force.",
            )
            .file(path.display().to_string())
            .hint("give the output another name"));
        }
    }
    let mut finished: Vec<(PathBuf, &PathBuf)> = Vec::new();
    let written = files.iter().try_for_each(|(target, text)| match target {
        Target::Stdout => session.print(text),
        Target::Device(path) => fs::write(path, text).map_err(|e| write_error(path, &e)),
        Target::File(path) => {
            let temporary = temporary_name(path);
            finished.push((temporary.clone(), path));
            write_new(&temporary, text).map_err(|e| write_error(path, &e))
        }
    });
    let placed = written.and_then(|()| {
        finished.iter().try_for_each(|(temporary, path)| {
            fs::rename(temporary, path).map_err(|e| write_error(path, &e))
        })
    });
    if placed.is_err() {
        for (temporary, _) in &finished {
            // It may be placed already, or never have been made.
            let _ = fs::remove_file(temporary);
        }
    }
    placed
}

/// Checks, before any work, that the files `names` can be written to `folder`.
///
/// # Errors
/// The folder is a file, or holds one of the files and `force` is not given.
pub fn check_folder<'n>(
    folder: &Path,
    names: impl IntoIterator<Item = &'n str>,
    force: bool,
) -> Result<()> {
    if folder.exists() && !folder.is_dir() {
        return Err(
            Error::new(Code::FileWrite, "This is a file; the output is a folder.")
                .file(folder.display().to_string())
                .hint("give another --output-dir"),
        );
    }
    let existing = names.into_iter().map(|name| folder.join(name));
    match existing.into_iter().find(|path| path.exists() && !force) {
        None => Ok(()),
        Some(path) => Err(Error::new(Code::FileExists, "The file exists already.")
            .file(path.display().to_string())
            .hint("add --force to overwrite it, or give another --output-dir")),
    }
}

/// Makes a folder with those above it.
///
/// # Errors
/// The folder cannot be made.
pub fn make_folder(path: &Path) -> Result<()> {
    fs::create_dir_all(path).map_err(|e| {
        Error::new(Code::FileWrite, format!("The folder cannot be made: {e}."))
            .file(path.display().to_string())
    })
}

fn write_new(path: &Path, text: &str) -> std::io::Result<()> {
    let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
    file.write_all(text.as_bytes())?;
    file.sync_all()
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

fn temporary_name(path: &Path) -> PathBuf {
    let name = path
        .file_name()
        .map(|n| n.to_string_lossy().into_owned())
        .unwrap_or_default();
    folder_of(path).join(format!(".{name}.{}.tmp", std::process::id()))
}

fn write_error(path: &Path, error: &std::io::Error) -> Error {
    Error::new(
        Code::FileWrite,
        format!("The file cannot be written: {error}."),
    )
    .file(path.display().to_string())
    .hint("check the folder's permissions and the free space")
}
