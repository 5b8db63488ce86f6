//! What the commands at work share: the stiffness, options of a path, its table and picture.

use crate::files::{Contents, Files, check_targets, ends_in};
use crate::picture::check_picture_name;
use crate::session::Session;
use crate::target::Target;
use std::path::Path;
use stiffarm::estimate::saved::Saved;
use stiffarm::model::cell::Cell;
use stiffarm::{Code, Error, Result};
use stiffarm_files::source;

/// Reads a stiffness, with a caution among its doubts where it was identified with another version of the cell.
///
/// # Errors
/// As [`Source::read_stiffness`].
pub fn read_stiffness(session: &Session, from: &str, cell: &Cell) -> Result<Saved> {
    let mut saved = source::read_stiffness(session, from, cell)?;
    let other = saved.of_another_cell(session.last_hash("cell").as_deref());
    saved.predictor.doubts.extend(other);
    Ok(saved)
}

/// The table, or the files of a program, and the picture of a command about a path.
pub struct Outputs {
    tables: Vec<Target>,
    figure: Option<Target>,
}

impl Outputs {
    /// Checks both places before any work.
    ///
    /// # Errors
    /// As [`Target::new`], [`check_picture_name`] and [`check_targets`].
    pub fn new(session: &Session, table: Option<&str>, figure: Option<&str>, force: bool) -> Result<Self> {
        let target = |path: Option<&str>| path.map(|path| Target::new(path, force)).transpose();
        let not_a_table = table.is_some_and(|path| ends_in(path, "json"));
        figure.map(check_picture_name).transpose()?;
        let (table, figure) = (target(table)?, target(figure)?);
        check_targets(session, &[table.as_ref(), figure.as_ref()])?;
        if not_a_table {
            let message = "This writes a table of the path (CSV), not JSON.";
            return Err(Error::new(Code::Usage, message)
                .key("--output")
                .hint("name it .csv; `--json > result.json` keeps the whole result"));
        }
        Ok(Outputs { tables: table.into_iter().collect(), figure })
    }

    /// Adds the file beside `table` with this ending.
    ///
    /// # Errors
    /// As [`Target::file`] and [`check_targets`].
    pub fn beside(&mut self, session: &Session, table: &str, ending: &str, force: bool) -> Result<()> {
        let target = Target::file(&Path::new(table).with_extension(ending), force)?;
        check_targets(session, &[Some(&target)])?;
        self.tables.push(target);
        Ok(())
    }

    /// The files that were asked for; `tables` and `figure` make what is in them.
    ///
    /// # Errors
    /// A text that cannot be made.
    pub fn files<C: Contents + 'static>(
        self,
        tables: impl FnOnce() -> Result<Vec<C>>,
        figure: impl FnOnce() -> String,
    ) -> Result<Files> {
        let mut files: Vec<(Target, Box<dyn Contents>)> = Vec::new();
        if !self.tables.is_empty() {
            for (target, contents) in self.tables.into_iter().zip(tables()?) {
                files.push((target, Box::new(contents)));
            }
        }
        if let Some(target) = self.figure {
            files.push((target, Box::new(figure())));
        }
        Ok(Files::new(files))
    }
}
