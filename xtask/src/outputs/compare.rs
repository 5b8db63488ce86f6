//! Two folders, compared byte by byte.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::generate::first_difference;
use crate::run::Failure;

/// So many differing files are shown with their first differing line; of the others the line's number.
const SHOWN: usize = 20;
/// So many characters of a line are shown, and so many of them before the difference.
const WIDTH: usize = 120;
const BEFORE: usize = 40;

/// Paths of the files of a folder by their names relative to it, with `/` on every system.
type Files = BTreeMap<String, PathBuf>;

/// What became of a file of the other folder.
#[derive(Debug, PartialEq, Eq)]
enum Change {
    /// It is there no more.
    Missing,
    /// The other folder does not have it.
    Extra,
    /// Its content is another one from this line on.
    Differs {
        line: usize,
        before: String,
        now: String,
    },
}

/// How a folder differs from another.
pub struct Comparison {
    /// Files of the folder.
    count: usize,
    /// Changed files by name.
    changes: BTreeMap<String, Change>,
}

/// Compares the files of `folder` with those of `other`.
pub fn compare(folder: &Path, other: &Path) -> Result<Comparison, Failure> {
    let (now, before) = (files(folder)?, files(other)?);
    let mut changes = BTreeMap::new();
    for (name, path) in &now {
        let change = match before.get(name) {
            None => Some(Change::Extra),
            Some(old) => difference(&read(old)?, &read(path)?),
        };
        changes.extend(change.map(|change| (name.clone(), change)));
    }
    for name in before.keys().filter(|name| !now.contains_key(*name)) {
        changes.insert(name.clone(), Change::Missing);
    }
    Ok(Comparison {
        count: now.len(),
        changes,
    })
}

/// The number of files of a folder.
pub fn count(folder: &Path) -> Result<usize, Failure> {
    Ok(files(folder)?.len())
}

impl Comparison {
    /// Whether every file is the same, and none is missing or extra.
    pub fn is_same(&self) -> bool {
        self.changes.is_empty()
    }

    /// What differs, and nothing where all is the same.
    pub fn details(&self) -> String {
        let mut out = String::new();
        let mut shown = 0;
        for (name, change) in &self.changes {
            match change {
                Change::Missing => out += &format!("{name}: missing\n"),
                Change::Extra => out += &format!("{name}: extra\n"),
                Change::Differs { line, before, now } => {
                    out += &format!("{name}:{line}: differs from this line on\n");
                    shown += 1;
                    if before == now {
                        out += "  only the end of the line differs\n";
                    } else if shown <= SHOWN {
                        out += &format!("  before: {before}\n  now:    {now}\n");
                    }
                }
            }
        }
        out
    }

    /// The closing line.
    pub fn closing(&self) -> String {
        let count = |wanted: fn(&Change) -> bool, what: &str| {
            let count = self.changes.values().filter(|c| wanted(c)).count();
            (count > 0).then(|| format!(", {count} {what}"))
        };
        let parts = [
            count(|c| matches!(c, Change::Differs { .. }), "differ"),
            count(|c| *c == Change::Missing, "missing"),
            count(|c| *c == Change::Extra, "extra"),
        ];
        let found: String = parts.into_iter().flatten().collect();
        let found = if found.is_empty() {
            ", all the same"
        } else {
            &found
        };
        format!("outputs: {} files{found}", self.count)
    }
}

/// Every file in `folder` and the folders in it.
fn files(folder: &Path) -> Result<Files, Failure> {
    let mut files = Files::new();
    let mut waiting = vec![(String::new(), folder.to_path_buf())];
    while let Some((prefix, folder)) = waiting.pop() {
        let error = |error: std::io::Error| unreadable(&folder, &error);
        for entry in std::fs::read_dir(&folder).map_err(error)? {
            let path = entry.map_err(error)?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let name = format!("{prefix}{name}");
            if path.is_dir() {
                waiting.push((format!("{name}/"), path));
            } else {
                files.insert(name, path);
            }
        }
    }
    Ok(files)
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|error| unreadable(path, &error))
}

fn unreadable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::internal(
        format!("`{}` could not be read: {error}", path.display()),
        "check that it exists and is readable",
    )
}

/// Where two contents begin to differ, if they do.
fn difference(before: &[u8], now: &[u8]) -> Option<Change> {
    if before == now {
        return None;
    }
    let line = first_difference(before, now);
    let of = |bytes: &[u8]| {
        let text = bytes.split(|byte| *byte == b'\n').nth(line - 1);
        String::from_utf8_lossy(text.unwrap_or_default()).into_owned()
    };
    let (before, now) = (of(before), of(now));
    let same = before.chars().zip(now.chars());
    let same = same.take_while(|(b, n)| b == n).count();
    Some(Change::Differs {
        line,
        before: excerpt(&before, same),
        now: excerpt(&now, same),
    })
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

    /// Two folders, removed at the end of the test.
    struct Pair(PathBuf);

    impl Pair {
        fn new(name: &str) -> Self {
            let id = std::process::id();
            let pair = Pair(std::env::temp_dir().join(format!("xtask-compare-{name}-{id}")));
            for folder in ["now", "before"] {
                pair.put(folder, "printed/a.txt", "one\ntwo\n");
                pair.put(folder, "plan.csv", "posture\n");
            }
            pair
        }

        fn put(&self, folder: &str, name: &str, content: &str) {
            let path = self.0.join(folder).join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, content).unwrap();
        }

        fn compare(&self) -> Comparison {
            compare(&self.0.join("now"), &self.0.join("before")).unwrap()
        }
    }

    impl Drop for Pair {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn equal_folders_are_the_same() {
        let comparison = Pair::new("equal").compare();
        assert!(comparison.is_same());
        assert_eq!(comparison.details(), "");
        assert_eq!(comparison.closing(), "outputs: 2 files, all the same");
    }

    #[test]
    fn what_differs_is_missing_or_extra_is_named() {
        let pair = Pair::new("changed");
        pair.put("now", "printed/a.txt", "one\ntwice\n");
        pair.put("now", "new/b.svg", "<svg>");
        pair.put("before", "old.json", "{}");
        let comparison = pair.compare();
        assert!(!comparison.is_same());
        assert_eq!(
            comparison.details(),
            "new/b.svg: extra\nold.json: missing\nprinted/a.txt:2: differs from this line on\n  \
             before: two\n  now:    twice\n"
        );
        assert_eq!(
            comparison.closing(),
            "outputs: 3 files, 1 differ, 1 missing, 1 extra"
        );
    }

    #[test]
    fn the_last_byte_counts() {
        for (before, now) in [("a\n", "a"), ("a", "a\n"), ("", "\n"), ("a\r\n", "a\n")] {
            assert!(difference(before.as_bytes(), now.as_bytes()).is_some());
        }
        assert_eq!(difference(b"a\n", b"a\n"), None);
        let pair = Pair::new("end");
        pair.put("now", "plan.csv", "posture");
        let told = "plan.csv:1: differs from this line on\n  only the end of the line differs\n";
        assert_eq!(pair.compare().details(), told);
    }

    #[test]
    fn of_a_long_line_the_difference_is_shown() {
        let line = |end: &str| format!("{}{end}{}", "ä".repeat(500), "z".repeat(500));
        let change = difference(line("1").as_bytes(), line("2").as_bytes());
        let Some(Change::Differs { line, before, now }) = change else {
            panic!("{change:?}");
        };
        let shown = |digit| format!("…{}{digit}{}…", "ä".repeat(40), "z".repeat(79));
        assert_eq!((line, before, now), (1, shown("1"), shown("2")));
    }

    #[test]
    fn a_folder_that_is_not_there_is_an_error() {
        let failure = files(Path::new("no-such-folder")).unwrap_err();
        assert!(failure.message.starts_with("`no-such-folder` could not"));
    }
}
