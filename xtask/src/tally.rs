//! Reading what `cargo test` prints: results and ignored tests.

/// What the lines of `cargo test` add up to.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Tests that passed.
    pub passed: usize,
    /// Tests that failed.
    pub failed: usize,
    /// Tests that were ignored, in the order of the output.
    pub ignored: Vec<Ignored>,
}

/// One ignored test.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ignored {
    /// The test's path in its crate, or `file - item (line N)` of a doc test.
    pub name: String,
    /// The text of `#[ignore = "…"]`.
    pub reason: Option<String>,
}

impl Tally {
    /// Takes in one line of standard output.
    pub fn see(&mut self, line: &str) {
        let line = without_colour(line);
        if let Some([passed, failed]) = parse_result(&line) {
            self.passed += passed;
            self.failed += failed;
        }
        self.ignored.extend(parse_ignored(&line));
    }
}

/// Passed and failed of `test result: ok. 3 passed; 0 failed; 1 ignored; …`.
fn parse_result(line: &str) -> Option<[usize; 2]> {
    let (_verdict, counts) = line.strip_prefix("test result: ")?.split_once(". ")?;
    let mut fields = counts.split("; ");
    let passed = fields.next()?.strip_suffix(" passed")?.parse().ok()?;
    let failed = fields.next()?.strip_suffix(" failed")?.parse().ok()?;
    Some([passed, failed])
}

/// The test of `test a::b ... ignored, reason`.
fn parse_ignored(line: &str) -> Option<Ignored> {
    let (name, outcome) = line.strip_prefix("test ")?.split_once(" ... ignored")?;
    Some(Ignored {
        name: name.trim_end_matches(" - should panic").to_string(),
        reason: outcome.strip_prefix(", ").map(String::from),
    })
}

/// `line` without terminal colours (`ESC [ … m`).
fn without_colour(line: &str) -> String {
    let mut pieces = line.split("\u{1b}[");
    let mut plain = pieces.next().unwrap_or_default().to_string();
    for piece in pieces {
        plain.push_str(piece.split_once('m').map_or(piece, |(_, text)| text));
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines of `cargo test` 1.95 on a crate with unit and doc tests.
    const SAMPLE: &str = "
running 5 tests
test tests::adds ... ok
test tests::measured ... ignored, needs STIFFARM_REFERENCE_DATA
test tests::slow ... ignored
test tests::panics - should panic ... ok
test tests::wrong ... FAILED

test result: FAILED. 2 passed; 1 failed; 2 ignored; 0 measured; 0 filtered out; finished in 0.00s

running 1 test
test src/lib.rs - add (line 3) ... ok

test result: ok. 1 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.21s
";

    fn ignored(name: &str, reason: Option<&str>) -> Ignored {
        Ignored { name: name.to_string(), reason: reason.map(String::from) }
    }

    #[test]
    fn a_captured_run_adds_up() {
        let mut tally = Tally::default();
        SAMPLE.lines().for_each(|line| tally.see(line));
        let expected = Tally {
            passed: 3,
            failed: 1,
            ignored: vec![
                ignored("tests::measured", Some("needs STIFFARM_REFERENCE_DATA")),
                ignored("tests::slow", None),
            ],
        };
        assert_eq!(tally, expected);
    }

    #[test]
    fn result_lines_are_told_from_text_about_them() {
        for line in [
            "test result: pending",
            "  left: \"test result: ok. 1 passed; 0 failed\"",
            "test result: ok. some passed; 0 failed; 0 ignored",
        ] {
            assert_eq!(parse_result(line), None, "{line}");
        }
    }

    #[test]
    fn ignored_tests_keep_their_whole_name() {
        let doc = "test crates/a/src/lib.rs - f (line 5) ... ignored";
        let expected = ignored("crates/a/src/lib.rs - f (line 5)", None);
        assert_eq!(parse_ignored(doc), Some(expected));
        let panics = "test a::b - should panic ... ignored, slow, and loud";
        let expected = ignored("a::b", Some("slow, and loud"));
        assert_eq!(parse_ignored(panics), Some(expected));
        assert_eq!(parse_ignored("test a ... ok"), None);
    }

    #[test]
    fn colours_do_not_hide_a_result() {
        let line = "test result: \u{1b}[32mok\u{1b}[0m. 1 passed; 2 failed; 0 ignored";
        assert_eq!(parse_result(&without_colour(line)), Some([1, 2]));
        let line = "test a ... \u{1b}[33mignored, slow\u{1b}[0m";
        let expected = ignored("a", Some("slow"));
        assert_eq!(parse_ignored(&without_colour(line)), Some(expected));
    }
}
