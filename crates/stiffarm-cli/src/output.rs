//! Printing: tables for people, one JSON object for machines.

use crate::files::write_all;
use crate::finding::finding_line;
use crate::input::Line;
use crate::screen::{fitted, plain, rendered};
use crate::session::Session;
use crate::target::Target;
use crate::text;
use serde::Serialize;
use std::io::{ErrorKind, Write};
use stiffarm::estimate::saved::Saved;
use stiffarm::findings::{Finding, Severity, codes};
use stiffarm::model::cell::Cell;
use stiffarm::{Code, Error, Result};
use stiffarm_files::envelope::{Envelope, write_result};
use stiffarm_files::source::NamedCell;
use stiffarm_report::tell::{Given, Telling, Told};

/// How a command ended, where it ended without an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// Done.
    Done,
    /// Done, with a finding that the user must look at.
    Finding,
    /// Stopped by the user; the best result so far was written.
    Interrupted,
}

impl Exit {
    /// The process's exit code.
    pub fn code(self) -> u8 {
        match self {
            Exit::Done => 0,
            Exit::Finding => 1,
            Exit::Interrupted => 130,
        }
    }

    /// [`Exit::Finding`] if there is one.
    pub fn finding(is_finding: bool) -> Self {
        if is_finding {
            Exit::Finding
        } else {
            Exit::Done
        }
    }

    /// [`Exit::Finding`] if one of them is serious, or names a joint that cannot be determined.
    pub fn of_findings(findings: &[Finding]) -> Self {
        let ends = |f: &Finding| f.severity == Severity::Serious || f.code == codes::JOINT_LEFT_OUT;
        Exit::finding(findings.iter().any(ends))
    }
}

impl Session {
    /// Wraps a result with what made it.
    pub fn envelope<O: Serialize, R: Serialize>(
        &self,
        command: &str,
        seed: Option<u64>,
        options: O,
        result: R,
    ) -> Envelope<O, R> {
        let (arguments, inputs) = (self.arguments(), self.hashes());
        Envelope::new(command, arguments, inputs, seed, options, result)
    }

    /// Prints the JSON object if that was asked for, else the table.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn show(&self, envelope: &impl Serialize, table: impl FnOnce() -> String) -> Result<()> {
        if self.json {
            self.print_exact(&write_result(envelope)?)
        } else {
            self.print(&fitted(&(table() + &self.written())))
        }
    }

    /// Writes the JSON object to `target`, if there is one, and the page, where one is asked for, and says what the
    /// result, made with `cell` where it has one, says: as a remark where the object itself, or another file, goes to
    /// standard output.
    ///
    /// # Errors
    /// A file or standard output cannot be written.
    pub fn deliver_told<'c, O: Serialize, R: Serialize + Telling<O>>(
        &self,
        target: Option<Target>,
        envelope: &Envelope<O, R>,
        cell: impl Into<Option<&'c NamedCell>>,
        details: bool,
    ) -> Result<()> {
        let is_stdout = matches!(target, Some(Target::Stdout));
        // The object alone needs no words.
        let words = match self.json && !self.stdout_is_taken.get() && !is_stdout {
            true => String::new(),
            false => self.in_words(envelope, cell.into(), details)?,
        };
        if let Some(target) = target.filter(|_| !is_stdout) {
            write_all(self, &[(target, write_result(envelope)?)])?;
        }
        self.write_page(envelope)?;
        if is_stdout {
            self.print_exact(&write_result(envelope)?)?;
            self.stdout_is_taken.set(true);
        }
        if self.stdout_is_taken.get() {
            self.remark(&words);
            return Ok(());
        }
        self.show(envelope, || words)
    }

    /// Delivers what a result at work says, and how the command ended by its `findings`. Where a table of its points went
    /// to standard output, only what is serious is said.
    ///
    /// # Errors
    /// As [`Session::deliver_told`].
    pub fn deliver_at_work<O: Serialize, R: Serialize + Telling<O>>(
        &self,
        envelope: &Envelope<O, R>,
        findings: &[Finding],
        (named, stiffness): (&NamedCell, &Saved),
        details: bool,
    ) -> Result<Exit> {
        self.write_page(envelope)?;
        if self.stdout_is_taken.get() {
            self.remark_serious(findings.iter());
        } else {
            let words = if self.json {
                String::new()
            } else {
                text::told(&told(envelope, Some(&named.cell))?, details)
            };
            self.show(envelope, || words + &named.line() + &stiffness.line())?;
        }
        Ok(Exit::of_findings(findings))
    }

    /// What a result says.
    fn in_words<O, R: Telling<O>>(
        &self,
        envelope: &Envelope<O, R>,
        cell: Option<&NamedCell>,
        details: bool,
    ) -> Result<String> {
        let told = told(envelope, cell.map(|named| &named.cell))?;
        Ok(text::told(&told, details) + &cell.map_or_else(String::new, Line::line))
    }

    /// Prints text for people to standard output: what others wrote in it is
    /// shown and not obeyed. A reader that has gone is no error.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn print(&self, text: &str) -> Result<()> {
        match self.captured {
            Some(_) => self.print_exact(&plain(text)),
            None => self.print_exact(&rendered(text)),
        }
    }

    /// Prints the content of a file, or an object, as it is.
    ///
    /// # Errors
    /// As [`Session::print`].
    pub fn print_exact(&self, text: &str) -> Result<()> {
        if let Some(captured) = &self.captured {
            captured.borrow_mut().out += text;
            return Ok(());
        }
        let mut out = anstream::AutoStream::new(std::io::stdout(), self.color).lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::new(
                Code::FileWrite,
                format!("Standard output cannot be written: {e}."),
            )),
            _ => Ok(()),
        }
    }

    /// Prints to standard error.
    pub fn print_error(&self, text: &str) {
        if let Some(captured) = &self.captured {
            captured.borrow_mut().err += &plain(text);
            return;
        }
        // Where standard error is closed there is nobody left to tell.
        let mut out = anstream::AutoStream::new(std::io::stderr(), self.color).lock();
        let _ = out.write_all(rendered(text).as_bytes());
    }

    /// The serious ones of `findings` on standard error: where a table went to
    /// standard output, nothing else says them.
    pub fn remark_serious<'f>(&self, findings: impl Iterator<Item = &'f Finding>) {
        for finding in findings.filter(|f| f.severity == Severity::Serious) {
            self.print_error(&finding_line(finding));
        }
    }

    /// A remark on standard error, unless the user wants quiet.
    pub fn remark(&self, text: &str) {
        if !self.quiet {
            self.print_error(&format!("{text}\n"));
        }
    }
}

/// What a result that was just made says, without pictures of its cell.
///
/// # Errors
/// A cell that cannot take its postures.
pub fn told<O, R: Telling<O>>(envelope: &Envelope<O, R>, cell: Option<&Cell>) -> Result<Told> {
    let given = Given {
        command: &envelope.command,
        name: "result",
        cell,
        pictures: false,
    };
    envelope.result.told(&envelope.options, &given)
}
