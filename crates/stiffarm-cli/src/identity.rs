//! Which file a name means, in whatever spelling.

use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};

/// One file that was read.
pub struct Input {
    /// What the command reads it as, for example `cell`.
    pub role: String,
    /// Its name in messages.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
    /// SHA-256 of the content.
    pub sha256: String,
    /// True for standard input.
    pub is_stdin: bool,
    /// The file, where it is one.
    pub id: Option<FileId>,
}

/// A file, not its name: `p.csv`, `./p.csv` and a link to it are the same.
#[derive(Debug, Clone)]
pub struct FileId {
    /// The folder without links, and the name in it.
    path: Option<PathBuf>,
    /// Device and number in it, which a second name of one file shares.
    inode: Option<(u64, u64)>,
}

impl FileId {
    /// The file that `path` means, whether it is there or not.
    pub fn of(path: &Path) -> Self {
        let inside = || {
            let folder = fs::canonicalize(folder_of(path)).ok()?;
            Some(folder.join(path.file_name()?))
        };
        FileId {
            path: fs::canonicalize(path).ok().or_else(inside),
            inode: fs::metadata(path).ok().as_ref().and_then(inode),
        }
    }

    /// True where both are one file.
    pub fn is(&self, other: &FileId) -> bool {
        let same = |a: &Option<PathBuf>, b: &Option<PathBuf>| a.is_some() && a == b;
        same(&self.path, &other.path) || (self.inode.is_some() && self.inode == other.inode)
    }
}

/// The folder that a path is in.
pub fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

#[cfg(unix)]
fn inode(meta: &Metadata) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    // A terminal or pipe is never the file of an output.
    meta.is_file().then(|| (meta.dev(), meta.ino()))
}

#[cfg(not(unix))]
fn inode(_: &Metadata) -> Option<(u64, u64)> {
    None
}

/// The file that standard input is redirected from, where the system tells.
#[cfg(unix)]
pub fn of_stdin() -> Option<FileId> {
    use std::os::fd::AsFd;
    let stdin = std::io::stdin().as_fd().try_clone_to_owned().ok()?;
    let meta = fs::File::from(stdin).metadata().ok()?;
    Some(FileId { path: None, inode: Some(inode(&meta)?) })
}

/// The file that standard input is redirected from, where the system tells.
#[cfg(not(unix))]
pub fn of_stdin() -> Option<FileId> {
    None
}
