//! The wheel: built from the checkout, and installed where its bytes are new.

use std::path::{Path, PathBuf};

use super::Place;
use crate::checked::Checked;
use crate::run::Failure;
use crate::tools::{self, call, program_in};

/// What cargo calls the extension module.
const MODULE: &str = if cfg!(windows) {
    "_stiffarm.dll"
} else if cfg!(target_os = "macos") {
    "lib_stiffarm.dylib"
} else {
    "lib_stiffarm.so"
};

/// Puts the wheel together with the extension module of the one build and installs it into the virtual environment;
/// none where it cannot be made, which is noted as a failure.
pub fn built_and_installed(place: &Place, checked: &mut Checked) -> Result<Option<PathBuf>, Failure> {
    let folder = place.folder.join("wheels");
    empty(&folder)?;
    place.workspace.built()?;
    let script = place.workspace.root().join("xtask/python/wheel.py");
    let (module, command) = (tools::built(MODULE)?, tools::stiffarm()?);
    let paths = [&script, &place.package, &module, &command, &folder].map(|path| path.to_string_lossy());
    let made = call(&place.python, &paths.each_ref().map(|path| path.as_ref()))
        .and_then(|_| only_file(&folder, "whl").ok_or_else(|| "there is not one".to_string()));
    let installed = made.and_then(|wheel| {
        let path = wheel.to_string_lossy();
        let words = ["-m", "pip", "install", "--quiet", "--no-deps"];
        let words = [&words[..], &["--force-reinstall", &path]].concat();
        let noted = place.folder.join("venv/stiffarm.whl");
        install(&wheel, &noted, || call(&place.python, &words)).map(|()| wheel.clone())
    });
    checked.note("the wheel is made and installed", &installed);
    Ok(installed.ok())
}

/// The source distribution, beside the wheel.
pub fn sdist(place: &Place) -> Result<PathBuf, String> {
    let folder = place.folder.join("wheels");
    let manifest = place.package.join("Cargo.toml");
    let [manifest, out] = [&manifest, &folder].map(|path| path.to_string_lossy());
    let words = ["-m", "maturin", "sdist", "--manifest-path", &manifest, "--out", &out];
    call(&place.python, &words)?;
    only_file(&folder, "gz").ok_or_else(|| "maturin made none".to_string())
}

/// A virtual environment of another Python with the wheel, and with what [`super::SMOKE`] needs in the versions that
/// are noted for it; the error is why there is none.
pub fn smoke_environment(place: &Place, version: &str, interpreter: &Path, wheel: &Path) -> Result<PathBuf, String> {
    let venv = place.folder.join(format!("venv-{version}"));
    let python = program_in(&venv, "python");
    let noted = venv.join("stiffarm.whl");
    let list = super::requirements(&place.package, version);
    let path = |path: &Path| path.to_string_lossy().into_owned();
    if !noted.is_file() {
        let words = ["-m", "venv", "--clear", "--without-pip", &path(&venv)];
        call(interpreter, &words)?;
    }
    install(wheel, &noted, || {
        let (python, list, wheel) = (path(&python), path(&list), path(wheel));
        let words = ["-m", "pip", "--python", &python, "install", "--quiet"];
        let what = ["--only-binary=:all:", "--constraint", &list, "--force-reinstall", "pytest", &wheel];
        call(&place.python, &[&words[..], &what].concat())
    })?;
    Ok(python)
}

/// Installs the wheel unless `noted` is a copy of it.
fn install(wheel: &Path, noted: &Path, install: impl FnOnce() -> Result<String, String>) -> Result<(), String> {
    let bytes = std::fs::read(wheel).map_err(|error| error.to_string())?;
    if std::fs::read(noted).is_ok_and(|noted| noted == bytes) {
        return Ok(());
    }
    install()?;
    std::fs::write(noted, &bytes).map_err(|error| error.to_string())
}

/// An empty folder: what an earlier version left would be taken for the new.
fn empty(folder: &Path) -> Result<(), Failure> {
    if folder.is_dir() {
        std::fs::remove_dir_all(folder).map_err(|error| unusable(folder, &error))?;
    }
    std::fs::create_dir_all(folder).map_err(|error| unusable(folder, &error))
}

fn unusable(folder: &Path, error: &std::io::Error) -> Failure {
    Failure::internal(format!("`{}` cannot be written: {error}", folder.display()), "delete it, and run it again")
}

/// The file of `folder` with this extension, where there is exactly one.
fn only_file(folder: &Path, extension: &str) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?;
    let mut paths = entries.flatten().map(|entry| entry.path());
    let mut matching = paths.by_ref().filter(|path| path.extension().is_some_and(|e| e == extension));
    let first = matching.next();
    first.filter(|_| matching.next().is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wheel_is_installed_once() {
        let folder = std::env::temp_dir().join(format!("xtask-wheel-{}", std::process::id()));
        empty(&folder).unwrap();
        assert_eq!(only_file(&folder, "whl"), None);
        let wheel = folder.join("a.whl");
        std::fs::write(&wheel, "one").unwrap();
        assert_eq!(only_file(&folder, "whl"), Some(wheel.clone()));

        let noted = folder.join("noted");
        let mut times = 0;
        let mut call = |says: Result<(), &str>| {
            let says = says.map(|()| String::new()).map_err(str::to_string);
            install(&wheel, &noted, || {
                times += 1;
                says
            })
        };
        assert_eq!(call(Err("no pip")), Err("no pip".to_string()));
        assert_eq!([call(Ok(())), call(Ok(()))], [Ok(()), Ok(())]);
        assert_eq!(times, 2);
        std::fs::write(&wheel, "two").unwrap();
        let mut again = false;
        install(&wheel, &noted, || {
            again = true;
            Ok(String::new())
        })
        .unwrap();
        assert!(again);

        std::fs::write(folder.join("b.whl"), "").unwrap();
        assert_eq!(only_file(&folder, "whl"), None);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
