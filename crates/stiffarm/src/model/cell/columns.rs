//! How tables that another software writes are read.

use std::collections::BTreeMap;

/// How the headings of measurement tables and paths translate, and what else is to know about
/// the files of another software: headings are matched without case and outer spaces.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Columns {
    /// Our heading, with the unit that the table has, to theirs:
    /// `x_mm` to `Center X`.
    pub names: BTreeMap<String, String>,
    /// Their headings of columns that do not matter.
    pub ignore: Vec<String>,
    /// Their heading of the column whose text is split by `name_pattern`; `name` where it is
    /// not given.
    pub name: Option<String>,
    /// How that text becomes posture, state and point.
    pub name_pattern: Option<NamePattern>,
    /// Their heading of a column of dates that belong to the times of another column.
    pub date: Option<String>,
    /// Order of day and month in dates like 05/11/2026.
    pub dates: Option<DateOrder>,
    /// The columns of a table without a heading, by our headings; `name`, `date`, and `-` for
    /// one that does not matter.
    pub order: Vec<String>,
    /// What separates the columns of a text, where its heading does not show it.
    pub separator: Option<Separator>,
    /// What a line of remarks begins with, beside `#`.
    pub comment: Option<String>,
    /// The text is ISO 8859-1, one byte a character, and not UTF-8.
    pub is_latin_1: bool,
    /// Worksheet of a workbook; the first where it is not given.
    pub sheet: Option<String>,
}

/// Order of day and month.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DateOrder {
    /// 23/11/2026.
    DayFirst,
    /// 11/23/2026.
    MonthFirst,
}

/// What separates the columns of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    /// `,`.
    Comma,
    /// `;`.
    Semicolon,
    /// A tab.
    Tab,
    /// One space or several.
    Space,
}

impl Separator {
    /// The character.
    pub fn character(self) -> char {
        match self {
            Separator::Comma => ',',
            Separator::Semicolon => ';',
            Separator::Tab => '\t',
            Separator::Space => ' ',
        }
    }
}

/// What stands at a place of a compound name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NamePart {
    /// `{posture}`.
    Posture,
    /// `{state}`.
    State,
    /// `{point}`.
    Point,
    /// `{station}`.
    Station,
    /// `{}`: anything, which does not matter.
    Any,
}

impl NamePart {
    /// The column that it becomes; `None` for what does not matter.
    pub fn column(self) -> Option<&'static str> {
        match self {
            NamePart::Posture => Some("posture"),
            NamePart::State => Some("state"),
            NamePart::Point => Some("point"),
            NamePart::Station => Some("station"),
            NamePart::Any => None,
        }
    }
}

/// A pattern like `{posture}::{state}::{point}`: parts, and the text between them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamePattern {
    text: String,
    /// Text before the first part.
    before: String,
    /// Each part with the text behind it.
    parts: Vec<(NamePart, String)>,
}

impl NamePattern {
    /// Reads a pattern; the error is a sentence.
    ///
    /// # Errors
    /// No part, an unknown or repeated one, two without a text between them, a brace that is
    /// not closed.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut pieces = text.split('{');
        let before = pieces.next().unwrap_or_default().to_string();
        let mut parts: Vec<(NamePart, String)> = Vec::new();
        for piece in pieces {
            let Some((name, behind)) = piece.split_once('}') else {
                return Err(format!("The brace before \"{piece}\" is not closed."));
            };
            let part = match name.trim().to_lowercase().as_str() {
                "posture" => NamePart::Posture,
                "state" => NamePart::State,
                "point" => NamePart::Point,
                "station" => NamePart::Station,
                "" => NamePart::Any,
                other => return Err(format!("There is no part {{{other}}}.")),
            };
            if part != NamePart::Any && parts.iter().any(|(earlier, _)| *earlier == part) {
                return Err(format!("{{{name}}} appears twice."));
            }
            if parts.last().is_some_and(|(_, behind)| behind.is_empty()) {
                return Err("Two parts need a text between them.".to_string());
            }
            parts.push((part, behind.to_string()));
        }
        if parts.iter().all(|(part, _)| *part == NamePart::Any) {
            return Err("The pattern names no part of a name.".to_string());
        }
        Ok(NamePattern { text: text.to_string(), before, parts })
    }

    /// The pattern as it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its parts that become columns, in their order.
    pub fn columns(&self) -> impl Iterator<Item = &'static str> {
        self.parts.iter().filter_map(|(part, _)| part.column())
    }

    /// The texts of [`columns`](Self::columns) in `name`; `None` where the name is another.
    /// Each part ends where the text behind it first appears; the last takes the rest.
    pub fn split<'n>(&self, name: &'n str) -> Option<Vec<&'n str>> {
        self.splits(name).into_iter().next()
    }

    /// Every way to [`split`](Self::split) `name`, that one first: there are several where what
    /// stands between the parts is in them, too (`P1-up-250-left`).
    pub fn splits<'n>(&self, name: &'n str) -> Vec<Vec<&'n str>> {
        let mut ways = NameSplits { left: MOST_STEPS, splits: Vec::new() };
        if let Some(rest) = name.strip_prefix(self.before.as_str()) {
            ways.follow(rest, &self.parts, &mut Vec::new());
        }
        ways.splits
    }
}

/// Places that are tried in one name: what stands between its parts is mostly there once.
const MOST_STEPS: usize = 2000;

/// The ways to split a name.
struct NameSplits<'n> {
    /// Places that may still be tried.
    left: usize,
    splits: Vec<Vec<&'n str>>,
}

impl<'n> NameSplits<'n> {
    /// Finds those in which `rest` is the text of `parts`, behind the texts `before`.
    fn follow(&mut self, rest: &'n str, parts: &[(NamePart, String)], before: &mut Vec<&'n str>) {
        let Some(((part, behind), later)) = parts.split_first() else {
            return self.splits.push(before.clone());
        };
        let places: Vec<usize> = if later.is_empty() {
            rest.strip_suffix(behind.as_str()).map(str::len).into_iter().collect()
        } else {
            rest.match_indices(behind.as_str()).map(|(at, _)| at).collect()
        };
        for at in places {
            let text = rest[..at].trim();
            let counts = part.column().is_some();
            if self.left == 0 || (counts && text.is_empty()) {
                continue;
            }
            self.left -= 1;
            before.extend(counts.then_some(text));
            self.follow(&rest[at + behind.len()..], later, before);
            before.truncate(before.len() - usize::from(counts));
        }
    }
}
