//! The lines of a file that an error is about, drawn with the place marked.

use crate::screen::paint;
use anstyle::{AnsiColor, Style};
use std::ops::Range;
use stiffarm::findings::visible;
use unicode_width::UnicodeWidthChar;

/// Columns between tab stops.
const TAB: usize = 4;

/// Columns of a line that are drawn; a line may be as long as its file.
const WIDEST: usize = 400;

/// Columns that are drawn before a place far to the right.
const BEFORE: usize = 40;

/// Draws the line that `span` (bytes of `text`) begins on, with its neighbours
/// and the place marked: from the span's start to its end or the end of the
/// line, with `label` below. An empty span is one arrow. Of a long line the part
/// about the place is drawn.
pub fn excerpt(file: &str, text: &str, span: Range<usize>, label: Option<&str>) -> String {
    let start = span.start.min(text.len());
    // Behind the last line end there is no further line: its end is meant.
    let at = text[..start].matches('\n').count();
    let at = at.min(text.lines().count().saturating_sub(1));
    let first = at.saturating_sub(1);
    let lines: Vec<&str> = text.lines().skip(first).take(at + 2 - first).collect();
    let line = lines.get(at - first).copied().unwrap_or_default();
    let offset = line.as_ptr() as usize - text.as_ptr() as usize;
    let from = start.saturating_sub(offset).min(line.len());
    let to = span.end.saturating_sub(offset).clamp(from, line.len());
    let (before, inside) = (drawn(&line[..from], 0), &line[from..to]);
    let (left, column) = (width(&before), line[..from].chars().count());
    let right = left + width(&drawn(inside, left));
    let cut = left.saturating_sub(BEFORE);
    let cut = if left < WIDEST - BEFORE { 0 } else { cut };

    let digits = (first + lines.len()).to_string().len();
    let blank = " ".repeat(digits);
    let place = format!("{file}:{}:{}", at + 1, column + 1);
    let link = AnsiColor::Cyan.on_default().bold().underline();
    let mut out = format!(" {blank} ╭─[{}]\n", paint(link, &place));
    for (i, line) in (first..).zip(lines) {
        let number = paint(Style::new().dimmed(), &format!("{:>digits$}", i + 1));
        out += &format!(" {number} │ {}\n", window(&drawn(line, 0), cut));
        if i == at {
            let end = (right - cut).min(WIDEST).max(left - cut);
            out += &marks(&format!(" {blank} · "), left - cut..end, label);
        }
    }
    out + &format!(" {blank} ╰────\n")
}

/// The part of a drawn line from column `cut` on.
fn window(line: &str, cut: usize) -> String {
    let mut out = String::new();
    let mut column = 0;
    for c in line.chars() {
        let next = column + c.width().unwrap_or(0);
        if column >= cut && next > cut + WIDEST {
            out.push('…');
            break;
        }
        match column {
            // A wide character that the cut goes through leaves a space.
            column if column >= cut => out.push(if cut > 0 && column == cut { '…' } else { c }),
            _ if next > cut => out.push('…'),
            _ => {}
        }
        column = next;
    }
    out
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
    format!("{margin}{indent}{}\n{margin}{below}{}\n", mark(&line), mark(&format!("╰── {label}")))
}

/// What marks a place.
fn mark(text: &str) -> String {
    paint(AnsiColor::Magenta.on_default().bold(), text)
}

/// Columns that a drawn text takes on a terminal.
fn width(text: &str) -> usize {
    text.chars().map(|c| c.width().unwrap_or(0)).sum()
}

/// The text as it is drawn behind `before` columns: tabs as spaces and hidden
/// characters in letters, so that the marks stand below their place.
fn drawn(text: &str, before: usize) -> String {
    let mut out = String::new();
    let mut column = before;
    for c in text.chars() {
        let end = out.len();
        match c {
            '\t' => out += &" ".repeat(TAB - column % TAB),
            c => out += &visible(c.encode_utf8(&mut [0; 4])),
        }
        column += width(&out[end..]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is drawn, without colours.
    fn picture(text: &str, span: Range<usize>, label: Option<&str>) -> String {
        let drawn = excerpt("a.csv", text, span, label);
        crate::screen::plain(&drawn)
    }

    #[test]
    fn the_place_is_marked_below_its_line() {
        assert_eq!(
            picture("a,b\r\n1,22x\r\n2,3\r\n4,5\r\n", 7..10, Some("b")),
            "   ╭─[a.csv:2:3]\n 1 │ a,b\n 2 │ 1,22x\n   ·   ─┬─\n   ·    ╰── b\n 3 │ 2,3\n   ╰────\n"
        );
        assert_eq!(picture("one", 0..3, None), "   ╭─[a.csv:1:1]\n 1 │ one\n   · ───\n   ╰────\n");
    }

    #[test]
    fn tabs_and_wide_characters_take_their_columns() {
        let text = "\t漢 x";
        let at = text.len() - 1;
        assert_eq!(
            picture(text, at..at + 1, Some("k")),
            "   ╭─[a.csv:1:4]\n 1 │     漢 x\n   ·        ┬\n   ·        ╰── k\n   ╰────\n"
        );
    }

    #[test]
    fn a_span_over_lines_is_marked_to_the_end_of_the_first() {
        assert_eq!(
            picture("k = [\n1,\n2]\n", 4..11, Some("k")),
            "   ╭─[a.csv:1:5]\n 1 │ k = [\n   ·     ┬\n   ·     ╰── k\n 2 │ 1,\n   ╰────\n"
        );
    }

    #[test]
    fn the_end_of_the_file_belongs_to_its_last_line() {
        for text in ["k = \"", "k = \"\n"] {
            assert_eq!(
                picture(text, text.len()..text.len(), None),
                "   ╭─[a.csv:1:6]\n 1 │ k = \"\n   ·      ▲\n   ╰────\n"
            );
        }
        assert_eq!(picture("", 0..0, None), "   ╭─[a.csv:1:1]\n   ╰────\n");
    }

    #[test]
    fn a_line_as_long_as_its_file_is_drawn_about_the_place() {
        let text = format!("{},x1,{}\nb\n", "1".repeat(1_000_000), "2".repeat(1_000_000));
        let picture = picture(&text, 1_000_001..1_000_003, Some("q"));
        assert!(picture.len() < 2000, "{picture}");
        let lines: Vec<&str> = picture.lines().collect();
        let column = |line: &str, what: &str| line.split(what).next().map(|s| s.chars().count());
        assert_eq!(column(lines[1], "x1"), column(lines[2], "─┬"));
        assert!(lines[0].contains(":1:1000002"), "{picture}");
        let all = super::excerpt("a", &text, 0..text.len(), None);
        assert!(all.len() < 4000, "{all}");
    }

    #[test]
    fn hidden_characters_are_drawn_in_letters() {
        let drawn = picture("a\u{1b}[31m,x\rb", 7..8, None);
        assert!(drawn.contains(" 1 │ a\\u{1b}[31m,x\\rb\n   ·             ─\n"), "{drawn}");
    }

    #[test]
    fn line_numbers_are_as_wide_as_the_largest() {
        let text = "\n".repeat(8) + "x\ny\n";
        let drawn = picture(&text, 8..9, None);
        assert!(drawn.starts_with("    ╭─[a.csv:9:1]\n  8 │ \n  9 │ x\n    · ─\n 10 │ y\n"));
    }
}
