//! The lines of a file that an error is about, drawn with the place marked.

use crate::table::paint;
use anstyle::{AnsiColor, Style};
use std::ops::Range;
use unicode_width::UnicodeWidthChar;

/// Columns between tab stops.
const TAB: usize = 4;

/// Draws the line that `span` (bytes of `text`) begins on, with its neighbours
/// and the place marked: from the span's start to its end or the end of the
/// line, with `label` below. An empty span is one arrow.
pub fn excerpt(file: &str, text: &str, span: Range<usize>, label: Option<&str>) -> String {
    let start = span.start.min(text.len());
    let lines: Vec<&str> = text.lines().collect();
    // Behind the last line end there is no further line: its end is meant.
    let at = text[..start].matches('\n').count();
    let at = at.min(lines.len().saturating_sub(1));
    let line = lines.get(at).copied().unwrap_or_default();
    let offset = line.as_ptr() as usize - text.as_ptr() as usize;
    let from = start.saturating_sub(offset).min(line.len());
    let to = span.end.saturating_sub(offset).clamp(from, line.len());
    let (left, column) = (width(&line[..from]), line[..from].chars().count());
    let right = left + width_behind(&line[from..to], left);

    let shown = at.saturating_sub(1)..(at + 2).min(lines.len());
    let digits = shown.end.to_string().len();
    let blank = " ".repeat(digits);
    let place = format!("{file}:{}:{}", at + 1, column + 1);
    let link = AnsiColor::Cyan.on_default().bold().underline();
    let mut out = format!(" {blank} ╭─[{}]\n", paint(link, &place));
    for i in shown {
        let number = paint(Style::new().dimmed(), &format!("{:>digits$}", i + 1));
        out += &format!(" {number} │ {}\n", without_tabs(lines[i]));
        if i == at {
            out += &marks(&format!(" {blank} · "), left..right, label);
        }
    }
    out + &format!(" {blank} ╰────\n")
}

/// The line below the text, and one more for a label.
fn marks(margin: &str, columns: Range<usize>, label: Option<&str>) -> String {
    let indent = " ".repeat(columns.start);
    if columns.is_empty() {
        return format!("{margin}{indent}{}\n", mark("▲"));
    }
    let Some(label) = label else {
        return format!("{margin}{indent}{}\n", mark(&"─".repeat(columns.len())));
    };
    let before = columns.len() / 2;
    let after = columns.len() - before - 1;
    let line = format!("{}┬{}", "─".repeat(before), "─".repeat(after));
    let below = " ".repeat(columns.start + before);
    format!(
        "{margin}{indent}{}\n{margin}{below}{}\n",
        mark(&line),
        mark(&format!("╰── {label}"))
    )
}

/// What marks a place.
fn mark(text: &str) -> String {
    paint(AnsiColor::Magenta.on_default().bold(), text)
}

/// Columns that a text takes on a terminal.
fn width(text: &str) -> usize {
    width_behind(text, 0)
}

/// Columns that a text takes behind `before` others.
fn width_behind(text: &str, before: usize) -> usize {
    let end = text.chars().fold(before, |column, c| match c {
        '\t' => (column / TAB + 1) * TAB,
        c => column + c.width().unwrap_or(0),
    });
    end - before
}

/// The text with its tabs as spaces, so that the marks stand below their place.
fn without_tabs(text: &str) -> String {
    let mut out = String::new();
    let mut column = 0;
    for c in text.chars() {
        let next = column + width_behind(c.encode_utf8(&mut [0; 4]), column);
        match c {
            '\t' => out += &" ".repeat(next - column),
            c => out.push(c),
        }
        column = next;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is drawn, without colours.
    fn drawn(text: &str, span: Range<usize>, label: Option<&str>) -> String {
        let drawn = excerpt("a.csv", text, span, label);
        anstream::adapter::strip_str(&drawn).to_string()
    }

    #[test]
    fn the_place_is_marked_below_its_line() {
        assert_eq!(
            drawn("a,b\r\n1,22x\r\n2,3\r\n4,5\r\n", 7..10, Some("b")),
            "   ╭─[a.csv:2:3]\n 1 │ a,b\n 2 │ 1,22x\n   ·   ─┬─\n   ·    ╰── b\n 3 │ 2,3\n   ╰────\n"
        );
        assert_eq!(
            drawn("one", 0..3, None),
            "   ╭─[a.csv:1:1]\n 1 │ one\n   · ───\n   ╰────\n"
        );
    }

    #[test]
    fn tabs_and_wide_characters_take_their_columns() {
        let text = "\t漢 x";
        let at = text.len() - 1;
        assert_eq!(
            drawn(text, at..at + 1, Some("k")),
            "   ╭─[a.csv:1:4]\n 1 │     漢 x\n   ·        ┬\n   ·        ╰── k\n   ╰────\n"
        );
    }

    #[test]
    fn a_span_over_lines_is_marked_to_the_end_of_the_first() {
        assert_eq!(
            drawn("k = [\n1,\n2]\n", 4..11, Some("k")),
            "   ╭─[a.csv:1:5]\n 1 │ k = [\n   ·     ┬\n   ·     ╰── k\n 2 │ 1,\n   ╰────\n"
        );
    }

    #[test]
    fn the_end_of_the_file_belongs_to_its_last_line() {
        for text in ["k = \"", "k = \"\n"] {
            assert_eq!(
                drawn(text, text.len()..text.len(), None),
                "   ╭─[a.csv:1:6]\n 1 │ k = \"\n   ·      ▲\n   ╰────\n"
            );
        }
        assert_eq!(drawn("", 0..0, None), "   ╭─[a.csv:1:1]\n   ╰────\n");
    }

    #[test]
    fn line_numbers_are_as_wide_as_the_largest() {
        let text = "\n".repeat(8) + "x\ny\n";
        let drawn = drawn(&text, 8..9, None);
        assert!(drawn.starts_with("    ╭─[a.csv:9:1]\n  8 │ \n  9 │ x\n    · ─\n 10 │ y\n"));
    }
}
