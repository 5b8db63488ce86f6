//! What a command answers: a value, which [`Session::deliver`] takes to screen and files.
//!
//! [`Session::deliver`]: crate::session::Session::deliver

use crate::files::Files;
use crate::finding::finding_line;
use crate::input::Line;
use crate::output::{Exit, summary};
use crate::page::page_of;
use crate::target::Target;
use crate::text;
use serde::Serialize;
use std::rc::Rc;
use stiffarm::Result;
use stiffarm::estimate::saved::Saved;
use stiffarm::findings::Finding;
use stiffarm::model::cell::Cell;
use stiffarm_files::envelope::{Envelope, write_result};
use stiffarm_files::source::NamedCell;
use stiffarm_report::summary::Summarise;

/// What came out of a command.
pub struct Answer {
    /// How it ended.
    pub exit: Exit,
    /// The result; `None` where the files are all that was asked for.
    pub shown: Option<Box<dyn Shown>>,
    /// Files to write, group by group.
    pub files: Vec<Files>,
    /// What is said of the result where a file takes standard output; `None` for all its words.
    pub beside: Option<String>,
    /// Said on standard error before all else, to those who want quiet, too.
    pub warning: &'static str,
    /// Said last, where every file could be written.
    pub notes: String,
}

/// A result in the forms in which people and programs see it. Each is made when it is wanted.
pub trait Shown {
    /// One JSON object.
    ///
    /// # Errors
    /// A value that JSON cannot hold.
    fn object(&self) -> Result<String>;
    /// What it says.
    ///
    /// # Errors
    /// A cell that cannot take its postures.
    fn words(&self) -> Result<String>;
    /// Its page, with pictures of `cell` where it has one.
    ///
    /// # Errors
    /// A result that has no page.
    fn page(&self, cell: Option<&Cell>) -> Result<String>;
}

/// A result with what made it, and how its words are found.
struct Made<O, R, W> {
    envelope: Rc<Envelope<O, R>>,
    words: W,
}

impl<O: Serialize, R: Serialize, W: Fn(&Envelope<O, R>) -> Result<String>> Shown for Made<O, R, W> {
    fn object(&self) -> Result<String> {
        write_result(&*self.envelope)
    }

    fn words(&self) -> Result<String> {
        (self.words)(&self.envelope)
    }

    fn page(&self, cell: Option<&Cell>) -> Result<String> {
        page_of(&*self.envelope, cell)
    }
}

impl Answer {
    /// Nothing but how the command ended: what it had to say was said while it ran.
    pub fn ended(exit: Exit) -> Self {
        Answer { exit, shown: None, files: Vec::new(), beside: None, warning: "", notes: String::new() }
    }

    /// A text as it is.
    pub fn text(text: impl Into<String>) -> Self {
        Answer::ended(Exit::Done).with(Files::one(Target::Stdout, text.into()))
    }

    fn made<O: Serialize + 'static, R: Serialize + 'static>(
        exit: Exit,
        envelope: Rc<Envelope<O, R>>,
        words: impl Fn(&Envelope<O, R>) -> Result<String> + 'static,
    ) -> Self {
        Answer { shown: Some(Box::new(Made { envelope, words })), ..Answer::ended(exit) }
    }

    /// A result that is shown as `table`, and has no page.
    pub fn table<O: Serialize + 'static, R: Serialize + 'static>(
        exit: Exit,
        envelope: Envelope<O, R>,
        table: String,
    ) -> Self {
        Answer::made(exit, Rc::new(envelope), move |_| Ok(table.clone()))
    }

    /// A result that tells itself, made with `cell` where it has one.
    pub fn summary<O: Serialize + 'static, R: Serialize + Summarise<O> + 'static>(
        exit: Exit,
        envelope: Envelope<O, R>,
        cell: impl Into<Option<NamedCell>>,
        details: bool,
    ) -> Self {
        let named: Option<NamedCell> = cell.into();
        Answer::made(exit, Rc::new(envelope), move |envelope| {
            let summary = summary(envelope, named.as_ref().map(|named| &named.cell))?;
            Ok(text::summary(&summary, details) + &named.as_ref().map_or_else(String::new, Line::line))
        })
    }

    /// A result at work, made with this cell and stiffness. Where a table of points goes to standard output, only what
    /// is serious among its `findings` is said.
    pub fn at_work<O: Serialize + 'static, R: Serialize + Summarise<O> + 'static>(
        exit: Exit,
        envelope: Rc<Envelope<O, R>>,
        findings: &[Finding],
        (named, stiffness): (NamedCell, &Saved),
        details: bool,
    ) -> Answer {
        let serious = findings.iter().filter(|f| f.is_serious());
        let beside = Some(serious.map(finding_line).collect());
        let lines = named.line() + &stiffness.line();
        let answer = Answer::made(exit, envelope, move |envelope| {
            let summary = summary(envelope, Some(&named.cell))?;
            Ok(text::summary(&summary, details) + &lines)
        });
        Answer { beside, ..answer }
    }

    /// With further files; nothing where there are none.
    pub fn with(mut self, files: impl Into<Option<Files>>) -> Self {
        self.files.extend(files.into());
        self
    }

    /// With the JSON object as a file, where one is asked for.
    ///
    /// # Errors
    /// A value that JSON cannot hold.
    pub fn with_object(self, target: Option<Target>) -> Result<Self> {
        match (target, &self.shown) {
            (Some(target), Some(shown)) => {
                let files = Files::one(target, shown.object()?);
                Ok(self.with(files))
            }
            _ => Ok(self),
        }
    }
}
