//! The command line of `cargo xtask`: text to [`Command`].

use std::path::PathBuf;

use crate::run::Failure;

/// What `cargo xtask help` prints.
pub const HELP: &str = include_str!("help.txt");

/// One parsed command line.
#[derive(Debug, PartialEq, Eq)]
pub enum Command {
    /// Print [`HELP`].
    Help,
    /// Run the tests.
    Test(TestOptions),
    /// Write the generated files, or with `check` compare them.
    Generate {
        /// Compare only.
        check: bool,
    },
    /// Keep what `stiffarm` prints and writes, and compare it.
    Outputs(OutputsOptions),
    /// Write the catalogue's data file, or with `check` compare it.
    Robots {
        /// The folder of the robot descriptions.
        folder: PathBuf,
        /// Compare only.
        check: bool,
    },
    /// Write the bundle of three.js, or with `check` compare it.
    Viewer {
        /// Compare only.
        check: bool,
    },
    /// Mutated inputs for readers and commands; the words are the fuzzer's.
    Fuzz(Vec<String>),
    /// Every check that is not a test.
    Lint,
    /// Sheets that other programs fill, alone.
    Sheets {
        /// Install what the machine lacks.
        install: bool,
    },
    /// Pages in browsers, alone.
    Pages(PagesOptions),
    /// The Python package, alone.
    Python(PythonOptions),
    /// [`Command::Lint`], then [`Command::Test`].
    Ci(TestOptions),
}

/// Options of `cargo xtask test`.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct TestOptions {
    /// Install what the machine lacks.
    pub install: bool,
    /// Parts that must not skip anything.
    pub require: Vec<Part>,
}

/// Options of `cargo xtask python`.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct PythonOptions {
    /// Install what the machine lacks.
    pub install: bool,
    /// Only these checks of the package.
    pub only: Option<Checks>,
    /// Handed to pytest.
    pub words: Vec<String>,
}

/// Checks of the Python package that belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Checks {
    /// The tests, on the installed wheel.
    Pytest,
    /// Annotations and stubs.
    Types,
    /// The code in Rust, and what would be published.
    Package,
}

/// Options of `cargo xtask pages`.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct PagesOptions {
    /// Install what the machine lacks.
    pub install: bool,
    /// Leave pictures of all pages in this folder.
    pub look: Option<PathBuf>,
    /// Make the pictures of the documentation in this folder instead of checking.
    pub gallery: Option<PathBuf>,
    /// Only these kinds of pages, with commas between them.
    pub only: Option<String>,
}

/// Options of `cargo xtask outputs`.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct OutputsOptions {
    /// The folder to fill.
    pub folder: PathBuf,
    /// The folder to compare it with.
    pub against: Option<PathBuf>,
    /// The executable to run instead of one that is built.
    pub binary: Option<PathBuf>,
    /// Numbers of threads to run with; none leaves it to the machine.
    pub threads: Vec<usize>,
    /// Whether to leave out what computes nothing new.
    pub is_brief: bool,
}

/// A part of the test suite that a machine may or may not be able to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// `cargo test` of the whole workspace, with doc tests.
    Rust,
    /// The Rust tests that read the reference data.
    Reference,
    /// Sheets that openpyxl and LibreOffice fill.
    Sheets,
    /// The Python package.
    Python,
    /// The wheel on the other Pythons that it supports.
    OtherPythons,
    /// The pages in a real browser.
    Browser,
}

impl Part {
    const ALL: [Part; 6] = [
        Part::Rust,
        Part::Reference,
        Part::Sheets,
        Part::Python,
        Part::OtherPythons,
        Part::Browser,
    ];

    /// The name that `--require` takes.
    pub fn name(self) -> &'static str {
        match self {
            Part::Rust => "rust",
            Part::Reference => "reference",
            Part::Sheets => "sheets",
            Part::Python => "python",
            Part::OtherPythons => "other-pythons",
            Part::Browser => "browser",
        }
    }
}

/// Parses the arguments after `cargo xtask`.
pub fn parse(arguments: &[String]) -> Result<Command, Failure> {
    let Some((name, rest)) = arguments.split_first() else {
        return Ok(Command::Help);
    };
    match name.as_str() {
        "help" | "--help" | "-h" => Ok(Command::Help),
        _ if (rest.iter().take_while(|a| *a != "--")).any(|a| a == "--help" || a == "-h") => {
            Ok(Command::Help)
        }
        "test" => Ok(Command::Test(parse_test(name, rest)?)),
        "ci" => Ok(Command::Ci(parse_test(name, rest)?)),
        "generate" => match rest {
            [] => Ok(Command::Generate { check: false }),
            [flag] if flag == "--check" => Ok(Command::Generate { check: true }),
            [flag] => Err(unexpected(name, flag)),
            [_, second, ..] => Err(unexpected(name, second)),
        },
        "viewer" => match rest {
            [] => Ok(Command::Viewer { check: false }),
            [flag] if flag == "--check" => Ok(Command::Viewer { check: true }),
            [flag] => Err(unexpected(name, flag)),
            [_, second, ..] => Err(unexpected(name, second)),
        },
        "sheets" => match rest {
            [] => Ok(Command::Sheets { install: false }),
            [flag] if flag == "--install" => Ok(Command::Sheets { install: true }),
            [first, ..] => Err(unexpected(name, first)),
        },
        "pages" => Ok(Command::Pages(parse_pages(rest)?)),
        "python" => Ok(Command::Python(parse_python(rest)?)),
        "outputs" => Ok(Command::Outputs(parse_outputs(rest)?)),
        "robots" => parse_robots(rest),
        "fuzz" => Ok(Command::Fuzz(rest.to_vec())),
        "lint" => match rest {
            [] => Ok(Command::Lint),
            [first, ..] => Err(unexpected(name, first)),
        },
        _ => Err(Failure::usage(
            format!("`{name}` is no command of `cargo xtask`"),
            "use test, sheets, pages, python, generate, outputs, robots, viewer, fuzz, lint, ci or help",
        )),
    }
}

/// Parses the options of `test`, which `ci` passes on.
fn parse_test(command: &str, rest: &[String]) -> Result<TestOptions, Failure> {
    let mut options = TestOptions::default();
    let mut rest = rest.iter();
    while let Some(argument) = rest.next() {
        if argument == "--install" {
            options.install = true;
        } else if let Some(parts) = argument.strip_prefix("--require=") {
            parse_parts(parts, &mut options.require)?;
        } else if argument == "--require" {
            let parts = rest.next().ok_or_else(|| {
                Failure::usage(
                    "`--require` has no value",
                    "name the parts after it, for example `--require rust,reference`",
                )
            })?;
            parse_parts(parts, &mut options.require)?;
        } else {
            return Err(unexpected(command, argument));
        }
    }
    Ok(options)
}

/// Parses the options of `python`.
fn parse_python(rest: &[String]) -> Result<PythonOptions, Failure> {
    let mut options = PythonOptions::default();
    let mut rest = rest.iter();
    while let Some(argument) = rest.next() {
        let value = match argument.as_str() {
            "--install" => {
                options.install = true;
                continue;
            }
            "--" => {
                options.words = rest.cloned().collect();
                break;
            }
            "--only" => rest.next().map(String::as_str),
            _ => Some(
                argument
                    .strip_prefix("--only=")
                    .ok_or_else(|| unexpected("python", argument))?,
            ),
        };
        options.only = Some(match value {
            Some("pytest") => Checks::Pytest,
            Some("types") => Checks::Types,
            Some("package") => Checks::Package,
            _ => {
                return Err(Failure::usage(
                    format!("`--only {}` names no checks", value.unwrap_or_default()),
                    "use pytest, types or package",
                ));
            }
        });
    }
    Ok(options)
}

/// Parses the options of `pages`.
fn parse_pages(rest: &[String]) -> Result<PagesOptions, Failure> {
    let mut options = PagesOptions::default();
    let mut rest = rest.iter();
    while let Some(argument) = rest.next() {
        let (name, joined) = match argument.split_once('=') {
            Some((name, value)) => (name, Some(value.to_string())),
            None => (argument.as_str(), None),
        };
        match name {
            "--install" if joined.is_none() => {
                options.install = true;
                continue;
            }
            "--look" | "--only" | "--gallery" => {}
            _ => return Err(unexpected("pages", argument)),
        }
        let value = joined.or_else(|| rest.next().cloned()).ok_or_else(|| {
            Failure::usage(
                format!("`{name}` has no value"),
                "see `cargo xtask help` for what it takes",
            )
        })?;
        match name {
            "--look" => options.look = Some(PathBuf::from(value)),
            "--gallery" => options.gallery = Some(PathBuf::from(value)),
            _ => options.only = Some(value),
        }
    }
    Ok(options)
}

/// Parses the folder and the options of `outputs`.
fn parse_outputs(rest: &[String]) -> Result<OutputsOptions, Failure> {
    let mut options = OutputsOptions::default();
    let mut folder = None;
    let mut rest = rest.iter();
    while let Some(argument) = rest.next() {
        let (name, joined) = match argument.split_once('=') {
            Some((name, value)) => (name, Some(value.to_string())),
            None => (argument.as_str(), None),
        };
        match name {
            "--against" | "--binary" | "--threads" => {}
            _ if argument == "--brief" => {
                options.is_brief = true;
                continue;
            }
            _ if argument.starts_with('-') || folder.is_some() => {
                return Err(unexpected("outputs", argument));
            }
            _ => {
                folder = Some(PathBuf::from(argument));
                continue;
            }
        }
        let value = joined.or_else(|| rest.next().cloned()).ok_or_else(|| {
            Failure::usage(
                format!("`{name}` has no value"),
                format!("name a path after it, for example `{name} target/path`"),
            )
        })?;
        match name {
            "--against" => options.against = Some(PathBuf::from(value)),
            "--binary" => options.binary = Some(PathBuf::from(value)),
            _ => options.threads = parse_threads(&value)?,
        }
    }
    options.folder = folder.ok_or_else(|| {
        Failure::usage(
            "`cargo xtask outputs` needs the folder to fill",
            "name it, for example `cargo xtask outputs target/outputs`",
        )
    })?;
    Ok(options)
}

/// Parses the folder and the flag of `robots`.
fn parse_robots(rest: &[String]) -> Result<Command, Failure> {
    let (mut folder, mut check) = (None, false);
    for argument in rest {
        match argument.as_str() {
            "--check" => check = true,
            _ if argument.starts_with('-') || folder.is_some() => {
                return Err(unexpected("robots", argument));
            }
            _ => folder = Some(PathBuf::from(argument)),
        }
    }
    let folder = folder.ok_or_else(|| {
        Failure::usage(
            "`cargo xtask robots` needs the folder of the robot descriptions",
            "name it, for example `cargo xtask robots ../shared/reference/robots`",
        )
    })?;
    Ok(Command::Robots { folder, check })
}

/// Numbers of threads with commas between them.
fn parse_threads(text: &str) -> Result<Vec<usize>, Failure> {
    let numbers: Option<Vec<usize>> = text
        .split(',')
        .map(|word| word.parse().ok().filter(|n| (1..=64).contains(n)))
        .collect();
    numbers.ok_or_else(|| {
        Failure::usage(
            format!("`--threads {text}` is no list of numbers from 1 to 64"),
            "write them with commas between them, for example `--threads 1,2,4`",
        )
    })
}

/// Adds the comma-separated part names in `text` to `parts`.
fn parse_parts(text: &str, parts: &mut Vec<Part>) -> Result<(), Failure> {
    for name in text.split(',') {
        let part = Part::ALL.into_iter().find(|part| part.name() == name);
        let part = part.ok_or_else(|| {
            Failure::usage(
                format!("`--require {text}`: `{name}` is no part of the tests"),
                format!("use {}", Part::ALL.map(Part::name).join(", ")),
            )
        })?;
        if !parts.contains(&part) {
            parts.push(part);
        }
    }
    Ok(())
}

fn unexpected(command: &str, argument: &str) -> Failure {
    Failure::usage(
        format!("`cargo xtask {command}` does not take `{argument}`"),
        "see `cargo xtask help`",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(line: &str) -> Result<Command, Failure> {
        let words: Vec<String> = line.split_whitespace().map(String::from).collect();
        parse(&words)
    }

    #[test]
    fn nothing_and_every_spelling_of_help_are_help() {
        for line in ["", "help", "--help", "-h", "test --help", "generate -h"] {
            assert_eq!(parsed(line).unwrap(), Command::Help, "{line}");
        }
    }

    #[test]
    fn test_options_are_read_in_both_spellings() {
        let expected = TestOptions {
            install: true,
            require: vec![Part::Rust, Part::Reference],
        };
        let command = parsed("test --install --require rust,reference").unwrap();
        assert_eq!(command, Command::Test(expected));
        let expected = TestOptions {
            install: false,
            require: vec![Part::Python, Part::Browser],
        };
        let command = parsed("ci --require=python --require browser,python").unwrap();
        assert_eq!(command, Command::Ci(expected));
    }

    #[test]
    fn generate_takes_check_alone() {
        assert_eq!(
            parsed("generate").unwrap(),
            Command::Generate { check: false }
        );
        assert_eq!(
            parsed("generate --check").unwrap(),
            Command::Generate { check: true }
        );
        assert_eq!(
            parsed("viewer --check").unwrap(),
            Command::Viewer { check: true }
        );
        assert_eq!(parsed("lint").unwrap(), Command::Lint);
        assert_eq!(
            parsed("sheets --install").unwrap(),
            Command::Sheets { install: true }
        );
    }

    #[test]
    fn fuzz_takes_the_words_of_the_fuzzer() {
        let words = ["--target", "cell", "--seconds", "5"].map(String::from);
        assert_eq!(
            parsed("fuzz --target cell --seconds 5").unwrap(),
            Command::Fuzz(words.to_vec())
        );
        assert_eq!(parsed("fuzz --help").unwrap(), Command::Help);
    }

    #[test]
    fn outputs_takes_a_folder_and_two_paths() {
        let plain = OutputsOptions {
            folder: PathBuf::from("now"),
            ..OutputsOptions::default()
        };
        assert_eq!(parsed("outputs now").unwrap(), Command::Outputs(plain));
        for line in [
            "outputs now --against before --binary target/release/stiffarm --threads 1,2 --brief",
            "outputs --brief --binary=target/release/stiffarm --against=before --threads=1,2 now",
        ] {
            let expected = OutputsOptions {
                folder: PathBuf::from("now"),
                against: Some(PathBuf::from("before")),
                binary: Some(PathBuf::from("target/release/stiffarm")),
                threads: vec![1, 2],
                is_brief: true,
            };
            assert_eq!(parsed(line).unwrap(), Command::Outputs(expected), "{line}");
        }
    }

    #[test]
    fn robots_takes_a_folder() {
        for (line, check) in [("robots data", false), ("robots --check data", true)] {
            let folder = PathBuf::from("data");
            assert_eq!(
                parsed(line).unwrap(),
                Command::Robots { folder, check },
                "{line}"
            );
        }
    }

    #[test]
    fn pages_takes_a_folder_for_pictures_and_kinds() {
        for line in [
            "pages --install --look pictures --only study,map",
            "pages --only=study,map --look=pictures --install",
        ] {
            let expected = PagesOptions {
                install: true,
                look: Some(PathBuf::from("pictures")),
                gallery: None,
                only: Some("study,map".to_string()),
            };
            assert_eq!(parsed(line).unwrap(), Command::Pages(expected), "{line}");
        }
        let failure = parsed("pages --look").unwrap_err();
        assert_eq!(failure.message, "`--look` has no value");
        let failure = parsed("pages study").unwrap_err();
        assert_eq!(failure.message, "`cargo xtask pages` does not take `study`");
    }

    #[test]
    fn python_takes_checks_and_words_for_pytest() {
        for line in [
            "python --install --only pytest -- -k cell -h",
            "python --only=pytest --install -- -k cell -h",
        ] {
            let expected = PythonOptions {
                install: true,
                only: Some(Checks::Pytest),
                words: ["-k", "cell", "-h"].map(String::from).to_vec(),
            };
            assert_eq!(parsed(line).unwrap(), Command::Python(expected), "{line}");
        }
        for (only, checks) in [("types", Checks::Types), ("package", Checks::Package)] {
            let expected = PythonOptions {
                only: Some(checks),
                ..PythonOptions::default()
            };
            let command = parsed(&format!("python --only {only}")).unwrap();
            assert_eq!(command, Command::Python(expected));
        }
        assert_eq!(parsed("python -h").unwrap(), Command::Help);
        for (line, message) in [
            ("python --only", "`--only ` names no checks"),
            ("python --only=mypy", "`--only mypy` names no checks"),
            ("python tests", "`cargo xtask python` does not take `tests`"),
        ] {
            assert_eq!(parsed(line).unwrap_err().message, message);
        }
    }

    #[test]
    fn wrong_usage_is_a_sentence_with_a_fix_and_code_2() {
        for (line, message) in [
            ("tset", "`tset` is no command of `cargo xtask`"),
            ("test --fast", "`cargo xtask test` does not take `--fast`"),
            ("ci all", "`cargo xtask ci` does not take `all`"),
            ("lint -v", "`cargo xtask lint` does not take `-v`"),
            (
                "generate --check x",
                "`cargo xtask generate` does not take `x`",
            ),
            ("test --require", "`--require` has no value"),
            ("outputs", "`cargo xtask outputs` needs the folder to fill"),
            ("outputs a b", "`cargo xtask outputs` does not take `b`"),
            ("outputs a -q", "`cargo xtask outputs` does not take `-q`"),
            (
                "robots",
                "`cargo xtask robots` needs the folder of the robot descriptions",
            ),
            ("robots a b", "`cargo xtask robots` does not take `b`"),
            ("outputs a --against", "`--against` has no value"),
            (
                "outputs a --threads 0",
                "`--threads 0` is no list of numbers from 1 to 64",
            ),
            (
                "test --require rust,",
                "`--require rust,`: `` is no part of the tests",
            ),
            (
                "test --require ruby",
                "`--require ruby`: `ruby` is no part of the tests",
            ),
        ] {
            let failure = parsed(line).unwrap_err();
            assert_eq!(failure.message, message);
            assert_eq!(failure.code, 2);
            assert!(!failure.fix.is_empty());
        }
    }
}
