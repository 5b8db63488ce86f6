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
        let mut table = Table { headings: headings.collect(), rows: Vec::new() };
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
        self.rows.push(fields.map(|field| field.replace('\n', "\\n")).collect());
    }

    /// Columns that the fields below a heading take.
    fn field_width(&self, column: usize) -> usize {
        let fields = self.rows.iter().filter_map(|row| row.get(column));
        fields.map(|field| screen::width(field)).max().unwrap_or(0)
    }
}

/// What fills a field up to `width`.
fn space(field: &str, width: usize) -> String {
    " ".repeat(width.saturating_sub(screen::width(field)))
}

impl Table {
    /// Widths of the columns: what they hold, and where that is more than `limit` narrower, first those whose
    /// heading is much wider than what stands below it, then those of words.
    fn widths(&self, limit: usize) -> Vec<usize> {
        let fields: Vec<usize> = (0..self.headings.len()).map(|c| self.field_width(c)).collect();
        let headings = self.headings.iter().map(|(heading, _)| screen::width(heading));
        let mut widths: Vec<usize> = headings.zip(&fields).map(|(h, f)| h.max(*f)).collect();
        let room = limit.saturating_sub(BETWEEN * widths.len().saturating_sub(1));
        let longest_word = |text: &str| text.split(' ').map(screen::width).max().unwrap_or(0);
        let least: Vec<usize> =
            self.headings.iter().zip(&fields).map(|((heading, _), field)| longest_word(heading).max(*field)).collect();
        narrow(&mut widths, &least, room);
        let of_words = |(column, (heading, align)): (usize, &(String, Align))| {
            if column > 0 && *align == Align::Left {
                NARROWEST.max(longest_word(heading)).min(least[column])
            } else {
                least[column]
            }
        };
        let least: Vec<usize> = self.headings.iter().enumerate().map(of_words).collect();
        let whole = widths.clone();
        narrow(&mut widths, &least, room);
        if widths.iter().sum::<usize>() <= room {
            return widths;
        }
        // Blocks are needed anyway, and have room for whole columns, but for sentences.
        let first = whole.first().copied().unwrap_or(0);
        let most = limit.saturating_sub(first + BETWEEN).max(NARROWEST);
        let columns = whole.iter().zip(&least).enumerate();
        columns
            .map(|(column, (whole, least))| match column {
                0 => *whole,
                _ => (*whole).min(most).max(*least),
            })
            .collect()
    }

    /// The columns in blocks that fit `limit`, each with the first column before its own: one block where
    /// all of them fit.
    fn blocks(&self, limit: usize) -> Vec<Block> {
        let widths = self.widths(limit);
        let lead = 1.min(widths.len());
        let mut blocks = vec![Block::of(&widths, 0..lead)];
        for column in lead..widths.len() {
            let last = blocks.len() - 1;
            let fits = blocks[last].width() + BETWEEN + widths[column] <= limit;
            if !fits && blocks[last].columns.len() > lead {
                blocks.push(Block::of(&widths, 0..lead));
            }
            let last = blocks.len() - 1;
            blocks[last].columns.push((column, widths[column]));
        }
        blocks
    }

    /// One line of a block for each line of its longest field.
    fn lines(&self, block: &Block, fields: &[String], is_heading: bool) -> String {
        let broken: Vec<Vec<String>> = block
            .columns
            .iter()
            .map(|(column, width)| {
                let field = fields.get(*column).map_or("", String::as_str);
                if screen::width(field) > *width { screen::lines(field, *width) } else { vec![field.to_string()] }
            })
            .collect();
        let height = broken.iter().map(Vec::len).max().unwrap_or(1);
        let style = if is_heading { Style::new().bold() } else { Style::new() };
        let mut out = String::new();
        for at in 0..height {
            let padded = block.columns.iter().zip(&broken).map(|((column, width), lines)| {
                // Headings stand on what they head.
                let above = if is_heading { height - lines.len() } else { 0 };
                let at = at.checked_sub(above);
                let field = at.and_then(|at| lines.get(at)).map_or("", String::as_str);
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
            let rows = rows.map(|row| self.lines(block, row, false));
            self.lines(block, &headings, true) + &rows.collect::<String>()
        });
        shown.collect::<Vec<_>>().join("\n")
    }
}

/// Narrows the widest columns first, down to `least` each, until they take `room` together.
fn narrow(widths: &mut [usize], least: &[usize], room: usize) {
    while widths.iter().sum::<usize>() > room {
        let excess = |column: &usize| widths[*column].saturating_sub(least[*column]);
        let widest = (0..widths.len()).filter(|c| excess(c) > 0).max_by_key(|c| (excess(c), *c));
        let Some(column) = widest else { return };
        widths[column] -= 1;
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
    fn of(widths: &[usize], columns: std::ops::Range<usize>) -> Self {
        Block { columns: columns.map(|column| (column, widths[column])).collect() }
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
        assert_eq!(text, "joint    k [N·m/rad]  note\njoint 1      9.500e5\n6              1.5e5\n");
    }

    #[test]
    fn a_wide_table_is_told_in_blocks_and_sentences_in_lines() {
        let mut table = Table::new(["joint", "first [mm]", "second [mm]", "between"]);
        table.align(3, Align::Left);
        table.row(["joint 1", "1.5", "22.5", "a sentence of a few words, and more"]);
        table.row(["joint 2", "2.5", "3", ""]);
        let fitted = |limit| screen::plain(&table.fitted(limit));
        assert_eq!(
            fitted(62),
            "           first   second\njoint       [mm]     [mm]  between\n\
             joint 1      1.5     22.5  a sentence of a few words, and more\n\
             joint 2      2.5        3\n"
        );
        // Headings are broken before words are.
        assert_eq!(
            fitted(47),
            "         first  second\njoint     [mm]    [mm]  between\n\
             joint 1    1.5    22.5  a sentence of a few\n                        words, and more\n\
             joint 2    2.5       3\n"
        );
        assert_eq!(
            fitted(34),
            "         first  second\njoint     [mm]    [mm]\njoint 1    1.5    22.5\njoint 2    2.5       3\n\n\
             joint    between\njoint 1  a sentence of a few\n         words, and more\njoint 2\n"
        );
        for limit in 30..90 {
            assert!(fitted(limit).lines().all(|line| screen::width(line) <= limit), "{limit}");
        }
    }
}
