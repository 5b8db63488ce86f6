//! A file under a temporary name beside its target, until it is complete.
//!
//! A run that is killed leaves its temporary file. The next run that writes into
//! the same folder takes it away: each run holds a lock on its own, which ends
//! with the process however it ends, so a file without lock belongs to nobody.
//! Process numbers would not do: in containers most runs have the same one.

use super::contents::Contents;
use crate::identity::folder_of;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{BufWriter, Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};

/// Names that are tried before something else must be wrong.
const TRIES: usize = 100;

/// Beginning and end of every temporary name.
const BEGIN: &str = ".stiffarm-";
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
        clean_up(&folder_of(target));
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
            let path = folder_of(target).join(format!("{BEGIN}{random:016x}{END}"));
            let file = match options.open(&path) {
                Err(e) if e.kind() == ErrorKind::AlreadyExists => continue,
                opened => opened?,
            };
            // Between making and locking it, another run may have taken it for
            // an abandoned one. A file system without locks has none to lose.
            if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) || !path.exists() {
                continue;
            }
            return Ok(Temporary { path, file, placed: false });
        }
        Err(Error::other("no temporary name is free"))
    }

    /// Gives the file its name, in place of one that has it.
    pub fn replace(mut self, target: &Path) -> Result<()> {
        fs::rename(&self.path, target)?;
        self.placed = true;
        Ok(())
    }

    /// Gives the file a name that nothing has; the temporary one goes.
    ///
    /// # Errors
    /// [`ErrorKind::AlreadyExists`] where something has it by now.
    pub fn place(self, target: &Path) -> Result<()> {
        match fs::hard_link(&self.path, target) {
            Err(e) if e.kind() != ErrorKind::AlreadyExists => {
                // A file system without second names, FAT for one: an empty file takes the
                // name where nothing has it, and then gives it up. A kill between leaves that.
                OpenOptions::new().write(true).create_new(true).open(target)?;
                self.replace(target).inspect_err(|_| {
                    let _ = fs::remove_file(target);
                })
            }
            placed => placed,
        }
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

/// Removes what killed runs have left in `folder`.
fn clean_up(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_file = || entry.file_type().is_ok_and(|kind| kind.is_file());
        if !(name.starts_with(BEGIN) && name.ends_with(END) && is_file()) {
            continue;
        }
        // One whose target must not be written to cannot be opened for that either.
        let mut writing = OpenOptions::new();
        let opened = writing.write(true).open(entry.path());
        let Ok(file) = opened.or_else(|_| File::open(entry.path())) else {
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
    clean_up(&folder_of(target));
    Temporary::new(target).map(drop)
}
