//! Texts in characters that every controller shows.

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
