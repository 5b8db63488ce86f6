//! Sheets filled by other programs: openpyxl and LibreOffice write a simulated experiment's readings into a sheet, and
//! `stiffarm identify` must make the same of it as of the readings as text (`xtask/sheets/fill.py`).

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use crate::run::{Failure, Workspace};

/// What became of one of the programs.
#[derive(Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The results agree.
    Passed,
    /// They do not, or the check did not come to its end.
    Failed(String),
    /// The machine lacks something.
    Skipped {
        /// What is missing.
        reason: String,
        /// How to get it.
        fix: &'static str,
    },
}

/// A program, by the name that `fill.py` has for it, and what came of it.
pub struct Filled {
    /// Name of the check in the list of what was skipped or failed.
    pub name: &'static str,
    /// What came of it.
    pub outcome: Outcome,
}

/// What `fill.py` needs of Python.
const PYTHON: &str = "import sys; sys.exit(sys.version_info < (3, 10))";

const INSTALL: &str = "cargo xtask sheets --install";

/// Fills sheets by each program; with `install`, what is missing is installed first.
pub fn run(workspace: &Workspace, install: bool) -> Result<Vec<Filled>, Failure> {
    let build = workspace.cargo(&["build", "--package", "stiffarm-cli", "--locked"]);
    println!("{build}");
    build.run()?;
    let target = match std::env::var_os("CARGO_TARGET_DIR") {
        Some(folder) => workspace.root().join(folder),
        None => workspace.root().join("target"),
    };
    let place = Place {
        script: workspace.root().join("xtask/sheets"),
        stiffarm: target.join(format!("debug/stiffarm{}", std::env::consts::EXE_SUFFIX)),
        folder: target.join("sheets"),
    };
    let filled = [
        ("sheet filled by openpyxl", place.openpyxl()),
        ("sheet filled by LibreOffice", place.libreoffice(install)),
    ];
    Ok(filled
        .into_iter()
        .map(|(name, outcome)| Filled { name, outcome })
        .collect())
}

/// `cargo xtask sheets`: this part alone.
pub fn alone(workspace: &Workspace, install: bool) -> Result<(), Failure> {
    let mut failed = false;
    for Filled { name, outcome } in run(workspace, install)? {
        match outcome {
            Outcome::Passed => {}
            Outcome::Skipped { reason, fix } => println!("SKIPPED {name}: {reason}; fix: {fix}"),
            Outcome::Failed(why) => {
                println!("FAILED {name}: {why}");
                failed = true;
            }
        }
    }
    match failed {
        true => Err(Failure::already_told()),
        false => Ok(()),
    }
}

/// Where everything lies.
struct Place {
    script: PathBuf,
    stiffarm: PathBuf,
    folder: PathBuf,
}

impl Place {
    fn openpyxl(&self) -> Outcome {
        let python = match first_that_runs(&["python3", "python"], &["-c", PYTHON]) {
            Some(python) => python,
            None => {
                return Outcome::Skipped {
                    reason: "there is no Python 3.10 or newer".to_string(),
                    fix: "install Python from python.org or the system's packages",
                };
            }
        };
        let venv = self.folder.join("venv");
        let bin = venv.join(if cfg!(windows) {
            "Scripts/python.exe"
        } else {
            "bin/python"
        });
        if !runs(&bin, &["-c", "import openpyxl"]) {
            let requirements = self.script.join("requirements.txt");
            let made =
                call(Path::new(python), &["-m", "venv", &venv.to_string_lossy()]).and_then(|_| {
                    let wanted = requirements.to_string_lossy();
                    call(
                        &bin,
                        &["-m", "pip", "install", "--quiet", "--requirement", &wanted],
                    )
                });
            if let Err(why) = made {
                return Outcome::Skipped {
                    reason: format!(
                        "openpyxl could not be installed into {}: {why}",
                        venv.display()
                    ),
                    fix: "give pip a way to pypi.org, and run it again",
                };
            }
        }
        self.fill(&bin, "openpyxl")
    }

    fn libreoffice(&self, install: bool) -> Outcome {
        let ready = || {
            let office = runs(Path::new("soffice"), &["--version"]);
            let python = first_that_runs(&["/usr/bin/python3", "python3"], &["-c", "import uno"]);
            python.filter(|_| office)
        };
        if install && ready().is_none() {
            println!("installing libreoffice-calc and python3-uno");
            // What is missing afterwards is said below.
            let packages = [
                "install",
                "-y",
                "-qq",
                "--no-install-recommends",
                "libreoffice-calc",
                "python3-uno",
            ];
            let _ = call(Path::new("apt-get"), &["update", "-qq"]);
            let _ = call(Path::new("apt-get"), &packages);
        }
        match ready() {
            Some(python) => self.fill(Path::new(python), "libreoffice"),
            None => Outcome::Skipped {
                reason: "there is no soffice with its Python bridge (uno)".to_string(),
                fix: INSTALL,
            },
        }
    }

    fn fill(&self, python: &Path, by: &str) -> Outcome {
        let script = self.script.join("fill.py");
        let paths = [&script, &self.stiffarm, &self.folder].map(|path| path.to_string_lossy());
        match call(python, &[&paths[0], by, &paths[1], &paths[2]]) {
            Ok(said) => {
                println!("{}", said.trim_end());
                Outcome::Passed
            }
            Err(why) => Outcome::Failed(why),
        }
    }
}

/// The first of `programs` that ends well with `arguments`.
fn first_that_runs<'p>(programs: &[&'p str], arguments: &[&str]) -> Option<&'p str> {
    let mut programs = programs.iter().copied();
    programs.find(|program| runs(Path::new(program), arguments))
}

fn runs(program: &Path, arguments: &[&str]) -> bool {
    output(program, arguments).is_ok_and(|output| output.status.success())
}

/// What a program prints; the error is the last line that it complains with.
fn call(program: &Path, arguments: &[&str]) -> Result<String, String> {
    let output = output(program, arguments)
        .map_err(|e| format!("`{}` could not be run: {e}", program.display()))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let complaint = String::from_utf8_lossy(&output.stderr);
    let last = complaint.lines().rfind(|line| !line.trim().is_empty());
    Err(last.map_or_else(|| output.status.to_string(), str::to_string))
}

fn output(program: &Path, arguments: &[&str]) -> std::io::Result<Output> {
    Command::new(program)
        .args(arguments)
        .env("DEBIAN_FRONTEND", "noninteractive")
        .stdin(Stdio::null())
        .output()
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
