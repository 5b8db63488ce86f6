//! A program around the command: what it hands over instead of files and a terminal.

use std::collections::BTreeMap;
use stiffarm::Watch;
use stiffarm::plan::select::Accept;

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
