//! Estimated text widths, and fitting texts into a width.
//!
//! The renderer does not know which font of the family list will be used.
//! The estimate follows the widest of them (DejaVu Sans), so that a text that
//! is judged to fit does fit in the others too.

/// How much wider bold text is.
pub(super) const BOLD: f64 = 1.1;

/// Approximate width of a text in pixels.
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().map(advance).sum::<f64>() * size
}

/// Width of one character in units of the font size.
fn advance(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '\'' => 0.28,
        'I' | ' ' | '.' | ',' | ':' | ';' | '|' | '/' | '\\' => 0.33,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '-' | '!' => 0.40,
        'm' | 'M' | 'w' | 'W' | '@' | '%' => 0.96,
        '+' | '=' | '<' | '>' | '×' | '±' | '−' | '–' => 0.84,
        'A'..='Z' => 0.70,
        'a'..='z' | '0'..='9' => 0.62,
        // Ideographs and symbols are about as wide as high.
        '\u{2190}'.. => 1.0,
        _ => 0.68,
    }
}

/// The text, shortened with an ellipsis if it is wider than `limit`.
pub(super) fn shorten(text: &str, size: f64, limit: f64) -> String {
    if width(text, size) <= limit {
        return text.to_owned();
    }
    let mut out = String::new();
    let mut used = width("…", size);
    for c in text.chars() {
        used += advance(c) * size;
        if used > limit {
            break;
        }
        out.push(c);
    }
    let mut out = out.trim_end().to_owned();
    out.push('…');
    out
}

/// The text in lines of at most `limit` pixels, broken at spaces, but for those of a unit in brackets that fits. A word
/// that is wider by itself is shortened, and so is the end of the last line when
/// `most` lines do not suffice.
pub(super) fn wrap(text: &str, size: f64, limit: f64, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words(text, size, limit) {
        if let Some(line) = lines.last_mut() {
            let joined = format!("{line} {word}");
            if width(&joined, size) <= limit {
                *line = joined;
                continue;
            }
        }
        lines.push(word);
    }
    let most = most.max(1);
    if lines.len() > most {
        let rest = lines.split_off(most - 1).join(" ");
        lines.push(rest);
    }
    lines.iter().map(|l| shorten(l, size, limit)).collect()
}

/// The words of a text. Those from `[` to `]` are one, where that fits into a line.
fn words(text: &str, size: f64, limit: f64) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut rest = text.split_whitespace();
    while let Some(word) = rest.next() {
        words.push(word.to_owned());
        if !word.starts_with('[') || word.ends_with(']') {
            continue;
        }
        let mut unit = word.to_owned();
        let mut after = rest.clone();
        for next in after.by_ref() {
            unit = format!("{unit} {next}");
            if next.ends_with(']') {
                break;
            }
        }
        if unit.ends_with(']') && width(&unit, size) <= limit {
            words.pop();
            words.push(unit);
            rest = after;
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_stays_on_one_line() {
        assert_eq!(wrap("uncertainty [% of k]", 10.0, 80.0, 3), ["uncertainty", "[% of k]"]);
        // Brackets that do not close, or that do not fit, are words like others.
        assert_eq!(wrap("a [b c", 10.0, 20.0, 3), ["a [b", "c"]);
        assert_eq!(wrap("[bb cc dd]", 10.0, 36.0, 3), ["[bb cc", "dd]"]);
    }

    #[test]
    fn wrapping_keeps_every_word_that_fits() {
        assert_eq!(wrap("one two three", 10.0, 60.0, 3), vec!["one two", "three"]);
        assert_eq!(wrap("short", 10.0, 100.0, 1), vec!["short"]);
        assert!(wrap("", 10.0, 100.0, 2).is_empty());
    }

    #[test]
    fn what_does_not_fit_is_marked() {
        let lines = wrap("alpha beta gamma delta", 10.0, 40.0, 2);
        assert_eq!(lines.len(), 2);
        assert!(lines[1].ends_with('…'));
        assert!(lines.iter().all(|l| width(l, 10.0) <= 40.0));
        assert!(shorten("incomprehensibilities", 10.0, 50.0).ends_with('…'));
    }
}
