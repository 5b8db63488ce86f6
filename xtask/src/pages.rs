//! Pages in real browsers: Chromium and Firefox open what stiffarm writes, and `xtask/pages/pages.py` checks it.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

use crate::arguments;
use crate::checked::{Checked, Script};
use crate::run::{Failure, Workspace};
use crate::tools::{self, Missing, first_that_runs};

/// How the browsers may be called.
const CHROMIUM: [&str; 5] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
];
const FIREFOX: [&str; 3] = ["firefox-esr", "firefox", "/Applications/Firefox.app/Contents/MacOS/firefox"];

const INSTALL: &str = "cargo xtask pages --install, as root on Debian";

const SCRIPT: Script = Script { name: "pages.py", word: "pages", fix: INSTALL };

/// Makes the pages and checks them.
pub fn run(workspace: &Workspace, options: &arguments::Pages) -> Result<Checked, Failure> {
    workspace.built()?;

    let mut checked = Checked::default();
    let find = || [&CHROMIUM[..], &FIREFOX].map(|names| first_that_runs(names, &["--version"]));
    let mut browsers = find();
    if options.install && browsers.contains(&None) {
        let mut packages: Vec<&str> = Vec::new();
        for (browser, package) in browsers.iter().zip(["chromium", "firefox-esr"]) {
            packages.extend(browser.is_none().then_some(package));
        }
        tools::apt_install(&packages);
        browsers = find();
    }
    for (browser, name) in browsers.iter().zip(["Chromium", "Firefox"]) {
        if browser.is_none() {
            checked.skip(format!("pages in {name}"), format!("there is no {name}"), INSTALL);
        }
    }
    if browsers == [None, None] {
        return Ok(checked);
    }
    let folder = tools::target(workspace).join("pages");
    let script = workspace.root().join("xtask/pages");
    let requirements = script.join("requirements.txt");
    let imports = "import PIL, axe_playwright_python, playwright";
    let python = match tools::python(&folder, &requirements, imports, options.install) {
        Ok(python) => python,
        Err(Missing { reason, fix }) => {
            checked.skip("pages in browsers", reason, fix);
            return Ok(checked);
        }
    };

    let mut words: Vec<OsString> = vec![script.join("pages.py").into()];
    let mut option = |name: &str, value: OsString| words.extend([name.into(), value]);
    option("--stiffarm", tools::stiffarm()?.into());
    option("--folder", folder.clone().into());
    for (browser, name) in browsers.iter().zip(["--chromium", "--firefox"]) {
        if let Some(browser) = browser {
            option(name, full_path(browser).into());
        }
    }
    if let Some(look) = &options.look {
        option("--look", look.into());
    }
    if let Some(gallery) = &options.gallery {
        option("--gallery", gallery.into());
    }
    if let Some(only) = &options.only {
        option("--only", only.into());
    }
    words.extend(options.all.then(|| OsString::from("--all")));
    checked.add(Checked::run(&SCRIPT, Command::new(python).args(words))?);
    Ok(checked)
}

/// `cargo xtask pages`: this part alone.
pub fn alone(workspace: &Workspace, options: &arguments::Pages) -> Result<(), Failure> {
    run(workspace, options)?.tell()
}

/// Where a program of that name lies: the browsers are started by other programs, which do not search for them.
fn full_path(name: &str) -> PathBuf {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let mut places = std::env::split_paths(&folders).map(|folder| folder.join(name));
    let place = places.find(|place| place.is_file());
    place.unwrap_or_else(|| PathBuf::from(name))
}
