//! Where what a command answers goes: files, words for people, one JSON object for machines.

use crate::answer::Answer;
use crate::error::report_beside;
use crate::files::{Files, Written};
use crate::screen::fitted;
use crate::session::Session;
use crate::target::Target;
use stiffarm::Result;

impl Session {
    /// Delivers what a command answered, and gives the exit code of the process.
    ///
    /// Files are written first, group by group, the page last. Standard output belongs to the file that was asked for
    /// there, and what there is to say goes to standard error; else it belongs to the JSON object or the words. A file
    /// that could not be written is told after the result, and decides the exit code.
    ///
    /// # Errors
    /// A form of the result that cannot be made; then nothing is written. Standard output cannot be written.
    pub fn deliver(&self, page: Option<Target>, answer: Answer) -> Result<u8> {
        let Answer { shown, mut files, .. } = answer;
        if let (Some(target), Some(shown)) = (page, &shown) {
            files.push(Files::one(target, shown.page(self.cell())?));
        }
        let is_taken = files.iter().any(Files::takes_stdout);
        let said = match (&shown, is_taken, answer.beside) {
            (None, ..) => String::new(),
            (Some(_), true, Some(beside)) => beside,
            (Some(_), true, None) if self.quiet => String::new(),
            (Some(shown), true, None) => shown.words()? + "\n",
            (Some(shown), false, _) if self.json => shown.object()?,
            (Some(shown), false, _) => shown.words()?,
        };
        self.print_error(answer.warning);
        let mut written = Written::default();
        for group in files {
            written.write(self, group)?;
        }
        let notes = match written.failure {
            Some(_) => "",
            None => answer.notes.as_str(),
        };
        if is_taken {
            self.print_error(&said);
            let rest = written.said() + notes;
            if !rest.is_empty() {
                self.remark(rest.trim_end());
            }
        } else if self.json {
            self.print_exact(&said)?;
        } else {
            self.print(&fitted(&(said + &written.said() + notes)))?;
        }
        Ok(match written.failure {
            Some(error) => report_beside(self, &error),
            None => answer.exit.code(),
        })
    }
}
