//! What all commands share: the way they were asked to speak, and what they read.

use crate::Captured;
use crate::args::Global;
use crate::arguments::arguments;
use crate::host::Host;
use crate::identity::{FileId, Input};
use crate::interrupt;
use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::Path;
use std::rc::Rc;
use stiffarm::findings::visible;
use stiffarm::model::cell::Cell;
use stiffarm::{Code, Error, Result};

/// Threads that are started on a machine of fewer cores.
const MOST_THREADS: usize = 16;

/// One run of the command.
pub struct Session {
    /// The command line, the program's name first.
    words: Vec<OsString>,
    /// One JSON object instead of tables.
    pub json: bool,
    /// Neither progress nor remarks.
    pub quiet: bool,
    /// When to use colours.
    pub color: anstream::ColorChoice,
    /// Everything read so far: errors quote from it, results name its hashes.
    inputs: RefCell<Vec<Input>>,
    /// Files that will be written.
    outputs: RefCell<Vec<FileId>>,
    /// Whether standard output is spoken for.
    stdout_is_taken: std::cell::Cell<bool>,
    /// The first cell that was read, as its file describes it: that of the page.
    cell: OnceCell<Cell>,
    /// Takes what is printed, instead of the process's own output.
    pub captured: Option<Rc<RefCell<Captured>>>,
    /// What the program around the command hands over.
    pub host: Rc<Host>,
}

impl Session {
    /// A session as the global options want it.
    pub fn new(words: &[OsString], global: &Global, captured: Option<Rc<RefCell<Captured>>>, host: Host) -> Self {
        Session {
            words: words.to_vec(),
            json: global.json,
            quiet: global.quiet,
            color: match global.color {
                clap::ColorChoice::Auto => anstream::ColorChoice::Auto,
                clap::ColorChoice::Always => anstream::ColorChoice::Always,
                clap::ColorChoice::Never => anstream::ColorChoice::Never,
            },
            inputs: RefCell::new(Vec::new()),
            outputs: RefCell::new(Vec::new()),
            stdout_is_taken: std::cell::Cell::new(global.json),
            cell: OnceCell::new(),
            captured,
            host: Rc::new(host),
        }
    }

    /// A session that speaks the same way and has read nothing yet, for files that are read again.
    pub fn afresh(&self) -> Self {
        Session {
            words: self.words.clone(),
            json: self.json,
            quiet: self.quiet,
            color: self.color,
            inputs: RefCell::default(),
            outputs: RefCell::default(),
            stdout_is_taken: std::cell::Cell::new(self.json),
            cell: OnceCell::new(),
            captured: self.captured.clone(),
            host: Rc::clone(&self.host),
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
        // More threads than cores gain nothing, and each takes memory.
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        rayon::ThreadPoolBuilder::new()
            .num_threads(usize::from(threads).min(cores.max(MOST_THREADS)))
            .build_global()
            .map_err(|e| {
                let message = format!("{threads} threads could not be started: {e}.");
                Error::new(Code::Usage, message).key("--threads").hint("give fewer; the results are the same")
            })
    }

    /// True once the user has asked to stop.
    pub fn stopped(&self) -> bool {
        let watch = self.host.watch.as_ref();
        watch.map_or_else(interrupt::stopped, |watch| watch.control().stopped())
    }

    /// Remembers an input.
    pub fn remember(&self, input: Input) {
        self.inputs.borrow_mut().push(input);
    }

    /// True when standard input has been read: it can be read once.
    pub fn has_read_stdin(&self) -> bool {
        self.inputs.borrow().iter().any(|input| input.is_stdin)
    }

    /// Remembers a file that will be written.
    ///
    /// # Errors
    /// Another result goes to the same file, or it is an input.
    pub fn will_write(&self, path: &Path) -> Result<()> {
        self.refuse_input(path)?;
        let id = FileId::of(path);
        if self.outputs.borrow().iter().any(|other| other.is(&id)) {
            return Err(Error::new(Code::Usage, "Two results would go to the same file.")
                .file(visible(&path.to_string_lossy()).into_owned())
                .hint("give each a name of its own"));
        }
        self.outputs.borrow_mut().push(id);
        Ok(())
    }

    /// Refuses an output that was read.
    ///
    /// # Errors
    /// The file is an input.
    pub fn refuse_input(&self, path: &Path) -> Result<()> {
        let id = FileId::of(path);
        let inputs = self.inputs.borrow();
        let ids = inputs.iter().filter_map(|input| input.id.as_ref());
        if ids.into_iter().any(|input| input.is(&id)) {
            Err(is_input(visible(&path.to_string_lossy()).into_owned()))
        } else {
            Ok(())
        }
    }

    /// Refuses an input that will be written; `name` is for messages.
    ///
    /// # Errors
    /// The file is an output.
    pub fn refuse_output(&self, id: Option<&FileId>, name: &str) -> Result<()> {
        let outputs = self.outputs.borrow();
        if id.is_some_and(|id| outputs.iter().any(|output| output.is(id))) {
            Err(is_input(name.to_string()))
        } else {
            Ok(())
        }
    }

    /// Remembers that standard output will take a result.
    ///
    /// # Errors
    /// It takes another already.
    pub fn will_print(&self) -> Result<()> {
        if self.stdout_is_taken.replace(true) {
            let message = "Standard output can take one result only.";
            return Err(Error::new(Code::Usage, message).hint("write one of them to a file"));
        }
        Ok(())
    }

    /// Remembers a cell that was read.
    pub fn remember_cell(&self, cell: &Cell) {
        self.cell.get_or_init(|| cell.clone());
    }

    /// The first cell that was read.
    pub fn cell(&self) -> Option<&Cell> {
        self.cell.get()
    }

    /// Text of an input by the name that errors use for it.
    pub fn text_of(&self, name: &str) -> Option<String> {
        let inputs = self.inputs.borrow();
        let input = inputs.iter().find(|input| input.name == name)?;
        std::str::from_utf8(&input.bytes).ok().map(String::from)
    }

    /// Hash of the input of a role that was read last.
    pub fn last_hash(&self, role: &str) -> Option<String> {
        let inputs = self.inputs.borrow();
        let input = inputs.iter().rev().find(|input| input.role == role);
        input.map(|input| input.sha256.clone())
    }

    /// The words of the command line that the result depends on, inputs as `{role}`.
    pub fn arguments(&self) -> Vec<String> {
        arguments(&self.words, &self.inputs.borrow(), &self.outputs.borrow())
    }

    /// Hashes of the inputs by their role.
    pub fn hashes(&self) -> BTreeMap<String, String> {
        let inputs = self.inputs.borrow();
        inputs.iter().map(|input| (input.role.clone(), input.sha256.clone())).collect()
    }
}

fn is_input(file: String) -> Error {
    Error::new(
        Code::Conflict,
        "This file is an input of the same command, and it is not overwritten even with --force.",
    )
    .file(file)
    .hint("give the output another name")
}
