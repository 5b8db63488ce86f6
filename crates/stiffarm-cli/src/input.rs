//! Reading: files, standard input, built-in files.

use crate::identity::{FileId, Input, folder_of, of_stdin};
use crate::session::Session;
use std::io::Read;
use std::path::Path;
use stiffarm::files::builtin;
use stiffarm::files::cell::parse_cell_bytes_with;
use stiffarm::files::registration::read_registration;
use stiffarm::files::table::{
    holds_measurements, read_growing_measurements, read_measurements, read_measurements_of,
    read_postures, sha256_hex,
};
use stiffarm::findings::visible;
use stiffarm::measure::prepare;
use stiffarm::measure::reduction::ReduceOptions;
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::{Candidate, Measurements};
use stiffarm::model::posture::{Posture, PostureGroup};
use stiffarm::model::robot::Robot;
use stiffarm::{Code, Error, Result};

/// Name of standard input in messages.
const STDIN: &str = "standard input";

/// A cell with the name it was asked for by.
pub struct NamedCell {
    /// The cell.
    pub cell: Cell,
    /// File name or `builtin:…`.
    pub name: String,
}

impl NamedCell {
    /// First line of every table: which cell this is about.
    pub fn line(&self) -> String {
        format!("cell: {} ({})\n", self.name, self.cell.name)
    }
}

impl Session {
    /// Reads a cell with the meshes that it names. Those of a file count from its folder, of a
    /// built-in cell they are built in, of standard input they count from the working folder.
    ///
    /// # Errors
    /// A file that cannot be read, or anything wrong with the cell.
    pub fn read_cell(&self, from: &str) -> Result<NamedCell> {
        let (name, bytes) = self.read("cell", from)?;
        let folder = folder_of(Path::new(from));
        let read = |file: &str| {
            let role = format!("cell mesh {file}");
            let mesh = match from.starts_with(builtin::PREFIX) || file.starts_with(builtin::PREFIX)
            {
                true => {
                    let name = file.strip_prefix(builtin::PREFIX).unwrap_or(file);
                    self.read(&role, &format!("{}{name}", builtin::PREFIX))
                }
                false => self.read_path(&role, &folder.join(file)),
            };
            mesh.map(|(_, bytes)| bytes)
                .map_err(|error| match error.code() {
                    // What it says of files to start from is no help here.
                    Code::FileRead => Error::new(Code::FileRead, error.message()),
                    _ => error,
                })
        };
        let cell = parse_cell_bytes_with(&bytes, &name, &read)?;
        if let Some(page) = self.page.borrow_mut().as_mut() {
            page.cell.get_or_insert_with(|| cell.clone());
        }
        Ok(NamedCell { cell, name })
    }

    /// Reads postures of `robot`.
    ///
    /// # Errors
    /// A file that cannot be read, or anything wrong with its table.
    pub fn read_postures(&self, role: &str, from: &str, robot: &Robot) -> Result<Vec<Posture>> {
        let (name, bytes) = self.read(role, from)?;
        let postures = read_postures(&bytes, &name, robot)?;
        if postures.is_empty() {
            return Err(Error::new(
                Code::TooFewData,
                "The table has no postures, only a heading.",
            )
            .file(name)
            .hint("add one row per posture"));
        }
        Ok(postures)
    }

    /// Reads groups of postures, named by their files.
    ///
    /// # Errors
    /// As [`Session::read_postures`].
    pub fn read_groups(&self, from: &[String], robot: &Robot) -> Result<Vec<PostureGroup>> {
        let stems: Vec<String> = from.iter().map(|from| group_name(from)).collect();
        let mut groups = Vec::with_capacity(from.len());
        for (i, (from, stem)) in from.iter().zip(&stems).enumerate() {
            let postures = self.read_postures(&format!("postures_{}", i + 1), from, robot)?;
            // Two files of one name in different folders stay apart.
            let same = stems[..i].iter().filter(|other| *other == stem).count();
            let name = if same == 0 {
                stem.clone()
            } else {
                format!("{stem} ({})", same + 1)
            };
            groups.push(PostureGroup { name, postures });
        }
        Ok(groups)
    }

    /// Reads displacements or raw readings from one file or several, with controller angles from
    /// `postures` where that is given.
    ///
    /// # Errors
    /// A file that cannot be read, or anything wrong with its table.
    pub fn read_measurements(
        &self,
        from: &[String],
        postures: Option<&str>,
        cell: &Cell,
    ) -> Result<Measurements> {
        self.measurements(from, postures, cell, false)
    }

    /// The same of files that are still being filled.
    ///
    /// # Errors
    /// As [`Session::read_measurements`].
    pub fn read_growing_measurements(
        &self,
        from: &[String],
        postures: Option<&str>,
        cell: &Cell,
    ) -> Result<Measurements> {
        self.measurements(from, postures, cell, true)
    }

    fn measurements(
        &self,
        from: &[String],
        postures: Option<&str>,
        cell: &Cell,
        growing: bool,
    ) -> Result<Measurements> {
        let robot = &cell.setup.robot;
        let postures = postures
            .map(|from| self.read_postures("postures", from, robot))
            .transpose()?;
        let mut files = Vec::with_capacity(from.len());
        for (number, from) in (1..).zip(from) {
            let role = match number {
                1 => "measurements".to_string(),
                _ => format!("measurements_{number}"),
            };
            files.push(self.read(&role, from)?);
        }
        let files: Vec<(&[u8], &str)> = files
            .iter()
            .map(|(name, bytes)| (bytes.as_slice(), name.as_str()))
            .collect();
        match growing {
            true => read_growing_measurements(&files, cell, postures.as_deref()),
            false => read_measurements_of(&files, cell, postures.as_deref()),
        }
    }

    /// Reads candidates to choose from: a table of postures, or one of measurements, whose
    /// postures count under their measured wrenches, of several states of a posture under
    /// the largest force. True where they were measured.
    ///
    /// # Errors
    /// A file that cannot be read, anything wrong with its table, readings that cannot be
    /// reduced.
    pub fn read_candidates(&self, from: &str, cell: &Cell) -> Result<(Vec<Candidate>, bool)> {
        let (name, bytes) = self.read("candidates", from)?;
        if !holds_measurements(&bytes, &name, cell)? {
            let postures = read_postures(&bytes, &name, &cell.setup.robot)?;
            let plain = postures
                .into_iter()
                .map(|posture| Candidate::new(posture.name, posture.q));
            return Ok((plain.collect(), false));
        }
        let measurements = read_measurements(&bytes, &name, cell, None)?;
        let measured = prepare(cell, measurements, &ReduceOptions::default())?;
        Ok((
            Candidate::of_measured(&cell.setup, &measured.postures),
            true,
        ))
    }

    /// Options of a reduction of raw readings: with the registration that
    /// `register` saved in `from`, if given.
    ///
    /// # Errors
    /// A file that cannot be read, or holds no registration.
    pub fn read_registration(&self, from: Option<&str>) -> Result<ReduceOptions> {
        let Some(from) = from else {
            return Ok(ReduceOptions::default());
        };
        let (name, bytes) = self.read("registration", from)?;
        let registration = read_registration(&bytes, &name)?;
        Ok({
            let mut options = ReduceOptions::default();
            options.base_from_tracker = Some(registration.base_from_tracker);
            options
        })
    }

    /// Reads a file, `-` or `builtin:NAME`; returns its name for messages and its bytes.
    ///
    /// # Errors
    /// The file cannot be read, there is no such built-in, or standard input is
    /// asked for twice.
    pub fn read(&self, role: &str, from: &str) -> Result<(String, Vec<u8>)> {
        if from == "-" {
            self.refuse_output(of_stdin().as_ref(), STDIN)?;
            let bytes = self.read_stdin()?;
            return Ok(self.taken(role, STDIN.to_string(), bytes, of_stdin(), true));
        }
        if let Some(name) = from.strip_prefix(builtin::PREFIX) {
            let bytes = read_builtin(name)?;
            return Ok(self.taken(role, from.to_string(), bytes, None, false));
        }
        self.read_path(role, Path::new(from))
    }

    /// Reads a file, whatever its name.
    ///
    /// # Errors
    /// The file cannot be read, or is an output.
    pub fn read_path(&self, role: &str, path: &Path) -> Result<(String, Vec<u8>)> {
        let from = path.to_string_lossy();
        let name = visible(&from).into_owned();
        let id = FileId::of(path);
        self.refuse_output(Some(&id), &name)?;
        let bytes = std::fs::read(path).map_err(|e| read_error(&from, &e))?;
        Ok(self.taken(role, name, bytes, Some(id), false))
    }

    /// Remembers what was read.
    fn taken(
        &self,
        role: &str,
        name: String,
        bytes: Vec<u8>,
        id: Option<FileId>,
        is_stdin: bool,
    ) -> (String, Vec<u8>) {
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
            return Err(Error::new(
                Code::Usage,
                "Standard input (`-`) can be used for one file only.",
            ));
        }
        let mut bytes = Vec::new();
        std::io::stdin().read_to_end(&mut bytes).map_err(|e| {
            Error::new(
                Code::FileRead,
                format!("Standard input cannot be read: {e}."),
            )
        })?;
        Ok(bytes)
    }
}

/// Name of a group: the file's without folder and extension.
pub fn group_name(from: &str) -> String {
    if from == "-" {
        return STDIN.to_string();
    }
    if let Some(name) = from.strip_prefix(builtin::PREFIX) {
        return name.to_string();
    }
    Path::new(from).file_stem().map_or_else(
        || from.to_string(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}

fn read_builtin(name: &str) -> Result<Vec<u8>> {
    let text = builtin::cell_text(name)
        .or_else(|| builtin::postures_text(name))
        .or_else(|| builtin::pairs_text(name))
        .or_else(|| builtin::path_text(name))
        .or_else(|| builtin::mesh_text(name));
    text.map(|text| text.as_bytes().to_vec()).ok_or_else(|| {
        let known: Vec<String> = builtin::names()
            .iter()
            .map(|n| format!("{}{n}", builtin::PREFIX))
            .collect();
        Error::new(
            Code::UnknownName,
            format!("There is no built-in file \"{}{name}\".", builtin::PREFIX),
        )
        .hint(format!("built in: {}", known.join(", ")))
    })
}

fn read_error(from: &str, error: &std::io::Error) -> Error {
    let hint = if builtin::names().contains(&from) {
        format!("did you mean {}{from}?", builtin::PREFIX)
    } else if Path::new(from).is_dir() {
        "give a file inside it".to_string()
    } else if error.kind() == std::io::ErrorKind::NotFound {
        "check the path; `stiffarm init` writes files to start from, and builtin:comau is built in"
            .to_string()
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
    Error::new(Code::FileRead, message)
        .file(visible(from))
        .hint(hint)
}
