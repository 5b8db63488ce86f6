//! Statements of RAPID, which end at `;` and not with the line.

use super::ProgramFile;
use super::cursor::Cursor;

/// What ends the words that are no instructions; all others end at `;`.
fn ends_at(word: &str) -> Option<&'static str> {
    Some(match word {
        "IF" | "ELSEIF" => "THEN",
        "FOR" | "WHILE" => "DO",
        "PROC" | "FUNC" => ")",
        "CASE" => ":",
        "MODULE" | "TRAP" | "RECORD" | "TEST" | "VERSION" | "LANGUAGE" => "\n",
        "ELSE" | "ENDIF" | "ENDFOR" | "ENDWHILE" | "ENDTEST" | "ENDPROC" | "ENDFUNC" | "ENDTRAP" | "ENDRECORD"
        | "ENDMODULE" | "ERROR" | "UNDO" | "BACKWARD" | "DEFAULT" => "",
        _ => return None,
    })
}

/// The statements of a module.
pub fn statements(file: &ProgramFile) -> Vec<Cursor<'_>> {
    let text = &file.text;
    let (mut all, mut at, mut line) = (Vec::new(), 0, 1);
    while at < text.len() {
        let rest = &text[at..];
        let first = rest.trim_start_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
        let begins = at + rest.len() - first.len();
        line += rest[..rest.len() - first.len()].matches('\n').count();
        let length = length_of(first);
        let one = Cursor::over(file, line, begins..begins + length);
        if length > 0 {
            all.push(if first.starts_with('!') { one } else { one.with_remarks('!') });
        }
        line += first[..length].matches('\n').count();
        at = begins + length;
    }
    all
}

/// Bytes of the statement that a text begins with.
fn length_of(text: &str) -> usize {
    let of_line = text.find('\n').unwrap_or(text.len());
    if text.starts_with(['!', '%']) {
        return of_line;
    }
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let mut begins = 0;
    let (word, behind) = loop {
        let rest = text[begins..].trim_start();
        begins = text.len() - rest.len();
        let word = rest[..rest.find(|c| !is_part(c)).unwrap_or(rest.len())].to_ascii_uppercase();
        begins += word.len();
        if !matches!(word.as_str(), "LOCAL" | "TASK") {
            break (word, begins);
        }
    };
    let next = text[behind..].trim_start();
    // Behind a label, or DEFAULT.
    let of_label = text.len() - next.len() + 1;
    let is_label = !word.is_empty() && next.starts_with(':') && !next.starts_with(":=");
    let end = match ends_at(&word) {
        Some("") if !is_label => return behind,
        Some("\n") => return of_line,
        Some("") | None if is_label => return of_label,
        Some(end) => end,
        None => ";",
    };
    let mut is_quoted = false;
    let mut is_remark = false;
    for (at, c) in text.char_indices().skip_while(|(at, _)| *at < behind) {
        match c {
            '\n' => is_remark = false,
            _ if is_remark => {}
            '"' => is_quoted = !is_quoted,
            _ if is_quoted => {}
            '!' => is_remark = true,
            // Also the instruction behind a condition without THEN.
            ';' => return at + 1,
            _ => {
                let here = &text.as_bytes()[at..];
                let is_end = here.len() >= end.len() && here[..end.len()].eq_ignore_ascii_case(end.as_bytes());
                let goes_on = |c: char| end.starts_with(char::is_alphabetic) && is_part(c);
                if is_end && !text[..at].ends_with(goes_on) && !text[at + end.len()..].starts_with(goes_on) {
                    return at + end.len();
                }
            }
        }
    }
    text.len()
}
