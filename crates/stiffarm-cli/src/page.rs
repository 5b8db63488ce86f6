//! `--report FILE`: the page of a result that was just made.

use crate::files::{ends_in, only_target};
use crate::session::Session;
use crate::target::Target;
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
        Err(Error::new(Code::Usage, "A page is a file whose name ends in .html.")
            .key(option)
            .hint("for example report.html; `--json > result.json` keeps the result itself"))
    }
}

/// Where the page of the result goes, if anywhere.
///
/// # Errors
/// A file that cannot be written, or exists and `force` is not given.
pub fn page_target(session: &Session, path: Option<&str>, force: bool) -> Result<Option<Target>> {
    let target = only_target(session, path, force)?;
    path.map_or(Ok(()), |path| check_page_name(path, "--report"))?;
    Ok(target)
}

/// The page of a result, of what its file holds: angles in degrees are not the same to the last bit, and `report` makes
/// the same page of the file.
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
