//! The text of a table as fields with their places.

use crate::error::{Code, Error, Result};

/// Numbers beyond this are slips of the pen; see the cell file's limit.
const LARGEST: f64 = 1e30;

/// A field and the character column it begins at, counted from 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    pub(super) text: String,
    pub(super) column: usize,
}

/// A row and its line, counted from 1; it has one field per column.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    pub(super) line: usize,
    pub(super) fields: Vec<Field>,
}

/// A table: its columns by name (lower case), and the lines below the heading.
#[derive(Debug)]
pub(super) struct Table<'a> {
    pub(super) columns: Vec<Field>,
    file: &'a str,
    heading_line: usize,
    delimiter: char,
    lines: Vec<(usize, String)>,
}

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
    /// Splits the text into lines and reads the heading.
    pub(super) fn read(bytes: &[u8], file: &'a str) -> Result<Self> {
        let text = decode(bytes, file)?.trim_start_matches('\u{feff}');
        let text = text.replace("\r\n", "\n").replace('\r', "\n");
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
        let mut columns = split(heading, delimiter);
        drop_empty_end(&mut columns, 0);
        for column in &mut columns {
            column.text = column.text.to_lowercase();
        }
        Ok(Table {
            columns,
            file,
            heading_line,
            delimiter,
            lines: lines.map(|(line, text)| (line, text.to_string())).collect(),
        })
    }

    /// The rows, each with one field per column. The heading is checked
    /// before: a column that it lacks explains rows that are too long.
    pub(super) fn rows(&self) -> Result<Vec<Row>> {
        let mut rows = Vec::with_capacity(self.lines.len());
        for (line, text) in &self.lines {
            let mut fields = split(text, self.delimiter);
            drop_empty_end(&mut fields, self.columns.len());
            if fields.iter().all(|field| field.text.is_empty()) {
                continue;
            }
            self.check_length(*line, text, &fields)?;
            rows.push(Row {
                line: *line,
                fields,
            });
        }
        if rows.is_empty() {
            let message = "There are no rows below the heading.";
            return Err(self.heading_error(None, Code::TableRow, message));
        }
        Ok(rows)
    }

    fn check_length(&self, line: usize, text: &str, fields: &[Field]) -> Result<()> {
        let (found, expected) = (fields.len(), self.columns.len());
        if found == expected {
            return Ok(());
        }
        if let Some(at) = decimal_comma(fields).filter(|_| found > expected) {
            let (whole, fraction) = (&fields[at].text, &fields[at + 1].text);
            let message = format!(
                "A comma seems to stand for the decimal point ({whole},{fraction}): \
                 the row has {found} fields, the heading {expected}."
            );
            return Err(Error::new(Code::DecimalComma, message)
                .file(self.file)
                .line(line, Some(fields[at].column))
                .hint(format!(
                    "write {whole}.{fraction}, or separate the columns with semicolons"
                )));
        }
        let message = format!("Fields in this row: {found}; columns in the heading: {expected}.");
        let error = Error::new(Code::TableRow, message)
            .file(self.file)
            .line(line, None);
        Err(if text.matches('"').count() % 2 == 1 {
            error.hint("a quotation mark is not closed on this line")
        } else {
            error
        })
    }

    /// Position of a column by its name.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.text == name)
    }

    /// An error at a field.
    pub(super) fn error(
        &self,
        row: &Row,
        column: usize,
        code: Code,
        message: impl Into<String>,
    ) -> Error {
        Error::new(code, message)
            .file(self.file)
            .line(row.line, Some(row.fields[column].column))
            .key(self.columns[column].text.as_str())
    }

    /// An error at the heading.
    pub(super) fn heading_error(
        &self,
        column: Option<usize>,
        code: Code,
        message: impl Into<String>,
    ) -> Error {
        let error = Error::new(code, message).file(self.file);
        let Some(column) = column.map(|column| &self.columns[column]) else {
            return error.line(self.heading_line, None);
        };
        let error = error.line(self.heading_line, Some(column.column));
        if column.text.is_empty() {
            error
        } else {
            error.key(column.text.as_str())
        }
    }

    /// The text of a field that must not be empty.
    pub(super) fn name<'r>(&self, row: &'r Row, column: usize) -> Result<&'r str> {
        let text = row.fields[column].text.as_str();
        if text.is_empty() {
            return Err(self.error(row, column, Code::TableRow, "The field is empty."));
        }
        Ok(text)
    }

    /// A finite number.
    pub(super) fn number(&self, row: &Row, column: usize) -> Result<f64> {
        let text = row.fields[column].text.as_str();
        if text.is_empty() {
            let message = "The field is empty; it must be a number.";
            return Err(self
                .error(row, column, Code::TableRow, message)
                .hint("fill it in, or remove the row if it was not measured"));
        }
        let value = match self.delimiter {
            ',' => text.parse::<f64>(),
            _ if text.contains('.') => text.parse::<f64>(),
            _ => text.replacen(',', ".", 1).parse::<f64>(),
        };
        let Ok(value) = value else {
            return Err(self.not_a_number(row, column, text));
        };
        if !value.is_finite() {
            let message = format!("\"{text}\" is not a finite number.");
            return Err(self.error(row, column, Code::NotFinite, message));
        }
        if value.abs() > LARGEST {
            let message = format!("{text} is too large to be meant.");
            return Err(self.error(row, column, Code::TableRow, message));
        }
        Ok(value)
    }

    fn not_a_number(&self, row: &Row, column: usize, text: &str) -> Error {
        if self.delimiter == ',' && text.replacen(',', ".", 1).parse::<f64>().is_ok() {
            let message = format!("{text} has a decimal comma, but commas separate the columns.");
            return self
                .error(row, column, Code::DecimalComma, message)
                .hint("write a decimal point, or separate the columns with semicolons");
        }
        let error = self.error(
            row,
            column,
            Code::TableRow,
            format!("\"{text}\" is not a number."),
        );
        let number_part = text.trim_end_matches(|c: char| !c.is_ascii_digit());
        if text.contains(',') && text.contains('.') {
            error.hint("leave out separators between thousands")
        } else if number_part.replacen(',', ".", 1).parse::<f64>().is_ok() {
            error.hint("write the number alone; the unit stands in the heading")
        } else {
            error
        }
    }
}

/// Splits one line into trimmed fields.
fn split(line: &str, delimiter: char) -> Vec<Field> {
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter as u8)
        .terminator(csv::Terminator::Any(b'\n'))
        .has_headers(false)
        .flexible(true)
        .from_reader(line.as_bytes());
    let mut record = csv::StringRecord::new();
    // One line of valid UTF-8 in memory: reading it cannot fail.
    let _ = reader.read_record(&mut record);
    let starts = starts(line, delimiter);
    record
        .iter()
        .enumerate()
        .map(|(i, text)| Field {
            text: text.trim().to_string(),
            column: starts.get(i).copied().unwrap_or(1),
        })
        .collect()
}

/// Character columns, from 1, at which the fields of a line begin.
fn starts(line: &str, delimiter: char) -> Vec<usize> {
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

/// Removes empty fields from the end, down to `keep` fields: spreadsheets pad rows.
fn drop_empty_end(fields: &mut Vec<Field>, keep: usize) {
    while fields.len() > keep && fields.last().is_some_and(|field| field.text.is_empty()) {
        fields.pop();
    }
}

/// First field that with the next one looks like the two halves of a decimal.
fn decimal_comma(fields: &[Field]) -> Option<usize> {
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let whole = |text: &str| digits(text.trim_start_matches(['+', '-']));
    // The first field is a name; a name that is a number proves nothing.
    (1..fields.len().saturating_sub(1))
        .find(|&i| whole(&fields[i].text) && digits(&fields[i + 1].text))
}
