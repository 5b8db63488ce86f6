//! Numbers as files write them.

use super::grid::{Column, Row, Rows, Style, Table};
use nalgebra::Vector3;
use std::borrow::Cow;
use stiffarm::error::{Code, Error, Result};
use stiffarm::units::LARGEST_NUMBER;

/// Lengths of a table in another unit have an error of their own: so many times the
/// limit of others is left to it.
const LENGTHS: f64 = 10.0;

/// Signs for minus that are not the one on the keyboard: of typesetters, and of programs that
/// mend texts.
const MINUS: [char; 4] = ['\u{2212}', '\u{2013}', '\u{fe63}', '\u{ff0d}'];

/// What stands between thousands where it can be nothing else: blanks at which no line breaks,
/// and the apostrophes of Switzerland.
const GROUPING: [char; 7] = ['\u{a0}', '\u{202f}', '\u{2009}', '\u{2007}', '\u{2008}', '\'', '\u{2019}'];

/// A number with the minus of the keyboard and without what parts its thousands; anything else as it is.
fn plain(text: &str) -> Cow<'_, str> {
    if text.is_ascii() && !text.contains('\'') {
        return Cow::Borrowed(text);
    }
    let negative = text.strip_prefix(MINUS);
    let rest = negative.unwrap_or(text).trim_start_matches(GROUPING);
    let unsigned = rest.trim_start_matches(['+', '-']);
    let end = unsigned.find(['.', ',', 'e', 'E']).unwrap_or(unsigned.len());
    let (whole, fraction) = unsigned.split_at(end);
    let sign = if negative.is_some() { "-" } else { &rest[..rest.len() - unsigned.len()] };
    let mut groups = whole.split(GROUPING);
    let digits = |group: &str| group.bytes().all(|b| b.is_ascii_digit());
    let first = groups.next().is_some_and(|first| (1..=3).contains(&first.len()) && digits(first));
    let is_grouped = whole.contains(GROUPING) && first && groups.all(|g| g.len() == 3 && digits(g));
    match (negative, is_grouped) {
        (None, false) => Cow::Borrowed(text),
        (_, true) => Cow::Owned(format!("{sign}{}{fraction}", whole.replace(GROUPING, ""))),
        (Some(_), false) => Cow::Owned(format!("-{rest}")),
    }
}

/// True where commas separate the columns and every number with a fraction stands in quotation
/// marks with a comma for its point, one of them at least where no comma parts thousands.
pub(super) fn has_quoted_decimals(rows: &Rows) -> bool {
    let fields = || rows.below().flat_map(|row| row.fields).map(|field| plain(&field.text));
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    let decimal = |text: &str| text.contains(',') && is_number(&text.replacen(',', ".", 1));
    let certain = |text: &str| {
        let (whole, fraction) = text.split_once(',').unwrap_or((text, ""));
        let whole = whole.trim_start_matches(['+', '-']);
        decimal(text) && (fraction.len() != 3 || !(1..=3).contains(&whole.len()) || whole == "0")
    };
    fields().any(|text| text.contains(',') && certain(&text))
        && !fields().any(|text| text.contains('.') && is_number(&text))
}

impl Table<'_> {
    /// The finite numbers of three columns, in SI units.
    pub(super) fn vector(&self, row: &Row, columns: &[Column]) -> Result<Vector3<f64>> {
        let mut vector = Vector3::zeros();
        for (component, column) in vector.iter_mut().zip(columns) {
            *component = self.number(row, *column)?;
        }
        Ok(vector)
    }

    /// A finite number in SI units.
    pub(super) fn number(&self, row: &Row, column: Column) -> Result<f64> {
        let at = column.at;
        let text = row.fields[at].text.as_str();
        if text.is_empty() {
            let message = "The field is empty; it must be a number.";
            return Err(self
                .error(row, at, Code::TableRow, message)
                .hint("fill it in, or remove the row if it was not measured"));
        }
        self.refuse_other(row, column, "a number", "format the column as a number")?;
        let plain = plain(text);
        let value = match self.style {
            Style::Others if !plain.contains('.') => plain.replacen(',', ".", 1).parse::<f64>(),
            Style::Commas if self.has_quoted_decimals => plain.replacen(',', ".", 1).parse::<f64>(),
            _ => plain.parse::<f64>(),
        };
        let Ok(value) = value else {
            return Err(self.not_a_number(row, at, text));
        };
        if !value.is_finite() {
            let message = format!("\"{text}\" is not a finite number.");
            return Err(self.error(row, at, Code::NotFinite, message));
        }
        if let Some(message) = self.beyond_sense(column, value) {
            let error = self.error(row, at, Code::TableRow, message);
            let other = column.unit.and_then(|unit| unit.of_others(&self.headings[at].name));
            return Err(error.hint_if(other));
        }
        Ok(column.unit.map_or(value, |unit| (unit.to_si)(value)))
    }

    /// Says that the number in `column` cannot be meant, where that is so.
    fn beyond_sense(&self, column: Column, value: f64) -> Option<String> {
        let Some(sense) = column.sense else {
            return (value.abs() > LARGEST_NUMBER).then(|| format!("{value:e} is too large."));
        };
        let refused = sense.refuse(value)?;
        let unit = self.headings[column.at].name.rsplit_once('_').map(|(_, unit)| unit);
        let is_length = unit.is_some_and(|unit| ["mm", "m", "um", "in"].contains(&unit));
        (!is_length || value.abs() >= LENGTHS * sense.limit).then_some(refused)
    }

    fn not_a_number(&self, row: &Row, column: usize, text: &str) -> Error {
        let with_point = text.replacen(',', ".", 1).parse::<f64>().is_ok();
        if with_point && self.style == Style::Commas {
            let message = format!("{text} has a decimal comma, but commas separate the columns.");
            return self
                .error(row, column, Code::DecimalComma, message)
                .hint("write a decimal point, or separate the columns with semicolons");
        }
        let message = format!("\"{text}\" is not a number.");
        let error = self.error(row, column, Code::TableRow, message);
        let number_part = text.trim_end_matches(|c: char| !c.is_ascii_digit());
        if with_point {
            error.hint("the cell holds text: format the column as a number, and enter it again")
        } else if text.contains(',') && text.contains('.') {
            error.hint("leave out separators between thousands")
        } else if number_part.replacen(',', ".", 1).parse::<f64>().is_ok() {
            error.hint("write the number alone; the unit stands in the heading")
        } else {
            error
        }
    }
}
