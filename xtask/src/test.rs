//! `cargo xtask test`: every test this machine can run, what it skips and why, and one closing line.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::arguments;
use crate::arguments::Part;
use crate::checked::Checked;
use crate::reference::{REFERENCE_VARIABLE, reference_folder};
use crate::run::{Failure, Workspace, beside, quoted, timed};
use crate::tally::{Ignored, Tally};
use crate::{pages, python, sheets};

/// One test or part that was not run.
#[derive(Debug, PartialEq, Eq)]
struct Skip {
    part: Part,
    name: String,
    reason: String,
    fix: String,
}

/// Runs all parts and prints the closing line last; a failure has been told by then.
pub fn run(workspace: &Workspace, options: &arguments::Test) -> Result<(), Failure> {
    let start = Instant::now();
    let reference = reference_folder(std::env::var_os(REFERENCE_VARIABLE));

    let mut tally = Tally::default();
    let mut failures = Vec::new();
    let mut checked = Vec::new();
    match workspace.built() {
        Ok(()) => {
            // Browsers and Ray wait for much of their time.
            let others = || of_other_programs(workspace, options.install);
            let (others, rust) = beside(others, || run_rust(workspace, reference.as_deref().ok()));
            let complaint;
            (tally, complaint) = rust?;
            failures.extend(complaint);
            checked = others?;
        }
        Err(failure) => failures.push(format!("rust: {}; fix: correct the first error above", failure.message)),
    }

    let mut skips = skips(&tally.ignored, &reference, &options.require);
    for (part, checked) in checked {
        tally.passed += checked.passed;
        failures.extend(checked.failures.into_iter().map(|why| failed(part, &why)));
        skips.extend(checked.skips.into_iter().map(|[name, reason, fix]| Skip { part, name, reason, fix }));
    }
    let (unmet, allowed): (Vec<_>, Vec<_>) = skips.iter().partition(|skip| options.require.contains(&skip.part));
    failures.extend(unmet.into_iter().map(described));

    println!();
    for skip in &allowed {
        println!("SKIPPED {}", described(skip));
    }
    for failure in &failures {
        println!("FAILED {failure}");
    }
    println!("tests took {:.1} s", start.elapsed().as_secs_f64());
    let (passed, failed) = (tally.passed, tally.failed + failures.len());
    let skipped = allowed.len();
    println!("total: {passed} passed, {failed} failed, {skipped} skipped");
    if failed == 0 { Ok(()) } else { Err(Failure::already_told()) }
}

/// Sheets and pages in other programs beside the Python package.
fn of_other_programs(workspace: &Workspace, install: bool) -> Result<Vec<(Part, Checked)>, Failure> {
    let pages = || -> Result<_, Failure> {
        let sheets = timed("sheets", || sheets::run(workspace, install))?;
        let browsers = arguments::Pages { install, ..arguments::Pages::default() };
        let pages = timed("pages", || pages::run(workspace, &browsers))?;
        Ok([(Part::Sheets, sheets), (Part::Browser, pages)])
    };
    let python = arguments::Python { install, ..arguments::Python::default() };
    let python = || timed("Python", || python::run(workspace, &python));
    let (pages, python) = beside(pages, python);
    let mut parts = python?;
    parts.extend(pages?);
    Ok(parts)
}

/// What `cargo test` runs, a call for each. Named one by one, because a plain `cargo test` also builds every example,
/// optimised; clippy has checked them already.
const TARGETS: [&str; 2] = ["--tests", "--doc"];

/// `cargo test` with doc tests, and with the tests that need the reference data where there is its folder. The text
/// is a failure that no test accounts for.
fn run_rust(workspace: &Workspace, reference: Option<&Path>) -> Result<(Tally, Option<String>), Failure> {
    let mut tally = Tally::default();
    let mut complaint = None;
    for targets in TARGETS {
        let failed = tally.failed;
        let mut arguments = vec!["test", "--workspace", "--locked", "--no-fail-fast", targets];
        if reference.is_some() {
            arguments.extend(["--", "--include-ignored"]);
        }
        let mut call = workspace.cargo(&arguments);
        if let Some(folder) = reference {
            call = call.env(REFERENCE_VARIABLE, folder);
        }
        println!("{call}");

        let name = format!("cargo test {targets}");
        let status = timed(name, || call.stream(|line| tally.see(line)))?;
        if !status.success() && tally.failed == failed {
            complaint = Some(format!(
                "rust: cargo test ended with {status} though no test failed; fix: correct the first error above"
            ));
            break;
        }
    }
    Ok((tally, complaint))
}

/// What was not run: the ignored tests, and the reference data where they are required, missing and no test says so.
fn skips(ignored: &[Ignored], reference: &Result<PathBuf, String>, require: &[Part]) -> Vec<Skip> {
    let mut skips: Vec<Skip> = ignored.iter().map(|test| skip_of(test, reference)).collect();
    let is_listed = skips.iter().any(|skip| skip.part == Part::Reference);
    if let Err(why) = reference
        && require.contains(&Part::Reference)
        && !is_listed
    {
        skips.push(without_reference("reference", why));
    }
    skips
}

fn skip_of(test: &Ignored, reference: &Result<PathBuf, String>) -> Skip {
    match (&test.reason, reference) {
        (Some(reason), Err(why)) if reason.contains(REFERENCE_VARIABLE) => without_reference(&test.name, why),
        (reason, _) => Skip {
            part: Part::Rust,
            name: test.name.clone(),
            reason: reason.clone().unwrap_or_else(|| "marked #[ignore] without a reason".to_string()),
            fix: format!("cargo test --workspace --locked -- --ignored --exact {}", quoted(&test.name)),
        },
    }
}

fn without_reference(name: &str, why: &str) -> Skip {
    Skip {
        part: Part::Reference,
        name: name.to_string(),
        reason: why.to_string(),
        fix: format!("{REFERENCE_VARIABLE}=/path/to/reference cargo xtask test (CONTRIBUTING.md says what lies there)"),
    }
}

fn described(skip: &Skip) -> String {
    format!("{}: {}; fix: {}", skip.name, skip.reason, skip.fix)
}

/// A failed check with what shows it alone.
fn failed(part: Part, why: &str) -> String {
    match part {
        Part::Sheets => format!("{why}; fix: cargo xtask sheets shows it alone"),
        Part::Browser => format!("page {why}; fix: cargo xtask pages shows the pages alone"),
        _ => format!("{why}; fix: cargo xtask python shows it alone"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ignored(name: &str, reason: &str) -> Ignored {
        Ignored { name: name.to_string(), reason: Some(reason.to_string()) }
    }

    #[test]
    fn skips_name_the_test_the_reason_and_the_fix() {
        let tests =
            [ignored("fanuc::measured", "needs STIFFARM_REFERENCE_DATA"), ignored("src/lib.rs - f (line 5)", "slow")];
        let reference = Err("STIFFARM_REFERENCE_DATA is not set".to_string());
        let skips = skips(&tests, &reference, &[]);
        assert_eq!(skips.iter().map(|s| s.part).collect::<Vec<_>>(), [Part::Reference, Part::Rust]);
        assert_eq!(
            described(&skips[0]),
            "fanuc::measured: STIFFARM_REFERENCE_DATA is not set; fix: \
             STIFFARM_REFERENCE_DATA=/path/to/reference cargo xtask test (CONTRIBUTING.md says what lies there)"
        );
        assert_eq!(
            described(&skips[1]),
            "src/lib.rs - f (line 5): slow; fix: \
             cargo test --workspace --locked -- --ignored --exact 'src/lib.rs - f (line 5)'"
        );
    }

    #[test]
    fn required_reference_data_are_missed_once() {
        let missing = Err("STIFFARM_REFERENCE_DATA is not set".to_string());
        let measured = [ignored("a", "needs STIFFARM_REFERENCE_DATA")];
        let required = [Part::Reference];
        assert_eq!(skips(&[], &missing, &required)[0].name, "reference");
        assert_eq!(skips(&measured, &missing, &required)[0].name, "a");
        assert_eq!(skips(&measured, &missing, &required).len(), 1);
        assert!(skips(&[], &missing, &[Part::Rust]).is_empty());
        assert!(skips(&[], &Ok("there".into()), &required).is_empty());
    }

    #[test]
    fn a_failed_check_says_what_shows_it_alone() {
        for (part, start, end) in [
            (Part::Sheets, "x: wide; fix: ", "cargo xtask sheets shows it alone"),
            (Part::Browser, "page x: wide; fix: ", "cargo xtask pages shows the pages alone"),
            (Part::Python, "x: wide; fix: ", "cargo xtask python shows it alone"),
            (Part::OtherPythons, "x: wide; fix: ", "cargo xtask python shows it alone"),
        ] {
            assert_eq!(failed(part, "x: wide"), format!("{start}{end}"));
        }
    }
}
