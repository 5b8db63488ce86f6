//! Reading what `cargo test` prints: results, ignored tests, and test programs that died.

use std::fmt;

/// What the lines of `cargo test` add up to.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Tests that passed.
    pub passed: usize,
    /// Tests that failed, with one for every test program that ended without a result line.
    pub failed: usize,
    /// Tests that were ignored, in the order of the output.
    pub ignored: Vec<Ignored>,
    /// Ignored tests by the result lines, which count also those whose own line other output ran into.
    counted: usize,
    /// A test program has announced its tests and not yet given their result.
    running: bool,
}

/// One ignored test.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ignored {
    /// The test's path in its crate, or `file - item (line N)` of a doc test.
    pub name: String,
    /// The text of `#[ignore = "…"]`.
    pub reason: Option<String>,
}

impl Ignored {
    fn nameless() -> Self {
        Ignored {
            name: "(a test whose line is garbled by other output)".to_string(),
            reason: None,
        }
    }
}

impl Tally {
    /// Takes in one line of standard output.
    pub fn see(&mut self, line: &str) {
        let line = without_colour(line);
        if let Some([passed, failed, ignored]) = parse_result(&line) {
            self.running = false;
            self.passed += passed;
            self.failed += failed;
            self.counted += ignored;
            while self.ignored.len() < self.counted {
                self.ignored.push(Ignored::nameless());
            }
        } else if is_announcement(&line) {
            self.close();
            self.running = true;
        } else if let Some(ignored) = parse_ignored(&line) {
            self.ignored.push(ignored);
        }
    }

    /// Ends the output, or the part of it that one test program wrote. A program that announced its tests and gave no
    /// result died, for example of a stack overflow: that counts as one failure.
    pub fn close(&mut self) {
        if self.running {
            self.failed += 1;
            self.running = false;
        }
    }
}

/// The counts of one whole run, shown as its closing line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Total {
    /// Tests that passed.
    pub passed: usize,
    /// Tests that failed.
    pub failed: usize,
    /// Tests that were not run.
    pub skipped: usize,
}

impl fmt::Display for Total {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Total {
            passed,
            failed,
            skipped,
        } = self;
        write!(
            f,
            "total: {passed} passed, {failed} failed, {skipped} skipped"
        )
    }
}

/// Passed, failed and ignored of `test result: ok. 3 passed; 0 failed; 1 ignored; …`.
fn parse_result(line: &str) -> Option<[usize; 3]> {
    let (_verdict, counts) = line.strip_prefix("test result: ")?.split_once(". ")?;
    let count = |what: &str| {
        let mut fields = counts.split("; ");
        fields.find_map(|field| field.strip_suffix(what)?.trim_end().parse().ok())
    };
    Some([count("passed")?, count("failed")?, count("ignored")?])
}

/// Whether the line is `running 3 tests`.
fn is_announcement(line: &str) -> bool {
    let count = line.strip_prefix("running ").and_then(|rest| {
        rest.strip_suffix(" tests")
            .or_else(|| rest.strip_suffix(" test"))
    });
    count.is_some_and(|count| count.parse::<usize>().is_ok())
}

/// The test of `test a::b ... ignored, reason`.
fn parse_ignored(line: &str) -> Option<Ignored> {
    let (name, outcome) = line.strip_prefix("test ")?.split_once(" ... ignored")?;
    let reason = match outcome {
        "" => None,
        _ => Some(outcome.strip_prefix(", ")?.to_string()),
    };
    Some(Ignored {
        name: name.trim_end_matches(" - should panic").to_string(),
        reason,
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

    /// Captured from `cargo test` 1.95 on a crate with unit, integration and doc tests.
    const SAMPLE: &str = r#"
running 5 tests
test tests::adds ... ok
test tests::measured ... ignored, needs STIFFARM_REFERENCE_DATA
test tests::slow ... ignored
test tests::panics - should panic ... ok
test tests::wrong ... FAILED

failures:

---- tests::wrong stdout ----

thread 'tests::wrong' panicked at src/lib.rs:20:9:
assertion `left == right` failed
  left: 1
 right: 2

failures:
    tests::wrong

test result: FAILED. 2 passed; 1 failed; 2 ignored; 0 measured; 0 filtered out; finished in 0.00s


running 0 tests

test result: ok. 0 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s


running 1 test
test src/lib.rs - add (line 3) ... ok

test result: ok. 1 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.21s

all doctests ran in 0.36s; merged doctests compilation took 0.14s
"#;

    fn tally(output: &str) -> Tally {
        let mut tally = Tally::default();
        output.lines().for_each(|line| tally.see(line));
        tally.close();
        tally
    }

    fn ignored(name: &str, reason: Option<&str>) -> Ignored {
        Ignored {
            name: name.to_string(),
            reason: reason.map(String::from),
        }
    }

    #[test]
    fn a_captured_run_adds_up() {
        let tally = tally(SAMPLE);
        assert_eq!((tally.passed, tally.failed), (3, 1));
        let expected = [
            ignored("tests::measured", Some("needs STIFFARM_REFERENCE_DATA")),
            ignored("tests::slow", None),
        ];
        assert_eq!(tally.ignored, expected);
    }

    #[test]
    fn a_test_program_that_dies_is_a_failure() {
        let died = "running 2 tests\ntest a ... ok\n";
        assert_eq!(tally(died).failed, 1);
        let followed = format!(
            "{died}\nrunning 1 test\ntest b ... ok\n\ntest result: ok. 1 passed; 0 failed; 0 ignored"
        );
        assert_eq!((tally(&followed).passed, tally(&followed).failed), (1, 1));
    }

    #[test]
    fn an_ignored_test_in_a_garbled_line_still_counts() {
        let output = "running 2 tests\ntest a ... ignored\nhellotest b ... ignored, slow\n\n\
                      test result: ok. 0 passed; 0 failed; 2 ignored";
        let expected = [ignored("a", None), Ignored::nameless()];
        assert_eq!(tally(output).ignored, expected);
    }

    #[test]
    fn result_lines_are_told_from_text_about_them() {
        assert_eq!(
            parse_result("test result: ok. 12 passed; 0 failed; 3 ignored"),
            Some([12, 0, 3])
        );
        assert_eq!(
            parse_result("test result: FAILED. 0 passed; 7 failed; 0 ignored"),
            Some([0, 7, 0])
        );
        for line in [
            "test result: pending",
            "  left: \"test result: ok. 1 passed; 0 failed\"",
            "test result: ok. some passed; 0 failed; 0 ignored",
            "",
        ] {
            assert_eq!(parse_result(line), None, "{line}");
        }
    }

    #[test]
    fn announcements_need_a_number() {
        assert!(is_announcement("running 1 test"));
        assert!(is_announcement("running 0 tests"));
        assert!(!is_announcement("running all tests"));
        assert!(!is_announcement("running 6 starts"));
    }

    #[test]
    fn ignored_tests_keep_their_whole_name() {
        assert_eq!(
            parse_ignored("test crates/a/src/lib.rs - f (line 5) ... ignored"),
            Some(ignored("crates/a/src/lib.rs - f (line 5)", None))
        );
        assert_eq!(
            parse_ignored("test a::b - should panic ... ignored, slow, and loud"),
            Some(ignored("a::b", Some("slow, and loud")))
        );
        assert_eq!(parse_ignored("test a ... ok"), None);
        assert_eq!(parse_ignored("test a ... ignoredly"), None);
    }

    #[test]
    fn colours_do_not_hide_a_result() {
        let line = "test result: \u{1b}[32mok\u{1b}[0m. 1 passed; 2 failed; 0 ignored";
        assert_eq!(parse_result(&without_colour(line)), Some([1, 2, 0]));
        let line = "test a ... \u{1b}[33mignored, slow\u{1b}[0m";
        assert_eq!(
            parse_ignored(&without_colour(line)),
            Some(ignored("a", Some("slow")))
        );
    }

    #[test]
    fn the_closing_line_is_fixed() {
        let total = Total {
            passed: 3,
            failed: 0,
            skipped: 12,
        };
        assert_eq!(total.to_string(), "total: 3 passed, 0 failed, 12 skipped");
    }
}
