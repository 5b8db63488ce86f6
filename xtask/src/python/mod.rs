//! The Python package: one wheel from the checkout, installed into a virtual environment under `target/python`, its
//! tests, and what holds for its code, its types and what would be published.

mod checks;
mod interpreters;
mod wheel;

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::arguments;
use crate::arguments::{Checks, Part};
use crate::checked::{Checked, Script};
use crate::reference::{REFERENCE_VARIABLE, reference_folder};
use crate::run::{Failure, Workspace, beside};
use crate::tools::{self, Missing};

/// Where the package lies.
const PACKAGE: &str = "crates/stiffarm-py";

/// The tests that need nothing but numpy: what runs on the other Pythons.
const SMOKE: &str = "tests/test_package.py";

/// The command to compare with, as the dev profile builds it.
const COMMAND_VARIABLE: &str = "STIFFARM_COMMAND";

const ALONE: &str = "cargo xtask python shows it alone";

const PYTEST: Script = Script { name: "pytest", word: "pytest", fix: ALONE };

/// Where everything lies, and the Python of the virtual environment.
struct Place<'a> {
    workspace: &'a Workspace,
    /// The package in the checkout.
    package: PathBuf,
    /// The folder below target.
    folder: PathBuf,
    /// The virtual environment's.
    python: PathBuf,
}

/// Builds the wheel and checks it; what comes of it, by the part of the tests it belongs to.
pub fn run(workspace: &Workspace, options: &arguments::Python) -> Result<Vec<(Part, Checked)>, Failure> {
    let mut checked = Checked::default();
    let place = match Place::prepared(workspace, options.install) {
        Ok(place) => place,
        Err(Missing { reason, fix }) => {
            checked.skip("the Python package and its tests", reason, fix);
            return Ok(vec![(Part::Python, checked)]);
        }
    };
    let wants = |checks| options.only.is_none_or(|only| only == checks);

    let Some(wheel) = wheel::built_and_installed(&place, &mut checked)? else {
        return Ok(vec![(Part::Python, checked)]);
    };
    // Checks of other programs beside pytest, which waits for much of its time.
    let said = || {
        let mut said = Checked::default();
        if wants(Checks::Package) {
            checks::package(&place, &wheel, &mut said);
        }
        if wants(Checks::Types) {
            checks::types(&place, &mut said);
        }
        said
    };
    let tested = || wants(Checks::Pytest).then(|| place.tested(&options.words));
    let (said, tested) = beside(said, tested);
    checked.add(said);
    let Some(tested) = tested else {
        return Ok(vec![(Part::Python, checked)]);
    };
    let (rest, reference) = without_reference(tested?);
    checked.add(rest);
    let mut parts = vec![(Part::Python, checked), (Part::Reference, reference)];
    if options.words.is_empty() {
        parts.push((Part::OtherPythons, place.others(&wheel)?));
    }
    Ok(parts)
}

/// `cargo xtask python`: this part alone.
pub fn alone(workspace: &Workspace, options: &arguments::Python) -> Result<(), Failure> {
    let mut all = Checked::default();
    for (_, checked) in run(workspace, options)? {
        all.add(checked);
    }
    let outcome = all.tell();
    println!("python: {} passed, {} failed, {} skipped", all.passed, all.failures.len(), all.skips.len());
    outcome
}

/// Takes the tests out that were skipped because the reference data are not there.
fn without_reference(mut tested: Checked) -> (Checked, Checked) {
    let (reference, rest): (Vec<_>, Vec<_>) =
        std::mem::take(&mut tested.skips).into_iter().partition(|[_, reason, _]| reason.contains(REFERENCE_VARIABLE));
    tested.skips = rest;
    let mut without = Checked::default();
    for [name, reason, _] in reference {
        let fix = format!("{REFERENCE_VARIABLE}=/path/to/reference cargo xtask test");
        without.skip(name, reason, &fix);
    }
    (tested, without)
}

impl<'a> Place<'a> {
    /// The virtual environment with everything that the tests need, made where it is not there or other versions are
    /// wanted.
    fn prepared(workspace: &'a Workspace, install: bool) -> Result<Self, Missing> {
        let package = workspace.root().join(PACKAGE);
        let folder = tools::target(workspace).join("python");
        if install && interpreters::of_this_machine().is_none() {
            tools::apt_install(&["python3", "python3-venv"]);
        }
        let version = interpreters::of_this_machine();
        let requirements = requirements(&package, version.as_deref().unwrap_or_default());
        if let Some(version) = version {
            println!("Python {version} with {}", requirements.display());
        }
        let imports = "import maturin, numpy, pytest";
        let python = tools::python(&folder, &requirements, imports, install)?;
        Ok(Place { workspace, package, folder, python })
    }

    /// All tests on the installed wheel, and the examples of its documentation.
    fn tested(&self, words: &[String]) -> Result<Checked, Failure> {
        let mut call = self.pytest(&self.python);
        call.args(["--doctest-modules", "--pyargs", "stiffarm", "tests"])
            .args(words)
            .env(COMMAND_VARIABLE, tools::stiffarm()?);
        if let Ok(folder) = reference_folder(std::env::var_os(REFERENCE_VARIABLE)) {
            call.env(REFERENCE_VARIABLE, folder);
        }
        Checked::run(&PYTEST, &mut call)
    }

    /// pytest in the package's folder, which holds nothing that could be imported in place of the wheel.
    fn pytest(&self, python: &Path) -> Command {
        let mut call = Command::new(python);
        // Quiet, so that nothing stands before the lines that are counted.
        call.args(["-m", "pytest", "-p", "counted", "-p", "no:cacheprovider"])
            .args(["--quiet", "-rN", "-o", "console_output_style=classic"])
            .arg("--continue-on-collection-errors")
            .current_dir(&self.package)
            .env("PYTHONPATH", self.workspace.root().join("xtask/python"))
            .env("MPLBACKEND", "Agg")
            .env("RAY_USAGE_STATS_ENABLED", "0");
        call
    }

    /// The same wheel on the other Pythons of this machine.
    fn others(&self, wheel: &Path) -> Result<Checked, Failure> {
        let default_version = interpreters::of_this_machine();
        let mut all = Checked::default();
        for version in interpreters::SUPPORTED {
            if default_version.as_deref() == Some(version) {
                continue;
            }
            let name = format!("the wheel on Python {version}");
            let Some(python) = interpreters::of_version(version) else {
                let reason = format!("there is no python{version} that runs");
                all.skip(name, reason, "install it, or see what the workflow says");
                continue;
            };
            println!("{name}");
            match wheel::smoke_environment(self, version, &python, wheel) {
                Ok(python) => {
                    let mut call = self.pytest(&python);
                    let mut tested = Checked::run(&PYTEST, call.arg(SMOKE))?;
                    for failure in &mut tested.failures {
                        *failure = format!("{name}: {failure}");
                    }
                    all.add(tested);
                }
                Err(why) => {
                    let reason = format!("what its tests need could not be installed: {why}");
                    all.skip(name, reason, "give pip a way to pypi.org, and run it again");
                }
            }
        }
        Ok(all)
    }
}

/// What is installed for the tests on this Python: the versions that were newest when they were noted, or for a Python
/// without a list the newest of today.
fn requirements(package: &Path, version: &str) -> PathBuf {
    let folder = package.join("requirements");
    let noted = folder.join(format!("python{version}.txt"));
    if noted.is_file() { noted } else { folder.join("wanted.txt") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_without_reference_data_belong_to_their_own_part() {
        let mut tested = Checked::default();
        tested.passed = 2;
        tested.skip("a", "needs STIFFARM_REFERENCE_DATA", ALONE);
        tested.skip("b", "no ray", ALONE);
        let (rest, reference) = without_reference(tested);
        assert_eq!((rest.passed, reference.passed), (2, 0));
        assert_eq!(rest.skips, [["b", "no ray", ALONE].map(String::from)]);
        assert_eq!(reference.skips[0][0], "a");
        assert!(reference.skips[0][2].starts_with("STIFFARM_REFERENCE_DATA="));
    }

    #[test]
    fn every_python_has_its_list_or_the_names_alone() {
        let workspace = Workspace::find().unwrap();
        let package = workspace.root().join(PACKAGE);
        for version in ["3.10", "3.11"] {
            let list = requirements(&package, version);
            assert!(list.ends_with(format!("python{version}.txt")));
            let text = std::fs::read_to_string(list).unwrap();
            let pins = || text.lines().filter(|line| !line.starts_with(['#', '-']));
            assert!(pins().count() > 50);
            assert!(pins().all(|line| line.contains("==")), "{text}");
        }
        assert!(requirements(&package, "3.99").ends_with("wanted.txt"));
        assert!(package.join(SMOKE).is_file());
    }
}
