//! The command line of `cargo xtask`.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

const EXIT_CODES: &str = "\
Exit codes: 0 done, 1 a test failed, a generated file is out of date or an output differs, 2 wrong usage, 3 a command \
could not be run; a step of lint that fails passes on its own code.";

/// Developer commands of the stiffarm workspace.
#[derive(Debug, Parser)]
#[command(bin_name = "cargo xtask", flatten_help = true, after_help = EXIT_CODES)]
pub struct Arguments {
    /// Without one the help is shown.
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Debug, PartialEq, Subcommand)]
pub enum Command {
    /// Every test; closes with one line, `total: N passed, N failed, N skipped`.
    ///
    /// Tests on the reference data run when STIFFARM_REFERENCE_DATA names its folder.
    Test(Test),
    /// Sheets filled by openpyxl and by LibreOffice, a part of test, alone.
    Sheets {
        /// Install what the machine lacks.
        #[arg(long)]
        install: bool,
    },
    /// Pages of stiffarm in Chromium and Firefox, a part of test, alone.
    Pages(Pages),
    /// The Python package, a part of test, alone: one wheel, built and installed into target/python.
    Python(Python),
    /// Write the generated files: docs/errors.md, docs/cell.schema.json, cells/, the licences of the
    /// Python package.
    Generate {
        /// Write nothing and fail when one of them is out of date.
        #[arg(long)]
        check: bool,
    },
    /// Run the commands of xtask/src/outputs/commands.txt and keep everything that they print and write.
    Outputs(Outputs),
    /// Write crates/stiffarm/data/robots.toml, the catalogue's data, from robot descriptions.
    Robots {
        /// Folder of the descriptions, for example ../shared/reference/robots.
        folder: PathBuf,
        /// Write nothing and fail when the file is not what they give.
        #[arg(long)]
        check: bool,
    },
    /// Write crates/stiffarm-report/assets/three.min.js, the part of three.js that pages carry, from xtask/viewer by
    /// npm.
    Viewer {
        /// Write nothing and fail when the file is not what npm gives; skipped without npm.
        #[arg(long)]
        check: bool,
    },
    /// Mutated inputs through every reader and every command, built for release, without end unless told.
    Fuzz {
        /// Options of the fuzzer.
        ///
        /// --seconds N     end after this time
        /// --inputs N      end after this many inputs of each target
        /// --target T      only this target; more than one may be given
        /// --seed S        other inputs [default: 1]
        /// --threads N     processes at a time [default: all cores]
        ///
        /// With one --target, and a --seed or nothing else, one input is run and shown:
        ///
        /// --input I       number I of the seed
        /// --replay FILE   one of fuzz/regressions
        /// --minimise      leave out what its fault can do without
        /// --output FILE   write the input to FILE
        #[arg(trailing_var_arg = true, allow_hyphen_values = true, verbatim_doc_comment)]
        words: Vec<String>,
    },
    /// Formatting, structure of the code, clippy, documentation, generated files,
    /// licences, unused dependencies.
    Lint,
    /// Lint, half a minute of fuzz, brief outputs on 1 and 4 threads, then test: what the continuous integration
    /// runs.
    Ci(Test),
}

#[derive(Debug, Default, PartialEq, Args)]
pub struct Test {
    /// Install what a part needs and the machine lacks: LibreOffice for the sheets, Chromium and Firefox for the pages,
    /// Python (apt-get, as root).
    #[arg(long)]
    pub install: bool,
    /// Parts that must not skip anything.
    #[arg(long, value_name = "PARTS", value_delimiter = ',')]
    pub require: Vec<Part>,
}

#[derive(Debug, Default, PartialEq, Args)]
pub struct Python {
    /// Install what the machine lacks.
    #[arg(long)]
    pub install: bool,
    /// Only these checks.
    #[arg(long, value_name = "CHECKS")]
    pub only: Option<Checks>,
    /// Handed to pytest, for example -k cell.
    #[arg(last = true)]
    pub words: Vec<String>,
}

/// Checks of the Python package that belong together.
#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
pub enum Checks {
    /// The tests, on the installed wheel.
    Pytest,
    /// Annotations and stubs: stubtest, basedpyright.
    Types,
    /// The code in Rust, and what would be published: clippy, sdist, twine, abi3audit.
    Package,
}

#[derive(Debug, Default, PartialEq, Args)]
pub struct Pages {
    /// Install what the machine lacks.
    #[arg(long)]
    pub install: bool,
    /// Leave pictures of the pages there: three widths, light and dark, printed, in Firefox.
    #[arg(long, value_name = "FOLDER")]
    pub look: Option<PathBuf>,
    /// Make the pictures of docs/report.md there instead (docs/images/gallery).
    #[arg(long, value_name = "FOLDER")]
    pub gallery: Option<PathBuf>,
    /// Only these kinds of xtask/pages/kinds.py, or sample, the checks tried on a written page.
    #[arg(long, value_name = "KIND,…")]
    pub only: Option<String>,
    /// Every check on every kind; without it the dear ones run where a page shows them something new.
    #[arg(long)]
    pub all: bool,
}

#[derive(Debug, Default, PartialEq, Args)]
pub struct Outputs {
    /// Folder to fill: new, empty, or filled by an earlier run.
    pub folder: PathBuf,
    /// Compare the folder with this one, the outputs before a change, byte by byte.
    #[arg(long, value_name = "OTHER")]
    pub against: Option<PathBuf>,
    /// Run this executable; without it `stiffarm` is built for release.
    #[arg(long, value_name = "PATH")]
    pub binary: Option<PathBuf>,
    /// Run all of them with each of these numbers of threads: the first fills FOLDER, each other one FOLDER-N, which is
    /// compared with FOLDER.
    #[arg(long, value_name = "N,…", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=64))]
    pub threads: Vec<u16>,
    /// Of runs that differ in --json only the one with it; no help, no wrong usage, none that takes long.
    #[arg(long = "brief")]
    pub is_brief: bool,
}

/// A part of the test suite that a machine may or may not be able to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Part {
    /// `cargo test` of the whole workspace, with doc tests.
    Rust,
    /// The tests that read the reference data.
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

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn parsed(line: &str) -> Result<Command, clap::Error> {
        let words = ["cargo xtask"].into_iter().chain(line.split_whitespace());
        Arguments::try_parse_from(words).map(|arguments| arguments.command.unwrap())
    }

    #[test]
    fn the_definition_is_sound() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn parts_are_named_with_commas_or_one_by_one() {
        let line = "ci --install --require rust,other-pythons --require=browser";
        let expected = Test { install: true, require: vec![Part::Rust, Part::OtherPythons, Part::Browser] };
        assert_eq!(parsed(line).unwrap(), Command::Ci(expected));
    }

    #[test]
    fn what_other_programs_get_is_taken_as_it_stands() {
        let expected = Python {
            only: Some(Checks::Pytest),
            words: ["-k", "cell", "-h"].map(String::from).to_vec(),
            ..Python::default()
        };
        let line = "python --only pytest -- -k cell -h";
        assert_eq!(parsed(line).unwrap(), Command::Python(expected));
        let words = ["--target", "cell", "--seconds", "5"].map(String::from);
        let fuzz = parsed("fuzz --target cell --seconds 5").unwrap();
        assert_eq!(fuzz, Command::Fuzz { words: words.into() });
    }

    #[test]
    fn numbers_of_threads_are_a_list() {
        let Command::Outputs(options) = parsed("outputs now --threads 1,2 --brief").unwrap() else {
            panic!("another command");
        };
        assert_eq!((options.threads, options.is_brief), (vec![1, 2], true));
        assert!(parsed("outputs now --threads 0").is_err());
    }

    #[test]
    fn wrong_usage_has_code_2_and_help_has_none() {
        for line in [
            "tset",
            "test --fast",
            "ci all",
            "lint -v",
            "generate --check x",
            "outputs",
            "outputs a b",
            "robots",
            "pages --look",
            "python tests",
            "python --only mypy",
            "test --require rust,",
        ] {
            assert_eq!(parsed(line).unwrap_err().exit_code(), 2, "{line}");
        }
        for line in ["help", "--help", "test -h", "python -h", "fuzz --help"] {
            assert_eq!(parsed(line).unwrap_err().exit_code(), 0, "{line}");
        }
    }
}
