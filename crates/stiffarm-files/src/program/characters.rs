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
