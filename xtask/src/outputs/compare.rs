//! Two folders, compared byte by byte.

use std::path::Path;

use crate::files::{self, first_difference};
use crate::run::Failure;

/// So many differing files are shown with their first differing line; of the others the line's number.
const SHOWN: usize = 20;
/// So many characters of a line are shown, and so many of them before the difference.
const WIDTH: usize = 120;
const BEFORE: usize = 40;

/// What the folders come to: a line or more for each file that is another one, and the closing line.
pub struct Comparison {
    pub changes: Vec<String>,
    pub closing: String,
}

/// Compares the files of `folder` with those of `other`.
pub fn compare(folder: &Path, other: &Path) -> Result<Comparison, Failure> {
    let (now, mut before) = (files::below(folder)?, files::below(other)?);
    let (mut changes, mut extra, mut differ) = (Vec::new(), 0, 0);
    for (name, path) in &now {
        let Some(old) = before.remove(name) else {
            changes.push(format!("{name}: extra"));
            extra += 1;
            continue;
        };
        let (old, new) = (files::read(&old)?, files::read(path)?);
        if old != new {
            differ += 1;
            changes.push(difference(name, &old, &new, differ <= SHOWN));
        }
    }
    changes.extend(before.keys().map(|name| format!("{name}: missing")));
    let mut closing = format!("outputs: {} files", now.len());
    for (count, what) in [(differ, "differ"), (before.len(), "missing"), (extra, "extra")] {
        if count > 0 {
            closing += &format!(", {count} {what}");
        }
    }
    if changes.is_empty() {
        closing += ", all the same";
    }
    Ok(Comparison { changes, closing })
}

/// Where two contents of a file begin to differ.
fn difference(name: &str, before: &[u8], now: &[u8], is_shown: bool) -> String {
    let line = first_difference(before, now);
    let sentence = format!("{name}:{line}: differs from this line on");
    let of = |bytes: &[u8]| {
        let text = bytes.split(|byte| *byte == b'\n').nth(line - 1);
        String::from_utf8_lossy(text.unwrap_or_default()).into_owned()
    };
    let (before, now) = (of(before), of(now));
    if before == now {
        return format!("{sentence}\n  only the end of the line differs");
    }
    if !is_shown {
        return sentence;
    }
    let same = before.chars().zip(now.chars());
    let same = same.take_while(|(b, n)| b == n).count();
    let (before, now) = (excerpt(&before, same), excerpt(&now, same));
    format!("{sentence}\n  before: {before}\n  now:    {now}")
}

/// The part of a line about its character `at`, marked where something is left out.
fn excerpt(line: &str, at: usize) -> String {
    let start = at.saturating_sub(BEFORE);
    let mut rest = line.chars().skip(start);
    let part: String = rest.by_ref().take(WIDTH).collect();
    let head = if start > 0 { "…" } else { "" };
    let tail = if rest.next().is_some() { "…" } else { "" };
    format!("{head}{part}{tail}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_missing_or_extra_is_named() {
        let root = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| files::write(&root.path().join(name), text).unwrap();
        let compared = || compare(&root.path().join("now"), &root.path().join("before")).unwrap();
        for folder in ["now", "before"] {
            put(&format!("{folder}/printed/a.txt"), "one\ntwo\n");
            put(&format!("{folder}/plan.csv"), "posture\n");
        }
        let same = compared();
        assert_eq!(same.closing, "outputs: 2 files, all the same");
        assert!(same.changes.is_empty());

        put("now/printed/a.txt", "one\ntwice\n");
        put("now/new/b.svg", "<svg>");
        put("now/plan.csv", "posture");
        put("before/old.json", "{}");
        let changed = compared();
        assert_eq!(
            changed.changes,
            [
                "new/b.svg: extra",
                "plan.csv:1: differs from this line on\n  only the end of the line differs",
                "printed/a.txt:2: differs from this line on\n  before: two\n  now:    twice",
                "old.json: missing",
            ]
        );
        let closing = "outputs: 3 files, 2 differ, 1 missing, 1 extra";
        assert_eq!(changed.closing, closing);
    }

    #[test]
    fn of_a_long_line_the_difference_is_shown() {
        let line = |end: &str| format!("{}{end}{}", "ä".repeat(500), "z".repeat(500));
        let shown = |digit| format!("…{}{digit}{}…", "ä".repeat(40), "z".repeat(79));
        let sentence = difference("a", line("1").as_bytes(), line("2").as_bytes(), true);
        assert!(sentence.ends_with(&format!("before: {}\n  now:    {}", shown("1"), shown("2"))));
    }
}
