//! What other programs say about the package: each a check with a name.

use std::path::Path;
use std::process::{Command, Stdio};

use super::{Place, wheel};
use crate::checked::Checked;
use crate::run::timed;
use crate::tools::program_in;

/// What would be published.
pub fn package(place: &Place, built: &Path, checked: &mut Checked) {
    let sdist = match wheel::sdist(place) {
        Ok(sdist) => sdist,
        Err(why) => return checked.note("sdist", &Err::<(), _>(why)),
    };
    checked.note("sdist holds the crates that it needs", &unpacked(place, &sdist));
    let twine = place.tool("twine", &["check", "--strict"]);
    check(checked, "twine check", with(twine, &[built, &sdist]));
    let abi3audit = place.tool("abi3audit", &["--strict", "--report"]);
    check(checked, "abi3audit", with(abi3audit, &[built]));
}

/// Annotations against the code, and code against its annotations.
pub fn types(place: &Place, checked: &mut Checked) {
    let mut stubtest = Command::new(&place.python);
    // Where nothing but the installed wheel can be imported.
    stubtest
        .args(["-m", "mypy.stubtest", "stiffarm", "--mypy-config-file"])
        .arg(place.package.join("pyproject.toml"))
        .arg("--allowlist")
        .arg(place.package.join("stubtest.txt"))
        .current_dir(&place.folder);
    check(checked, "mypy stubtest", stubtest);
    let mut basedpyright = place.tool("basedpyright", &["--project"]);
    basedpyright.arg(place.package.join("pyproject.toml")).arg("--pythonpath").arg(&place.python);
    check(checked, "basedpyright --strict", basedpyright);
}

impl Place<'_> {
    /// A program that pip has put beside the Python.
    fn tool(&self, name: &str, words: &[&str]) -> Command {
        let mut call = Command::new(program_in(&self.folder.join("venv"), name));
        call.args(words).current_dir(&self.folder);
        call
    }
}

fn with(mut call: Command, paths: &[&Path]) -> Command {
    call.args(paths);
    call
}

/// Whether cargo finds in the unpacked source distribution every crate of the workspace that the package needs. Not
/// `--locked`: the lock file has also the crates that are left out. That it builds is tried where wheels are released,
/// because it takes minutes.
fn unpacked(place: &Place, sdist: &Path) -> Result<(), String> {
    let folder = place.folder.join("sdist");
    if folder.is_dir() {
        std::fs::remove_dir_all(&folder).map_err(|error| error.to_string())?;
    }
    let mut unpack = Command::new(&place.python);
    unpack.args(["-m", "tarfile", "--extract"]).args([sdist, &folder]);
    outcome(&mut unpack)?;
    let name = sdist.file_name().unwrap_or_default().to_string_lossy();
    let root = folder.join(name.trim_end_matches(".tar.gz"));
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    outcome(
        Command::new(cargo)
            .args(["metadata", "--quiet", "--offline"])
            .args(["--format-version", "1", "--manifest-path"])
            .arg(root.join("crates/stiffarm-py/Cargo.toml")),
    )
}

/// Runs the program of a check and notes what comes of it.
fn check(checked: &mut Checked, name: &str, mut call: Command) {
    checked.note(name, &timed(name, || outcome(&mut call)));
}

/// Whether a program ends well. What it says is shown where it does not, and a line of it is the reason.
fn outcome(call: &mut Command) -> Result<(), String> {
    let program = call.get_program().to_string_lossy().into_owned();
    let output = call
        .env("PYTHONIOENCODING", "utf-8")
        .env("NO_COLOR", "1")
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("`{program}` could not be run: {error}"))?;
    if output.status.success() {
        return Ok(());
    }
    let said = [output.stdout, output.stderr].map(|s| String::from_utf8_lossy(&s).into_owned());
    said.iter().for_each(|text| print!("{text}"));
    Err(complaint(&said).unwrap_or_else(|| output.status.to_string()))
}

/// The line of what a program says that tells most: its last error, or the last line at all.
fn complaint(said: &[String]) -> Option<String> {
    let lines = || said.iter().flat_map(|text| text.lines()).map(str::trim);
    let error = lines().rfind(|line| line.to_lowercase().starts_with("error"));
    let last = || lines().rfind(|line| !line.is_empty());
    error.or_else(last).map(str::to_string)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_complaint_is_the_last_error_or_the_last_line() {
        let said = |texts: [&str; 2]| complaint(&texts.map(String::from));
        assert_eq!(said(["", " \n"]), None);
        assert_eq!(said(["a\nb\n\n", ""]).unwrap(), "b");
        assert_eq!(said(["1 error", "Error: x\nhelp: y\n"]).unwrap(), "Error: x");
    }

    #[test]
    fn a_check_is_noted_by_its_name_and_the_last_line_of_its_program() {
        let mut checked = Checked::default();
        let cargo = |word: &str| {
            let mut call = Command::new("cargo");
            call.arg(word);
            call
        };
        check(&mut checked, "version", cargo("--version"));
        check(&mut checked, "wrong", cargo("--no-such-flag"));
        check(&mut checked, "none", Command::new("no-such-program-of-stiffarm"));
        assert_eq!(checked.passed, 1);
        assert!(checked.failures[0].starts_with("wrong: "));
        assert!(checked.failures[1].contains("could not be run"));
    }
}
