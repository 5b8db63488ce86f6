//! Texts and numbers as controllers take them.

use super::{Language, MoveKind, Program, ProgramOptions};
use crate::units::rad_to_deg;

/// Characters beside letters and digits that every controller shows and none takes for a quotation
/// mark, a placeholder or the end of a line.
const SHOWN: &str = " .,:?()+-/=_#";

/// The text in characters that every controller shows: accents are dropped, what has no such
/// character becomes `_`.
pub fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            c if c.is_ascii_alphanumeric() || SHOWN.contains(c) => out.push(c),
            c if c.is_control() => out.push(' '),
            'ä' | 'æ' => out.push_str("ae"),
            'ö' | 'ø' => out.push_str("oe"),
            'ü' => out.push_str("ue"),
            'Ä' | 'Æ' => out.push_str("Ae"),
            'Ö' | 'Ø' => out.push_str("Oe"),
            'Ü' => out.push_str("Ue"),
            'ß' => out.push_str("ss"),
            'à' | 'á' | 'â' | 'ã' | 'å' => out.push('a'),
            'è' | 'é' | 'ê' | 'ë' => out.push('e'),
            'ì' | 'í' | 'î' | 'ï' => out.push('i'),
            'ò' | 'ó' | 'ô' | 'õ' => out.push('o'),
            'ù' | 'ú' | 'û' => out.push('u'),
            'ç' => out.push('c'),
            'ñ' => out.push('n'),
            '°' => out.push_str(" deg"),
            '–' | '—' | '−' => out.push('-'),
            _ => out.push('_'),
        }
    }
    let words: Vec<&str> = out.split(' ').filter(|word| !word.is_empty()).collect();
    words.join(" ")
}

/// `text` in lines of at most `width` characters, broken at spaces where there are any. What is
/// joined with spaces again is the text, unless a word had to be broken.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in plain(text).split(' ') {
        let mut word = word;
        let last = lines.last().map_or(0, String::len);
        if last > 0 && last + 1 + word.len() > width {
            lines.push(String::new());
        }
        while word.len() > width {
            // All characters are ASCII by now.
            let (head, tail) = word.split_at(width);
            if let Some(line) = lines.last_mut() {
                line.push_str(head);
            }
            lines.push(String::new());
            word = tail;
        }
        if let Some(line) = lines.last_mut() {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines
}

/// What is said at a wait, in lines of at most `width` characters; never nothing.
pub fn said(text: &str, width: usize) -> Vec<String> {
    match plain(text).as_str() {
        "" => wrapped("Continue", width),
        text => wrapped(text, width),
    }
}

/// The header in comment lines of at most `width` characters, with what the language adds.
pub fn header(program: &Program, language: Language, width: usize) -> Vec<String> {
    let speed = format!("A speed of 100 per cent is {}.", language.speed_of());
    let lines = program.header.iter().chain([&speed]);
    let lines = lines.flat_map(|line| wrapped(line, width));
    lines.filter(|line| !line.is_empty()).collect()
}

/// A name of at most `width` characters.
pub fn name(name: &str, width: usize) -> String {
    let mut name = plain(name);
    name.truncate(width);
    name.trim_end().to_string()
}

/// What stands in a comment before a move.
pub fn marker(kind: MoveKind, posture: &str, width: usize) -> String {
    format!("{} {}", kind.as_str(), name(posture, width))
}

/// Kind and name in such a comment.
pub fn marked(comment: &str) -> Option<(MoveKind, String)> {
    let (word, name) = comment.trim().split_once(' ')?;
    let kind = MoveKind::ALL
        .into_iter()
        .find(|kind| kind.as_str() == word)?;
    Some((kind, name.trim().to_string()))
}

/// Decimals of the angles in degrees: as few as lose nothing, two at least, `most` at most.
pub fn decimals(program: &Program, most: usize) -> usize {
    let angles: Vec<f64> = program
        .moves()
        .flat_map(|m| m.q.iter().map(|a| rad_to_deg(*a)))
        .collect();
    let exact = |digits: usize| {
        let factor = 10f64.powi(digits as i32);
        // Degrees of an angle in radians are off by the last bits.
        angles
            .iter()
            .all(|a| (a * factor - (a * factor).round()).abs() < 1e-7)
    };
    (2..most).find(|digits| exact(*digits)).unwrap_or(most)
}

/// Degrees with `decimals`, in the controller's order; never `-0.00`.
pub fn degrees(q: &[f64], options: &ProgramOptions, decimals: usize) -> Vec<String> {
    let values = options.to_controller(q);
    values
        .iter()
        .map(|angle| fixed(rad_to_deg(*angle), decimals))
        .collect()
}

/// A number with fixed decimals; never `-0.00`.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text
        .trim_start_matches('-')
        .chars()
        .all(|c| c == '0' || c == '.')
    {
        true => text.trim_start_matches('-').to_string(),
        false => text,
    }
}

/// Lines with an end each: CR LF where the controller or its tools run on Windows.
pub fn joined(lines: &[String], end: &str) -> String {
    lines.iter().map(|line| format!("{line}{end}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn texts_keep_what_can_be_shown() {
        assert_eq!(plain("Größe \"A\";\n45°"), "Groesse _A__ 45 deg");
        assert_eq!(
            wrapped("measure unloaded, loaded", 10),
            ["measure", "unloaded,", "loaded"]
        );
        assert_eq!(wrapped("abcdefghij kl", 4), ["abcd", "efgh", "ij", "kl"]);
        assert_eq!(wrapped("", 4), [""]);
        assert_eq!(fixed(-0.001, 2), "0.00");
        assert_eq!(fixed(-0.006, 2), "-0.01");
    }

    proptest! {
        #[test]
        fn lines_are_short_and_together_the_text(text in ".{0,120}", width in 1usize..40) {
            let lines = wrapped(&text, width);
            prop_assert!(lines.iter().all(|line| line.len() <= width));
            prop_assert!(lines.iter().all(|line| line.chars().all(|c| c.is_ascii_alphanumeric() || SHOWN.contains(c))));
            let letters = |text: &str| text.replace(' ', "");
            prop_assert_eq!(letters(&lines.concat()), letters(&plain(&text)));
        }
    }
}
