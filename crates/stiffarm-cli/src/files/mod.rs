//! Writing files: never over existing ones unasked, and never half.
//!
//! Everything that can be known before the work is checked before it: that the
//! folder is there and can be written to, that no file exists unasked, that no
//! two results and no input are the same file in another spelling. What fails
//! all the same, a disk that has filled up, or a file that another program has
//! made meanwhile, costs the file and not the result: it is printed.

mod contents;
mod temporary;

use crate::identity::folder_of;
use crate::session::Session;
use crate::target::Target;
pub use contents::{Contents, Rows};
use std::fs;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use stiffarm::findings::visible;
use stiffarm::{Code, Error, Result};
use temporary::Temporary;

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
                return Err(
                    Error::new(Code::FileWrite, "This is a folder; the output is a file.")
                        .file(name)
                        .hint("give a file name inside it"),
                );
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
            return Err(Error::new(
                Code::FileWrite,
                format!("There is no folder {}.", shown(&folder)),
            )
            .file(name)
            .hint("make the folder first"));
        }
        temporary::probe(&target).map_err(|e| write_error(path, &e))?;
        Ok(Target::File {
            path: target,
            force,
        })
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
    let own = Path::new(path).extension();
    own.is_some_and(|own| own.eq_ignore_ascii_case(ending))
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
/// A file that cannot be written is no error here: its text is printed where it
/// is a table, the session remembers the failure ([`Session::fail`]), and the
/// command goes on to show its result.
///
/// # Errors
/// A file is an input of the same command, or standard output cannot be written.
pub fn write_all<C: Contents>(session: &Session, files: &[(Target, C)]) -> Result<()> {
    write_unsaid(session, files)?;
    for (target, _) in files.iter().filter(|_| !session.has_failed()) {
        if let Target::File { path, .. } | Target::Device(path) = target {
            session.has_written(shown(path));
        }
    }
    Ok(())
}

/// The same where the command itself says what was written.
fn write_unsaid<C: Contents>(session: &Session, files: &[(Target, C)]) -> Result<()> {
    for (target, _) in files {
        let Target::File { path, .. } = target else {
            continue;
        };
        session.refuse_input(path)?;
    }
    if files.iter().any(|(target, _)| target.is_stdout()) {
        session.stdout_is_taken.set(true);
    }
    let Err(error) = place_all(files) else {
        let to_stdout = files.iter().filter(|(target, _)| target.is_stdout());
        return to_stdout
            .into_iter()
            .try_for_each(|(_, contents)| session.print_exact(&contents.text()));
    };
    session.fail(error);
    files
        .iter()
        .try_for_each(|(target, contents)| match target {
            Target::Stdout => session.print_exact(&contents.text()),
            Target::File { path, .. } | Target::Device(path) => {
                print_instead(session, path, &contents.text())
            }
        })
}

/// Writes `files` to `folder`, which is made where it is not there, as
/// [`write_all`] does: it may have changed since [`check_folder`].
///
/// # Errors
/// As [`write_all`].
pub fn write_folder<C: Contents>(
    session: &Session,
    folder: &Path,
    files: Vec<(String, C)>,
    force: bool,
) -> Result<()> {
    let target = |(name, _): &(String, C)| Target::file(&folder.join(name), force);
    let targets: Result<Vec<Target>> =
        make_folder(folder).and_then(|()| files.iter().map(target).collect());
    match targets {
        Ok(targets) => {
            let texts = files.into_iter().map(|(_, text)| text);
            write_unsaid(session, &targets.into_iter().zip(texts).collect::<Vec<_>>())
        }
        Err(error) => {
            session.fail(error);
            files.iter().try_for_each(|(name, contents)| {
                print_instead(session, &folder.join(name), &contents.text())
            })
        }
    }
}

/// Prints a table that could not be written. Pictures and objects are no use on
/// a screen, and what they show is printed anyway.
fn print_instead(session: &Session, path: &Path, text: &str) -> Result<()> {
    if is_table(path) && !session.json {
        session.print(&format!("not written, {}:\n{text}\n", shown(path)))
    } else {
        Ok(())
    }
}

fn is_table(path: &Path) -> bool {
    !path.extension().is_some_and(|e| {
        ["svg", "json", "xlsx", "html"]
            .iter()
            .any(|other| e.eq_ignore_ascii_case(other))
    })
}

/// Writes the files and devices among `files`.
fn place_all<C: Contents>(files: &[(Target, C)]) -> Result<()> {
    let mut finished: Vec<(Temporary, &PathBuf, bool)> = Vec::new();
    for (target, contents) in files {
        if let Target::File { path, force } = target {
            let temporary = Temporary::write(path, contents).map_err(|e| write_error(path, &e))?;
            finished.push((temporary, path, *force));
        }
    }
    for (target, contents) in files {
        if let Target::Device(path) = target {
            let written = fs::File::create(path).and_then(|file| {
                let mut out = BufWriter::new(file);
                contents.write_to(&mut out)?;
                out.flush()
            });
            written.map_err(|e| write_error(path, &e))?;
        }
    }
    // The only moment at which a kill leaves new files beside old ones.
    let mut made: Vec<&PathBuf> = Vec::new();
    for (temporary, path, force) in finished {
        let placed = if force {
            temporary.replace(path)
        } else {
            temporary.place(path)
        };
        if let Err(error) = placed {
            // Without the others of its command none is of use.
            made.into_iter()
                .for_each(|path| drop(fs::remove_file(path)));
            return Err(match error.kind() {
                ErrorKind::AlreadyExists => exists(
                    path,
                    "Something else has made the file while this command ran.",
                ),
                _ => write_error(path, &error),
            });
        }
        made.extend((!force).then_some(path));
    }
    Ok(())
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
        return Err(
            Error::new(Code::FileWrite, "This is a file; the output is a folder.")
                .file(name)
                .hint("name another folder"),
        );
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
        return Err(Error::new(Code::FileWrite, message)
            .file(name)
            .hint("name another folder"));
    }
    let nearest = nearest.unwrap_or(Path::new("."));
    let inside = folder
        .file_name()
        .map_or_else(|| nearest.to_path_buf(), |name| nearest.join(name));
    temporary::probe(&inside).map_err(|e| {
        Error::new(Code::FileWrite, format!("The folder cannot be made: {e}.")).file(name)
    })
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
    Error::new(Code::FileExists, message)
        .file(shown(path))
        .hint("add --force to overwrite it, or choose another name")
}

fn write_error(path: &Path, error: &std::io::Error) -> Error {
    Error::new(
        Code::FileWrite,
        format!("The file cannot be written: {error}."),
    )
    .file(shown(path))
    .hint("check the folder's permissions and the free space")
}
