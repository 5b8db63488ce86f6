//! What results say that are at hand as JSON, for a program around the command.

use crate::page::page_of_saved;
use crate::screen::plain;
use crate::text;
use stiffarm::Result;
use stiffarm::files::result::read_result;
use stiffarm::model::cell::Cell;
use stiffarm_report::tell::{Given, tell};

/// What a result says, in words: a result as `--json` prints it, and its cell where that is at hand.
///
/// # Errors
/// A text that holds no result, or one that is not told.
pub fn told(json: &str, cell: Option<&Cell>, details: bool) -> Result<String> {
    let saved = read_result(json.as_bytes(), "result")?;
    let told = tell(&Given::new(&saved, cell).in_words())?;
    Ok(plain(&text::told(&told, details)))
}

/// The page of a result as `--json` prints it, with its cell where that is at hand.
///
/// # Errors
/// As [`told`].
pub fn page(json: &str, cell: Option<&Cell>) -> Result<String> {
    page_of_saved(&read_result(json.as_bytes(), "result")?, cell)
}
