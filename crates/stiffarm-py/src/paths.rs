//! Paths of tables and programs, as tables.

use crate::cell::PyCell;
use crate::error::Raised;
use pyo3::prelude::*;
use stiffarm::findings::Finding;
use stiffarm::{Code, Error, Result};
use stiffarm_files::builtin;
use stiffarm_files::source::{NamedPath, Source, read_path};
use stiffarm_files::table::{self, write_path};
use stiffarm_files::tool_path::{LANGUAGES, PathLanguage};

/// Files of the disk, and those that are built in.
pub struct Files;

impl Source for Files {
    fn read(&self, _role: &str, from: &str) -> Result<(String, Vec<u8>)> {
        let bytes = match from.strip_prefix(builtin::PREFIX) {
            Some(name) => builtin::bytes(name)?.to_vec(),
            None => std::fs::read(from).map_err(|error| {
                let message = format!("The file cannot be read: {error}.");
                Error::new(Code::FileRead, message).file(from)
            })?,
        };
        Ok((from.to_string(), bytes))
    }
}

/// The language of this name.
fn language_of(name: &str) -> Result<PathLanguage> {
    let row = LANGUAGES.iter().find(|(label, ..)| *label == name);
    row.map(|(.., language)| *language).ok_or_else(|| {
        let names: Vec<&str> = LANGUAGES.iter().map(|(name, ..)| *name).collect();
        let message = format!("There is no language \"{name}\" of paths.");
        let error = Error::new(Code::UnknownName, message).key("language");
        error.hint(names.join(", "))
    })
}

/// What is to be known, as JSON.
fn said(findings: &[Finding]) -> Result<String> {
    serde_json::to_string(findings).map_err(|error| Error::new(Code::Internal, error.to_string()))
}

/// The table of a path, and what is to be known about it.
#[pyfunction]
#[pyo3(signature = (cell, from, language))]
pub fn path_text(py: Python<'_>, cell: &PyCell, from: &str, language: Option<&str>) -> PyResult<(String, String)> {
    let read = py.detach(|| {
        let language = language.map(language_of).transpose()?;
        let path = read_path(&Files, from, &cell.cell, language, None, None)?;
        let text = write_path(&path.table.format, &path.table.points)?;
        Ok((text, said(&path.findings)?))
    });
    read.raised(py)
}

/// Files with their contents, and what is to be known about them.
type Written = (Vec<Vec<u8>>, String);

/// The files of the program `from` with its points where those of a table are.
#[pyfunction]
#[pyo3(signature = (cell, from, table, language))]
pub fn path_program(
    py: Python<'_>,
    cell: &PyCell,
    from: &str,
    table: &str,
    language: Option<&str>,
) -> PyResult<Written> {
    let written = py.detach(|| -> Result<Written> {
        let language = language.map(language_of).transpose()?;
        let path = read_path(&Files, from, &cell.cell, language, None, None)?;
        let NamedPath { table: nominal, program: Some(program), .. } = &path else {
            let error = Error::new(Code::Unsupported, "This is a table, and no program.").file(from);
            return Err(error.hint("a table is written with save()"));
        };
        let moved = table::read_path(table.as_bytes(), "points", &cell.cell, None)?;
        let written = program.write(&nominal.points, &moved.points)?;
        let findings = said(&written.findings())?;
        Ok((written.files.into_iter().map(|(_, bytes)| bytes).collect(), findings))
    });
    written.raised(py)
}
