//! A table as headings and rows, whatever file it came from.

use super::heading_row::own_unit;
use super::naming::{DATE, NAME, normal};
use super::place::{by_place, left_out_by_place};
use super::quantity::Unit;
pub(super) use super::rows::{Field, Row, Rows};
use crate::names::fault_of;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fmt::Display;
use std::hash::Hash;
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::Finding;
use stiffarm::model::cell::Columns;
use stiffarm::units::Sense;

/// How a field begins whose formula has no value: the program that wrote it does not calculate.
pub(super) const OPEN_FORMULA: &str = "a formula that nobody has calculated";

/// A heading.
#[derive(Debug, Clone)]
pub(super) struct Heading {
    /// Its name as this program knows it, lower case.
    pub(super) name: String,
    /// As it stands in the file.
    pub(super) shown: String,
    pub(super) column: usize,
    /// The cell file says that the column does not matter.
    pub(super) ignored: bool,
}

/// How numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Style {
    /// Commas separate the columns: decimal point.
    Commas,
    /// Semicolons or tabs do: decimal point or comma.
    Others,
    /// Cells of a spreadsheet, which knows its numbers.
    Sheet,
}

/// A table: its headings, and the rows below.
#[derive(Debug)]
pub(super) struct Table<'a> {
    pub(super) headings: Vec<Heading>,
    /// Names of the files, for messages.
    pub(super) files: Vec<&'a str>,
    pub(super) style: Style,
    pub(super) rows: Rows,
    /// What another software calls its columns, by the cell file.
    pub(super) foreign: Vec<String>,
    /// What a reader who misses a column should know, for example that only
    /// the first sheet is read.
    pub(super) aside: Option<String>,
    /// What separates the columns of a text.
    pub(super) delimiter: char,
    /// Commas separate the columns, and numbers in quotation marks have another for the point.
    pub(super) has_quoted_decimals: bool,
    /// The columns are those of `order` in `[columns]`: the file has no heading.
    pub(super) by_order: bool,
    /// What was taken for granted when it was read.
    pub(super) remarks: Vec<Finding>,
}

/// Where a column stands, its unit if it has one, and what its numbers can be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column {
    pub(super) at: usize,
    pub(super) unit: Option<Unit>,
    pub(super) sense: Option<&'static Sense>,
}

impl<'a> Table<'a> {
    /// A table from rows of which the first is the heading.
    pub(super) fn new(file: &'a str, style: Style, mut rows: Rows, foreign: &Columns) -> Self {
        let heading = rows.at(0);
        let named = heading.fields.iter().rposition(|f| !f.text.is_empty());
        let named = named.map_or(0, |last| last + 1);
        // Columns without a heading do not matter where the cell file says so, or nothing stands in them.
        let nameless = foreign.ignore.iter().any(String::is_empty);
        let widest = rows.below().map(|row| row.fields.len()).max().unwrap_or(0);
        let first = match (style, heading.fields.first()) {
            (Style::Sheet, Some(field)) => field.column as usize,
            _ => 1,
        };
        let by_place = by_place(&heading, first, foreign);
        let of_places = by_place.iter().filter(|at| **at < widest).max();
        let width = match of_places {
            _ if nameless => named.max(widest),
            last => named.max(last.map_or(0, |last| last + 1)),
        };
        let filled: Vec<bool> = (0..width)
            .map(|at| {
                let mut fields = rows.below().filter_map(|row| row.fields.get(at));
                fields.any(|field| !field.text.is_empty())
            })
            .collect();
        let none = Field::empty();
        let headings: Vec<Heading> = (0..width)
            .map(|at| {
                let field = heading.fields.get(at).unwrap_or(&none);
                let heading_name = normal(&field.text);
                let same = |other: &String| normal(other) == heading_name;
                let ours = foreign.names.iter().find(|(_, theirs)| same(theirs));
                let ours = ours.map(|(ours, _)| ours.clone());
                let name = || foreign.name.as_ref().filter(|n| same(n)).map(|_| NAME.into());
                let date = || foreign.date.as_ref().filter(|d| same(d)).map(|_| DATE.into());
                Heading {
                    ignored: foreign.ignore.iter().any(same)
                        || by_place.contains(&at)
                        || (heading_name.is_empty() && !filled[at]),
                    name: ours
                        .or_else(name)
                        .or_else(date)
                        .or_else(|| own_unit(&heading_name))
                        .unwrap_or_else(|| heading_name.clone()),
                    shown: field.text.to_string(),
                    column: field.column as usize,
                }
            })
            .collect();
        if width > named {
            rows.fill_up(width);
        }
        let left_out = headings.iter().enumerate();
        let left_out = left_out.filter(|(at, _)| by_place.contains(at));
        let left_out: Vec<(usize, &str)> = left_out.map(|(at, heading)| (at, heading.shown.as_str())).collect();
        let remarks = left_out_by_place(&left_out, file);
        rows.drop_empty_ends(headings.len());
        Table {
            files: vec![file],
            style,
            rows,
            headings,
            foreign: foreign.names.values().chain(&foreign.ignore).cloned().collect(),
            aside: None,
            delimiter: ',',
            has_quoted_decimals: false,
            by_order: false,
            remarks: remarks.into_iter().collect(),
        }
    }

    /// Says that the columns are those of `order`: each `-` among them does not matter.
    pub(super) fn set_by_order(&mut self, by_order: bool) {
        self.by_order = by_order;
        if by_order {
            for heading in &mut self.headings {
                heading.ignored |= heading.name == "-";
            }
        }
    }

    /// True where decimals are written with a comma, in columns that it does not separate.
    pub(super) fn has_decimal_commas(&self) -> bool {
        let mut fields = self.rows.below().flat_map(|row| row.fields);
        self.delimiter != ','
            && fields.any(|field| field.text.replacen(',', ".", 1).parse::<f64>().is_ok() && field.text.contains(','))
    }

    /// The rows, each with one field per column. The heading is checked
    /// before: a column that it lacks explains rows that are too long.
    pub(super) fn rows(&self) -> Result<Vec<Row<'_>>> {
        let rows: Vec<Row<'_>> = self.rows.below().filter(|row| !row.is_empty()).collect();
        for row in &rows {
            self.check_length(row)?;
        }
        if rows.is_empty() {
            let message = "The table has no rows below its heading.";
            return Err(self.heading_error(None, Code::TooFewData, message));
        }
        Ok(rows)
    }

    pub(super) fn check_length(&self, row: &Row) -> Result<()> {
        let (field_count, expected) = (row.fields.len(), self.headings.len());
        if field_count == expected {
            return Ok(());
        }
        if self.style == Style::Sheet {
            // Gaps of a sheet are filled, so its rows can only be too long.
            let stray = &row.fields[expected..];
            let held = stray.iter().find(|field| !field.text.is_empty());
            let text = held.map_or("", |field| field.text.as_str());
            let message = format!("\"{text}\" lies beyond the last column of the heading.");
            return Err(Error::new(Code::TableRow, message)
                .file(self.file(row))
                .line(row.line, held.map(|field| field.column as usize))
                .hint("give its column a heading, or empty the cell"));
        }
        let comma =
            (self.style == Style::Commas && field_count > expected).then(|| self.decimal_comma(row.fields)).flatten();
        if let Some(at) = comma {
            let (whole, fraction) = (&row.fields[at].text, &row.fields[at + 1].text);
            let message = format!(
                "A comma seems to stand for the decimal point ({whole},{fraction}): \
                 the row has {field_count} fields, the heading {expected}."
            );
            return Err(Error::new(Code::DecimalComma, message)
                .file(self.file(row))
                .line(row.line, Some(row.fields[at].column as usize))
                .hint(format!("write {whole}.{fraction}, or separate the columns with semicolons")));
        }
        let message = format!("Fields in this row: {field_count}; columns in the heading: {expected}.");
        let error = Error::new(Code::TableRow, message).file(self.file(row)).line(row.line, None);
        Err(if row.open_quote {
            error.hint("a quotation mark is not closed on this line")
        } else if self.by_order {
            error.hint(
                "the file has no heading that is known, so order in [columns] of the cell file names its columns; \
                 \"-\" stands for one that does not matter",
            )
        } else {
            error
        })
    }

    /// An error at a field.
    pub(super) fn error(&self, row: &Row, column: usize, code: Code, message: impl Into<String>) -> Error {
        Error::new(code, message)
            .file(self.file(row))
            .line(row.line, Some(row.fields[column].column as usize))
            .key(self.headings[column].shown.as_str())
    }

    /// Name of the file that a row stands in.
    fn file(&self, row: &Row) -> &'a str {
        self.files[row.source]
    }

    fn heading_line(&self) -> usize {
        self.rows.at(0).line
    }

    /// An error at the heading.
    pub(super) fn heading_error(&self, column: Option<usize>, code: Code, message: impl Into<String>) -> Error {
        let error = Error::new(code, message).file(self.files[0]);
        let Some(heading) = column.map(|column| &self.headings[column]) else {
            return error.line(self.heading_line(), None);
        };
        let error = error.line(self.heading_line(), Some(heading.column));
        if heading.shown.is_empty() { error } else { error.key(heading.shown.as_str()) }
    }

    /// The error with what a reader should know whose heading is none of a table.
    pub(super) fn with_aside(&self, error: Error) -> Error {
        let our_names = ["posture", "point", "q1_deg", "x_mm"];
        let usable = |heading: &Heading| our_names.contains(&heading.name.as_str());
        match (&self.aside, error.code()) {
            (Some(aside), Code::TableHeading) if !self.headings.iter().any(usable) => {
                let hint = error.hint_text().map(|hint| format!("{hint}; "));
                let hint = hint.unwrap_or_default() + aside;
                error.hint(hint)
            }
            _ => error,
        }
    }

    /// The text of a field that must not be empty.
    pub(super) fn name<'r>(&self, row: &Row<'r>, column: Column) -> Result<&'r str> {
        let text = row.fields[column.at].text.as_str();
        if text.is_empty() {
            return Err(self.error(row, column.at, Code::TableRow, "The field is empty."));
        }
        self.refuse_other(row, column, "text", "format the column as text")?;
        match fault_of(text) {
            Some(wrong) => Err(self.error(row, column.at, Code::TableRow, wrong)),
            None => Ok(text),
        }
    }

    /// Refuses a `name` of a `what` that an earlier row has; `lines` holds those so far.
    pub(super) fn once<N: Eq + Hash + Display>(
        &self,
        lines: &mut HashMap<N, usize>,
        (what, name): (&str, N),
        row: &Row,
        at: usize,
    ) -> Result<()> {
        match lines.entry(name) {
            Entry::Vacant(entry) => {
                entry.insert(row.line);
                Ok(())
            }
            Entry::Occupied(entry) => {
                let (name, first) = (entry.key(), entry.get());
                let message = format!("The {what} \"{name}\" appears twice; first on line {first}.");
                Err(self.error(row, at, Code::Duplicate, message))
            }
        }
    }

    /// True where a field is empty.
    pub(super) fn is_blank(&self, row: &Row, column: Column) -> bool {
        row.fields[column.at].text.is_empty()
    }

    /// The column, where there is one and the row has something in it.
    pub(super) fn filled(&self, row: &Row, column: Option<Column>) -> Option<Column> {
        column.filter(|column| !self.is_blank(row, *column))
    }

    pub(super) fn refuse_other(&self, row: &Row, column: Column, wanted: &str, hint: &str) -> Result<()> {
        let field = &row.fields[column.at];
        if !field.other {
            return Ok(());
        }
        let message = format!("The cell holds {}; it must be {wanted}.", field.text);
        let error = self.error(row, column.at, Code::TableRow, message);
        Err(if field.text.starts_with(OPEN_FORMULA) {
            error.hint(
                "open the workbook in a spreadsheet program and save it, or write the value instead of the formula",
            )
        } else {
            error.hint(format!("{hint}, and enter the value again"))
        })
    }

    /// First field that with the next one looks like the two halves of a decimal.
    fn decimal_comma(&self, fields: &[Field]) -> Option<usize> {
        // Names come first; one that is a number proves nothing.
        let has_unit = |heading: &Heading| Sense::of(&heading.name).is_some();
        let first = self.headings.iter().position(has_unit).unwrap_or(1).max(1);
        let is_number = |field: &Field| field.text.is_empty() || field.text.parse::<f64>().is_ok();
        if !fields.iter().skip(first).all(is_number) {
            return None;
        }
        // Where other numbers have a point, one field too many is no fraction.
        let excess = fields.len() - self.headings.len();
        if excess == 1 && fields.iter().skip(first).any(|field| field.text.contains('.')) {
            return None;
        }
        let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        let whole = |text: &str| digits(text.trim_start_matches(['+', '-']));
        (first..fields.len().saturating_sub(1)).find(|&i| whole(&fields[i].text) && digits(&fields[i + 1].text))
    }
}
