//! Sheets filled by other programs: openpyxl and LibreOffice write a simulated experiment's readings into a sheet, and
//! `stiffarm identify` must make the same of it as of the readings as text (`xtask/sheets/fill.py`).

use std::path::{Path, PathBuf};

use crate::checked::Checked;
use crate::run::{Failure, Workspace};
use crate::tools::{self, Missing, call, first_that_runs, runs};

const INSTALL: &str = "cargo xtask sheets --install";

/// Fills sheets by each program; with `install`, what is missing is installed first.
pub fn run(workspace: &Workspace, install: bool) -> Result<Checked, Failure> {
    workspace.built()?;
    let scripts = workspace.root().join("xtask/sheets");
    let folder = tools::target(workspace).join("sheets");
    let paths = [scripts.join("fill.py"), tools::stiffarm()?, folder.clone()];
    let [script, stiffarm, target] = paths.each_ref().map(|path| path.to_string_lossy());
    let requirements = scripts.join("requirements.txt");
    let openpyxl = tools::python(&folder, &requirements, "import openpyxl", install);
    let mut checked = Checked::default();
    for (name, by, python) in [
        ("sheet filled by openpyxl", "openpyxl", openpyxl),
        ("sheet filled by LibreOffice", "libreoffice", office(install)),
    ] {
        let filled = match python {
            Ok(python) => call(&python, &[&script, by, &stiffarm, &target]),
            Err(Missing { reason, fix }) => {
                checked.skip(name, reason, fix);
                continue;
            }
        };
        if let Ok(said) = &filled {
            println!("{}", said.trim_end());
        }
        checked.note(name, &filled);
    }
    Ok(checked)
}

/// `cargo xtask sheets`: this part alone.
pub fn alone(workspace: &Workspace, install: bool) -> Result<(), Failure> {
    run(workspace, install)?.tell()
}

/// A Python that reaches LibreOffice.
fn office(install: bool) -> Result<PathBuf, Missing> {
    let ready = || {
        let office = runs(Path::new("soffice"), &["--version"]);
        let python = first_that_runs(&["/usr/bin/python3", "python3"], &["-c", "import uno"]);
        python.filter(|_| office)
    };
    if install && ready().is_none() {
        tools::apt_install(&["libreoffice-calc", "python3-uno"]);
    }
    ready()
        .map(PathBuf::from)
        .ok_or_else(|| Missing { reason: "there is no soffice with its Python bridge (uno)".to_string(), fix: INSTALL })
}
