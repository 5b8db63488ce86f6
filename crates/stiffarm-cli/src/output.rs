//! Printing: text for people, files and objects as they are; how a command ends.

use crate::screen::{plain, rendered};
use crate::session::Session;
use serde::Serialize;
use std::io::{ErrorKind, Write};
use stiffarm::findings::{Finding, Severity, codes};
use stiffarm::model::cell::Cell;
use stiffarm::{Code, Error, Result};
use stiffarm_files::envelope::Envelope;
use stiffarm_report::summary::{Context, Summarise, Summary};

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
        if is_finding { Exit::Finding } else { Exit::Done }
    }

    /// [`Exit::Interrupted`] if the user stopped the work, else as [`Exit::of_findings`].
    pub fn so_far(interrupted: bool, findings: &[Finding]) -> Self {
        if interrupted { Exit::Interrupted } else { Exit::of_findings(findings) }
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
            Err(e) if e.kind() != ErrorKind::BrokenPipe => {
                Err(Error::new(Code::FileWrite, format!("Standard output cannot be written: {e}.")))
            }
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
pub fn summary<O, R: Summarise<O>>(envelope: &Envelope<O, R>, cell: Option<&Cell>) -> Result<Summary> {
    let context = Context { command: &envelope.command, name: "result", cell, pictures: false };
    envelope.result.summary(&envelope.options, &context)
}
