//! Where inputs come from: whoever can give bytes by name reads everything else.
//!
//! The roles under which inputs are read are the keys of `inputs` in a result
//! ([`Envelope`](super::envelope::Envelope)).

use super::cell::parse_cell_bytes_with;
use super::table::{self, PathFormat, PathKind, PathTable};
use super::tool_path::{Kind, PathLanguage, ToolPath, read_tool_path, recognised};
use super::{builtin, registration, stiffness};
use std::path::Path;
use stiffarm::error::{Code, Error, Result};
use stiffarm::estimate::saved::{PRIOR, Saved};
use stiffarm::findings::Finding;
use stiffarm::measure::prepare;
use stiffarm::measure::reduction::ReduceOptions;
use stiffarm::model::cell::Cell;
use stiffarm::model::implausible;
use stiffarm::model::measurement::{Candidate, Measurements};
use stiffarm::model::path::PathTarget;
use stiffarm::model::posture::{Posture, PostureGroup};
use stiffarm::model::process::ForceAxes;
use stiffarm::model::robot::Robot;

/// Stands for standard input where a file name could stand.
pub const STANDARD_INPUT: &str = "-";

/// Name of standard input in messages.
pub const STANDARD_INPUT_NAME: &str = "standard input";

/// A cell with the name it was asked for by.
#[derive(Debug, Clone)]
pub struct NamedCell {
    /// The cell.
    pub cell: Cell,
    /// File name or `builtin:…`.
    pub name: String,
}

/// A path with its name.
#[derive(Debug, Clone)]
pub struct NamedPath {
    /// The points, and how the file writes them; for a program the columns of a table of it.
    pub table: PathTable,
    /// The program, where the file is no table.
    pub program: Option<ToolPath>,
    /// What is to be known about the program, in sentences.
    pub findings: Vec<Finding>,
    /// File name or `builtin:…`.
    pub name: String,
}

impl NamedPath {
    /// Gives the points the loads of a recorded log.
    fn take_loads(&mut self, source: &impl Source, log: &str, cell: &Cell, axes: Option<ForceAxes>) -> Result<()> {
        let (name, bytes) = source.read("log", log)?;
        let read = table::read_log(&bytes, &name, cell, axes)?;
        let put = read.put_on(cell, &mut self.table.points);
        let put = put.map_err(|error| match error.place().line {
            Some(_) => error.file(self.name.as_str()),
            None => error.file(name),
        });
        self.findings.extend(put?);
        Ok(())
    }

    /// Gives the points without a load that of their feature.
    fn take_features(&mut self, cell: &Cell) -> Result<()> {
        let features = cell.work.put_on(&mut self.table.points);
        let features = features.map_err(|error| error.file(self.name.as_str()))?;
        self.findings.extend(features);
        Ok(())
    }

    /// Gives the table columns for what its points hold: loads of a feature or a log need not be in the axes of its
    /// own.
    fn fit_columns(&mut self, cell: &Cell) {
        let PathTable { points, format } = &mut self.table;
        if points.iter().any(|point| !format.holds(point)) {
            *format = format.clone().holding(points, cell);
        }
    }

    /// An error about one of the points, with the file that the point stands in.
    pub fn in_file(&self, error: Error) -> Error {
        match error.place().line {
            Some(_) => error.file(&self.name),
            None => error,
        }
    }
}

/// Gives inputs by name, and remembers their hashes by role: what they hold is read by the functions below.
pub trait Source {
    /// Reads a file, `builtin:NAME` ([`builtin::bytes`]) or whatever else can be named;
    /// returns the name for messages and the bytes, and remembers their SHA-256 under `role`.
    ///
    /// # Errors
    /// It cannot be read.
    fn read(&self, role: &str, from: &str) -> Result<(String, Vec<u8>)>;
}

/// Reads a cell with the meshes that it names. Those of a file count from its folder, of a
/// built-in cell they are built in, of standard input they count from the working folder.
///
/// # Errors
/// A file that cannot be read, or anything wrong with the cell.
pub fn read_cell(source: &impl Source, from: &str) -> Result<NamedCell> {
    let (name, bytes) = source.read("cell", from)?;
    let read = |file: &str| {
        let mesh = source.read(&format!("cell mesh {file}"), &beside(from, file));
        mesh.map(|(_, bytes)| bytes).map_err(|error| match error.code() {
            // What it says of files to start from is no help here.
            Code::FileRead => Error::new(Code::FileRead, error.message()),
            _ => error,
        })
    };
    let cell = parse_cell_bytes_with(&bytes, &name, &read)?;
    Ok(NamedCell { cell, name })
}

/// Reads postures of `robot`.
///
/// # Errors
/// A file that cannot be read, or anything wrong with its table.
pub fn read_postures(source: &impl Source, role: &str, from: &str, robot: &Robot) -> Result<Vec<Posture>> {
    let (name, bytes) = source.read(role, from)?;
    let postures = table::read_postures(&bytes, &name, robot)?;
    if postures.is_empty() {
        return Err(Error::new(Code::TooFewData, "The table has no postures, only a heading.")
            .file(name)
            .hint("add one row per posture"));
    }
    Ok(postures)
}

/// Reads groups of postures, named by their files.
///
/// # Errors
/// As [`read_postures`].
pub fn read_groups(source: &impl Source, from: &[String], robot: &Robot) -> Result<Vec<PostureGroup>> {
    let stems: Vec<String> = from.iter().map(|from| group_name(from)).collect();
    let mut groups = Vec::with_capacity(from.len());
    for (number, (from, name)) in (1..).zip(from.iter().zip(distinct(&stems))) {
        let postures = read_postures(source, &format!("postures_{number}"), from, robot)?;
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
    source: &impl Source,
    from: &[String],
    postures: Option<&str>,
    cell: &Cell,
) -> Result<Measurements> {
    let (files, postures) = measurement_files(source, from, postures, cell)?;
    table::read_measurements_of(&borrowed(&files), cell, postures.as_deref())
}

/// The same of files that are still being filled.
///
/// # Errors
/// As [`read_measurements`].
pub fn read_growing_measurements(
    source: &impl Source,
    from: &[String],
    postures: Option<&str>,
    cell: &Cell,
) -> Result<Measurements> {
    let (files, postures) = measurement_files(source, from, postures, cell)?;
    table::read_growing_measurements(&borrowed(&files), cell, postures.as_deref())
}

/// Reads candidates to choose from: a table of postures, or one of measurements, whose
/// postures count under their measured wrenches, of several states of a posture under
/// the largest force. True where they were measured.
///
/// # Errors
/// A file that cannot be read, anything wrong with its table, readings that cannot be
/// reduced.
pub fn read_candidates(source: &impl Source, from: &str, cell: &Cell) -> Result<(Vec<Candidate>, bool)> {
    let (name, bytes) = source.read("candidates", from)?;
    if !table::holds_measurements(&bytes, &name, cell)? {
        let postures = table::read_postures(&bytes, &name, &cell.setup.robot)?;
        let plain = postures.into_iter().map(|posture| Candidate::new(posture.name, posture.q));
        return Ok((plain.collect(), false));
    }
    let measurements = table::read_measurements(&bytes, &name, cell, None)?;
    let measured = prepare(cell, measurements, &ReduceOptions::default())?;
    Ok((Candidate::of_measured(&cell.setup, &measured.postures), true))
}

/// Options of a reduction of raw readings: with the registration that
/// `register` saved in `from`, if given.
///
/// # Errors
/// A file that cannot be read, or holds no registration.
pub fn read_registration(source: &impl Source, from: Option<&str>) -> Result<ReduceOptions> {
    let mut options = ReduceOptions::default();
    if let Some(from) = from {
        let (name, bytes) = source.read("registration", from)?;
        let registration = registration::read_registration(&bytes, &name)?;
        options.base_from_tracker = Some(registration.base_from_tracker);
    }
    Ok(options)
}

/// Reads a joint stiffness of `cell`: a result of `identify`, a bare list,
/// or `prior` for the cell's own (a file of that name is `./prior`).
///
/// # Errors
/// A file that cannot be read, anything wrong with it, or a cell without prior.
pub fn read_stiffness(source: &impl Source, from: &str, cell: &Cell) -> Result<Saved> {
    if from == PRIOR {
        return Saved::prior(cell);
    }
    let (name, bytes) = source.read("stiffness", from)?;
    stiffness::read_stiffness(&bytes, &name, cell)
}

/// Reads a path of the tool's tip, a table or a program in `language`, or as its name and its text say
/// ([`recognised`]), with its loads; `axes` are those of its forces where no column says so. `log` is a recorded load
/// along it.
///
/// # Errors
/// A file that cannot be read, or anything wrong with it.
pub fn read_path(
    source: &impl Source,
    from: &str,
    cell: &Cell,
    language: Option<PathLanguage>,
    axes: Option<ForceAxes>,
    log: Option<&str>,
) -> Result<NamedPath> {
    let mut path = parsed(source, from, cell, language, axes)?;
    if let Some(log) = log {
        path.take_loads(source, log, cell, axes)?;
    }
    path.take_features(cell)?;
    path.fit_columns(cell);
    let doubts = implausible::chips(&cell.work, &path.table.points);
    path.findings.extend(doubts);
    Ok(path)
}

/// The path as its file has it.
fn parsed(
    source: &impl Source,
    from: &str,
    cell: &Cell,
    language: Option<PathLanguage>,
    axes: Option<ForceAxes>,
) -> Result<NamedPath> {
    let (name, bytes) = source.read("path", from)?;
    let (kind, said) = recognised(&name, &bytes, language)?;
    let mut path = match kind {
        Some(kind) => program_path(source, kind, from, (name, &bytes), cell)?,
        None => {
            NamedPath { table: table::read_path(&bytes, &name, cell, axes)?, program: None, findings: Vec::new(), name }
        }
    };
    path.findings.extend(said);
    Ok(path)
}

/// A path as a program, with the file that is beside `from` where its kind has one.
fn program_path(
    source: &impl Source,
    kind: Kind,
    from: &str,
    (name, bytes): (String, &[u8]),
    cell: &Cell,
) -> Result<NamedPath> {
    let beside = kind.companion().and_then(|ending| {
        let beside = Path::new(from).with_extension(ending);
        // A program need not have one.
        source.read("path_points", &beside.to_string_lossy()).ok()
    });
    let beside = beside.as_ref().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
    let read = read_tool_path(kind, (&name, bytes), beside, cell)?;
    let axes_only = read.points.iter().any(|p| matches!(p.target, PathTarget::Axis { .. }));
    let kind = if axes_only { PathKind::ToolAxes } else { PathKind::Poses };
    Ok(NamedPath {
        table: PathTable { format: PathFormat::new(kind, cell).holding(&read.points, cell), points: read.points },
        program: Some(read.program),
        findings: read.findings,
        name,
    })
}

/// Files of measurements, and controller angles from `postures`.
type MeasurementFiles = (Vec<(String, Vec<u8>)>, Option<Vec<Posture>>);

fn measurement_files(
    source: &impl Source,
    from: &[String],
    postures: Option<&str>,
    cell: &Cell,
) -> Result<MeasurementFiles> {
    let robot = &cell.setup.robot;
    let postures = postures.map(|from| read_postures(source, "postures", from, robot)).transpose()?;
    let mut files = Vec::with_capacity(from.len());
    for (number, from) in (1..).zip(from) {
        let role = match number {
            1 => "measurements".to_string(),
            _ => format!("measurements_{number}"),
        };
        files.push(source.read(&role, from)?);
    }
    Ok((files, postures))
}

fn borrowed(files: &[(String, Vec<u8>)]) -> Vec<(&[u8], &str)> {
    files.iter().map(|(name, bytes)| (bytes.as_slice(), name.as_str())).collect()
}

/// Where a file lies that the cell `cell` names.
pub fn beside(cell: &str, file: &str) -> String {
    if cell.starts_with(builtin::PREFIX) || file.starts_with(builtin::PREFIX) {
        let name = file.strip_prefix(builtin::PREFIX).unwrap_or(file);
        return format!("{}{name}", builtin::PREFIX);
    }
    let folder = match Path::new(cell).parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    folder.join(file).to_string_lossy().into_owned()
}

/// Names of groups that stay apart, where two files of one name lie in different folders: `plan`, `plan (2)`.
pub fn distinct(names: &[String]) -> Vec<String> {
    let apart = |(i, name): (usize, &String)| {
        let same = names[..i].iter().filter(|other| *other == name).count();
        match same {
            0 => name.clone(),
            _ => format!("{name} ({})", same + 1),
        }
    };
    names.iter().enumerate().map(apart).collect()
}

/// Name of a group: the file's without folder and extension.
pub fn group_name(from: &str) -> String {
    if from == STANDARD_INPUT {
        return STANDARD_INPUT_NAME.to_string();
    }
    if let Some(name) = from.strip_prefix(builtin::PREFIX) {
        return name.to_string();
    }
    Path::new(from).file_stem().map_or_else(|| from.to_string(), |stem| stem.to_string_lossy().into_owned())
}
