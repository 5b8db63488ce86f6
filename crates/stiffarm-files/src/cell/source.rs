//! The text of a cell file, and the checks of single values in it.
//!
//! A value knows its place, and the place tells the key path that a message names; list entries
//! count from 1, as joints do.

use super::value::{Deg, Fixed, HasSpan, List, Number, Spanned, Text, Unit};
use crate::check_name;
use nalgebra::{DMatrix, UnitQuaternion, Vector3};
use std::collections::HashMap;
use std::ops::Range;
use stiffarm::error::{Code, Error, Result, did_you_mean};
use stiffarm::units::{LARGEST_NUMBER, Sense};

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
    /// The key paths of values by their bytes, each before those inside it.
    paths: HashMap<Range<usize>, Vec<String>>,
}

impl<'a> Source<'a> {
    pub(super) fn new(text: &'a str, file: &'a str) -> Self {
        let mark = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        Source { file, text, files: None, mark, paths: HashMap::new() }
    }

    /// The same, with a reader of the files that it names.
    pub(super) fn with_files(self, files: &'a ReadFile<'a>) -> Self {
        Source { files: Some(files), ..self }
    }

    /// Bytes of a file that the cell names.
    pub(super) fn read(&self, file: &str) -> Result<Vec<u8>> {
        let Some(read) = self.files else {
            let message = "Only the text of the cell is read here, not the files that it names.";
            let hint = "read it with `parse_cell_with`, or give capsules instead: `stiffarm capsules`";
            return Err(Error::new(Code::Unsupported, message).hint(hint));
        };
        read(file)
    }

    /// The text without a byte order mark; all spans count from its start.
    pub(super) fn body(&self) -> &'a str {
        &self.text[self.mark..]
    }

    /// Takes the key paths of all values.
    pub(super) fn set_paths(&mut self, paths: Vec<(Range<usize>, String)>) {
        for (span, path) in paths {
            self.paths.entry(span).or_default().push(path);
        }
    }

    /// The key path of a value.
    fn path(&self, place: &impl HasSpan) -> &str {
        let paths = self.paths.get(&place.span());
        paths.and_then(|paths| paths.last()).map_or("", String::as_str)
    }

    /// The key path of `name` in a table.
    pub(super) fn path_in(&self, table: &impl HasSpan, name: &str) -> String {
        format!("{}.{name}", self.path(table))
    }

    /// Refuses keys of `table` that its kind does not have; `refusal` makes message and hint of such a key.
    pub(super) fn refuse_others(
        &self,
        table: &impl HasSpan,
        is_known: impl Fn(&str) -> bool,
        refusal: impl Fn(&str) -> (String, String),
    ) -> Result<()> {
        let mut keys = self.keys(table).into_iter();
        if let Some((span, name)) = keys.find(|(_, name)| !is_known(name)) {
            let (message, hint) = refusal(name);
            let key = self.path_in(table, name);
            return Err(self.error_at(Code::Conflict, &key, span.clone(), message).hint(hint));
        }
        Ok(())
    }

    /// The keys of `table` with their places, in the order of the file.
    pub(super) fn keys(&self, table: &impl HasSpan) -> Vec<(&std::ops::Range<usize>, &str)> {
        let path = self.path(table);
        let all = self.paths.iter();
        let all = all.flat_map(|(span, paths)| paths.iter().map(move |key_path| (span, key_path)));
        let mut keys: Vec<_> = all
            .filter_map(|(span, key_path)| Some((span, key_path.strip_prefix(path)?.strip_prefix('.')?)))
            .filter(|(_, name)| !name.contains(['.', '[']))
            .collect();
        keys.sort_by_key(|(span, _)| span.start);
        keys
    }

    /// An error at a value.
    pub(super) fn error(&self, code: Code, at: &impl HasSpan, message: impl Into<String>) -> Error {
        self.place(Error::new(code, message), at)
    }

    /// Adds the place of a value to an error that has none.
    pub(super) fn place(&self, error: Error, at: &impl HasSpan) -> Error {
        self.place_at(error, self.path(at), at.span())
    }

    /// Adds the place of a value to what was made of it, where that is an error.
    pub(super) fn placed<T>(&self, at: &impl HasSpan, made: Result<T>) -> Result<T> {
        made.map_err(|error| self.place(error, at))
    }

    /// An error at the bytes `span` of the body, which belong to `key`.
    pub(super) fn error_at(&self, code: Code, key: &str, span: Range<usize>, message: impl Into<String>) -> Error {
        self.place_at(Error::new(code, message), key, span)
    }

    /// Adds such a place to an error that has none.
    pub(super) fn place_at(&self, error: Error, key: &str, span: Range<usize>) -> Error {
        let span = span.start + self.mark..span.end + self.mark;
        let error = error.span(self.text, span).file(self.file);
        if key.is_empty() { error } else { error.key(key) }
    }

    /// A table that must be there.
    pub(super) fn required_table<'v, T>(
        &self,
        value: &'v Option<Spanned<T>>,
        name: &str,
        hint: &str,
    ) -> Result<&'v Spanned<T>> {
        let missing = || Error::new(Code::MissingKey, "This key is missing.").key(name);
        value.as_ref().ok_or_else(|| missing().file(self.file).hint(hint))
    }

    /// A key `name` that must be in `table`.
    pub(super) fn required<'v, T>(
        &self,
        table: &impl HasSpan,
        value: &'v Option<T>,
        name: &str,
        hint: &str,
    ) -> Result<&'v T> {
        let missing = || self.missing(table, &self.path_in(table, name), hint);
        value.as_ref().ok_or_else(missing)
    }

    /// Says that a key is missing, at the place of what needs it.
    pub(super) fn missing(&self, at: &impl HasSpan, key: &str, hint: &str) -> Error {
        let error = Error::new(Code::MissingKey, "This key is missing.").hint(hint);
        self.place_at(error, key, at.span())
    }

    /// What `read` makes of a value, where it is given.
    pub(super) fn optional<T, V>(
        &self,
        value: &Option<T>,
        read: impl FnOnce(&Self, &T) -> Result<V>,
    ) -> Result<Option<V>> {
        value.as_ref().map(|value| read(self, value)).transpose()
    }

    /// A finite number of a size that can be meant, in SI units as all that follow.
    pub(super) fn number<U: Unit>(&self, value: &Number<U>) -> Result<f64> {
        self.in_unit(value).map(U::si)
    }

    /// The same in the unit of the file.
    fn in_unit<U>(&self, value: &Number<U>) -> Result<f64> {
        let number = value.get();
        if !number.is_finite() {
            let message = format!("{number} is not a finite number.");
            return Err(self.error(Code::NotFinite, value, message));
        }
        let sense = Sense::of(self.path(value));
        let wrong = match sense {
            Some(sense) => sense.refuse(number),
            None => (number.abs() > LARGEST_NUMBER).then(|| format!("{number:e} is too large.")),
        };
        if let Some(message) = wrong {
            let error = self.error(Code::InvalidValue, value, message);
            return Err(error.hint_if(sense.and_then(Sense::hint)));
        }
        // Values too small to square are zero; −0 stays what it is.
        Ok(if number.abs() < SMALLEST { 0.0 * number } else { number })
    }

    /// A number above zero.
    pub(super) fn positive<U: Unit>(&self, value: &Number<U>) -> Result<f64> {
        self.in_unit(value)?;
        let number = value.get();
        if number <= 0.0 {
            let message = format!("The value must be above 0, got {number}.");
            return Err(self.error(Code::InvalidValue, value, message));
        }
        let smallest = Sense::of(self.path(value)).map_or(SMALLEST, |sense| sense.smallest);
        if number < smallest {
            let message = format!("{number:e} is too small to be meant: give {smallest:e} or more.");
            return Err(self.error(Code::InvalidValue, value, message));
        }
        Ok(U::si(number))
    }

    /// Zero or a number above it.
    pub(super) fn not_negative<U: Unit>(&self, value: &Number<U>) -> Result<f64> {
        let number = self.in_unit(value)?;
        if number < 0.0 {
            let message = format!("The value must be 0 or more, got {number}.");
            return Err(self.error(Code::InvalidValue, value, message));
        }
        // −0 is 0.
        Ok(U::si(number.abs()))
    }

    /// A list of `count` finite numbers; `what` says what they are.
    pub(super) fn numbers<U: Unit>(&self, list: &List<U>, count: usize, what: &str) -> Result<Vec<f64>> {
        self.count(list, count, "numbers", what)?;
        self.each(list, Self::number)
    }

    /// A list of `count` numbers above zero.
    pub(super) fn positives<U: Unit>(&self, list: &List<U>, count: usize, what: &str) -> Result<Vec<f64>> {
        self.count(list, count, "numbers", what)?;
        self.each(list, Self::positive)
    }

    /// Three finite numbers.
    pub(super) fn vector<U: Unit>(&self, list: &Fixed<3, U>) -> Result<Vector3<f64>> {
        let values = self.numbers(&list.0, 3, "x, y, z")?;
        Ok(Vector3::from_column_slice(&values))
    }

    /// The rotation of roll, pitch, yaw: turns about x, then y, then z of the frame that stays.
    pub(super) fn rotation(&self, list: &Fixed<3, Deg>) -> Result<UnitQuaternion<f64>> {
        let values = self.numbers(&list.0, 3, "roll, pitch, yaw")?;
        Ok(UnitQuaternion::from_euler_angles(values[0], values[1], values[2]))
    }

    /// Two numbers, the first below the second.
    pub(super) fn range<U: Unit>(&self, list: &Fixed<2, U>) -> Result<[f64; 2]> {
        self.range_or(list, false)
    }

    /// Two numbers of which the first is not above the second: equal ones hold a joint
    /// where it is.
    pub(super) fn range_or_place<U: Unit>(&self, list: &Fixed<2, U>) -> Result<[f64; 2]> {
        self.range_or(list, true)
    }

    fn range_or<U: Unit>(&self, list: &Fixed<2, U>, place: bool) -> Result<[f64; 2]> {
        self.count(&list.0, 2, "numbers", "[low, high]")?;
        let values = self.each(&list.0, Self::in_unit)?;
        let (low, high) = (values[0], values[1]);
        if low > high || (low == high && !place) {
            let message = format!("The lower value must be below the upper one, got {low} and {high}.");
            let error = self.error(Code::InvalidValue, list, message);
            return Err(error.hint("write the lower value first: [low, high]"));
        }
        Ok([low, high].map(U::si))
    }

    /// One range per joint, each taken by `range`: [`Source::range`] or
    /// [`Source::range_or_place`].
    pub(super) fn ranges<U: Unit>(
        &self,
        rows: &Spanned<Vec<Fixed<2, U>>>,
        joints: usize,
        range: impl Fn(&Self, &Fixed<2, U>) -> Result<[f64; 2]>,
    ) -> Result<Vec<[f64; 2]>> {
        self.count(rows, joints, "rows", "one [low, high] per joint")?;
        self.each(rows, range)
    }

    /// A square matrix, row by row.
    pub(super) fn matrix(&self, rows: &Spanned<Vec<List>>, n: usize) -> Result<DMatrix<f64>> {
        self.count(rows, n, "rows", "one per joint")?;
        let values = self.each(rows, |source, row| source.numbers(row, n, "one per joint"))?;
        Ok(DMatrix::from_fn(n, n, |i, j| values[i][j]))
    }

    /// A name for tables: not empty, on one line, no spaces around it.
    pub(super) fn name(&self, text: &Text) -> Result<String> {
        self.checked_name(text.get(), text)
    }

    /// [`Source::name`] of a text that stands at `place`.
    pub(super) fn checked_name(&self, name: &str, place: &impl HasSpan) -> Result<String> {
        match check_name(name) {
            Ok(()) => Ok(name.to_string()),
            Err(error) => Err(self.place(error, place)),
        }
    }

    /// A name that none of `others` has yet.
    pub(super) fn unique_name<'n>(&self, text: &Text, mut others: impl Iterator<Item = &'n str>) -> Result<String> {
        let name = self.name(text)?;
        if others.any(|other| other == name) {
            let message = format!("The name \"{name}\" appears twice.");
            return Err(self.error(Code::Duplicate, text, message));
        }
        Ok(name)
    }

    /// One of a few words.
    pub(super) fn choice<T: Copy>(&self, text: &Text, choices: &[(&str, T)], hint: &str) -> Result<T> {
        let word = text.get().as_str();
        if let Some((_, value)) = choices.iter().find(|(name, _)| *name == word) {
            return Ok(*value);
        }
        let message = format!("\"{word}\" is not one of the choices.");
        let nearest = did_you_mean(word, choices.iter().map(|(name, _)| *name));
        let error = self.error(Code::InvalidValue, text, message);
        Err(error.hint(nearest.unwrap_or_else(|| hint.to_string())))
    }

    /// What `read` makes of each entry of a list.
    pub(super) fn each<T, V>(&self, list: &Spanned<Vec<T>>, read: impl Fn(&Self, &T) -> Result<V>) -> Result<Vec<V>> {
        list.get().iter().map(|entry| read(self, entry)).collect()
    }

    /// Checks the number of entries of a list.
    pub(super) fn count<T>(&self, list: &Spanned<Vec<T>>, count: usize, unit: &str, what: &str) -> Result<()> {
        let length = list.get().len();
        if length == count {
            return Ok(());
        }
        let unit = if count == 1 { unit.trim_end_matches('s') } else { unit };
        let message = format!("This must be {count} {unit} ({what}), got {length}.");
        Err(self.error(Code::Dimension, list, message))
    }
}
