//! `[columns]`: what another software calls the columns of measurement tables and paths, and
//! what else is to know about its files.

use super::profiles::{NAMES, profile};
use super::raw::{RawColumn, RawColumns};
use super::source::Source;
use super::value::{HasSpan, Spanned, Text};
use crate::table::own_heading;
use stiffarm::error::{Code, Error, Result, did_you_mean};
use stiffarm::model::cell::{Columns, DateOrder, NamePattern, Separator};
use stiffarm::model::robot::Robot;

/// The key of the headings that do not matter.
const IGNORE: &str = "ignore";

/// The key of the columns of a table without a heading.
const ORDER: &str = "order";

/// Keys that are no headings, beside `ignore` and `order`.
const SETTINGS: [&str; 9] =
    ["profile", "name", "name_pattern", "date", "dates", "separator", "encoding", "comment", "sheet"];

/// Names in `order` that are no headings of ours.
const NOT_HEADINGS: [&str; 3] = ["name", "date", "-"];

/// The entries of the table, with what they are checked against.
struct Reader<'s> {
    source: &'s Source<'s>,
    robot: &'s Robot,
    /// Headings of the other software so far, without case: two that differ in it alone are
    /// one; with their keys.
    taken: Vec<(String, String)>,
    columns: Columns,
}

/// The headings of the other software, where the cell names them.
pub(super) fn columns(source: &Source<'_>, table: Option<&Spanned<RawColumns>>, robot: &Robot) -> Result<Columns> {
    let entries = || table.into_iter().flat_map(|table| &table.get().0);
    let mut reader = Reader { source, robot, taken: Vec::new(), columns: Columns::default() };
    // The profile first: what else stands there overrides it.
    for (name, value) in entries().filter(|(name, _)| name.get() == "profile") {
        reader.entry(name, value)?;
    }
    for (name, value) in entries().filter(|(name, _)| name.get() != "profile") {
        reader.entry(name, value)?;
    }
    Ok(reader.columns)
}

impl Reader<'_> {
    fn entry(&mut self, name: &Text, value: &Spanned<RawColumn>) -> Result<()> {
        let key = format!("columns.{}", name.get());
        let key_name = name.get().as_str();
        match value.get() {
            RawColumn::Several(list) if key_name == IGNORE => self.ignore(list, &key),
            RawColumn::Several(list) if key_name == ORDER => self.order(list, &key),
            RawColumn::One(_) if key_name == IGNORE || key_name == ORDER => {
                let message = "This is text; it must be a list in brackets.";
                let error = self.fault(Code::WrongType, &key, value, message);
                Err(error.hint(format!("write {key_name} = [\"…\", \"…\"]")))
            }
            RawColumn::Several(_) => {
                if !SETTINGS.contains(&key_name) {
                    self.ours(name, &key)?;
                }
                let message = "This is a list; it must be text in quotes.";
                Err(self.fault(Code::WrongType, &key, value, message))
            }
            RawColumn::One(text) if SETTINGS.contains(&key_name) => self.setting(key_name, text, value, &key),
            RawColumn::One(theirs) => {
                let ours = self.ours(name, &key)?;
                let theirs = self.source.checked_name(theirs, value)?;
                self.take(&theirs, &key).map_err(|message| self.fault(Code::Duplicate, &key, value, &message))?;
                if self.columns.names.insert(ours, theirs).is_some() {
                    let message = "This column appears twice, in different case.";
                    return Err(self.source.error_at(Code::Duplicate, &key, name.span(), message));
                }
                Ok(())
            }
        }
    }

    fn ignore(&mut self, list: &[Text], key: &str) -> Result<()> {
        for (i, theirs) in list.iter().enumerate() {
            let key = format!("{key}[{}]", i + 1);
            // Nothing stands for columns without a heading.
            let heading = match theirs.get().as_str() {
                "" => String::new(),
                _ => self.source.name(theirs)?,
            };
            self.take(&heading, &key)
                .map_err(|message| self.source.error_at(Code::Duplicate, &key, theirs.span(), &message))?;
            self.columns.ignore.push(heading);
        }
        Ok(())
    }

    fn order(&mut self, list: &[Text], key: &str) -> Result<()> {
        let mut order: Vec<String> = Vec::new();
        for (i, name) in list.iter().enumerate() {
            let key = format!("{key}[{}]", i + 1);
            let ours =
                if NOT_HEADINGS.contains(&name.get().as_str()) { name.get().clone() } else { self.ours(name, &key)? };
            if ours != "-" && order.contains(&ours) {
                let message = "This column appears twice.";
                return Err(self.source.error_at(Code::Duplicate, &key, name.span(), message));
            }
            order.push(ours);
        }
        self.columns.order = order;
        Ok(())
    }

    /// A key with a text that is no heading of a column alone.
    fn setting(&mut self, key_name: &str, text: &str, value: &Spanned<RawColumn>, key: &str) -> Result<()> {
        let one_of = |choices: &[&str]| {
            let message = format!("\"{text}\" is none of the choices.");
            let error = self.fault(Code::UnknownName, key, value, &message);
            let nearest = did_you_mean(text, choices.iter().copied());
            Err(error.hint(nearest.unwrap_or_else(|| format!("write one of: {}", choices.join(", ")))))
        };
        match key_name {
            "profile" => match profile(text) {
                Some(columns) => self.columns = columns,
                None => {
                    let message = format!("There is no profile \"{text}\".");
                    let error = self.fault(Code::UnknownName, key, value, &message);
                    if let Some(nearest) = did_you_mean(text, NAMES) {
                        return Err(error.hint(nearest));
                    }
                    return Err(error.hint(format!(
                        "profiles: {}; for another software name its headings: x_mm = \"…\", y_mm = \"…\", z_mm = \
                         \"…\"",
                        NAMES.join(", ")
                    )));
                }
            },
            "dates" => {
                self.columns.dates = Some(match text {
                    "day-first" => DateOrder::DayFirst,
                    "month-first" => DateOrder::MonthFirst,
                    _ => return one_of(&["day-first", "month-first"]),
                });
            }
            "separator" => {
                self.columns.separator = Some(match text {
                    "comma" | "," => Separator::Comma,
                    "semicolon" | ";" => Separator::Semicolon,
                    "tab" | "\t" => Separator::Tab,
                    "space" | " " => Separator::Space,
                    _ => return one_of(&["comma", "semicolon", "tab", "space"]),
                });
            }
            "encoding" => {
                self.columns.is_latin_1 = match text {
                    "utf-8" => false,
                    "latin-1" => true,
                    _ => return one_of(&["utf-8", "latin-1"]),
                };
            }
            "name_pattern" => {
                let pattern = NamePattern::parse(text).map_err(|message| {
                    let error = self.fault(Code::InvalidValue, key, value, &message);
                    error.hint("write for example {posture}::{state}::{point}; {} stands for what does not matter")
                })?;
                self.columns.name_pattern = Some(pattern);
            }
            _ => {
                let theirs = self.source.checked_name(text, value)?;
                if ["name", "date"].contains(&key_name) {
                    self.take(&theirs, key).map_err(|message| self.fault(Code::Duplicate, key, value, &message))?;
                }
                let place = match key_name {
                    "name" => &mut self.columns.name,
                    "date" => &mut self.columns.date,
                    "comment" => &mut self.columns.comment,
                    _ => &mut self.columns.sheet,
                };
                *place = Some(theirs);
            }
        }
        Ok(())
    }

    /// Remembers a heading of the other software; the error says which key has it already.
    fn take(&mut self, theirs: &str, key: &str) -> std::result::Result<(), String> {
        let lower = theirs.to_lowercase();
        if let Some((_, other)) = self.taken.iter().find(|(name, _)| *name == lower) {
            return Err(format!("{other} has this heading already."));
        }
        self.taken.push((lower, key.to_string()));
        Ok(())
    }

    /// The heading of ours that a key names.
    fn ours(&self, name: &Text, key: &str) -> Result<String> {
        let joints = self.robot.joint_count();
        own_heading(name.get(), joints, IGNORE).map_err(|e| self.source.place_at(e, key, name.span()))
    }

    fn fault(&self, code: Code, key: &str, value: &Spanned<RawColumn>, message: &str) -> Error {
        self.source.error_at(code, key, value.span(), message)
    }
}
