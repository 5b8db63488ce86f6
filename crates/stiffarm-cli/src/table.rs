//! Tables for people: numbers right-aligned under their units.

use crate::screen;
use anstyle::{AnsiColor, Style};
use std::fmt;

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

impl Table {
    /// The columns in blocks that fit `limit`, each with the first column before its own: one block where
    /// all of them fit. A last column of sentences is broken into lines where it has room for that.
    fn blocks(&self, limit: usize) -> Vec<Block> {
        let widths: Vec<usize> = (0..self.headings.len()).map(|c| self.width(c)).collect();
        let mut blocks: Vec<Block> = Vec::new();
        for (column, width) in widths.iter().enumerate() {
            let last = blocks.last_mut();
            let is_first = column == 0;
            let is_sentence =
                column + 1 == widths.len() && self.headings[column].1 == Align::Left && !is_first;
            if let Some(block) = last {
                let left = limit.saturating_sub(block.width() + BETWEEN);
                if *width <= left {
                    block.push(column, *width);
                    continue;
                }
                if is_sentence && left >= NARROWEST {
                    block.push(column, left);
                    continue;
                }
            }
            let mut block = Block::default();
            if !is_first {
                block.push(0, widths[0]);
            }
            let left = limit.saturating_sub(block.width() + BETWEEN);
            block.push(
                column,
                match is_sentence && left >= NARROWEST {
                    true => left.min(*width),
                    false => *width,
                },
            );
            // The first column alone is no block.
            match blocks.last_mut() {
                Some(only) if only.columns.len() == 1 => *only = block,
                _ => blocks.push(block),
            }
        }
        blocks
    }

    /// One line of a block for each line of its longest field.
    fn lines(&self, block: &Block, fields: &[String], style: Style) -> String {
        let broken: Vec<Vec<String>> = block
            .columns
            .iter()
            .map(|(column, width)| {
                let field = fields.get(*column).map_or("", String::as_str);
                match screen::width(field) > *width {
                    true => screen::lines(field, *width),
                    false => vec![field.to_string()],
                }
            })
            .collect();
        let height = broken.iter().map(Vec::len).max().unwrap_or(1);
        let mut out = String::new();
        for at in 0..height {
            let padded = block
                .columns
                .iter()
                .zip(&broken)
                .map(|((column, width), lines)| {
                    let field = lines.get(at).map_or("", String::as_str);
                    match self.headings[*column].1 {
                        Align::Left => format!("{field}{}", space(field, *width)),
                        Align::Right => format!("{}{field}", space(field, *width)),
                    }
                });
            let line = padded.collect::<Vec<_>>().join(&" ".repeat(BETWEEN));
            out += &paint(style, line.trim_end());
            out.push('\n');
        }
        out
    }

    /// The table in `limit` columns.
    fn fitted(&self, limit: usize) -> String {
        let headings: Vec<String> = self.headings.iter().map(|(h, _)| h.clone()).collect();
        let blocks = self.blocks(limit);
        let shown = blocks.iter().map(|block| {
            let rows = self.rows.iter();
            let rows = rows.map(|row| self.lines(block, row, Style::new()));
            self.lines(block, &headings, Style::new().bold()) + &rows.collect::<String>()
        });
        shown.collect::<Vec<_>>().join("\n")
    }
}

/// Spaces between columns.
const BETWEEN: usize = 2;
/// Columns of a terminal that sentences are broken to at least.
const NARROWEST: usize = 20;

/// Columns of a table side by side, with their widths.
#[derive(Debug, Default)]
struct Block {
    columns: Vec<(usize, usize)>,
}

impl Block {
    fn push(&mut self, column: usize, width: usize) {
        self.columns.push((column, width));
    }

    fn width(&self) -> usize {
        let widths: usize = self.columns.iter().map(|(_, width)| width).sum();
        widths + BETWEEN * self.columns.len().saturating_sub(1)
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.fitted(screen::all_columns()))
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

    #[test]
    fn a_wide_table_is_told_in_blocks_and_sentences_in_lines() {
        let mut table = Table::new(["joint", "first [mm]", "second [mm]", "between"]);
        table.align(3, Align::Left);
        table.row([
            "joint 1",
            "1.5",
            "22.5",
            "a sentence of a few words, and more",
        ]);
        table.row(["joint 2", "2.5", "3", ""]);
        let fitted = |limit| screen::plain(&table.fitted(limit));
        assert_eq!(
            fitted(56),
            "joint    first [mm]  second [mm]  between\n\
             joint 1         1.5         22.5  a sentence of a few\n                                  \
             words, and more\n\
             joint 2         2.5            3\n"
        );
        assert_eq!(
            fitted(40),
            "joint    first [mm]  second [mm]\njoint 1         1.5         22.5\njoint 2         2.5            3\n\n\
             joint    between\njoint 1  a sentence of a few words, and\n         more\njoint 2\n"
        );
        for limit in 30..90 {
            assert!(
                fitted(limit)
                    .lines()
                    .all(|line| screen::width(line) <= limit),
                "{limit}"
            );
        }
    }
}
