//! Tables: postures, displacements, raw readings, point pairs and paths.
//!
//! Read from text: UTF-8 with or without byte order mark, UTF-16 with one, LF or CRLF, columns
//! separated by commas (decimal point), or by semicolons or tabs (decimal comma
//! or point, as Excel writes in much of Europe). Blank lines and lines that
//! begin with `#` are skipped. Read from `.xlsx`: the first sheet.
//! Which of both a file is, its content says.
//!
//! Columns are found by their names, in any order and any case; an unknown
//! column is an error, so that a slip in a heading is never ignored. Each
//! heading ends in its unit: lengths `_mm`, `_m`, `_um` or `_in`, forces `_n` or
//! `_kn`, moments `_nm` or `_nmm`, angles `_deg` or `_rad`, times `_s`, `_ms` or
//! `_min`, the components of one quantity in one unit. Headings of another
//! software are named in the cell file ([`Columns`](stiffarm::model::cell::Columns)).
//!
//! Written: UTF-8, LF, commas, and the shortest decimals that are read back as
//! the same values: a written table, read and written again, is the same text.
//!
//! Names are text everywhere ([`check_name`](crate::check_name)): what a
//! spreadsheet would take for a formula, or a reader would not see, is refused.
//!
//! One table of columns. A column is a name without unit, a quantity, and a
//! group whose columns share one unit (`heading`, `quantity`); reading,
//! writing, errors, the keys of `[columns]` and their schema all come from it.
//! Text and workbook become the same rows before anything is read (`grid`), so
//! both have the same errors.

mod beside;
mod clamped;
mod columns;
mod dh;
mod displacements;
mod foreign;
mod grid;
mod heading;
mod heading_row;
mod layout;
mod line;
mod loads;
mod log;
mod measurements;
mod naming;
mod number;
mod pairs;
mod path;
mod place;
mod poses;
mod postures;
mod quantity;
mod readings;
mod rows;
mod sheet;
mod suggest;
mod text;
mod tidy;
mod unread;
mod values;
mod workbook;
mod write;

pub use clamped::{read_clamped, write_clamped};
pub(crate) use dh::other_convention;
pub use dh::read_dh_rows;
pub use log::read_log;
pub use measurements::{holds_measurements, read_growing_measurements, read_measurements, read_measurements_of};
pub use pairs::read_pairs;
pub use path::{PathFormat, PathKind, PathTable, read_path, write_path};
pub use poses::{NamedPose, read_poses, write_poses};
pub use postures::read_postures;
pub use sheet::write_sheet_workbook;
pub use sheet::{Sheet, SheetOptions, SheetRow, displacement_sheet, is_turned, reading_sheet};
pub(crate) use values::own_heading;
#[cfg(feature = "schema")]
pub(crate) use values::own_headings;
pub use write::{write_displacements, write_postures, write_readings, write_simulated, write_simulated_readings};

use sha2::{Digest, Sha256};

/// SHA-256 of `bytes` in lower-case hexadecimal: names an input in a result.
pub fn sha256_hex(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
