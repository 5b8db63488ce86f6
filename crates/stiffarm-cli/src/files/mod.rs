//! Writing files: never over existing ones unasked, and never half.
//!
//! Everything that can be known before the work is checked before it: that the
//! folder is there and can be written to, that no file exists unasked, that no
//! two results and no input are the same file in another spelling. What fails
//! all the same, a disk that has filled up, or a file that another program has
//! made meanwhile, costs the file and not the result: it is printed.

mod contents;
mod temporary;
mod written;

use crate::identity::folder_of;
use crate::session::Session;
use crate::target::Target;
pub use contents::{Contents, Rows};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use stiffarm::findings::visible;
use stiffarm::{Code, Error, Result};
pub use written::{Files, Said, Written, place};

/// Links that a link may lead over; as many as Linux follows.
const MOST_LINKS: usize = 40;

impl Target {
    /// Checks `path` (`-` is standard output) before any work is done for it.
    ///
    /// # Errors
    /// The file exists and `force` is not given, its folder is missing or
    /// cannot be written to.
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
        let name = shown(path);
        let target = match fs::metadata(path) {
            Ok(meta) if meta.is_dir() => {
                return Err(Error::new(Code::FileWrite, "This is a folder; the output is a file.")
                    .file(name)
                    .hint("give a file name inside it"));
            }
            Ok(meta) if !meta.is_file() => return Ok(Target::Device(path.to_path_buf())),
            Ok(_) if !force => return Err(exists(path, "The file exists already.")),
            // A link stays a link: what it points to is replaced.
            Ok(_) => fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf()),
            Err(e) if e.kind() == ErrorKind::NotFound => match fs::symlink_metadata(path) {
                Ok(_) if !force => {
                    return Err(exists(path, "This is a link to a file that is not there."));
                }
                Ok(_) => link_end(path)?,
                Err(_) => path.to_path_buf(),
            },
            // No folder on the way, or one that may not be looked into, is said below.
            Err(_) if !folder_of(path).is_dir() => path.to_path_buf(),
            Err(e) => return Err(write_error(path, &e)),
        };
        let folder = folder_of(&target);
        if !folder.is_dir() {
            return Err(Error::new(Code::FileWrite, format!("There is no folder {}.", shown(&folder)))
                .file(name)
                .hint("make the folder first"));
        }
        temporary::probe(&target).map_err(|e| write_error(path, &e))?;
        Ok(Target::File { path: target, force })
    }

    /// True for standard output.
    pub fn is_stdout(&self) -> bool {
        matches!(self, Target::Stdout)
    }
}

/// The file that a link to nothing would be.
fn link_end(path: &Path) -> Result<PathBuf> {
    let mut end = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&end) {
            Ok(next) => end = folder_of(&end).join(next),
            Err(_) => return Ok(end),
        }
    }
    let error = Error::new(Code::FileWrite, "The links lead in a circle.");
    Err(error.file(shown(path)))
}

/// The file of a command that writes one result, where it is asked for.
///
/// # Errors
/// As [`Target::new`] and [`check_targets`].
pub fn only_target(session: &Session, path: Option<&str>, force: bool) -> Result<Option<Target>> {
    let target = path.map(|path| Target::new(path, force)).transpose()?;
    check_targets(session, &[target.as_ref()])?;
    Ok(target)
}

/// Whether the name of a file ends in `.` and this ending, in any letters.
pub fn ends_in(path: &str, ending: &str) -> bool {
    let extension = Path::new(path).extension();
    extension.is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
}

/// Refuses a second use of standard output, and a file that is written twice
/// or that the command reads.
///
/// # Errors
/// More than one of `targets`, or one of them and `--json`, is standard output;
/// two are one file, in whatever spelling; one is an input.
pub fn check_targets(session: &Session, targets: &[Option<&Target>]) -> Result<()> {
    for target in targets.iter().flatten() {
        if let Target::File { path, .. } = target {
            session.will_write(path)?;
        }
    }
    let mut printed = targets.iter().flatten().filter(|target| target.is_stdout());
    printed.try_for_each(|_| session.will_print())
}

/// Checks, before any work, that the files `names` can be written to `folder`.
///
/// # Errors
/// The folder is a file, cannot be made or written to; it holds one of the
/// files and `force` is not given; one of the files is an input.
pub fn check_folder<'n>(
    session: &Session,
    folder: &Path,
    names: impl IntoIterator<Item = &'n str>,
    force: bool,
) -> Result<()> {
    let name = shown(folder);
    if folder.exists() && !folder.is_dir() {
        return Err(Error::new(Code::FileWrite, "This is a file; the output is a folder.")
            .file(name)
            .hint("name another folder"));
    }
    if folder.is_dir() {
        for name in names {
            let target = Target::file(&folder.join(name), force).map_err(|e| match e.code() {
                Code::FileExists => e.hint("add --force to overwrite it, or name another folder"),
                _ => e,
            })?;
            if let Target::File { path, .. } = target {
                session.will_write(&path)?;
            }
        }
        return Ok(());
    }
    // The nearest folder that is there, in which the others will be made.
    let above = folder.ancestors().skip(1);
    let nearest = above.into_iter().find(|above| above.exists());
    if let Some(file) = nearest.filter(|nearest| !nearest.is_dir()) {
        let message = format!("The folder cannot be made: {} is a file.", shown(file));
        return Err(Error::new(Code::FileWrite, message).file(name).hint("name another folder"));
    }
    let nearest = nearest.unwrap_or(Path::new("."));
    let inside = folder.file_name().map_or_else(|| nearest.to_path_buf(), |name| nearest.join(name));
    temporary::probe(&inside)
        .map_err(|e| Error::new(Code::FileWrite, format!("The folder cannot be made: {e}.")).file(name))
}

/// Makes a folder with those above it.
///
/// # Errors
/// The folder cannot be made.
pub fn make_folder(path: &Path) -> Result<()> {
    fs::create_dir_all(path).map_err(|e| {
        Error::new(Code::FileWrite, format!("The folder cannot be made: {e}."))
            .file(shown(path))
            .hint("check the permissions of the folder above it")
    })
}

/// A path as messages show it.
pub fn shown(path: &Path) -> String {
    visible(&path.to_string_lossy()).into_owned()
}

/// A file that is not overwritten unasked.
fn exists(path: &Path, message: &str) -> Error {
    Error::new(Code::FileExists, message).file(shown(path)).hint("add --force to overwrite it, or choose another name")
}

fn write_error(path: &Path, error: &std::io::Error) -> Error {
    Error::new(Code::FileWrite, format!("The file cannot be written: {error}."))
        .file(shown(path))
        .hint("check the folder's permissions and the free space")
}
