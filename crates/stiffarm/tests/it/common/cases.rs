//! Tables of cases in text files, reports of slips and of findings.

use stiffarm::Code;
use stiffarm::findings::Finding;

/// One case a line, its `N` columns with ` => ` between them; `\n` and `\\` as in Rust. Headings begin with `##`.
pub fn cases<const N: usize>(text: &str) -> Vec<[String; N]> {
    let lines = text.lines().filter(|line| !line.is_empty() && !line.starts_with("##"));
    let columns = |line: &str| -> [String; N] {
        let parts = line.split(" =>").map(|part| part.strip_prefix(' ').unwrap_or(part));
        let parts: Vec<String> = parts.map(unescaped).collect();
        parts.try_into().unwrap_or_else(|_| panic!("{N} columns: {line}"))
    };
    lines.map(columns).collect()
}

/// What a report says of one slip: what was written, and the error with its code.
#[track_caller]
pub fn slip<T>(shown: &str, result: stiffarm::Result<T>) -> String {
    let Err(error) = result else { panic!("accepted: {shown}") };
    format!("» {shown}\n[{}] {error}\n\n", error.code().as_str())
}

/// What is said of a table of refusals: what is wrong, the code that names it, and what came of it.
#[track_caller]
pub fn refusals<'a, T>(rows: impl IntoIterator<Item = (&'a str, Code, stiffarm::Result<T>)>) -> String {
    let mut report = String::new();
    for (what, code, result) in rows {
        assert_eq!(result.as_ref().err().map(|error| error.code()), Some(code), "{what}");
        report += &slip(what, result);
    }
    report
}

/// What is said of findings, a line each: code, subject and sentence.
pub fn sentences<'a>(findings: impl IntoIterator<Item = &'a Finding>) -> String {
    let line = |finding: &Finding| format!("[{}] {}: {}\n", finding.code, finding.subject, finding.sentence);
    findings.into_iter().map(line).collect()
}

/// What is written in place of `from`, in one line.
pub fn shown(from: &str, to: &str) -> String {
    match to {
        "" => format!("without {}", from.trim_end()),
        to => to.trim_end().replace('\n', "; "),
    }
}

fn unescaped(text: &str) -> String {
    let mut out = String::new();
    let mut characters = text.chars();
    while let Some(c) = characters.next() {
        if c != '\\' {
            out.push(c);
            continue;
        }
        out.push(match characters.next() {
            Some('n') => '\n',
            Some('\\') => '\\',
            other => panic!("{other:?} after a backslash in {text}"),
        });
    }
    out
}
