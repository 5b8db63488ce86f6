//! Statements of CL data, of one or more lines.

use super::words::Weight;
use crate::program::{Cursor, Number};
use nalgebra::{UnitVector3, Vector3};
use std::borrow::Cow;
use stiffarm::error::{Error, Result};

/// A statement of one or more lines.
pub(super) struct Statement<'a> {
    pub head: Cursor<'a>,
    pub word: Cow<'a, str>,
    /// None where the word is not known.
    pub weight: Option<Weight>,
    pub numbers: Vec<(Cursor<'a>, Number)>,
    pub words: Vec<String>,
    /// Byte behind its last number.
    pub end: usize,
}

/// A word of letters, digits and `_`; empty where none stands here.
fn name<'a>(line: &mut Cursor<'a>) -> &'a str {
    let rest = line.space().rest();
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let length = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
    line.skip(length);
    &rest[..length]
}

/// The word that begins a line, in capitals; a label before it (`A1)`) is passed.
pub(super) fn word<'a>(line: &mut Cursor<'a>) -> Cow<'a, str> {
    let mut first_word = name(line);
    while !first_word.is_empty() && line.passes(")") {
        first_word = name(line);
    }
    if first_word.bytes().any(|byte| byte.is_ascii_lowercase()) {
        Cow::Owned(first_word.to_ascii_uppercase())
    } else {
        Cow::Borrowed(first_word)
    }
}

/// Whether the next line goes on with this one.
pub(super) fn goes_on(rest: &str) -> bool {
    let at = rest.find('$');
    at.is_some_and(|at| !rest[at + 1..].starts_with('$'))
}

impl<'a> Statement<'a> {
    pub fn new(head: Cursor<'a>, word: Cow<'a, str>, weight: Option<Weight>) -> Self {
        Statement { head, word, weight, numbers: Vec::with_capacity(6), words: Vec::new(), end: 0 }
    }

    /// Takes numbers and words with commas between them; true where the next line goes on.
    pub fn items(&mut self, line: &mut Cursor<'a>) -> Result<bool> {
        loop {
            match line.space().rest().as_bytes() {
                [] | [b'$', b'$', ..] => return Ok(false),
                [b'$', ..] => return Ok(true),
                [b',', ..] => {
                    line.skip(1);
                    continue;
                }
                _ => {}
            }
            let place = line.clone();
            match line.placed() {
                Ok(number) => {
                    self.end = line.position();
                    self.numbers.push((place, number));
                }
                Err(error) => match name(line) {
                    "" => {
                        let is_bracket = line.rest().starts_with(['(', ')', '/']);
                        match self.weight {
                            Some(Weight::Numbers) => return Err(error),
                            Some(Weight::Nested) if !is_bracket => return Err(error),
                            // Text of a statement whose numbers do not count.
                            _ => line.skip(line.rest().chars().next().map_or(0, char::len_utf8)),
                        }
                        self.end = line.position();
                    }
                    // Only arcs have a word: TIMES.
                    _ if self.weight == Some(Weight::Numbers) && self.word != "CIRCLE" => {
                        return Err(error);
                    }
                    word => self.words.push(word.to_ascii_uppercase()),
                },
            }
        }
    }

    pub fn has(&self, word: &str) -> bool {
        self.words.iter().any(|candidate| candidate == word)
    }

    /// An error at its word.
    pub fn wrong(&self, message: impl Into<String>) -> Error {
        self.head.wrong(message)
    }

    /// Three numbers as they stand.
    pub fn vector(&self, from: usize) -> Result<Vector3<f64>> {
        let numbers = self.numbers.get(from..from + 3).unwrap_or_default();
        match numbers {
            [(_, x), (_, y), (_, z)] => Ok(Vector3::new(x.value, y.value, z.value)),
            _ => Err(self.wrong("Three numbers are needed here.")),
        }
    }

    pub fn direction(&self, from: usize) -> Result<UnitVector3<f64>> {
        let vector = self.vector(from)?;
        // Axes of CAM systems are rounded, and not of another length.
        let length = vector.norm();
        if (length - 1.0).abs() > 0.01 {
            let message = format!("This axis has length {length:.3}; it must be 1.");
            let error = self.numbers[from].0.wrong(message);
            return Err(error.hint("decimals have points here, and numbers commas between them"));
        }
        Ok(UnitVector3::new_normalize(vector))
    }
}
