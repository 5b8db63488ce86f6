//! Programs of other projects that parts of the tests need: whether they are there, calling them, and getting them.

use std::env::consts::EXE_SUFFIX;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;

use crate::run::{Failure, Workspace};

/// Why something is not there, and how to get it.
#[derive(Debug, PartialEq, Eq)]
pub struct Missing {
    /// What is missing.
    pub reason: String,
    /// How to get it.
    pub fix: &'static str,
}

/// How a Python may be called, first the one that people mean.
const PYTHONS: [&str; 7] = ["python3", "python", "python3.14", "python3.13", "python3.12", "python3.11", "python3.10"];

/// What the scripts need of Python.
const PYTHON: &str = "import sys; sys.exit(sys.version_info < (3, 10))";

/// The folder that cargo builds in.
pub fn target(workspace: &Workspace) -> PathBuf {
    match std::env::var_os("CARGO_TARGET_DIR") {
        Some(folder) => workspace.root().join(folder),
        None => workspace.root().join("target"),
    }
}

/// The command, from [`Workspace::build`].
pub fn stiffarm() -> Result<PathBuf, Failure> {
    built(&format!("stiffarm{EXE_SUFFIX}"))
}

/// A file that [`Workspace::build`] has left in the folder of this program.
pub fn built(file: &str) -> Result<PathBuf, Failure> {
    match std::env::current_exe().map(|this| this.with_file_name(file)) {
        Ok(path) if path.is_file() => Ok(path),
        _ => Err(Failure::internal(
            format!("`{file}` does not lie beside this program"),
            "start it as `cargo xtask`, which builds both into one folder",
        )),
    }
}

/// How the machine's Python is called, if it has one that is new enough.
pub fn interpreter() -> Option<&'static str> {
    first_that_runs(&PYTHONS, &["-c", PYTHON])
}

/// The Python of a virtual environment in `folder` that holds what `requirements` lists; `imports` is a statement that
/// succeeds once it does. With `install`, Debian's Python is installed where there is none that can make one.
pub fn python(folder: &Path, requirements: &Path, imports: &str, install: bool) -> Result<PathBuf, Missing> {
    let venv = folder.join("venv");
    let bin = program_in(&venv, "python");
    // Which versions are wanted changes with the file: what was installed by another is made anew.
    let wanted = std::fs::read(requirements).unwrap_or_default();
    let noted = venv.join("requirements.txt");
    if std::fs::read(&noted).is_ok_and(|noted| noted == wanted) && runs(&bin, &["-c", imports]) {
        return Ok(bin);
    }
    let make = || {
        let python = interpreter()?;
        Some(call(Path::new(python), &["-m", "venv", "--clear", &venv.to_string_lossy()]))
    };
    let mut made = make();
    if install && !matches!(made, Some(Ok(_))) {
        apt_install(&["python3", "python3-venv"]);
        made = make();
    }
    let made = made.ok_or_else(|| Missing {
        reason: "there is no Python 3.10 or newer".to_string(),
        fix: "install Python from python.org or the system's packages",
    })?;
    let list = requirements.to_string_lossy();
    made.and_then(|_| {
        call(
            &bin,
            // Of gigabytes of packages the tests import a part, which Python compiles itself.
            &["-m", "pip", "install", "--quiet", "--no-compile", "--requirement", &list],
        )
    })
    .and_then(|_| std::fs::write(&noted, &wanted).map_err(|e| e.to_string()))
    .map_err(|why| Missing {
        reason: format!("what {list} lists could not be installed into {}: {why}", venv.display()),
        fix: "give pip a way to pypi.org, and run it again",
    })?;
    Ok(bin)
}

/// Where a virtual environment has a program.
pub fn program_in(venv: &Path, name: &str) -> PathBuf {
    if cfg!(windows) { venv.join(format!("Scripts/{name}.exe")) } else { venv.join(format!("bin/{name}")) }
}

/// Installs Debian's packages, as root; what is missing afterwards is told by those who look for it.
pub fn apt_install(packages: &[&str]) {
    // One at a time: apt refuses a second.
    static APT: Mutex<()> = Mutex::new(());
    let _turn = APT.lock();
    println!("installing {}", packages.join(", "));
    let mut arguments = vec!["install", "-y", "-qq", "--no-install-recommends"];
    arguments.extend(packages);
    for arguments in [&["update", "-qq"][..], &arguments] {
        if let Err(why) = call(Path::new("apt-get"), arguments) {
            println!("apt-get {}: {why}", arguments[0]);
        }
    }
}

/// The first of `programs` that ends well with `arguments`.
pub fn first_that_runs<'p>(programs: &[&'p str], arguments: &[&str]) -> Option<&'p str> {
    let mut programs = programs.iter().copied();
    programs.find(|program| runs(Path::new(program), arguments))
}

/// Whether a program is there and ends well.
pub fn runs(program: &Path, arguments: &[&str]) -> bool {
    output(program, arguments).is_ok_and(|output| output.status.success())
}

/// What a program prints; the error is the last line that it complains with.
pub fn call(program: &Path, arguments: &[&str]) -> Result<String, String> {
    let output = output(program, arguments).map_err(|e| format!("`{}` could not be run: {e}", program.display()))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let complaint = String::from_utf8_lossy(&output.stderr);
    let last = complaint.lines().rfind(|line| !line.trim().is_empty());
    Err(last.map_or_else(|| output.status.to_string(), str::to_string))
}

fn output(program: &Path, arguments: &[&str]) -> std::io::Result<Output> {
    Command::new(program).args(arguments).env("DEBIAN_FRONTEND", "noninteractive").stdin(Stdio::null()).output()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_that_is_not_there_or_fails_says_so() {
        let none = Path::new("no-such-program-of-stiffarm");
        assert!(!runs(none, &[]));
        assert!(call(none, &[]).unwrap_err().contains("could not be run"));
        assert_eq!(first_that_runs(&["no-such-program-of-stiffarm"], &[]), None);
        let cargo = Path::new("cargo");
        assert!(call(cargo, &["--version"]).unwrap().starts_with("cargo"));
        assert!(call(cargo, &["no-such-subcommand"]).is_err());
    }
}
