//! Reading and writing `cell.toml`, format 1.
//!
//! Every key carries its unit as a suffix (`_mm`, `_deg`, `_n`, `_nm_per_rad`,
//! …); inside the library the values are SI. Unknown keys are errors that
//! suggest the nearest key. Each error names file, line, column and key path;
//! list entries count from 1, so `tool.measuring_point[2]` is the second
//! measuring point.

mod bounds;
mod columns;
mod convert;
mod elastic;
mod example;
mod instruments;
mod keys;
mod lists;
mod load;
mod profiles;
mod raw;
mod robot;
mod robot_keys;
mod route;
mod scene;
#[cfg(feature = "schema")]
mod schema;
mod sheets;
mod source;
mod table_of_robot;
mod task;
mod template;
mod value;
mod work;

pub use bounds::{BOUNDS_MARGIN_DEG, joints_kept_inside};
#[cfg(feature = "schema")]
pub use schema::cell_schema;
pub use sheets::{measurements_template, postures_template};
pub use table_of_robot::{RobotTable, robot_table};
pub use template::{template, template_of, template_with_shapes};

use crate::text::decode;
use source::Source;
use stiffarm::error::Result;
use stiffarm::model::cell::Cell;

/// Reads a cell from the text of a `cell.toml`; `file_name` is for messages.
///
/// A byte order mark and CRLF line ends are accepted. A shape of kind "mesh" is in a file of its own:
/// [`parse_cell_with`] reads those.
///
/// # Errors
/// Not TOML, a format this version does not know, unknown or missing keys,
/// values of the wrong kind, size or range: each with its place and a hint.
pub fn parse_cell(text: &str, file_name: &str) -> Result<Cell> {
    let mut source = Source::new(text, file_name);
    let raw = keys::read(&mut source)?;
    convert::cell(&source, &raw)
}

/// As [`parse_cell`], of a cell with shapes of kind "mesh": `read` gives the bytes of a file
/// by the name that the cell has for it, which counts from the folder of the cell file.
///
/// # Errors
/// As [`parse_cell`]; what `read` returns, and bytes that are no mesh, at the key that names the file.
pub fn parse_cell_with(text: &str, file_name: &str, read: &dyn Fn(&str) -> Result<Vec<u8>>) -> Result<Cell> {
    let mut source = Source::new(text, file_name).with_files(read);
    let raw = keys::read(&mut source)?;
    convert::cell(&source, &raw)
}

/// As [`parse_cell_with`], from the bytes of a `cell.toml`.
///
/// # Errors
/// Bytes that are not UTF-8, and everything of [`parse_cell_with`].
pub fn parse_cell_bytes_with(bytes: &[u8], file_name: &str, read: &dyn Fn(&str) -> Result<Vec<u8>>) -> Result<Cell> {
    let text = decode(bytes).map_err(|error| error.file(file_name))?;
    parse_cell_with(&text, file_name, read)
}

/// Reads a cell from the bytes of a `cell.toml`.
///
/// # Errors
/// Bytes that are not UTF-8, and everything of [`parse_cell`].
pub fn parse_cell_bytes(bytes: &[u8], file_name: &str) -> Result<Cell> {
    let text = decode(bytes).map_err(|error| error.file(file_name))?;
    parse_cell(&text, file_name)
}
