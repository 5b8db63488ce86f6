//! `--report FILE`: the page of a result that was just made.

use crate::files::write_all;
use crate::files::{ends_in, only_target};
use crate::session::Session;
use crate::session::WantedPage;
use serde::Serialize;
use stiffarm::Result;
use stiffarm::model::cell::Cell;
use stiffarm::{Code, Error};
use stiffarm_files::result::SavedResult;
use stiffarm_report::page::render_page;
use stiffarm_report::report::{WithCell, report};

/// Refuses a page whose name says that it is something else: no browser would open it by a double click.
///
/// # Errors
/// A name with another ending than .html or .htm.
pub fn check_page_name(path: &str, option: &str) -> Result<()> {
    if path == "-" || ends_in(path, "html") || ends_in(path, "htm") {
        Ok(())
    } else {
        Err(
            Error::new(Code::Usage, "A page is a file whose name ends in .html.")
                .key(option)
                .hint("for example report.html; `--json > result.json` keeps the result itself"),
        )
    }
}

impl Session {
    /// Remembers where the page of the result goes, if anywhere.
    ///
    /// # Errors
    /// A file that cannot be written, or exists and `force` is not given.
    pub fn will_report(&self, path: Option<&str>, force: bool) -> Result<()> {
        if let Some(path) = path {
            let target = only_target(self, Some(path), force)?;
            check_page_name(path, "--report")?;
            self.page
                .replace(target.map(|target| WantedPage { target, cell: None }));
        }
        Ok(())
    }

    /// Writes the page of a result, where one is asked for.
    ///
    /// # Errors
    /// A result that has no page.
    pub fn write_page(&self, envelope: &impl Serialize) -> Result<()> {
        let Some(wanted) = self.page.borrow_mut().take() else {
            return Ok(());
        };
        let page = page_of(envelope, wanted.cell.as_ref())?;
        write_all(self, &[(wanted.target, page)])
    }
}

/// The page of a result, of what its file holds: angles in degrees are not the same to the last bit, and `report` makes the
/// same page of the file.
///
/// # Errors
/// A result that has no page.
pub fn page_of(envelope: &impl Serialize, cell: Option<&Cell>) -> Result<String> {
    page_of_saved(&SavedResult::of(envelope, "result")?, cell)
}

/// The same of a result that was read.
///
/// # Errors
/// As [`page_of`].
pub fn page_of_saved(saved: &SavedResult, cell: Option<&Cell>) -> Result<String> {
    Ok(render_page(&report(&[WithCell::new(saved, cell)])?))
}
