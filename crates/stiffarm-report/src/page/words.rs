//! Sentences of a page.

use crate::figure::svg::escape;
use crate::summary::{Number, Piece, Text};
use stiffarm::units::sentence_with_minus;

/// Longest code that stays on one line \[characters\]; narrow screens have room for it.
const UNBROKEN: usize = 26;

/// Words in which numbers of the result keep their full value.
pub(super) fn text(text: &Text) -> String {
    pieces(text, together)
}

/// The same in a cell of a table, where words may be a name from a file: its signs stay.
pub(super) fn cell(text: &Text) -> String {
    pieces(text, unbroken)
}

fn pieces(text: &Text, shown: fn(&str) -> String) -> String {
    let pieces = text.0.iter().map(|piece| match piece {
        Piece::Words(words) => shown(words),
        Piece::Strong(words) => format!("<strong>{}</strong>", shown(words)),
        Piece::Code(words) => code(words),
        Piece::Link(words, anchor) => {
            format!("<a href=\"#{}\">{}</a>", escape(anchor), escape(words))
        }
        Piece::Different(words) => format!("<span class=\"different\">{}</span>", escape(words)),
        Piece::Number(number) => number_html(number),
    });
    pieces.collect()
}

/// Words of a sentence, with the minus of numbers.
fn together(words: &str) -> String {
    unbroken(&sentence_with_minus(words))
}

/// Words in which no line ends between a number and its % or ±.
fn unbroken(words: &str) -> String {
    let words = words.replace("± ", "±\u{a0}").replace(" %", "\u{a0}%");
    escape(&words)
}

/// What one types; short words of it are not broken at their hyphens.
fn code(words: &str) -> String {
    let class = if words.chars().count() <= UNBROKEN { " class=\"short\"" } else { "" };
    format!("<code{class}>{}</code>", escape(words))
}

/// A number with its full value, where the result has it.
fn number_html(number: &Number) -> String {
    let shown = escape(&number.text());
    if !number.is_of_result {
        return format!("<span class=\"n\">{shown}</span>");
    }
    // JSON's own writing of the value, `null` where there is none.
    let value = serde_json::to_string(&number.value).unwrap_or_default();
    let factor = if number.factor == 1.0 { String::new() } else { format!(" data-factor=\"{}\"", number.factor) };
    format!("<span class=\"n\" data-value=\"{value}\"{factor}>{shown}</span>")
}

/// A sentence in which what one types stands in backticks.
pub(super) fn prose(sentence: &str) -> String {
    let pieces: Vec<&str> = sentence.split('`').collect();
    // A backtick without its partner is a character like any other.
    if pieces.len().is_multiple_of(2) {
        return together(sentence);
    }
    let pieces = pieces.iter().enumerate().map(|(i, piece)| match i % 2 {
        0 => together(piece),
        _ => code(piece),
    });
    pieces.collect()
}
