//! The text of a cell file, and the checks of single values in it.
//!
//! Each check takes the value with its place and the key path that a message
//! names; list entries count from 1, as joints do.

use super::raw::{At, Number, NumberRows, Numbers, Text};
use crate::error::{Code, Error, Result};
use crate::files::check_name;
use crate::units::{LARGEST_NUMBER, Sense, deg_to_rad};
use nalgebra::{DMatrix, UnitQuaternion, Vector3};
use std::ops::Range;

/// Numbers above zero from here on are zero: their squares and fourth powers must stay
/// finite, and above zero, in everything that is computed from a cell.
const SMALLEST: f64 = 1e-30;

/// Reads a file that a cell names: from the name to the bytes.
pub(super) type ReadFile<'a> = dyn Fn(&str) -> Result<Vec<u8>> + 'a;

/// A cell file's text and name.
pub(super) struct Source<'a> {
    file: &'a str,
    text: &'a str,
    /// Reads files that the cell names; none where only the text may be used.
    files: Option<&'a ReadFile<'a>>,
    /// Bytes of the byte order mark before the TOML text.
    mark: usize,
}

impl<T> At<T> {
    pub(super) fn get(&self) -> &T {
        self.0.get_ref()
    }

    pub(super) fn span(&self) -> Range<usize> {
        self.0.span()
    }
}

impl<'a> Source<'a> {
    pub(super) fn new(text: &'a str, file: &'a str) -> Self {
        let mark = if text.starts_with('\u{feff}') {
            '\u{feff}'.len_utf8()
        } else {
            0
        };
        Source {
            file,
            text,
            files: None,
            mark,
        }
    }

    /// The same, with a reader of the files that it names.
    pub(super) fn with_files(self, files: &'a ReadFile<'a>) -> Self {
        Source {
            files: Some(files),
            ..self
        }
    }

    /// Bytes of a file that the cell names.
    pub(super) fn read(&self, file: &str) -> Result<Vec<u8>> {
        let Some(read) = self.files else {
            let message = "Only the text of the cell is read here, not the files that it names.";
            let hint =
                "read it with `parse_cell_with`, or give capsules instead: `stiffarm capsules`";
            return Err(Error::new(Code::Unsupported, message).hint(hint));
        };
        read(file)
    }

    /// The text without a byte order mark; all spans count from its start.
    pub(super) fn body(&self) -> &'a str {
        &self.text[self.mark..]
    }

    /// An error at the bytes `span` of the body.
    pub(super) fn error(
        &self,
        code: Code,
        key: &str,
        span: Range<usize>,
        message: impl Into<String>,
    ) -> Error {
        self.place(Error::new(code, message), key, span)
    }

    /// Adds the place to an error that has none.
    pub(super) fn place(&self, error: Error, key: &str, span: Range<usize>) -> Error {
        let span = span.start + self.mark..span.end + self.mark;
        let error = error.span(self.text, span).file(self.file);
        if key.is_empty() {
            error
        } else {
            error.key(key)
        }
    }

    /// A key that must be there; `table` is the place of the table that lacks
    /// it (none where it would stand at the top of the file).
    pub(super) fn required<'v, T>(
        &self,
        value: &'v Option<At<T>>,
        key: &str,
        table: Option<Range<usize>>,
        hint: &str,
    ) -> Result<&'v At<T>> {
        value.as_ref().ok_or_else(|| {
            let error = Error::new(Code::MissingKey, "This key is missing.").hint(hint);
            match table {
                Some(span) => self.place(error, key, span),
                None => error.key(key).file(self.file),
            }
        })
    }

    /// A finite number of a size that can be meant.
    pub(super) fn number(&self, value: &Number, key: &str) -> Result<f64> {
        let number = *value.get();
        if !number.is_finite() {
            return Err(self.error(
                Code::NotFinite,
                key,
                value.span(),
                format!("{number} is not a finite number."),
            ));
        }
        let sense = Sense::of(key);
        let wrong = match sense {
            Some(sense) => sense.refuse(number),
            None => (number.abs() > LARGEST_NUMBER).then(|| format!("{number:e} is too large.")),
        };
        match wrong {
            Some(message) => {
                let error = self.error(Code::InvalidValue, key, value.span(), message);
                Err(match sense.and_then(Sense::hint) {
                    Some(hint) => error.hint(hint),
                    None => error,
                })
            }
            // Values too small to square are zero; −0 stays what it is.
            None if number.abs() < SMALLEST => Ok(0.0 * number),
            None => Ok(number),
        }
    }

    /// A number above zero.
    pub(super) fn positive(&self, value: &Number, key: &str) -> Result<f64> {
        self.number(value, key)?;
        let number = *value.get();
        if number <= 0.0 {
            return Err(self.error(
                Code::InvalidValue,
                key,
                value.span(),
                format!("The value must be above 0, got {number}."),
            ));
        }
        let smallest = Sense::of(key).map_or(SMALLEST, |sense| sense.smallest);
        if number < smallest {
            let message =
                format!("{number:e} is too small to be meant: give {smallest:e} or more.");
            return Err(self.error(Code::InvalidValue, key, value.span(), message));
        }
        Ok(number)
    }

    /// Zero or a number above it.
    pub(super) fn not_negative(&self, value: &Number, key: &str) -> Result<f64> {
        let number = self.number(value, key)?;
        if number < 0.0 {
            return Err(self.error(
                Code::InvalidValue,
                key,
                value.span(),
                format!("The value must be 0 or more, got {number}."),
            ));
        }
        // −0 is 0.
        Ok(number.abs())
    }

    /// A list of `count` finite numbers; `what` says what they are.
    pub(super) fn numbers(
        &self,
        list: &Numbers,
        key: &str,
        count: usize,
        what: &str,
    ) -> Result<Vec<f64>> {
        self.count(list, key, count, what)?;
        self.each(list, key, |value, key| self.number(value, key))
    }

    /// A list of `count` numbers above zero.
    pub(super) fn positives(
        &self,
        list: &Numbers,
        key: &str,
        count: usize,
        what: &str,
    ) -> Result<Vec<f64>> {
        self.count(list, key, count, what)?;
        self.each(list, key, |value, key| self.positive(value, key))
    }

    /// Three finite numbers.
    pub(super) fn vector(&self, list: &Numbers, key: &str) -> Result<Vector3<f64>> {
        let values = self.numbers(list, key, 3, "x, y, z")?;
        Ok(Vector3::from_column_slice(&values))
    }

    /// The rotation of roll, pitch, yaw in degrees: turns about x, then y, then z
    /// of the frame that stays.
    pub(super) fn rotation(&self, list: &Numbers, key: &str) -> Result<UnitQuaternion<f64>> {
        let values = self.numbers(list, key, 3, "roll, pitch, yaw")?;
        let [roll, pitch, yaw] = [values[0], values[1], values[2]].map(deg_to_rad);
        Ok(UnitQuaternion::from_euler_angles(roll, pitch, yaw))
    }

    /// Two numbers, the first below the second.
    pub(super) fn range(&self, list: &Numbers, key: &str) -> Result<[f64; 2]> {
        let values = self.numbers(list, key, 2, "[low, high]")?;
        let (low, high) = (values[0], values[1]);
        if low >= high {
            let message =
                format!("The lower value must be below the upper one, got {low} and {high}.");
            return Err(self
                .error(Code::InvalidValue, key, list.span(), message)
                .hint("write the lower value first: [low, high]"));
        }
        Ok([low, high])
    }

    /// Two numbers of which the first is not above the second: equal ones hold a joint
    /// where it is.
    pub(super) fn range_or_place(&self, list: &Numbers, key: &str) -> Result<[f64; 2]> {
        let values = self.numbers(list, key, 2, "[low, high]")?;
        match values[0] == values[1] {
            true => Ok([values[0]; 2]),
            false => self.range(list, key),
        }
    }

    /// One range per joint, each taken by `range`: [`Source::range`] or
    /// [`Source::range_or_place`].
    pub(super) fn ranges(
        &self,
        rows: &NumberRows,
        key: &str,
        joints: usize,
        range: impl Fn(&Self, &Numbers, &str) -> Result<[f64; 2]>,
    ) -> Result<Vec<[f64; 2]>> {
        self.rows(rows, key, joints, "rows", "one [low, high] per joint")?;
        self.each(rows, key, |row, key| range(self, row, key))
    }

    /// A square matrix, row by row.
    pub(super) fn matrix(&self, rows: &NumberRows, key: &str, n: usize) -> Result<DMatrix<f64>> {
        self.rows(rows, key, n, "rows", "one per joint")?;
        let values = self.each(rows, key, |row, key| {
            self.numbers(row, key, n, "one per joint")
        })?;
        Ok(DMatrix::from_fn(n, n, |i, j| values[i][j]))
    }

    /// A name for tables: not empty, on one line, no spaces around it.
    pub(super) fn name(&self, text: &Text, key: &str) -> Result<String> {
        self.checked_name(text.get(), text.span(), key)
    }

    /// [`Source::name`] of a text whose place is given.
    pub(super) fn checked_name(&self, name: &str, span: Range<usize>, key: &str) -> Result<String> {
        match check_name(name) {
            Ok(()) => Ok(name.to_string()),
            Err(error) => Err(self.place(error, key, span)),
        }
    }

    /// A name that none of `others` has yet.
    pub(super) fn unique_name<'n>(
        &self,
        text: &Text,
        key: &str,
        mut others: impl Iterator<Item = &'n str>,
    ) -> Result<String> {
        let name = self.name(text, key)?;
        if others.any(|other| other == name) {
            let message = format!("The name \"{name}\" appears twice.");
            return Err(self.error(Code::Duplicate, key, text.span(), message));
        }
        Ok(name)
    }

    /// Applies `check` to each entry of a list, naming it `key[1]`, `key[2]`, ….
    pub(super) fn each<T, U>(
        &self,
        list: &At<Vec<T>>,
        key: &str,
        check: impl Fn(&T, &str) -> Result<U>,
    ) -> Result<Vec<U>> {
        let entries = list.get().iter().enumerate();
        entries
            .map(|(i, entry)| check(entry, &format!("{key}[{}]", i + 1)))
            .collect()
    }

    fn count(&self, list: &Numbers, key: &str, count: usize, what: &str) -> Result<()> {
        self.rows(list, key, count, "numbers", what)
    }

    /// Checks the number of entries of a list.
    pub(super) fn rows<T>(
        &self,
        list: &At<Vec<T>>,
        key: &str,
        count: usize,
        unit: &str,
        what: &str,
    ) -> Result<()> {
        let found = list.get().len();
        if found == count {
            return Ok(());
        }
        let unit = if count == 1 {
            unit.trim_end_matches('s')
        } else {
            unit
        };
        let message = format!("This must be {count} {unit} ({what}), got {found}.");
        Err(self.error(Code::Dimension, key, list.span(), message))
    }
}
