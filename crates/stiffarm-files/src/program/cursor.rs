//! A place in a line of a program, and what is read there.

use super::ProgramFile;
use stiffarm::error::{Code, Error, Result};

/// Goes through one line, or through one statement of several lines.
#[derive(Debug, Clone)]
pub struct Cursor<'a> {
    file: &'a str,
    /// Which file of a program.
    index: u32,
    /// The text of the file.
    text: &'a str,
    /// The line in which it begins, counted from 1.
    number: usize,
    /// Byte positions in the file.
    begins: usize,
    ends: usize,
    at: usize,
    /// Begins a remark within a statement of several lines.
    remark: Option<char>,
}

/// A number as it stands in a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number {
    pub value: f64,
    /// Byte position in the file.
    pub at: u32,
    /// Bytes of its text.
    pub length: u32,
}

/// The lines of a file.
pub fn lines(file: &ProgramFile) -> impl Iterator<Item = Cursor<'_>> {
    let text = file.text.trim_start_matches('\u{feff}');
    let mut begins = file.text.len() - text.len();
    text.split_inclusive('\n').enumerate().map(move |(i, whole)| {
        let line = whole.strip_suffix('\n').unwrap_or(whole);
        let line = line.strip_suffix('\r').unwrap_or(line);
        let cursor = Cursor::over(file, i + 1, begins..begins + line.len());
        begins += whole.len();
        cursor
    })
}

/// Whether a name has this letter.
fn is_part(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '$'
}

impl<'a> Cursor<'a> {
    /// These bytes of a file, which begin in the line of this number.
    pub fn over(file: &'a ProgramFile, number: usize, bytes: std::ops::Range<usize>) -> Self {
        Cursor {
            file: &file.name,
            index: 0,
            text: &file.text,
            number,
            begins: bytes.start,
            ends: bytes.end,
            at: bytes.start,
            remark: None,
        }
    }

    /// The same in a file of this number.
    pub fn in_file(self, index: u32) -> Self {
        Cursor { index, ..self }
    }

    /// The same where `remark` begins a remark up to the end of its line.
    pub fn with_remarks(self, remark: char) -> Self {
        let remark = Some(remark);
        Cursor { remark, ..self }
    }

    /// Which file of a program it is in.
    pub fn file_index(&self) -> u32 {
        self.index
    }

    /// What is left of the line.
    pub fn rest(&self) -> &'a str {
        &self.text[self.at..self.ends]
    }

    /// Passes spaces, and remarks within a statement.
    pub fn space(&mut self) -> &mut Self {
        loop {
            let rest = self.rest();
            self.at += rest.len() - rest.trim_start().len();
            let is_remark = self.remark.is_some_and(|remark| self.rest().starts_with(remark));
            if !is_remark {
                return self;
            }
            self.at += self.rest().find('\n').unwrap_or(self.rest().len());
        }
    }

    /// Passes so many bytes.
    pub fn skip(&mut self, bytes: usize) {
        self.at += bytes;
    }

    /// The line's number, counted from 1.
    pub fn line_number(&self) -> usize {
        self.number + self.text[self.begins..self.at].matches('\n').count()
    }

    /// Byte position in the file.
    pub fn position(&self) -> usize {
        self.at
    }

    /// A finite number with its place.
    pub fn placed(&mut self) -> Result<Number> {
        let at = self.space().position();
        let value = self.number()?;
        Ok(Number { value, at: at as u32, length: (self.position() - at) as u32 })
    }

    /// True where only spaces are left.
    pub fn is_done(&self) -> bool {
        self.clone().space().rest().is_empty()
    }

    /// Passes `text`, after spaces and in any case, if it stands here.
    pub fn passes(&mut self, text: &str) -> bool {
        let mut next = self.clone();
        next.space();
        let here = next.rest().as_bytes();
        let is_next = here.len() >= text.len() && here[..text.len()].eq_ignore_ascii_case(text.as_bytes());
        if is_next {
            self.at = next.at + text.len();
        }
        is_next
    }

    /// Passes a word: no letter, digit or `_` follows.
    pub fn word(&mut self, word: &str) -> bool {
        let before = self.at;
        let is_next = self.passes(word) && !self.rest().starts_with(|c: char| c.is_alphanumeric() || c == '_');
        if !is_next {
            self.at = before;
        }
        is_next
    }

    /// The place behind `text`, where it stands further on in any case and is no part of a longer name.
    pub fn behind(&self, text: &str) -> Option<Self> {
        let rest = self.rest();
        let joins = |before: &str, behind: &str| before.ends_with(is_part) && behind.starts_with(is_part);
        let stands = |at: &usize| {
            let end = at + text.len();
            let is_here = rest.get(*at..end).is_some_and(|here| here.eq_ignore_ascii_case(text));
            is_here && !joins(&rest[..*at], text) && !joins(text, &rest[end..])
        };
        let at = (0..rest.len()).find(stands)?;
        Some(Cursor { at: self.at + at + text.len(), ..self.clone() })
    }

    /// What stands before the remark that `mark` begins.
    pub fn before(&self, mark: char) -> Self {
        let length = self.rest().find(mark).unwrap_or(self.rest().len());
        Cursor { ends: self.at + length, ..self.clone() }
    }

    /// Passes `text`.
    pub fn expect(&mut self, text: &str) -> Result<()> {
        if self.passes(text) { Ok(()) } else { Err(self.wrong_here(format!("`{text}` is missing here."))) }
    }

    /// Refuses what is left but spaces.
    pub fn end(&mut self) -> Result<()> {
        if self.is_done() { Ok(()) } else { Err(self.wrong_here("This is not expected here.")) }
    }

    /// A name: letters, digits, `_` and `$`.
    pub fn identifier(&mut self) -> Result<&'a str> {
        self.space();
        let rest = self.rest();
        let length = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
        if length == 0 {
            return Err(self.wrong("A name is missing here."));
        }
        self.at += length;
        Ok(&rest[..length])
    }

    /// A finite number.
    pub fn number(&mut self) -> Result<f64> {
        self.space();
        let rest = self.rest();
        let is_part = |(i, c): (usize, char)| {
            let after_e = i > 0 && rest.as_bytes()[i - 1].eq_ignore_ascii_case(&b'e');
            c.is_ascii_digit()
                || c == '.'
                || (c.eq_ignore_ascii_case(&'e') && i > 0)
                || ("+-".contains(c) && (i == 0 || after_e))
        };
        let end = rest.char_indices().find(|next| !is_part(*next));
        let length = end.map_or(rest.len(), |(at, _)| at);
        match rest[..length].parse::<f64>() {
            Ok(number) if number.is_finite() => {
                self.at += length;
                Ok(number)
            }
            _ => Err(self.wrong("A number is missing here.")),
        }
    }

    /// An angle in degrees, given in radians.
    pub fn angle(&mut self) -> Result<f64> {
        let before = self.clone();
        match self.number()? {
            degrees if degrees.abs() <= 1e5 => Ok(degrees.to_radians()),
            _ => Err(before.wrong("This is not a joint angle in degrees.")),
        }
    }

    /// A speed in per cent.
    pub fn percent(&mut self) -> Result<u8> {
        let before = self.clone();
        let number = self.number()?;
        if (0.5..=100.0).contains(&number) {
            Ok(number.round() as u8)
        } else {
            Err(before.wrong("A speed of 1 to 100 per cent is needed here."))
        }
    }

    /// A text between two `quote`s.
    pub fn quoted(&mut self, quote: char) -> Result<&'a str> {
        let mark = quote.to_string();
        self.expect(&mark)?;
        let rest = self.rest();
        let Some(end) = rest.find(quote) else {
            return Err(self.wrong(format!("The {quote} that ends this text is missing.")));
        };
        self.at += end + 1;
        Ok(&rest[..end])
    }

    /// So many numbers with commas between them.
    pub fn list(&mut self, count: usize, number: impl Fn(&mut Self, usize) -> Result<f64>) -> Result<Vec<f64>> {
        let mut values = Vec::with_capacity(count);
        for at in 0..count {
            if at > 0 {
                self.expect(",")?;
            }
            values.push(number(self, at)?);
        }
        Ok(values)
    }

    /// An error at what comes next but spaces.
    pub fn wrong_here(&mut self, message: impl Into<String>) -> Error {
        self.space().wrong(message)
    }

    /// An error at this place.
    pub fn wrong(&self, message: impl Into<String>) -> Error {
        let before = self.text[..self.at].rsplit('\n').next().unwrap_or_default();
        let column = before.trim_start_matches('\u{feff}').chars().count() + 1;
        Error::new(Code::Program, message).file(self.file).line(self.line_number(), Some(column))
    }
}
