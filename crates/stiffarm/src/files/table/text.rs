//! Tables in CSV text, and the choice between text and workbook.

use super::grid::{Field, Rows, Style, Table};
use super::workbook;
use crate::error::{Code, Error, Result};
use crate::model::cell::Columns;
use std::borrow::Cow;

/// The bytes as text.
///
/// # Errors
/// Bytes that are not UTF-8, with line and column of the first.
pub(crate) fn decode<'a>(bytes: &'a [u8], file: &str) -> Result<&'a str> {
    std::str::from_utf8(bytes).map_err(|error| {
        let good = &bytes[..error.valid_up_to()];
        let line = good.iter().filter(|byte| **byte == b'\n').count() + 1;
        let start = good
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |at| at + 1);
        let before = String::from_utf8_lossy(&good[start..]);
        let column = before.trim_start_matches('\u{feff}').chars().count() + 1;
        let utf16 = bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]);
        let message = if utf16 {
            "The file is UTF-16 text; it must be UTF-8."
        } else {
            "A character here is not UTF-8."
        };
        Error::new(Code::Encoding, message)
            .file(file)
            .line(line, Some(column))
            .hint("save the file as UTF-8 (in Excel: \"CSV UTF-8\")")
    })
}

impl<'a> Table<'a> {
    /// Reads a workbook or a text, by their content; `foreign` names the
    /// columns that another software calls otherwise.
    pub(super) fn read(bytes: &[u8], file: &'a str, foreign: &Columns) -> Result<Self> {
        if workbook::is_one(bytes) {
            return workbook::read(bytes, file, foreign);
        }
        let text = decode(bytes, file)?.trim_start_matches('\u{feff}');
        let text = match text.contains('\r') {
            true => Cow::Owned(text.replace("\r\n", "\n").replace('\r', "\n")),
            false => Cow::Borrowed(text),
        };
        let mut lines = (1..)
            .zip(text.split('\n'))
            .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'))
            .peekable();
        // Excel writes the separator into a first line `sep=;`.
        let announced = lines
            .next_if(|(_, line)| {
                line.get(..4)
                    .is_some_and(|s| s.eq_ignore_ascii_case("sep="))
            })
            .and_then(|(_, line)| line.chars().nth(4))
            .filter(|delimiter| [',', ';', '\t'].contains(delimiter));
        let Some((heading_line, heading)) = lines.next() else {
            return Err(
                Error::new(Code::TableHeading, "The table is empty: it has no heading.")
                    .file(file)
                    .hint("the first line names the columns"),
            );
        };
        let by_heading = if heading.contains(';') {
            ';'
        } else if heading.contains('\t') && !heading.contains(',') {
            '\t'
        } else {
            ','
        };
        let delimiter = announced.unwrap_or(by_heading);
        let style = match delimiter {
            ',' => Style::Commas,
            _ => Style::Others,
        };
        let mut rows = Rows::default();
        split(heading_line, heading, delimiter, &mut rows);
        lines.for_each(|(line, text)| split(line, text, delimiter, &mut rows));
        let mut table = Table::new(file, style, rows, foreign);
        table.delimiter = delimiter;
        Ok(table)
    }
}

/// Adds one line, split into trimmed fields.
fn split(line: usize, text: &str, delimiter: char, rows: &mut Rows) {
    // Most lines have no quotation marks; a path has a hundred thousand of them.
    if !text.contains('"') {
        let mut column = 1;
        let fields = text.split(delimiter).map(|text| {
            let start = column;
            column += text.chars().count() as u32 + 1;
            Field {
                text: text.trim().into(),
                column: start,
                other: false,
            }
        });
        return rows.push(line, fields, false);
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
    let fields = record.iter().enumerate().map(|(i, text)| Field {
        text: text.trim().into(),
        column: starts.get(i).copied().unwrap_or(1),
        other: false,
    });
    rows.push(line, fields, text.matches('"').count() % 2 == 1);
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
