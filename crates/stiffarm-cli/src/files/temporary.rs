//! A file under a temporary name beside its target, until it is complete.
//!
//! A run that is killed leaves its temporary file. The next run that writes the
//! same target takes it away: each run holds a lock on its own, which ends with
//! the process however it ends, so a file without lock belongs to nobody.
//! Process numbers would not do: in containers most runs have the same one.

use super::contents::Contents;
use crate::identity::folder_of;
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{BufWriter, Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};

/// Names that are tried before something else must be wrong.
const TRIES: usize = 100;

/// End of every temporary name.
const END: &str = ".tmp";

/// A complete file that waits for its name. It goes when it is dropped.
pub struct Temporary {
    path: PathBuf,
    /// Holds the lock.
    file: File,
    placed: bool,
}

impl Temporary {
    /// Writes `contents` beside `target`, with the permissions of the file that
    /// is there.
    pub fn write(target: &Path, contents: &impl Contents) -> Result<Self> {
        clean_up(target);
        let temporary = Temporary::new(target)?;
        // A file system without permissions has none to keep, and read-only on
        // Windows would forbid the new name.
        #[cfg(unix)]
        if let Ok(meta) = fs::metadata(target) {
            let _ = temporary.file.set_permissions(meta.permissions());
        }
        let mut out = BufWriter::new(&temporary.file);
        contents.write_to(&mut out)?;
        out.flush()?;
        drop(out);
        temporary.file.sync_all()?;
        Ok(temporary)
    }

    fn new(target: &Path) -> Result<Self> {
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        // What others may not read is not shown to them for a moment either.
        #[cfg(unix)]
        if let Ok(meta) = fs::metadata(target) {
            use std::os::unix::fs::{OpenOptionsExt, PermissionsExt};
            options.mode(meta.permissions().mode() & 0o600);
        }
        for _ in 0..TRIES {
            let random = RandomState::new().build_hasher().finish();
            let path = folder_of(target).join(format!("{}{random:016x}{END}", begin(target)));
            let file = match options.open(&path) {
                Err(e) if e.kind() == ErrorKind::AlreadyExists => continue,
                opened => opened?,
            };
            // Between making and locking it, another run may have taken it for
            // an abandoned one. A file system without locks has none to lose.
            if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) || !path.exists() {
                continue;
            }
            return Ok(Temporary {
                path,
                file,
                placed: false,
            });
        }
        Err(Error::other("no temporary name is free"))
    }

    /// Gives the file its name, in place of one that has it.
    pub fn place(mut self, target: &Path) -> Result<()> {
        fs::rename(&self.path, target)?;
        self.placed = true;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.placed {
            // Nothing can be done about one that does not go.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// How the temporary names of a target begin. Its whole name would be too long
/// for some; its hash tells it from its neighbours.
fn begin(target: &Path) -> String {
    let name = target.file_name().unwrap_or(OsStr::new(""));
    // FNV-1a: the same in every run and version.
    let hash = name
        .as_encoded_bytes()
        .iter()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
        });
    format!(".stiffarm-{hash:016x}-")
}

/// Removes what killed runs have left of `target`.
fn clean_up(target: &Path) {
    let Ok(entries) = fs::read_dir(folder_of(target)) else {
        return;
    };
    let begin = begin(target);
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if !(name.starts_with(&begin) && name.ends_with(END)) {
            continue;
        }
        let Ok(file) = OpenOptions::new().write(true).open(entry.path()) else {
            continue;
        };
        if file.try_lock().is_ok() {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Sees whether `target` could be written: makes a temporary file beside it and
/// takes it away again.
pub fn probe(target: &Path) -> Result<()> {
    clean_up(target);
    Temporary::new(target).map(drop)
}
