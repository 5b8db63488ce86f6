//! Built-in cells, posture groups, point pairs, paths and meshes: `builtin:comau`,
//! `builtin:comau-group1`, `builtin:example-pairs`, `builtin:contour`, `builtin:spindle.obj`.
//!
//! The files lie in `data/cells`, sources in their comments.

use crate::error::{Code, Error, Result, did_you_mean};
use crate::files::cell::parse_cell;
use crate::files::table::read_postures;
use crate::model::cell::Cell;
use crate::model::posture::Posture;
use crate::model::robot::Robot;

/// What stands before a built-in name where a file name could stand.
pub const PREFIX: &str = "builtin:";

const CELLS: [(&str, &str); 4] = [
    ("comau", include_str!("../../data/cells/comau.toml")),
    (
        "comau-reference",
        include_str!("../../data/cells/comau-reference.toml"),
    ),
    (
        "comau-shapes",
        include_str!("../../data/cells/comau-shapes.toml"),
    ),
    (
        "fanuc-r2000ic",
        include_str!("../../data/cells/fanuc-r2000ic.toml"),
    ),
];

const POSTURES: [(&str, &str); 1] = [(
    "comau-group1",
    include_str!("../../data/cells/comau-group1.csv"),
)];

const PAIRS: [(&str, &str); 1] = [(
    "example-pairs",
    include_str!("../../data/cells/example-pairs.csv"),
)];

const PATHS: [(&str, &str); 1] = [("contour", include_str!("../../data/cells/contour.csv"))];

/// A mesh keeps the ending that says which kind it is.
const MESHES: [(&str, &str); 1] = [("spindle.obj", include_str!("../../data/cells/spindle.obj"))];

/// Names of the built-in cells; the first is the default cell.
pub fn cell_names() -> Vec<&'static str> {
    CELLS.iter().map(|(name, _)| *name).collect()
}

/// Names of the built-in posture groups.
pub fn postures_names() -> Vec<&'static str> {
    POSTURES.iter().map(|(name, _)| *name).collect()
}

/// Names of the built-in tables of point pairs.
pub fn pairs_names() -> Vec<&'static str> {
    PAIRS.iter().map(|(name, _)| *name).collect()
}

/// Names of the built-in paths.
pub fn path_names() -> Vec<&'static str> {
    PATHS.iter().map(|(name, _)| *name).collect()
}

/// Names of the built-in meshes.
pub fn mesh_names() -> Vec<&'static str> {
    MESHES.iter().map(|(name, _)| *name).collect()
}

/// All built-in names, cells first.
pub fn names() -> Vec<&'static str> {
    [
        cell_names(),
        postures_names(),
        pairs_names(),
        path_names(),
        mesh_names(),
    ]
    .concat()
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
    let kinds: [&[(&str, &str)]; 5] = [&CELLS, &POSTURES, &PAIRS, &PATHS, &MESHES];
    let found = kinds.into_iter().find_map(|files| text(files, name));
    found.map(str::as_bytes).ok_or_else(|| {
        let known: Vec<String> = names().iter().map(|n| format!("{PREFIX}{n}")).collect();
        Error::new(
            Code::UnknownName,
            format!("There is no built-in file \"{PREFIX}{name}\"."),
        )
        .hint(format!("built in: {}", known.join(", ")))
    })
}

/// A built-in cell; `name` without [`PREFIX`].
///
/// # Errors
/// There is no built-in cell of this name.
pub fn cell(name: &str) -> Result<Cell> {
    let text = cell_text(name).ok_or_else(|| unknown("cell", name, cell_names()))?;
    parse_cell(text, &format!("{PREFIX}{name}"))
}

impl Cell {
    /// A built-in cell, as [`cell`]: `comau`, `comau-reference`, `comau-shapes`,
    /// `fanuc-r2000ic`.
    ///
    /// # Errors
    /// There is no built-in cell of this name.
    pub fn built_in(name: &str) -> Result<Cell> {
        cell(name)
    }

    /// Reads a cell from the bytes of a `cell.toml`; `file_name` is for messages.
    ///
    /// # Errors
    /// As [`parse_cell_bytes`](crate::files::cell::parse_cell_bytes).
    pub fn from_toml(bytes: &[u8], file_name: &str) -> Result<Cell> {
        crate::files::cell::parse_cell_bytes(bytes, file_name)
    }
}

/// A built-in posture group for `robot`; `name` without [`PREFIX`].
///
/// # Errors
/// There is no built-in group of this name, or it belongs to another robot.
pub fn postures(name: &str, robot: &Robot) -> Result<Vec<Posture>> {
    let text =
        postures_text(name).ok_or_else(|| unknown("posture group", name, postures_names()))?;
    read_postures(text.as_bytes(), &format!("{PREFIX}{name}"), robot)
}

fn text(files: &[(&'static str, &'static str)], name: &str) -> Option<&'static str> {
    files
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, text)| *text)
}

fn unknown(what: &str, name: &str, known: Vec<&'static str>) -> Error {
    let hint = did_you_mean(name, known.iter().copied())
        .unwrap_or_else(|| format!("built in: {}", known.join(", ")));
    Error::new(
        Code::UnknownName,
        format!("There is no built-in {what} \"{name}\"."),
    )
    .hint(hint)
}
