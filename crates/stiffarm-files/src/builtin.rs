//! Built-in cells, posture groups, measurements, point pairs, paths and meshes: `builtin:comau`,
//! `builtin:comau-group1`, `builtin:fanuc-r2000ic-readings`, `builtin:example-pairs`,
//! `builtin:contour`, `builtin:spindle.obj`.
//!
//! The files lie in `data/cells`, sources in their comments.

use crate::cell::parse_cell;
use crate::table::{read_measurements, read_postures};
use stiffarm::error::{Code, Error, Result, did_you_mean};
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::Measurements;
use stiffarm::model::posture::Posture;
use stiffarm::model::robot::Robot;

/// What stands before a built-in name where a file name could stand.
pub const PREFIX: &str = "builtin:";

const CELLS: [(&str, &str); 4] = [
    ("comau", include_str!("../data/cells/comau.toml")),
    ("comau-reference", include_str!("../data/cells/comau-reference.toml")),
    ("comau-shapes", include_str!("../data/cells/comau-shapes.toml")),
    ("fanuc-r2000ic", include_str!("../data/cells/fanuc-r2000ic.toml")),
];

const POSTURES: [(&str, &str); 1] = [("comau-group1", include_str!("../data/cells/comau-group1.csv"))];

const MEASUREMENTS: [(&str, &str); 1] =
    [("fanuc-r2000ic-readings", include_str!("../data/cells/fanuc-r2000ic-readings.csv"))];

const PAIRS: [(&str, &str); 1] = [("example-pairs", include_str!("../data/cells/example-pairs.csv"))];

const PATHS: [(&str, &str); 1] = [("contour", include_str!("../data/cells/contour.csv"))];

/// A mesh keeps the ending that says which kind it is.
const MESHES: [(&str, &str); 1] = [("spindle.obj", include_str!("../data/cells/spindle.obj"))];

/// Names of the built-in cells; the first is the default cell.
pub fn cell_names() -> Vec<&'static str> {
    CELLS.iter().map(|(name, _)| *name).collect()
}

/// The files of all kinds, cells first.
const KINDS: [&[(&str, &str)]; 6] = [&CELLS, &POSTURES, &MEASUREMENTS, &PAIRS, &PATHS, &MESHES];

/// All built-in names, cells first.
pub fn names() -> Vec<&'static str> {
    KINDS.concat().iter().map(|(name, _)| *name).collect()
}

/// Text of a built-in `cell.toml`; `name` without [`PREFIX`].
pub fn cell_text(name: &str) -> Option<&'static str> {
    text(&CELLS, name)
}

/// Text of a built-in posture table; `name` without [`PREFIX`].
pub fn postures_text(name: &str) -> Option<&'static str> {
    text(&POSTURES, name)
}

/// Text of a built-in table of point pairs; `name` without [`PREFIX`].
pub fn pairs_text(name: &str) -> Option<&'static str> {
    text(&PAIRS, name)
}

/// Text of a built-in path; `name` without [`PREFIX`].
pub fn path_text(name: &str) -> Option<&'static str> {
    text(&PATHS, name)
}

/// Text of a built-in mesh; `name` without [`PREFIX`].
pub fn mesh_text(name: &str) -> Option<&'static str> {
    text(&MESHES, name)
}

/// Content of a built-in file of whatever kind; `name` without [`PREFIX`].
///
/// # Errors
/// There is no built-in file of this name.
pub fn bytes(name: &str) -> Result<&'static [u8]> {
    let content = text(&KINDS.concat(), name);
    content.map(str::as_bytes).ok_or_else(|| {
        let built_in: Vec<String> = names().iter().map(|n| format!("{PREFIX}{n}")).collect();
        Error::new(Code::UnknownName, format!("There is no built-in file \"{PREFIX}{name}\"."))
            .hint(format!("built in: {}", built_in.join(", ")))
    })
}

/// A built-in cell; `name` without [`PREFIX`]: `comau`, `comau-reference`, `comau-shapes`,
/// `fanuc-r2000ic`.
///
/// # Errors
/// There is no built-in cell of this name.
pub fn cell(name: &str) -> Result<Cell> {
    let text = cell_text(name).ok_or_else(|| unknown("cell", name, cell_names()))?;
    parse_cell(text, &format!("{PREFIX}{name}"))
}

/// A built-in posture group for `robot`; `name` without [`PREFIX`].
///
/// # Errors
/// There is no built-in group of this name, or it belongs to another robot.
pub fn postures(name: &str, robot: &Robot) -> Result<Vec<Posture>> {
    let group_names = || POSTURES.map(|(name, _)| name).to_vec();
    let text = postures_text(name).ok_or_else(|| unknown("posture group", name, group_names()))?;
    read_postures(text.as_bytes(), &format!("{PREFIX}{name}"), robot)
}

/// Built-in measurements of `cell`; `name` without [`PREFIX`].
///
/// # Errors
/// There is no built-in file of this name, or it holds no measurements of the cell.
pub fn measurements(name: &str, cell: &Cell) -> Result<Measurements> {
    read_measurements(bytes(name)?, &format!("{PREFIX}{name}"), cell, None)
}

fn text(files: &[(&'static str, &'static str)], name: &str) -> Option<&'static str> {
    files.iter().find(|(file_name, _)| *file_name == name).map(|(_, text)| *text)
}

fn unknown(what: &str, name: &str, built_in: Vec<&'static str>) -> Error {
    let hint =
        did_you_mean(name, built_in.iter().copied()).unwrap_or_else(|| format!("built in: {}", built_in.join(", ")));
    Error::new(Code::UnknownName, format!("There is no built-in {what} \"{name}\".")).hint(hint)
}
