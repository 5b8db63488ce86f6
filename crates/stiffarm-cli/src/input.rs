//! Reading: files, standard input, built-in files.

use crate::identity::{FileId, Input, of_stdin};
use crate::session::Session;
use std::io::Read;
use std::path::Path;
use stiffarm::estimate::saved::{PRIOR, Saved};
use stiffarm::findings::visible;
use stiffarm::model::observation::ExtraTerm;
use stiffarm::{Code, Error, Result};
use stiffarm_files::builtin;
use stiffarm_files::source::{NamedCell, STANDARD_INPUT, STANDARD_INPUT_NAME, Source, read_cell};
use stiffarm_files::table::sha256_hex;

/// An input as a line above a table.
pub trait Line {
    /// The line with its end.
    fn line(&self) -> String;
}

impl Line for NamedCell {
    /// First line of every table: which cell this is about.
    fn line(&self) -> String {
        format!("cell: {} ({})\n", self.name, self.cell.name)
    }
}

impl Line for Saved {
    /// Where the stiffness comes from, as a line below the cell's.
    fn line(&self) -> String {
        let errors = &self.predictor.common;
        let is_mixed = |term: &ExtraTerm| matches!(term, ExtraTerm::Spring { .. });
        let mixed = self.predictor.extra.iter().any(is_mixed);
        let with = match (&self.predictor.spread, errors.is_empty()) {
            (_, true) if mixed => "the mixed elastic model and its covariance",
            (_, false) if mixed => "the mixed elastic model, its covariance and common-mode errors",
            (Some(_), false) => "covariance and common-mode errors",
            (Some(_), true) => "covariance",
            (None, _) => "no covariance",
        };
        if self.name == PRIOR {
            "stiffness: the cell's prior, which states no uncertainty\n".to_string()
        } else {
            format!("stiffness: {} (with {with})\n", self.name)
        }
    }
}

impl Source for Session {
    /// Reads a file, `-` or `builtin:NAME`; standard input can be read once.
    fn read(&self, role: &str, from: &str) -> Result<(String, Vec<u8>)> {
        if let Some(bytes) = self.host.inputs.get(from) {
            return Ok(self.taken(role, visible(from).into_owned(), bytes.clone(), None, false));
        }
        if from == STANDARD_INPUT {
            self.refuse_output(of_stdin().as_ref(), STANDARD_INPUT_NAME)?;
            let bytes = self.read_stdin()?;
            let name = STANDARD_INPUT_NAME.to_string();
            return Ok(self.taken(role, name, bytes, of_stdin(), true));
        }
        if let Some(name) = from.strip_prefix(builtin::PREFIX) {
            let bytes = builtin::bytes(name)?.to_vec();
            return Ok(self.taken(role, from.to_string(), bytes, None, false));
        }
        self.read_file(role, Path::new(from))
    }
}

impl Session {
    /// Reads a cell as [`read_cell`], and remembers it for the page of the result.
    ///
    /// # Errors
    /// As [`read_cell`].
    pub fn read_cell(&self, from: &str) -> Result<NamedCell> {
        let named = read_cell(self, from)?;
        self.remember_cell(&named.cell);
        Ok(named)
    }

    /// Reads a file, whatever its name.
    ///
    /// # Errors
    /// The file cannot be read, or is an output.
    pub fn read_file(&self, role: &str, path: &Path) -> Result<(String, Vec<u8>)> {
        let from = path.to_string_lossy();
        let name = visible(&from).into_owned();
        let id = FileId::of(path);
        self.refuse_output(Some(&id), &name)?;
        let bytes = std::fs::read(path).map_err(|e| read_error(&from, &e))?;
        Ok(self.taken(role, name, bytes, Some(id), false))
    }

    /// Remembers what was read.
    fn taken(&self, role: &str, name: String, bytes: Vec<u8>, id: Option<FileId>, is_stdin: bool) -> (String, Vec<u8>) {
        self.remember(Input {
            role: role.to_string(),
            name: name.clone(),
            sha256: sha256_hex(&bytes),
            bytes: bytes.clone(),
            is_stdin,
            id,
        });
        (name, bytes)
    }

    fn read_stdin(&self) -> Result<Vec<u8>> {
        if self.has_read_stdin() {
            return Err(Error::new(Code::Usage, "Standard input (`-`) can be used for one file only."));
        }
        let mut bytes = Vec::new();
        std::io::stdin()
            .read_to_end(&mut bytes)
            .map_err(|e| Error::new(Code::FileRead, format!("Standard input cannot be read: {e}.")))?;
        Ok(bytes)
    }
}

fn read_error(from: &str, error: &std::io::Error) -> Error {
    let hint = if builtin::names().contains(&from) {
        format!("did you mean {}{from}?", builtin::PREFIX)
    } else if Path::new(from).is_dir() {
        "give a file inside it".to_string()
    } else if error.kind() == std::io::ErrorKind::NotFound {
        "check the path; `stiffarm init` writes files to start from, and builtin:comau is built in".to_string()
    } else {
        "check that you may read it".to_string()
    };
    let message = if Path::new(from).is_dir() {
        "This is a folder, not a file.".to_string()
    } else if error.kind() == std::io::ErrorKind::NotFound {
        "There is no such file.".to_string()
    } else {
        format!("The file cannot be read: {error}.")
    };
    Error::new(Code::FileRead, message).file(visible(from)).hint(hint)
}
