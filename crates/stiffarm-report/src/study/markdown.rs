//! Text in Markdown that stays text, whatever names it holds.

use stiffarm::findings::visible;

/// A sentence or a name: no tags, links, emphasis, code or headings of its own.
pub(super) fn text(text: &str) -> String {
    let text = visible(text);
    let characters: Vec<char> = text.chars().collect();
    let at = |i: usize| characters.get(i).copied().unwrap_or(' ');
    let mut out = String::with_capacity(text.len());
    for (i, &c) in characters.iter().enumerate() {
        let before = match i {
            0 => ' ',
            i => at(i - 1),
        };
        match c {
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '&' => out += "&amp;",
            // A bare address becomes a link on many pages.
            ':' if at(i + 1) == '/' && at(i + 2) == '/' => out += "&#58;",
            '.' if i >= 3 && (i - 3..i).all(|j| at(j).eq_ignore_ascii_case(&'w')) => {
                out += "&#46;";
            }
            '\\' | '`' | '*' | '~' => out.extend(['\\', c]),
            // Inside a word it is a letter: k(J_N).
            '_' if !(before.is_alphanumeric() && at(i + 1).is_alphanumeric()) => out += "\\_",
            '(' | '[' if before == ']' => out.extend(['\\', c]),
            '#' | '+' | '-' | '=' | '[' | '|' if i == 0 => out.extend(['\\', c]),
            c => out.push(c),
        }
    }
    out
}

/// The same in a cell of a table.
pub(super) fn cell(name: &str) -> String {
    // `text` has written a bar at the beginning already.
    let text = text(name);
    match text.strip_prefix("\\|") {
        Some(rest) => format!("\\|{}", rest.replace('|', "\\|")),
        None => text.replace('|', "\\|"),
    }
}

/// Lines between fences, which no backticks among them end.
pub(super) fn fenced(text: &str) -> String {
    let text = visible(text);
    let mut longest = 0;
    let mut run = 0;
    for c in text.chars() {
        run = if c == '`' { run + 1 } else { 0 };
        longest = longest.max(run);
    }
    let fence = "`".repeat(3.max(longest + 1));
    format!("{fence}\n{text}\n{fence}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_sentences_stay_as_they_are() {
        let sentence = "k(J_N) ignores q1 (at |k̂ − k|/k = 5 %): 1.5 mm, bound [%].";
        assert_eq!(text(sentence), sentence);
        assert_eq!(cell("q1 [°]"), "q1 [°]");
    }

    #[test]
    fn markup_in_names_is_text() {
        let cases = [
            ("<script>x</script>", "&lt;script&gt;x&lt;/script&gt;"),
            ("a|b", "a\\|b"),
            ("|b", "\\|b"),
            ("# heading", "\\# heading"),
            ("[x](http://a.b)", "\\[x]\\(http&#58;//a.b)"),
            ("a [x][y]", "a [x]\\[y]"),
            ("*a* _b_ `c` ~d~", "\\*a\\* \\_b\\_ \\`c\\` \\~d\\~"),
            ("a\nb\u{202e}", "a\\\\nb\\\\u{202e}"),
            ("&lt;", "&amp;lt;"),
            ("- item", "\\- item"),
        ];
        for (name, wanted) in cases {
            assert_eq!(cell(name), wanted, "{name}");
        }
        assert!(text("see www.example.com").contains("www&#46;example"));
        assert_eq!(fenced("a ```` b"), "`````\na ```` b\n`````");
    }
}
