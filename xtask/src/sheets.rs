//! Sheets filled by other programs: openpyxl and LibreOffice write a simulated experiment's readings into a sheet, and
//! `stiffarm identify` must make the same of it as of the readings as text (`xtask/sheets/fill.py`).

use std::path::{Path, PathBuf};

use crate::run::{Failure, Workspace};
use crate::tools::{self, Missing, call, first_that_runs, runs};

/// What became of one of the programs.
#[derive(Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The results agree.
    Passed,
    /// They do not, or the check did not come to its end.
    Failed(String),
    /// The machine lacks something.
    Skipped(Missing),
}

/// A program, by the name that `fill.py` has for it, and what came of it.
pub struct Filled {
    /// Name of the check in the list of what was skipped or failed.
    pub name: &'static str,
    /// What came of it.
    pub outcome: Outcome,
}

const INSTALL: &str = "cargo xtask sheets --install";

/// Fills sheets by each program; with `install`, what is missing is installed first.
pub fn run(workspace: &Workspace, install: bool) -> Result<Vec<Filled>, Failure> {
    let build = workspace.build();
    println!("{build}");
    build.run()?;
    let place = Place {
        script: workspace.root().join("xtask/sheets"),
        stiffarm: tools::stiffarm(workspace),
        folder: tools::target(workspace).join("sheets"),
    };
    let filled = [
        ("sheet filled by openpyxl", place.openpyxl(install)),
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
            Outcome::Skipped(Missing { reason, fix }) => {
                println!("SKIPPED {name}: {reason}; fix: {fix}")
            }
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
    fn openpyxl(&self, install: bool) -> Outcome {
        let requirements = self.script.join("requirements.txt");
        match tools::python(&self.folder, &requirements, "import openpyxl", install) {
            Ok(python) => self.fill(&python, "openpyxl"),
            Err(missing) => Outcome::Skipped(missing),
        }
    }

    fn libreoffice(&self, install: bool) -> Outcome {
        let ready = || {
            let office = runs(Path::new("soffice"), &["--version"]);
            let python = first_that_runs(&["/usr/bin/python3", "python3"], &["-c", "import uno"]);
            python.filter(|_| office)
        };
        if install && ready().is_none() {
            tools::apt_install(&["libreoffice-calc", "python3-uno"]);
        }
        match ready() {
            Some(python) => self.fill(Path::new(python), "libreoffice"),
            None => Outcome::Skipped(Missing {
                reason: "there is no soffice with its Python bridge (uno)".to_string(),
                fix: INSTALL,
            }),
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
