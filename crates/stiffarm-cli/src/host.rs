//! A program around the command: what it hands over instead of files and a terminal.

use crate::screen::plain;
use crate::text;
use std::collections::BTreeMap;
use stiffarm::files::result::read_result;
use stiffarm::model::cell::Cell;
use stiffarm::plan::select::Accept;
use stiffarm::{Result, Watch};
use stiffarm_report::page::render_page;
use stiffarm_report::report::report;
use stiffarm_report::tell::{Given, tell};

/// What a program that runs the command in its own process gives it.
#[derive(Default)]
pub struct Host {
    /// Inputs that are no files, by their names among the words; they come before files of these names.
    pub inputs: BTreeMap<String, Vec<u8>>,
    /// Told how far long work is, and asked whether to stop it with the best so far.
    pub watch: Option<Watch>,
    /// Which postures `select` may choose, beside the limits of the cell.
    pub accept: Option<Accept>,
}

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
    let saved = read_result(json.as_bytes(), "result")?;
    Ok(render_page(&report(&[Given::new(&saved, cell)])?))
}
