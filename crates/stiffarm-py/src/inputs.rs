//! Inputs of a call: files, texts in memory, arrays; and their hashes for the result.

use crate::cell::PyCell;
use crate::error::Raised;
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::cell::RefCell;
use std::collections::BTreeMap;
use stiffarm::files::builtin;
use stiffarm::files::envelope::{Envelope, write_result};
use stiffarm::files::source::{Source, distinct, group_name};
use stiffarm::files::table::{sha256_hex, write_postures};
use stiffarm::model::observation::check_angles;
use stiffarm::model::posture::{Posture, PostureGroup};
use stiffarm::model::robot::Robot;
use stiffarm::{Code, Error, Result};

/// A table or a saved result.
#[derive(FromPyObject)]
pub enum Given {
    /// Name and bytes.
    Memory(String, Vec<u8>),
    /// A file, or `builtin:NAME`.
    File(String),
}

/// Postures.
#[derive(FromPyObject)]
pub enum GivenPostures<'py> {
    /// Names, and angles \[rad\], one row each.
    Values(Vec<String>, PyReadonlyArray2<'py, f64>),
    /// Name and bytes of a table.
    Memory(String, Vec<u8>),
    /// A file, or `builtin:NAME`.
    File(String),
}

/// Postures without the interpreter's lock.
pub enum Postures {
    /// Angles and names.
    Values(Vec<Posture>),
    /// A table.
    Table(Given),
}

impl GivenPostures<'_> {
    /// The same as values of the library.
    pub fn owned(self, py: Python<'_>) -> PyResult<Postures> {
        Ok(match self {
            GivenPostures::Memory(name, bytes) => Postures::Table(Given::Memory(name, bytes)),
            GivenPostures::File(name) => Postures::Table(Given::File(name)),
            GivenPostures::Values(names, angles) => {
                if names.len() != angles.shape()[0] {
                    let message = "There are not as many names as postures.";
                    return Err(Error::new(Code::Dimension, message)).raised(py);
                }
                let rows = crate::arrays::postures(&angles)?;
                let postures = names.into_iter().zip(rows).map(|(name, q)| Posture {
                    name,
                    q: q.to_vec(),
                });
                Postures::Values(postures.collect())
            }
        })
    }
}

/// What a call has read.
pub struct Inputs {
    memory: RefCell<BTreeMap<String, Vec<u8>>>,
    hashes: RefCell<BTreeMap<String, String>>,
}

impl Inputs {
    /// Those of a call about `cell`.
    pub fn of(cell: &PyCell) -> Self {
        Inputs {
            memory: RefCell::default(),
            hashes: RefCell::new(cell.hashes().clone()),
        }
    }

    /// Those of a call without a cell.
    pub fn none() -> Self {
        Inputs {
            memory: RefCell::default(),
            hashes: RefCell::default(),
        }
    }

    /// The name under which an input is read.
    pub fn name(&self, given: Given) -> String {
        match given {
            Given::File(name) => name,
            Given::Memory(name, bytes) => {
                self.memory.borrow_mut().insert(name.clone(), bytes);
                name
            }
        }
    }

    /// The names of several.
    pub fn names(&self, given: Vec<Given>) -> Vec<String> {
        given.into_iter().map(|one| self.name(one)).collect()
    }

    /// Postures of `robot`; an array counts as the table that is written of it.
    ///
    /// # Errors
    /// A table that cannot be read, no postures, angles of the wrong number or not finite.
    pub fn postures(&self, role: &str, given: Postures, robot: &Robot) -> Result<Vec<Posture>> {
        let postures = match given {
            Postures::Table(table) => return self.read_postures(role, &self.name(table), robot),
            Postures::Values(postures) => postures,
        };
        if postures.is_empty() {
            return Err(Error::new(Code::TooFewData, "There are no postures."));
        }
        for posture in &postures {
            check_angles(robot, &posture.q)?;
        }
        let hash = sha256_hex(write_postures(&postures).as_bytes());
        self.hashes.borrow_mut().insert(role.to_string(), hash);
        Ok(postures)
    }

    /// Groups of postures; a file without a name gives its own.
    ///
    /// # Errors
    /// As [`Inputs::postures`].
    pub fn groups(
        &self,
        given: Vec<(String, Postures)>,
        robot: &Robot,
    ) -> Result<Vec<PostureGroup>> {
        let stem = |(name, postures): &(String, Postures)| match postures {
            Postures::Table(Given::File(file)) if name.is_empty() => group_name(file),
            _ => name.clone(),
        };
        let names = distinct(&given.iter().map(stem).collect::<Vec<_>>());
        let mut groups = Vec::with_capacity(given.len());
        for (number, (name, (_, postures))) in (1..).zip(names.into_iter().zip(given)) {
            let postures = self.postures(&format!("postures_{number}"), postures, robot)?;
            groups.push(PostureGroup { name, postures });
        }
        match groups.is_empty() {
            true => Err(Error::new(
                Code::TooFewData,
                "There are no groups of postures.",
            )),
            false => Ok(groups),
        }
    }

    /// SHA-256 of the cell.
    pub fn cell_hash(&self) -> Option<String> {
        self.hashes.borrow().get("cell").cloned()
    }

    /// The result as the command prints it.
    ///
    /// # Errors
    /// A result that JSON cannot hold.
    pub fn document<O: Serialize, R: Serialize>(
        self,
        command: &str,
        seed: Option<u64>,
        options: O,
        result: R,
    ) -> Result<String> {
        let inputs = self.hashes.into_inner();
        write_result(&Envelope::new(
            command,
            Vec::new(),
            inputs,
            seed,
            options,
            result,
        ))
    }
}

impl Source for Inputs {
    fn read(&self, role: &str, from: &str) -> Result<(String, Vec<u8>)> {
        let known = self.memory.borrow().get(from).cloned();
        let bytes = match (known, from.strip_prefix(builtin::PREFIX)) {
            (Some(bytes), _) => bytes,
            (None, Some(name)) => builtin::bytes(name)?.to_vec(),
            (None, None) => std::fs::read(from).map_err(|error| {
                let message = format!("The file cannot be read: {error}.");
                Error::new(Code::FileRead, message).file(from)
            })?,
        };
        let mut hashes = self.hashes.borrow_mut();
        hashes.insert(role.to_string(), sha256_hex(&bytes));
        Ok((from.to_string(), bytes))
    }
}

/// A choice by its name in results; dashes and underscores are alike.
///
/// # Errors
/// There is none of this name; the names that there are stand in the hint.
pub fn choice<T: DeserializeOwned>(key: &str, name: &str) -> Result<T> {
    let read = |name: String| serde_json::from_value::<T>(serde_json::Value::String(name));
    read(name.to_string())
        .or_else(|_| read(name.replace('-', "_")))
        .or_else(|_| read(name.replace('_', "-")))
        .map_err(|error| {
            let said = error.to_string();
            let known = said
                .split_once("expected ")
                .map(|(_, known)| known.to_string());
            let error = Error::new(Code::UnknownName, format!("There is no \"{name}\" here."));
            let error = error.key(key);
            match known {
                Some(known) => error.hint(format!("known: {}", known.replace('`', ""))),
                None => error,
            }
        })
}
