//! Writing: groups of files, and what became of them.

use super::contents::Contents;
use super::temporary::Temporary;
use super::{exists, make_folder, shown, write_error};
use crate::session::Session;
use crate::target::Target;
use std::fs;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use stiffarm::findings::list;
use stiffarm::{Error, Result};

/// Files that are written together, all of them or none.
pub struct Files {
    place: Place,
    said: Said,
    then: Option<Box<dyn FnOnce() -> String>>,
}

/// Where files go.
enum Place {
    /// Each to a place of its own.
    Targets(Vec<(Target, Box<dyn Contents>)>),
    /// All under their names to a folder, which is made where it is not there.
    Folder { folder: PathBuf, files: Vec<(String, Box<dyn Contents>)>, force: bool },
}

/// How files that were written are named to the user.
pub enum Said {
    /// Each by its path.
    Names,
    /// In these words, which follow "wrote".
    As(String),
    /// Not at all: the result names them.
    Nothing,
}

impl Files {
    /// Files, each to a place of its own.
    pub fn new(files: Vec<(Target, Box<dyn Contents>)>) -> Self {
        Files::at(Place::Targets(files))
    }

    /// A single file.
    pub fn one(target: Target, contents: impl Contents + 'static) -> Self {
        Files::new(vec![(target, Box::new(contents))])
    }

    /// Files of these names in a folder that [`super::check_folder`] has looked at.
    pub fn folder<C: Contents + 'static>(
        folder: &Path,
        files: impl IntoIterator<Item = (String, C)>,
        force: bool,
    ) -> Self {
        let boxed = |(name, contents)| (name, Box::new(contents) as Box<dyn Contents>);
        Files::at(Place::Folder { folder: folder.to_path_buf(), files: files.into_iter().map(boxed).collect(), force })
    }

    fn at(place: Place) -> Self {
        Files { place, said: Said::Names, then: None }
    }

    /// Names them so.
    pub fn said(self, said: Said) -> Self {
        Files { said, ..self }
    }

    /// Does this once they are written; what it says is a remark.
    pub fn then(self, then: impl FnOnce() -> String + 'static) -> Self {
        Files { then: Some(Box::new(then)), ..self }
    }

    /// Whether one of them is standard output.
    pub fn takes_stdout(&self) -> bool {
        match &self.place {
            Place::Targets(files) => files.iter().any(|(target, _)| target.is_stdout()),
            Place::Folder { .. } => false,
        }
    }
}

/// What became of the files of a command.
#[derive(Default)]
pub struct Written {
    names: Vec<String>,
    /// Why the first that failed could not be written.
    pub failure: Option<Error>,
}

impl Written {
    /// Writes a group. Files that cannot be written are no error here: what is a table is printed, and the command
    /// goes on to show its result.
    ///
    /// # Errors
    /// A file is an input of the same command, or standard output cannot be written.
    pub fn write(&mut self, session: &Session, group: Files) -> Result<()> {
        let files = match group.place {
            Place::Targets(files) => files,
            Place::Folder { folder, files, force } => {
                // It may have changed since it was looked at.
                let target = |(name, _): &(String, _)| Target::file(&folder.join(name), force);
                let targets = make_folder(&folder).and_then(|()| files.iter().map(target).collect());
                match targets {
                    Ok(targets) => {
                        let targets: Vec<Target> = targets;
                        let contents = files.into_iter().map(|(_, contents)| contents);
                        targets.into_iter().zip(contents).collect()
                    }
                    Err(error) => {
                        self.failure.get_or_insert(error);
                        return files
                            .iter()
                            .try_for_each(|(name, contents)| print_instead(session, &folder.join(name), &**contents));
                    }
                }
            }
        };
        for (target, _) in &files {
            if let Target::File { path, .. } = target {
                session.refuse_input(path)?;
            }
        }
        let placed = place(&files);
        for (target, contents) in &files {
            match target {
                Target::Stdout => session.print_exact(&contents.text())?,
                Target::File { path, .. } | Target::Device(path) if placed.is_err() => {
                    print_instead(session, path, &**contents)?;
                }
                Target::File { .. } | Target::Device(_) => {}
            }
        }
        if let Err(error) = placed {
            self.failure.get_or_insert(error);
        }
        // Beside a failure nothing is said of what went well.
        if self.failure.is_some() {
            return Ok(());
        }
        match group.said {
            Said::Names => self.names.extend(files.iter().filter_map(|(target, _)| match target {
                Target::File { path, .. } | Target::Device(path) => Some(shown(path)),
                Target::Stdout => None,
            })),
            Said::As(words) => self.names.push(words),
            Said::Nothing => {}
        }
        let remark = group.then.map_or_else(String::new, |then| then());
        if !remark.is_empty() {
            session.remark(&remark);
        }
        Ok(())
    }

    /// What was written, as the last line of what is printed; nothing where nothing was.
    pub fn said(&self) -> String {
        match self.names.as_slice() {
            [] => String::new(),
            names => format!("\nwrote {}\n", list(names)),
        }
    }
}

/// Prints a table that could not be written. Pictures and objects are no use on
/// a screen, and what they show is printed anyway.
fn print_instead(session: &Session, path: &Path, contents: &dyn Contents) -> Result<()> {
    if is_table(path) && !session.json {
        session.print(&format!("not written, {}:\n{}\n", shown(path), contents.text()))
    } else {
        Ok(())
    }
}

fn is_table(path: &Path) -> bool {
    !path.extension().is_some_and(|e| ["svg", "json", "xlsx", "html"].iter().any(|other| e.eq_ignore_ascii_case(other)))
}

/// Writes the files and devices among `files`, all or none: each file is complete under a temporary name beside its
/// target before the first gets its own.
///
/// # Errors
/// One of them cannot be written.
pub fn place<C: Contents>(files: &[(Target, C)]) -> Result<()> {
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
        let placed = if force { temporary.replace(path) } else { temporary.place(path) };
        if let Err(error) = placed {
            // Without the others of its command none is of use.
            made.into_iter().for_each(|path| drop(fs::remove_file(path)));
            return Err(match error.kind() {
                ErrorKind::AlreadyExists => exists(path, "Something else has made the file while this command ran."),
                _ => write_error(path, &error),
            });
        }
        made.extend((!force).then_some(path));
    }
    Ok(())
}
