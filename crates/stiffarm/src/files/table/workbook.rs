//! Tables in `.xlsx` workbooks: the first sheet.
//!
//! Cells are read one by one, never as a rectangle: one stray cell in the last
//! corner of a sheet would ask for more memory than there is.
//!
//! Workbooks cell by cell. calamine's ranges are dense: one stray cell in a
//! sheet's last corner would ask for hundreds of gigabytes. Its cell reader
//! gives only what is there.

use super::grid::Table;
use crate::error::{Code, Error, Result};
use crate::model::cell::Columns;

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
/// A file that is no .xlsx, an empty first sheet, or a build without the
/// feature `xlsx`.
pub(super) fn read<'a>(bytes: &[u8], file: &'a str, foreign: &Columns) -> Result<Table<'a>> {
    if bytes.starts_with(OLE) {
        let message = "This is a workbook of the old format (.xls) or one with a password.";
        let error = Error::new(Code::Unsupported, message);
        return Err(error.file(file).hint(HINT));
    }
    first_sheet(bytes, file, foreign)
}

#[cfg(not(feature = "xlsx"))]
fn first_sheet<'a>(_: &[u8], file: &'a str, _: &Columns) -> Result<Table<'a>> {
    let message = "This is a ZIP archive, as .xlsx is; this build reads no .xlsx.";
    let error = Error::new(Code::Unsupported, message).file(file);
    Err(error.hint("save the sheet as \"CSV UTF-8\", or build with the feature xlsx"))
}

#[cfg(feature = "xlsx")]
use with_calamine::first_sheet;

#[cfg(feature = "xlsx")]
mod with_calamine {
    use super::HINT;
    use crate::error::{Code, Error, Result};
    use crate::files::table::grid::{Field, Row, Style, Table};
    use crate::model::cell::Columns;
    use calamine::{DataRef, Reader, SheetType, Xlsx, XlsxError};
    use std::collections::BTreeMap;
    use std::io::Cursor;

    /// A cell's text, or what it holds that is neither text nor number.
    type Held = Result<String, &'static str>;

    /// The cells of a sheet that hold something, by row and column from 0.
    type Cells = BTreeMap<u32, BTreeMap<u32, Held>>;

    pub(super) fn first_sheet<'a>(
        bytes: &[u8],
        file: &'a str,
        foreign: &Columns,
    ) -> Result<Table<'a>> {
        let broken = |error: XlsxError| {
            let message = format!("The file cannot be read as an .xlsx workbook: {error}.");
            Error::new(Code::FileRead, message).file(file).hint(HINT)
        };
        let mut workbook = Xlsx::new(Cursor::new(bytes)).map_err(broken)?;
        let sheets = workbook.sheets_metadata().iter();
        let names: Vec<String> = sheets
            .filter(|sheet| sheet.typ == SheetType::WorkSheet)
            .map(|sheet| sheet.name.clone())
            .collect();
        let Some((first, others)) = names.split_first() else {
            let error = Error::new(Code::TableHeading, "The workbook has no sheets.");
            return Err(error.file(file).hint(HINT));
        };
        let mut rows = rows(cells(&mut workbook, first).map_err(broken)?).into_iter();
        // Other sheets matter only to those who miss something in the first.
        let with_data = others
            .iter()
            .find(|name| cells(&mut workbook, name).is_ok_and(|cells| !cells.is_empty()));
        let aside = with_data.map(|other| {
            format!("only the first sheet, \"{first}\", is read; \"{other}\" holds data, too: move the table's sheet to the front")
        });
        let Some(heading) = rows.next() else {
            let message = format!("The first sheet, \"{first}\", is empty.");
            let error = Error::new(Code::TableHeading, message).file(file);
            return Err(
                error.hint(aside.unwrap_or_else(|| "the first row names the columns".to_string()))
            );
        };
        let mut table = Table::new(file, Style::Sheet, heading, rows.collect(), foreign);
        table.aside = aside;
        Ok(table)
    }

    fn cells(workbook: &mut Xlsx<Cursor<&[u8]>>, sheet: &str) -> Result<Cells, XlsxError> {
        let mut reader = workbook.worksheet_cells_reader(sheet)?;
        let mut cells = Cells::new();
        while let Some(cell) = reader.next_cell()? {
            let held: Held = match cell.get_value() {
                DataRef::Empty => continue,
                DataRef::Int(number) => Ok(number.to_string()),
                DataRef::Float(number) => Ok(number.to_string()),
                DataRef::String(text) => Ok(text.trim().to_string()),
                DataRef::SharedString(text) => Ok(text.trim().to_string()),
                DataRef::Bool(_) => Err("true or false"),
                DataRef::DateTime(_) | DataRef::DateTimeIso(_) => Err("a date or time"),
                DataRef::DurationIso(_) => Err("a duration"),
                DataRef::Error(_) => Err("an error of its formula"),
            };
            if held.as_ref().is_ok_and(String::is_empty) {
                continue;
            }
            let (row, column) = cell.get_position();
            let row = cells.entry(row).or_default();
            row.insert(column, held);
        }
        Ok(cells)
    }

    /// The rows as of a text: comments left out, gaps filled with empty fields.
    fn rows(mut cells: Cells) -> Vec<Row> {
        cells.retain(|_, row| {
            let first = row.values().next();
            !first.is_some_and(|held| held.as_ref().is_ok_and(|text| text.starts_with('#')))
        });
        // The table may begin in any column; it is as wide as its heading.
        let heading = cells.values().next().map(|row| row.keys().copied());
        let Some(mut columns) = heading else {
            return Vec::new();
        };
        let left = columns.next().unwrap_or_default();
        let width = left..=columns.next_back().unwrap_or(left);
        cells
            .into_iter()
            .map(|(line, mut row)| {
                let beside: Vec<u32> = row.keys().copied().filter(|c| !width.contains(c)).collect();
                let fields = width.clone().chain(beside).map(|column| {
                    let held = row.remove(&column).unwrap_or(Ok(String::new()));
                    Field {
                        other: held.as_ref().err().copied(),
                        text: held.unwrap_or_else(String::from),
                        column: column as usize + 1,
                    }
                });
                Row {
                    line: line as usize + 1,
                    fields: fields.collect(),
                    open_quote: false,
                }
            })
            .collect()
    }
}
