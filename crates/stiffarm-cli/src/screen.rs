//! Text for a terminal: styles are ours, everything else is shown and not obeyed.
//!
//! Names, quoted lines and file names come from anywhere, and an escape sequence
//! in one of them would be the terminal's command. So a style is wrapped in a
//! mark that nobody knows beforehand, and whatever stands outside such marks is
//! printed with its hidden characters in letters. This is the only place that
//! does it: all text for people goes through [`rendered`].

use anstyle::Style;
use std::borrow::Cow;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::LazyLock;
use stiffarm::findings::{is_hidden, visible};

/// Columns where nothing says how many there are.
const USUAL: usize = 80;
/// Columns that sentences take at least and at most.
const NARROWEST: usize = 40;
const WIDEST: usize = 100;

/// Two characters of private use, others in each run.
static MARK: LazyLock<String> = LazyLock::new(|| {
    let random = RandomState::new().build_hasher().finish();
    let private = |bits: u64| char::from_u32(0xF_0000 + (bits % 0xFFFE) as u32);
    [random, random >> 32].into_iter().filter_map(private).collect()
});

/// `text` in a style; what prints it drops the style where colours are not wanted.
pub fn paint(style: Style, text: &str) -> String {
    let mark = MARK.as_str();
    format!("{mark}{style}{mark}{text}{mark}{style:#}{mark}")
}

/// The text as a terminal may have it: our styles, line ends, tabs, and all
/// other hidden characters in letters.
pub fn rendered(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for (i, part) in text.split(MARK.as_str()).enumerate() {
        match i % 2 {
            0 => out += &shown(part),
            _ => out += part,
        }
    }
    out
}

/// The text without styles, as it is shown.
pub fn plain(text: &str) -> String {
    let parts = text.split(MARK.as_str()).step_by(2);
    parts.map(shown).collect()
}

/// Columns that sentences may take: all there are, but no more than can be read well.
pub fn columns() -> usize {
    all_columns().min(WIDEST)
}

/// Columns that tables may take: `COLUMNS`, else the terminal's, else 80.
pub fn all_columns() -> usize {
    let stated = std::env::var("COLUMNS").ok().and_then(|c| c.parse().ok());
    let terminal = || terminal_size::terminal_size().map(|(width, _)| usize::from(width.0));
    stated.or_else(terminal).unwrap_or(USUAL).max(NARROWEST)
}

/// Text whose lines all fit the terminal: tables do already, sentences are broken at spaces. What stands behind
/// a name stays behind it. Lines that are to be copied into a file stay whole.
pub fn fitted(text: &str) -> String {
    let (limit, readable) = (all_columns(), columns());
    let mut out = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let bare = line.strip_suffix('\n').unwrap_or(line);
        if width(bare) <= limit || bare.contains(" = [") {
            out += line;
            continue;
        }
        let indent = behind_a_name(bare).unwrap_or(2);
        let between = format!("\n{}", " ".repeat(indent));
        out += &lines_in(bare, readable, indent).join(&between);
        out += &line[bare.len()..];
    }
    out
}

/// Where the text begins that stands, after two spaces or more, behind a name.
fn behind_a_name(line: &str) -> Option<usize> {
    let at = line.find("  ").filter(|at| (1..=30).contains(at))?;
    let spaces = line[at..].chars().take_while(|c| *c == ' ').count();
    let name = &line[..at];
    (!name.contains(MARK.as_str())).then(|| width(name) + spaces)
}

/// Parts of a sentence, the first of `columns`, the others by `indent` less.
fn lines_in(sentence: &str, columns: usize, indent: usize) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut at = 0;
    for word in sentence.split(' ') {
        let word_width = width(word);
        if at > indent && at + 1 + word_width > columns {
            out.push(String::new());
            at = indent;
        } else if at > 0 || out.len() > 1 || !out[0].is_empty() {
            // Spaces within a line stay as many as they are.
            if !(out.len() > 1 && at == indent) {
                let last = out.len() - 1;
                out[last].push(' ');
                at += 1;
            }
        }
        let last = out.len() - 1;
        out[last] += word;
        at += word_width;
    }
    out
}

/// The text in lines of at most `columns`, broken at spaces; a word that is longer is broken too.
pub fn lines(text: &str, columns: usize) -> Vec<String> {
    let mut out = vec![String::new()];
    for word in text.split(' ') {
        let last = out.len() - 1;
        let word_width = width(word);
        let used = width(&out[last]);
        if used > 0 && used + 1 + word_width <= columns {
            out[last] = format!("{} {word}", out[last]);
            continue;
        }
        if used > 0 {
            out.push(String::new());
        }
        let last = out.len() - 1;
        out[last] = word.to_string();
        // A styled word stays whole: its marks must not be torn apart.
        while width(&out[out.len() - 1]) > columns && !word.contains(MARK.as_str()) {
            let long = out.pop().unwrap_or_default();
            let cut = long.char_indices().nth(columns).map_or(long.len(), |(at, _)| at);
            out.push(long[..cut].to_string());
            out.push(long[cut..].to_string());
        }
    }
    out
}

/// The sentence in lines of at most `columns`, those after the first indented. A word
/// that is longer stays whole.
pub fn wrapped(sentence: &str, columns: usize) -> String {
    lines_in(sentence, columns, 2).join("\n  ")
}

/// Columns that a text of one line takes, styles left out.
pub fn width(text: &str) -> usize {
    plain(text).chars().count()
}

/// Hidden characters in letters, but for line ends and tabs.
fn shown(text: &str) -> Cow<'_, str> {
    let is_layout = |c: char| c == '\n' || c == '\t';
    if !text.chars().any(|c| is_hidden(c) && !is_layout(c)) {
        return Cow::Borrowed(text);
    }
    let mut out = String::new();
    for c in text.chars() {
        if is_layout(c) { out.push(c) } else { out += &visible(c.encode_utf8(&mut [0; 4])) }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use anstyle::AnsiColor;

    #[test]
    fn sentences_wrap_at_words_and_styles_take_no_columns() {
        let red = AnsiColor::Red.on_default();
        let text = format!("{} and more words", paint(red, "one two"));
        assert_eq!(plain(&wrapped(&text, 11)), "one two and\n  more\n  words");
        assert_eq!(wrapped("short", 80), "short");
        assert_eq!(wrapped("averylongword b", 5), "averylongword\n  b");
    }

    #[test]
    fn long_lines_are_broken_and_tables_and_lines_to_copy_are_not() {
        let sentence = "word ".repeat(30);
        let sentence = sentence.trim_end();
        let table = "a  b\n1  2\n";
        let copied = format!("xyz_mm = [{}]\n", "1.5, ".repeat(30));
        let named = format!("limits    {sentence}\n");
        let text = format!("{table}{sentence}\n{copied}{named}");
        let shown = fitted(&text);
        assert!(shown.starts_with(table) && shown.contains(&copied), "{shown}");
        for line in shown.lines().filter(|line| !line.contains(" = [")) {
            assert!(width(line) <= 80, "{line}");
        }
        // Nothing is lost, and the rest of what is named stands below its beginning.
        let words = |text: &str| text.split_whitespace().map(String::from).collect::<Vec<_>>();
        assert_eq!(words(&shown), words(&text));
        assert!(shown.contains("limits    word word") && shown.contains("\n          word"), "{shown}");
    }

    #[test]
    fn styles_pass_and_escapes_of_others_are_shown() {
        let red = AnsiColor::Red.on_default();
        let text = format!("{}\n", paint(red, "a\u{1b}[2Jb"));
        assert_eq!(rendered(&text), format!("{red}a\\u{{1b}}[2Jb{red:#}\n"));
        assert_eq!(plain(&text), "a\\u{1b}[2Jb\n");
        let nested = paint(red, &paint(red, "x"));
        assert_eq!((plain(&nested).as_str(), width(&nested)), ("x", 1));
        assert_eq!(rendered("a\tb\u{202e}c\r\n"), "a\tb\\u{202e}c\\r\n");
    }
}
