//! Tables in `.xlsx` workbooks: the first sheet.
//!
//! Cells are read one by one, never as a rectangle: one stray cell in the last
//! corner of a sheet would ask for more memory than there is.
//!
//! Workbooks cell by cell. calamine's ranges are dense: one stray cell in a
//! sheet's last corner would ask for hundreds of gigabytes. Its cell reader
//! gives only what is there.
//!
//! A workbook is an archive, and a small archive can unpack to anything. What it
//! unpacks to is counted before it is read (`unpacked`), and what it holds while
//! it is read (`sheet`).

mod parts;
mod sheet;
mod unpacked;

use super::grid::Table;
use sheet::first_sheet;
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::cell::Columns;

/// How a ZIP archive begins, which an .xlsx is.
const ZIP: &[u8] = b"PK\x03\x04";

/// How the old Excel format and a workbook with a password begin.
const OLE: &[u8] = &[0xd0, 0xcf, 0x11, 0xe0];

/// What helps where a workbook cannot be read.
const HINT: &str = "save the sheet as .xlsx without a password, or as \"CSV UTF-8\"";

/// True for bytes that are a workbook and no text.
pub(super) fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(ZIP) || bytes.starts_with(OLE)
}

/// Reads the first sheet of a workbook.
///
/// # Errors
/// A file that is no .xlsx, or an empty first sheet.
pub(super) fn read<'a>(bytes: &[u8], file: &'a str, foreign: &Columns) -> Result<Table<'a>> {
    if bytes.starts_with(OLE) {
        let message = "This is a workbook of the old format (.xls) or one with a password.";
        let error = Error::new(Code::Unsupported, message);
        return Err(error.file(file).hint(HINT));
    }
    first_sheet(bytes, file, foreign)
}
