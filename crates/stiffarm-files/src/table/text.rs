//! Tables in CSV text, and the choice between text and workbook.

use super::foreign::{self, Names};
use super::grid::{Field, Rows, Style, Table};
use super::heading_row::{find, of_own_sheet};
use super::number::has_quoted_decimals;
use super::rows::named;
use super::tidy;
use super::workbook;
use crate::text::decode;
use std::borrow::Cow;
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::cell::{Columns, Separator};

impl<'a> Table<'a> {
    /// Reads a workbook or a text, by their content; `foreign` names the
    /// columns that another software calls otherwise.
    pub(super) fn read(bytes: &[u8], file: &'a str, foreign: &Columns) -> Result<Self> {
        let mut table = Table::read_one(bytes, file, foreign)?;
        foreign::finish(&mut table, foreign, &Names::default())?;
        Ok(table)
    }

    /// Reads several files of measurements with the same columns as one table.
    pub(super) fn read_all(
        files: &[(&[u8], &'a str)],
        columns: &Columns,
        names: &Names<'_>,
        growing: bool,
    ) -> Result<Self> {
        let tables = files.iter();
        let tables = tables.map(|(bytes, file)| {
            let mut table = Table::read_one(bytes, file, columns)?;
            tidy::leave_out(&mut table, columns);
            Ok(table)
        });
        let mut tables: Vec<Table<'a>> = tables.collect::<Result<_>>()?;
        let sheet = foreign::take(&mut tables);
        let mut tables = tables.into_iter();
        let mut table = tables.next().ok_or_else(|| {
            let error = Error::new(Code::TooFewData, "There is no file to read.");
            error.hint("give a table")
        })?;
        for other in tables {
            foreign::join(&mut table, other)?;
        }
        if let Some(sheet) = sheet {
            foreign::put(&mut table, &sheet, growing)?;
        }
        foreign::finish(&mut table, columns, names)?;
        tidy::carry_down(&mut table);
        Ok(table)
    }

    fn read_one(bytes: &[u8], file: &'a str, columns: &Columns) -> Result<Self> {
        if workbook::is_one(bytes) {
            return workbook::read(bytes, file, columns);
        }
        let text = match decode(bytes) {
            Err(error) if columns.is_latin_1 && error.code() == Code::Encoding => {
                bytes.iter().copied().map(char::from).collect()
            }
            read => read.map_err(|error| {
                if error.code() != Code::Encoding {
                    return error.file(file);
                }
                let hint = "save the file as UTF-8 (in Excel: \"CSV UTF-8\"), or write encoding = \"latin-1\" into \
                    [columns] of the cell file";
                error.file(file).hint(hint)
            })?,
        };
        let text = text.trim_start_matches('\u{feff}');
        let text = if text.contains('\r') {
            Cow::Owned(text.replace("\r\n", "\n").replace('\r', "\n"))
        } else {
            Cow::Borrowed(text)
        };
        let remark = |line: &str| {
            let line = line.trim_start();
            let theirs = columns.comment.as_deref();
            line.starts_with('#') || theirs.is_some_and(|comment| line.starts_with(comment))
        };
        let mut lines: Vec<(usize, &str)> =
            (1..).zip(text.split('\n')).filter(|(_, line)| !line.trim().is_empty() && !remark(line)).collect();
        // Excel writes the separator into a first line `sep=;`.
        let announcement =
            lines.first().filter(|(_, line)| line.get(..4).is_some_and(|s| s.eq_ignore_ascii_case("sep=")));
        let announced = announcement.and_then(|(_, line)| line.chars().nth(4));
        let announced = announced.filter(|delimiter| [',', ';', '\t'].contains(delimiter));
        lines.drain(..usize::from(announcement.is_some()));
        let by_itself = |line: &str| {
            let fields = fields(line, announced.unwrap_or_else(|| by_heading(line)));
            fields.into_iter().map(|(text, _)| text)
        };
        let sheet_columns = of_own_sheet(lines.iter().map(|(_, line)| by_itself(line)), columns);
        let columns = sheet_columns.as_ref().unwrap_or(columns);
        let stated_delimiter = columns.separator.map(Separator::character).or(announced);
        let titles = find(
            lines.iter().map(|(_, line)| {
                let delimiter = stated_delimiter.unwrap_or_else(|| by_heading(line));
                fields(line, delimiter).into_iter().map(|(text, _)| text)
            }),
            columns,
        );
        // Without a heading that is known, the cell file may say what the columns are.
        let by_order = titles.is_none() && !columns.order.is_empty();
        lines.drain(..titles.unwrap_or(0));
        let Some((first_line, first)) = lines.first().copied() else {
            return Err(Error::new(Code::TableHeading, "The table is empty: it has no heading.")
                .file(file)
                .hint("the first line names the columns"));
        };
        let delimiter = stated_delimiter
            .unwrap_or_else(|| if by_order && !first.contains([',', ';', '\t']) { ' ' } else { by_heading(first) });
        let style = match delimiter {
            ',' => Style::Commas,
            _ => Style::Others,
        };
        let mut rows = Rows::default();
        if by_order {
            rows.push(first_line, named(&columns.order), false);
        }
        for (line, text) in lines {
            split(line, text, delimiter, &mut rows);
        }
        let mut table = Table::new(file, style, rows, columns);
        table.delimiter = delimiter;
        table.has_quoted_decimals = delimiter == ',' && has_quoted_decimals(&table.rows);
        table.set_by_order(by_order);
        Ok(table)
    }
}

/// What separates the columns below this heading.
fn by_heading(heading: &str) -> char {
    if heading.contains(';') {
        ';'
    } else if heading.contains('\t') && !heading.contains(',') {
        '\t'
    } else {
        ','
    }
}

/// Adds one line, split into trimmed fields.
fn split(line: usize, text: &str, delimiter: char, rows: &mut Rows) {
    // Most lines have no quotation marks; a path has a hundred thousand of them.
    if !text.contains('"') && delimiter != ' ' {
        let mut column = 1;
        let fields = text.split(delimiter).map(|text| {
            let start = column;
            column += text.chars().count() as u32 + 1;
            Field { text: text.trim().into(), column: start, other: false }
        });
        return rows.push(line, fields, false);
    }
    let fields =
        fields(text, delimiter).into_iter().map(|(text, column)| Field { text: text.into(), column, other: false });
    rows.push(line, fields, text.matches('"').count() % 2 == 1);
}

/// The trimmed fields of a line, with the columns in which they begin.
fn fields(text: &str, delimiter: char) -> Vec<(String, u32)> {
    if delimiter == ' ' {
        return spaced(text);
    }
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter as u8)
        .terminator(csv::Terminator::Any(b'\n'))
        .has_headers(false)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut record = csv::StringRecord::new();
    // One line of valid UTF-8 in memory: reading it cannot fail.
    let _ = reader.read_record(&mut record);
    let starts = starts(text, delimiter);
    let fields = record.iter().enumerate();
    fields.map(|(i, text)| (text.trim().to_string(), starts.get(i).copied().unwrap_or(1))).collect()
}

/// The fields of a line that are separated by spaces or tabs; quotation marks keep a text together.
fn spaced(text: &str) -> Vec<(String, u32)> {
    let mut out: Vec<(String, u32)> = Vec::new();
    let mut quote = None;
    let mut inside = false;
    for (column, c) in (1..).zip(text.chars()) {
        match quote {
            Some(mark) if c == mark => quote = None,
            None if c.is_whitespace() => inside = false,
            None if !inside && ['"', '\''].contains(&c) => {
                quote = Some(c);
                inside = true;
                out.push((String::new(), column));
            }
            _ => {
                if !inside {
                    out.push((String::new(), column));
                    inside = true;
                }
                if let Some((field, _)) = out.last_mut() {
                    field.push(c);
                }
            }
        }
    }
    out
}

/// Character columns, from 1, at which the fields of a line begin.
fn starts(line: &str, delimiter: char) -> Vec<u32> {
    let mut starts = vec![1];
    let (mut quoted, mut at_start) = (false, true);
    let mut characters = (1..).zip(line.chars()).peekable();
    while let Some((column, c)) = characters.next() {
        if quoted {
            // A doubled quotation mark stands for one.
            let doubled = c == '"' && characters.next_if(|(_, next)| *next == '"').is_some();
            quoted = c != '"' || doubled;
            continue;
        }
        quoted = at_start && c == '"';
        at_start = c == delimiter;
        if at_start {
            starts.push(column + 1);
        }
    }
    starts
}
