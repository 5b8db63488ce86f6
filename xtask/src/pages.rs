//! Pages in real browsers: Chromium and Firefox open what stiffarm writes, and `xtask/pages/pages.py` checks it.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::arguments::PagesOptions;
use crate::outputs::fanuc;
use crate::reference::{REFERENCE_VARIABLE, reference_folder};
use crate::run::{Failure, Workspace, copy_lines};

use crate::tools::{self, Missing, first_that_runs};

/// What came of the checks.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Checked {
    /// How many passed.
    pub passed: usize,
    /// Page, check and reason of each that failed.
    pub failures: Vec<String>,
    /// Page or browser that was not looked at, the reason, and the fix.
    pub skips: Vec<[String; 3]>,
    /// The counts of the script's last line.
    told: Option<[usize; 3]>,
}

/// How the browsers may be called.
const CHROMIUM: [&str; 5] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
];
const FIREFOX: [&str; 3] = [
    "firefox-esr",
    "firefox",
    "/Applications/Firefox.app/Contents/MacOS/firefox",
];

const INSTALL: &str = "cargo xtask pages --install, as root on Debian";

/// Makes the pages and checks them.
pub fn run(workspace: &Workspace, options: &PagesOptions) -> Result<Checked, Failure> {
    let build = workspace.cargo(&["build", "--package", "stiffarm-cli", "--locked"]);
    println!("{build}");
    build.run()?;

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
            checked.skip(
                format!("pages in {name}"),
                format!("there is no {name}"),
                INSTALL,
            );
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
            checked.skip("pages in browsers".to_string(), reason, fix);
            return Ok(checked);
        }
    };

    let mut words: Vec<OsString> = vec![script.join("pages.py").into()];
    let mut option = |name: &str, value: OsString| words.extend([name.into(), value]);
    option("--stiffarm", tools::stiffarm(workspace).into());
    option("--folder", folder.clone().into());
    for (browser, name) in browsers.iter().zip(["--chromium", "--firefox"]) {
        if let Some(browser) = browser {
            option(name, full_path(browser).into());
        }
    }
    if let Ok(measured) = fanuc::folder(reference_folder(std::env::var_os(REFERENCE_VARIABLE))) {
        let table = folder.join("fanuc.csv");
        fanuc::write(&measured, &table)?;
        option("--fanuc", table.into());
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
    checked.run(&python, &words)?;
    Ok(checked)
}

/// `cargo xtask pages`: this part alone.
pub fn alone(workspace: &Workspace, options: &PagesOptions) -> Result<(), Failure> {
    let checked = run(workspace, options)?;
    println!();
    for [name, reason, fix] in &checked.skips {
        println!("SKIPPED {name}: {reason}; fix: {fix}");
    }
    for failure in &checked.failures {
        println!("FAILED {failure}");
    }
    match checked.failures.is_empty() {
        true => Ok(()),
        false => Err(Failure::already_told()),
    }
}

/// Where a program of that name lies: the browsers are started by other programs, which do not search for them.
fn full_path(name: &str) -> PathBuf {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let mut places = std::env::split_paths(&folders).map(|folder| folder.join(name));
    let found = places.find(|place| place.is_file());
    found.unwrap_or_else(|| PathBuf::from(name))
}

impl Checked {
    fn skip(&mut self, name: String, reason: String, fix: &str) {
        self.skips.push([name, reason, fix.to_string()]);
    }

    /// Runs the script and takes in what it prints. One that dies on its way is a failure.
    fn run(&mut self, python: &Path, words: &[OsString]) -> Result<(), Failure> {
        let unusable = |error: std::io::Error| {
            Failure::internal(
                format!("`{}` could not be run: {error}", python.display()),
                "delete target/pages, and run it again",
            )
        };
        let mut child = Command::new(python)
            .args(words)
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .env("PYTHONIOENCODING", "utf-8")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(unusable)?;
        if let Some(output) = child.stdout.take() {
            let output = std::io::BufReader::new(output);
            copy_lines(output, std::io::stdout(), |line| self.see(line)).map_err(unusable)?;
        }
        let status = child.wait().map_err(unusable)?;
        self.close(&status.to_string());
        Ok(())
    }

    /// Takes in one line of the script.
    fn see(&mut self, line: &str) {
        if line.starts_with("ok ") {
            self.passed += 1;
        } else if let Some(failure) = line.strip_prefix("FAILED ") {
            self.failures.push(failure.to_string());
        } else if let Some(skip) = line.strip_prefix("SKIPPED ") {
            let (name, rest) = skip.split_once(": ").unwrap_or((skip, ""));
            let (reason, fix) = rest.split_once("; fix: ").unwrap_or((rest, INSTALL));
            self.skip(name.to_string(), reason.to_string(), fix);
        } else if let Some(counts) = line.strip_prefix("pages: ") {
            let counts: Vec<usize> = counts
                .split(", ")
                .filter_map(|count| count.split(' ').next()?.parse().ok())
                .collect();
            self.told = counts.try_into().ok();
        }
    }

    /// What the script ended with: its last line must count what the others said.
    fn close(&mut self, status: &str) {
        let told = self.told.map(|[passed, failed, _]| [passed, failed]);
        if told != Some([self.passed, self.failures.len()]) {
            let why = format!("pages.py: it came not to its end ({status})");
            self.failures.push(why);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINES: [&str; 5] = [
        "ok sample: size (0.01 MB)",
        "pictures of sample in look",
        "FAILED study: steps: scene cell: no list",
        "SKIPPED page fanuc: there are no data; fix: set it",
        "pages: 1 passed, 1 failed, 1 skipped",
    ];

    fn seen(lines: &[&str]) -> Checked {
        let mut checked = Checked::default();
        lines.iter().for_each(|line| checked.see(line));
        checked.close("exit status: 1");
        checked
    }

    #[test]
    fn lines_of_the_script_add_up() {
        let checked = seen(&LINES);
        assert_eq!(checked.passed, 1);
        assert_eq!(checked.failures, ["study: steps: scene cell: no list"]);
        let skip = ["page fanuc", "there are no data", "set it"].map(String::from);
        assert_eq!(checked.skips, [skip]);
    }

    #[test]
    fn a_script_that_dies_or_counts_otherwise_is_a_failure() {
        for lines in [&LINES[..4], &[], &LINES[1..]] {
            let last = seen(lines).failures.pop().unwrap();
            assert_eq!(last, "pages.py: it came not to its end (exit status: 1)");
        }
    }
}
