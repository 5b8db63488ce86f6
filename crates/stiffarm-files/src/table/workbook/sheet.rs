//! The first sheet of a workbook, cell by cell.

use super::HINT;
use super::parts::{self, Hidden};
use super::unpacked;
use crate::table::foreign::DATED;
use crate::table::grid::{Field, OPEN_FORMULA, Rows, Style, Table};
use crate::table::heading_row::{find, of_own_sheet};
use crate::table::rows::{in_words, named};
use calamine::{DataRef, Dimensions, ExcelDateTime, Reader, SheetType, Xlsx, XlsxError};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::{Finding, codes, list};
use stiffarm::model::cell::Columns;

/// Rows and columns of a sheet, by the format.
const LAST: (u32, u32) = (1_048_575, 16_383);

/// Columns between the first and the last of a heading. The widest table there
/// is has some thirty.
const MOST_COLUMNS: u32 = 512;

/// Cells that hold something, and fields of the table: a path of a million
/// points with positions and angles.
const MOST_CELLS: usize = 10_000_000;

/// Characters of a cell, by the format.
const LONGEST_TEXT: usize = 32_767;

/// Bytes of all cells. One long text can be shared by all of them.
const MOST_TEXT: usize = 256 << 20;

/// Sheets beside the first that are looked into, and cells of one.
const OTHERS: usize = 16;
const CELLS_OF_OTHERS: usize = 100_000;

/// A cell's text, or what it holds that is neither text nor number.
type CellContent = std::result::Result<String, String>;

/// The cells of a sheet that hold something, by row and column from 0.
type Cells = BTreeMap<u32, BTreeMap<u32, CellContent>>;

pub(super) fn first_sheet<'a>(bytes: &[u8], file: &'a str, foreign: &Columns) -> Result<Table<'a>> {
    unpacked::check(bytes).map_err(|e| e.file(file))?;
    // The reader of the format counts letters and digits of a place without
    // looking whether they fit, and stops the program where they do not.
    let read = catch_unwind(AssertUnwindSafe(|| read(bytes, foreign)));
    let read = read.unwrap_or_else(|_| {
        let message = "The file cannot be read as an .xlsx workbook: its places make no sense.";
        Err(Error::new(Code::FileRead, message))
    });
    let Sheet { name, rows, aside, by_order, merged, hidden, columns } = read.map_err(|e| match e.hint_text() {
        Some(_) => e.file(file),
        None => e.file(file).hint(HINT),
    })?;
    if rows.is_empty() {
        let message = format!("The first sheet, \"{name}\", is empty.");
        let error = Error::new(Code::TableHeading, message).file(file);
        return Err(error.hint(aside.unwrap_or_else(|| "the first row names the columns".to_string())));
    }
    let foreign = columns.as_ref().unwrap_or(foreign);
    let mut table = Table::new(file, Style::Sheet, rows, foreign);
    table.aside = aside;
    table.set_by_order(by_order);
    let filled = shown(&table, |column| merged.contains(&column));
    let sentence = format!("Cells are merged in {}: each of their rows has the value of the first.", list(&filled));
    let remark = Finding::note(codes::MERGED_CELLS, "readings", sentence);
    table.remarks.extend((!filled.is_empty()).then_some(remark));
    table.remarks.extend(not_seen(&table, &name, &hidden));
    Ok(table)
}

/// The headings that count, of the columns for whose number, from 0, `wanted` holds.
fn shown(table: &Table<'_>, wanted: impl Fn(u32) -> bool) -> Vec<String> {
    let headings = table.headings.iter().filter(|heading| !heading.ignored);
    let wanted = headings.filter(|heading| wanted(heading.column as u32 - 1));
    wanted.map(|heading| heading.shown.clone()).collect()
}

/// Says which rows and columns count though nobody sees them. Columns are mostly hidden for want
/// of room; a row that a filter hides is mostly meant to be left out.
fn not_seen(table: &Table<'_>, sheet: &str, hidden: &Hidden) -> Option<Finding> {
    let rows = table.rows.below().filter(|row| !row.is_empty());
    let lines = rows.map(|row| row.line);
    let lines: Vec<usize> = lines.filter(|line| hidden.rows.contains(&(*line as u32 - 1))).collect();
    let columns = shown(table, |column| hidden.has_column(column));
    let mut parts = Vec::new();
    if !lines.is_empty() {
        let noun = if lines.len() == 1 { "row" } else { "rows" };
        parts.push(format!("{} hidden {noun} ({})", lines.len(), in_words(&lines)));
    }
    if !columns.is_empty() {
        let noun = if columns.len() == 1 { "column" } else { "columns" };
        let names = list(&columns);
        parts.push(format!("{} hidden {noun} ({names})", columns.len()));
    }
    let sentence = format!(
        "The sheet \"{sheet}\" of {} has {}, which count like all others. Take the filter off and delete what is not \
         to count.",
        table.files[0],
        parts.join(" and ")
    );
    match (lines.is_empty(), columns.is_empty()) {
        (true, true) => None,
        (true, false) => Some(Finding::note(codes::HIDDEN_CELLS, "readings", sentence)),
        (false, _) => Some(Finding::caution(codes::HIDDEN_CELLS, "readings", sentence)),
    }
}

/// The first sheet, and what a reader should know of the others.
struct Sheet {
    name: String,
    rows: Rows,
    aside: Option<String>,
    by_order: bool,
    /// Columns, from 0, in which merged cells were filled.
    merged: Vec<u32>,
    hidden: Hidden,
    /// What counts of `[columns]` where the sheet is one of our own.
    columns: Option<Columns>,
}

fn broken(error: XlsxError) -> Error {
    let message = format!("The file cannot be read as an .xlsx workbook: {error}.");
    Error::new(Code::FileRead, message)
}

fn read(bytes: &[u8], foreign: &Columns) -> Result<Sheet> {
    let mut workbook = Xlsx::new(Cursor::new(bytes)).map_err(broken)?;
    let sheets = workbook.sheets_metadata().iter();
    let names: Vec<String> =
        sheets.filter(|sheet| sheet.typ == SheetType::WorkSheet).map(|sheet| sheet.name.clone()).collect();
    let Some((first, others)) = names.split_first() else {
        return Err(Error::new(Code::TableHeading, "The workbook has no sheets."));
    };
    if let Some(wanted) = &foreign.sheet {
        let Some(name) = names.iter().find(|name| *name == wanted) else {
            // The sheet of an export is none of our own workbook.
            let first_sheet = sheet(&mut workbook, bytes, first, foreign);
            if let Some(first_sheet) = first_sheet.ok().filter(|first_sheet| first_sheet.columns.is_some()) {
                return Ok(first_sheet);
            }
            let message = format!("The workbook has no sheet \"{wanted}\".");
            return Err(Error::new(Code::UnknownName, message)
                .hint(format!("sheet in [columns] of the cell file names one of: {}", names.join(", "))));
        };
        return sheet(&mut workbook, bytes, name, foreign);
    }
    let first_sheet = sheet(&mut workbook, bytes, first, foreign)?;
    // Other sheets matter only to those who miss something in the first.
    let mut others = others.iter().take(OTHERS);
    let with_data = others.find(|name| holds_something(&mut workbook, name));
    let aside = with_data.map(|other| {
        format!(
            "only the first sheet, \"{first}\", is read; \"{other}\" holds data, too: move the table's sheet to \
            the front, or name it in [columns] of the cell file: sheet = \"{other}\""
        )
    });
    Ok(Sheet { aside, ..first_sheet })
}

/// The sheet of this name.
fn sheet(workbook: &mut Xlsx<Cursor<&[u8]>>, bytes: &[u8], name: &str, foreign: &Columns) -> Result<Sheet> {
    let waits = parts::waits_to_be_calculated(bytes);
    let mut cells = cells(workbook, name, waits)?;
    let columns = of_own_sheet(cells.values().map(texts), foreign);
    let foreign = columns.as_ref().unwrap_or(foreign);
    let has_heading = titles(&mut cells, foreign);
    // Where nothing is left out nothing is merged, and the sheet need not be read again.
    let width = cells.values().next().map_or(0, BTreeMap::len);
    let merged = if cells.values().any(|row| row.len() < width) {
        workbook.merge_cells_by_sheet_name(name).map_err(broken)?
    } else {
        Vec::new()
    };
    let merged = fill(&mut cells, &merged)?;
    let (rows, by_order) = rows(cells, has_heading, foreign)?;
    Ok(Sheet {
        name: name.to_string(),
        rows,
        aside: None,
        by_order,
        merged,
        hidden: parts::hidden(bytes, name),
        columns,
    })
}

/// Gives each row of merged cells below the heading the value of the first; the columns in
/// which there are some.
fn fill(cells: &mut Cells, merged: &[Dimensions]) -> Result<Vec<u32>> {
    let heading = cells.keys().next().copied().unwrap_or_default();
    let mut columns = Vec::new();
    let (mut count, mut text) = (0, 0);
    for region in merged {
        let ((first, column), (last, _)) = (region.start, region.end);
        let held = cells.get(&first).and_then(|row| row.get(&column)).cloned();
        let Some(held) = held.filter(|_| heading < first && first < last) else {
            continue;
        };
        for (_, row) in cells.range_mut(first + 1..=last) {
            count += 1;
            text += held.as_ref().map_or(0, String::len);
            if count > MOST_CELLS || text > MOST_TEXT {
                return Err(too_large());
            }
            row.entry(column).or_insert_with(|| held.clone());
            if !columns.contains(&column) {
                columns.push(column);
            }
        }
    }
    Ok(columns)
}

/// What a cell holds; `None` for nothing.
fn held(value: &DataRef<'_>) -> Option<CellContent> {
    let held: CellContent = match value {
        DataRef::Empty => return None,
        DataRef::Int(number) => Ok(number.to_string()),
        DataRef::Float(number) => Ok(number.to_string()),
        DataRef::String(text) => Ok(text.trim().to_string()),
        DataRef::SharedString(text) => Ok(text.trim().to_string()),
        DataRef::Bool(_) => Err("true or false".to_string()),
        DataRef::DateTime(time) => Err(shown_time(time)),
        DataRef::DateTimeIso(text) => Err(format!("{DATED}{text}")),
        DataRef::DurationIso(_) => Err("a duration".to_string()),
        DataRef::Error(_) => Err("an error of its formula".to_string()),
    };
    (!held.as_ref().is_ok_and(String::is_empty)).then_some(held)
}

/// Date and time to a millisecond, by the calendar of the workbook (from 1900 or 1904).
fn shown_time(time: &ExcelDateTime) -> String {
    let (year, month, day, hour, minute, second, milli) = time.to_ymd_hms_milli();
    let clock = format!("{hour:02}:{minute:02}:{second:02}.{milli:03}");
    if time.as_f64() < 1.0 {
        // A time without a date is a part of the first day.
        format!("{DATED}{clock}")
    } else {
        format!("{DATED}{year:04}-{month:02}-{day:02} {clock}")
    }
}

fn holds_something(workbook: &mut Xlsx<Cursor<&[u8]>>, sheet: &str) -> bool {
    let Ok(mut reader) = workbook.worksheet_cells_reader(sheet) else {
        return false;
    };
    for _ in 0..CELLS_OF_OTHERS {
        match reader.next_cell() {
            Ok(Some(cell)) if held(cell.get_value()).is_some() => return true,
            Ok(Some(_)) => {}
            Ok(None) | Err(_) => return false,
        }
    }
    false
}

/// The cells of a sheet; in a workbook that `waits` to be calculated, a formula's 0 is no value.
fn cells(workbook: &mut Xlsx<Cursor<&[u8]>>, sheet: &str, waits: bool) -> Result<Cells> {
    let mut reader = workbook.worksheet_cells_reader(sheet).map_err(broken)?;
    let mut cells = Cells::new();
    let (mut count, mut text) = (0, 0);
    while let Some(cell) = reader.next_cell_with_formula_metadata().map_err(broken)? {
        // Looked at before it is copied.
        let length = match &cell.value {
            DataRef::String(text) => text.len(),
            DataRef::SharedString(text) => text.len(),
            _ => 0,
        };
        let (row, column) = cell.pos;
        let at = |message: String| {
            let place = (row as usize + 1, Some(column as usize + 1));
            Error::new(Code::TableRow, message).line(place.0, place.1)
        };
        if length > 4 * LONGEST_TEXT {
            let message = format!("A cell holds {length} bytes; no sheet has cells that long.");
            return Err(at(message).hint("empty the cell"));
        }
        let open = match &cell.value {
            DataRef::Empty => true,
            DataRef::Int(0) => waits,
            DataRef::Float(value) => waits && *value == 0.0,
            _ => false,
        };
        let held = if open && cell.formula.is_some() {
            let place = format!("{}{} of sheet \"{sheet}\"", letters(column), row + 1);
            Some(Err(format!("{OPEN_FORMULA} ({place})")))
        } else {
            held(&cell.value)
        };
        let Some(held) = held else {
            continue;
        };
        if row > LAST.0 || column > LAST.1 {
            let message = "A cell lies beyond the last row or column that a sheet can have.";
            return Err(at(message.to_string()).hint(HINT));
        }
        count += 1;
        text += length;
        if count > MOST_CELLS || text > MOST_TEXT {
            return Err(too_large());
        }
        cells.entry(row).or_default().insert(column, held);
    }
    Ok(cells)
}

/// The letters of a column from 0, as spreadsheets name it.
fn letters(column: u32) -> String {
    let (before, last) = (column / 26, char::from(b'A' + (column % 26) as u8));
    match before {
        0 => last.to_string(),
        before => letters(before - 1) + &last.to_string(),
    }
}

fn too_large() -> Error {
    let message = format!("The sheet holds more than {MOST_CELLS} cells or {} MB of text.", MOST_TEXT >> 20);
    Error::new(Code::Unsupported, message).hint("give the table in parts, or as \"CSV UTF-8\"")
}

/// Takes comments and titles above the heading away; false where no row is a heading.
fn titles(cells: &mut Cells, foreign: &Columns) -> bool {
    cells.retain(|_, row| {
        let first = row.values().next();
        let remark = |text: &String| {
            let theirs = foreign.comment.as_deref();
            text.starts_with('#') || theirs.is_some_and(|comment| text.starts_with(comment))
        };
        !first.is_some_and(|held| held.as_ref().is_ok_and(remark))
    });
    let heading = find(cells.values().map(texts), foreign);
    for _ in 0..heading.unwrap_or(0) {
        cells.pop_first();
    }
    heading.is_some()
}

/// The texts of a row.
fn texts(row: &BTreeMap<u32, CellContent>) -> Vec<String> {
    let texts = row.values().filter_map(|held| held.as_ref().ok());
    texts.cloned().collect()
}

/// The rows as of a text: gaps filled with empty fields.
fn rows(cells: Cells, has_heading: bool, foreign: &Columns) -> Result<(Rows, bool)> {
    let mut rows = Rows::default();
    let by_order = !has_heading && !foreign.order.is_empty();
    // The table may begin in any column; it is as wide as its heading.
    let heading = cells.iter().next();
    let Some((line, mut columns)) = heading.map(|(line, row)| (line, row.keys().copied())) else {
        return Ok((rows, by_order));
    };
    let left = columns.next().unwrap_or_default();
    let right = columns.next_back().unwrap_or(left);
    let width = left..=right;
    if right - left >= MOST_COLUMNS {
        let message = format!("The heading is {} columns wide; a table has {MOST_COLUMNS} at most.", right - left + 1);
        return Err(Error::new(Code::TableHeading, message)
            .line(*line as usize + 1, Some(right as usize + 1))
            .hint("a cell far to the right belongs to no table: empty it"));
    }
    if cells.len().saturating_mul((right - left + 1) as usize) > MOST_CELLS {
        return Err(too_large());
    }
    if by_order {
        rows.push(*line as usize + 1, named(&foreign.order), false);
    }
    for (line, mut row) in cells {
        let beside: Vec<u32> = row.keys().copied().filter(|c| !width.contains(c)).collect();
        let fields = width.clone().chain(beside).map(|column| {
            let held = row.remove(&column).unwrap_or(Ok(String::new()));
            Field { other: held.is_err(), text: held.unwrap_or_else(|other| other).into(), column: column + 1 }
        });
        rows.push(line as usize + 1, fields, false);
    }
    Ok((rows, by_order))
}
