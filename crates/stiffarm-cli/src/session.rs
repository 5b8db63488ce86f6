//! What all commands share: the way they were asked to speak, and what they read.

use crate::args::Global;
use std::cell::RefCell;
use std::collections::BTreeMap;
use stiffarm::{Code, Error, Result};

/// One file that was read.
pub struct Input {
    /// What the command reads it as, for example `cell`.
    pub role: String,
    /// Its name in messages.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
    /// SHA-256 of the content.
    pub sha256: String,
    /// True for standard input.
    pub is_stdin: bool,
}

/// One run of the command.
pub struct Session {
    /// One JSON object instead of tables.
    pub json: bool,
    /// Neither progress nor remarks.
    pub quiet: bool,
    /// When to use colours.
    pub color: anstream::ColorChoice,
    /// Everything read so far: errors quote from it, results name its hashes.
    inputs: RefCell<Vec<Input>>,
}

impl Session {
    /// A session as the global options want it.
    pub fn new(global: &Global) -> Self {
        Session {
            json: global.json,
            quiet: global.quiet,
            color: match global.color {
                clap::ColorChoice::Auto => anstream::ColorChoice::Auto,
                clap::ColorChoice::Always => anstream::ColorChoice::Always,
                clap::ColorChoice::Never => anstream::ColorChoice::Never,
            },
            inputs: RefCell::new(Vec::new()),
        }
    }

    /// Sizes the pool that all parallel work runs on.
    ///
    /// # Errors
    /// The threads cannot be started.
    pub fn set_threads(&self, global: &Global) -> Result<()> {
        let Some(threads) = global.threads else {
            return Ok(());
        };
        rayon::ThreadPoolBuilder::new()
            .num_threads(usize::from(threads))
            .build_global()
            .map_err(|e| {
                Error::new(
                    Code::Internal,
                    format!("{threads} threads could not be started: {e}."),
                )
            })
    }

    /// Remembers an input.
    pub fn remember(&self, input: Input) {
        self.inputs.borrow_mut().push(input);
    }

    /// True when standard input has been read: it can be read once.
    pub fn has_read_stdin(&self) -> bool {
        self.inputs.borrow().iter().any(|input| input.is_stdin)
    }

    /// True when `path` is a file that was read.
    pub fn has_read(&self, path: &std::path::Path) -> bool {
        let Ok(path) = std::fs::canonicalize(path) else {
            return false;
        };
        let inputs = self.inputs.borrow();
        inputs
            .iter()
            .filter(|input| !input.is_stdin)
            .any(|input| std::fs::canonicalize(&input.name).is_ok_and(|p| p == path))
    }

    /// Text of an input by the name that errors use for it.
    pub fn text_of(&self, name: &str) -> Option<String> {
        let inputs = self.inputs.borrow();
        let input = inputs.iter().find(|input| input.name == name)?;
        std::str::from_utf8(&input.bytes).ok().map(String::from)
    }

    /// Hashes of the inputs by their role.
    pub fn hashes(&self) -> BTreeMap<String, String> {
        let inputs = self.inputs.borrow();
        inputs
            .iter()
            .map(|input| (input.role.clone(), input.sha256.clone()))
            .collect()
    }
}
