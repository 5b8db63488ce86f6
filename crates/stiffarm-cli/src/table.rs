//! Tables for people: numbers right-aligned under their units.

use crate::screen;
use anstyle::{AnsiColor, Style};
use std::fmt;
use stiffarm::findings::Severity;

/// Side a column is aligned to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Names and sentences.
    Left,
    /// Numbers.
    Right,
}

/// A table in the making.
#[derive(Debug, Clone)]
pub struct Table {
    headings: Vec<(String, Align)>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table whose first column holds names and the others numbers.
    pub fn new<S: Into<String>>(headings: impl IntoIterator<Item = S>) -> Self {
        let headings = headings.into_iter().map(|h| (h.into(), Align::Right));
        let mut table = Table {
            headings: headings.collect(),
            rows: Vec::new(),
        };
        table.align(0, Align::Left);
        table
    }

    /// Aligns one column.
    pub fn align(&mut self, column: usize, align: Align) {
        if let Some(heading) = self.headings.get_mut(column) {
            heading.1 = align;
        }
    }

    /// Adds a row; missing fields stay empty. A row is one line, whatever its names hold.
    pub fn row<S: Into<String>>(&mut self, fields: impl IntoIterator<Item = S>) {
        let fields = fields.into_iter().map(Into::into);
        self.rows
            .push(fields.map(|field| field.replace('\n', "\\n")).collect());
    }

    /// Adds a column on the right of the rows there are.
    pub fn column<'a>(
        &mut self,
        heading: &str,
        align: Align,
        fields: impl IntoIterator<Item = &'a str>,
    ) {
        self.headings.push((heading.to_string(), align));
        for (row, field) in self.rows.iter_mut().zip(fields) {
            row.push(field.replace('\n', "\\n"));
        }
    }

    fn width(&self, column: usize) -> usize {
        let fields = self
            .rows
            .iter()
            .filter_map(|row| row.get(column))
            .map(|f| screen::width(f));
        fields
            .chain([screen::width(&self.headings[column].0)])
            .max()
            .unwrap_or(0)
    }
}

/// What fills a field up to `width`.
fn space(field: &str, width: usize) -> String {
    " ".repeat(width.saturating_sub(screen::width(field)))
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widths: Vec<usize> = (0..self.headings.len()).map(|c| self.width(c)).collect();
        let line =
            |fields: &[String]| {
                let padded = self.headings.iter().zip(&widths).enumerate().map(
                    |(c, ((_, align), width))| {
                        let field = fields.get(c).map_or("", String::as_str);
                        match align {
                            Align::Left => format!("{field}{}", space(field, *width)),
                            Align::Right => format!("{}{field}", space(field, *width)),
                        }
                    },
                );
                padded.collect::<Vec<_>>().join("  ").trim_end().to_string()
            };
        let headings: Vec<String> = self.headings.iter().map(|(h, _)| h.clone()).collect();
        writeln!(f, "{}", paint(Style::new().bold(), &line(&headings)))?;
        self.rows
            .iter()
            .try_for_each(|row| writeln!(f, "{}", line(row)))
    }
}

pub use crate::screen::paint;

/// A heading between tables.
pub fn title(text: &str) -> String {
    format!("\n{}\n", paint(Style::new().bold().underline(), text))
}

/// `text` as something that is wrong.
pub fn red(text: &str) -> String {
    paint(AnsiColor::Red.on_default().bold(), text)
}

/// `text` as something that makes results unusable: a plain word first, which needs no colour.
pub fn serious(text: &str) -> String {
    red(&format!("SERIOUS: {text}"))
}

/// The word that a finding of this weight begins with.
pub fn weight(severity: Severity) -> String {
    match severity {
        Severity::Serious => red("SERIOUS"),
        Severity::Caution => yellow("caution"),
        Severity::Note => "note".to_string(),
    }
}

/// `text` as something to look at.
pub fn yellow(text: &str) -> String {
    paint(AnsiColor::Yellow.on_default(), text)
}

/// `text` as something that is right.
pub fn green(text: &str) -> String {
    paint(AnsiColor::Green.on_default(), text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_right_aligned_and_line_ends_bare() {
        let mut table = Table::new(["joint", "k [N·m/rad]", "note"]);
        table.align(2, Align::Left);
        table.row(["joint 1", "9.500e5", ""]);
        table.row(["6", "1.5e5"]);
        let text = screen::plain(&table.to_string());
        assert_eq!(
            text,
            "joint    k [N·m/rad]  note\njoint 1      9.500e5\n6              1.5e5\n"
        );
    }
}
