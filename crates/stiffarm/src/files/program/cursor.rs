//! A place in a line of a program, and what is read there.

use super::{Move, MoveKind, ProgramFile, Step, text};
use crate::error::{Code, Error, Result};

/// Goes through one line.
#[derive(Debug, Clone)]
pub struct Cursor<'a> {
    file: &'a str,
    line: &'a str,
    /// Counted from 1.
    number: usize,
    /// Byte position.
    at: usize,
}

/// The lines of a file.
pub fn lines(file: &ProgramFile) -> impl Iterator<Item = Cursor<'_>> {
    let lines = file.text.trim_start_matches('\u{feff}').lines();
    lines.enumerate().map(|(i, line)| Cursor {
        file: &file.name,
        line,
        number: i + 1,
        at: 0,
    })
}

impl<'a> Cursor<'a> {
    /// What is left of the line.
    pub fn rest(&self) -> &'a str {
        &self.line[self.at..]
    }

    /// Passes spaces.
    pub fn space(&mut self) -> &mut Self {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
        self
    }

    /// Passes one character.
    pub fn step(&mut self) {
        self.at += self.rest().chars().next().map_or(0, char::len_utf8);
    }

    /// True where only spaces are left.
    pub fn is_done(&self) -> bool {
        self.rest().trim().is_empty()
    }

    /// Passes `text`, after spaces and in any case, if it stands here.
    pub fn passes(&mut self, text: &str) -> bool {
        let mut next = self.clone();
        next.space();
        let here = next.rest().as_bytes();
        let found =
            here.len() >= text.len() && here[..text.len()].eq_ignore_ascii_case(text.as_bytes());
        if found {
            self.at = next.at + text.len();
        }
        found
    }

    /// Passes a word: no letter, digit or `_` follows.
    pub fn word(&mut self, word: &str) -> bool {
        let before = self.at;
        let found = self.passes(word)
            && !self
                .rest()
                .starts_with(|c: char| c.is_alphanumeric() || c == '_');
        if !found {
            self.at = before;
        }
        found
    }

    /// Passes `text`.
    pub fn expect(&mut self, text: &str) -> Result<()> {
        match self.passes(text) {
            true => Ok(()),
            false => Err(self.space().wrong(format!("`{text}` is missing here."))),
        }
    }

    /// Refuses what is left but spaces.
    pub fn end(&mut self) -> Result<()> {
        match self.is_done() {
            true => Ok(()),
            false => Err(self.space().wrong("This is not expected here.".to_string())),
        }
    }

    /// A name: letters, digits, `_` and `$`.
    pub fn identifier(&mut self) -> Result<&'a str> {
        self.space();
        let rest = self.rest();
        let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '$';
        let length = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
        if length == 0 {
            return Err(self.wrong("A name is missing here.".to_string()));
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
            _ => Err(self.wrong("A number is missing here.".to_string())),
        }
    }

    /// An angle in degrees, given in radians.
    pub fn angle(&mut self) -> Result<f64> {
        let before = self.clone();
        match self.number()? {
            degrees if degrees.abs() <= 1e5 => Ok(degrees.to_radians()),
            _ => Err(before.wrong("This is no angle of a joint in degrees.".to_string())),
        }
    }

    /// A speed in per cent.
    pub fn percent(&mut self) -> Result<u8> {
        let before = self.clone();
        let number = self.number()?;
        match (0.5..=100.0).contains(&number) {
            true => Ok(number.round() as u8),
            false => Err(before.wrong("A speed of 1 to 100 per cent is needed here.".to_string())),
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

    /// An error at this place.
    pub fn wrong(&self, message: String) -> Error {
        let column = self.line[..self.at].chars().count() + 1;
        Error::new(Code::Program, message)
            .file(self.file)
            .line(self.number, Some(column))
    }
}

/// Steps that grow line by line.
#[derive(Debug, Default)]
pub struct Steps {
    steps: Vec<Step>,
    /// Kind and name of the next move.
    next: Option<(MoveKind, String)>,
    /// What has been said since the last step.
    said: Vec<String>,
    moves: usize,
}

impl Steps {
    /// A comment: it may name the next move.
    pub fn comment(&mut self, comment: &str) {
        if let Some(marked) = text::marked(comment) {
            self.next = Some(marked);
        }
    }

    /// A line of a message.
    pub fn say(&mut self, line: &str) {
        self.said.push(line.to_string());
    }

    /// The program waits for somebody.
    pub fn wait(&mut self) {
        let text = std::mem::take(&mut self.said).join(" ");
        self.steps.push(Step::Wait(text));
    }

    /// A move. Without a comment before it, it has a number for a name.
    pub fn go(&mut self, q: Vec<f64>, speed_percent: u8) {
        self.moves += 1;
        let unnamed = || (MoveKind::Posture, format!("move {}", self.moves));
        let (kind, name) = self.next.take().unwrap_or_else(unnamed);
        self.steps.push(Step::Move(Move {
            name,
            kind,
            q,
            speed_percent,
        }));
    }

    /// All of them.
    pub fn done(self) -> Vec<Step> {
        self.steps
    }
}
