//! `cargo xtask generate`: files that are made from the code, so that they cannot contradict it.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::run::{Failure, Workspace};

/// Everything that is generated. A new generated file is one more row.
const GENERATED: &[Generated] = &[
    Generated {
        target: "docs/errors.md",
        source: Source::Stiffarm(&["docs", "errors"]),
    },
    Generated {
        target: "docs/commands.md",
        source: Source::Stiffarm(&["docs", "commands"]),
    },
    Generated {
        target: "docs/cell.schema.json",
        source: Source::Stiffarm(&["schema", "cell"]),
    },
    Generated {
        target: "cells",
        source: Source::CopyOf("crates/stiffarm/data/cells"),
    },
    // The licences go into the wheel, which takes nothing from outside its folder.
    Generated {
        target: "crates/stiffarm-py/LICENSE-APACHE",
        source: Source::CopyOfFile("LICENSE-APACHE"),
    },
    Generated {
        target: "crates/stiffarm-py/LICENSE-MIT",
        source: Source::CopyOfFile("LICENSE-MIT"),
    },
];

/// One generated file or folder, relative to the workspace root.
struct Generated {
    target: &'static str,
    source: Source,
}

/// Where the bytes come from.
enum Source {
    /// Standard output of the `stiffarm` command with these arguments.
    Stiffarm(&'static [&'static str]),
    /// Every file of this folder under its own name; the target folder holds nothing else.
    CopyOf(&'static str),
    /// This file.
    CopyOfFile(&'static str),
}

/// File contents by path relative to the workspace root, with `/` on every system.
type Files = BTreeMap<String, Vec<u8>>;

/// How a file in the tree differs from what would be generated.
#[derive(Debug, PartialEq, Eq)]
enum Drift {
    Missing,
    Differs { line: usize },
    Stray,
}

/// What to do about [`Drift::Stray`].
const STRAY_FIX: &str = "delete it, or move it to the folder that is copied";

/// Builds everything, then writes what is generated, or with `check` only compares it.
pub fn run(workspace: &Workspace, check: bool) -> Result<(), Failure> {
    workspace.build().run()?;
    run_built(workspace, check)
}

/// [`run`] with the `stiffarm` that has been built into the folder of this program.
pub fn run_built(workspace: &Workspace, check: bool) -> Result<(), Failure> {
    let program = beside_this_program("stiffarm")?;
    let stiffarm = |arguments: &[&str]| printed(&program, arguments);
    let expected = expected_files(workspace.root(), GENERATED, stiffarm)?;
    let drifts = drifts(workspace.root(), GENERATED, &expected)?;
    if check {
        report(&drifts, expected.len())
    } else {
        write(workspace.root(), &expected, &drifts)
    }
}

/// The program `name` in the folder of this one.
pub fn beside_this_program(name: &str) -> Result<PathBuf, Failure> {
    let path = std::env::current_exe()
        .map(|this| this.with_file_name(format!("{name}{}", std::env::consts::EXE_SUFFIX)));
    match path {
        Ok(path) if path.is_file() => Ok(path),
        _ => Err(Failure::internal(
            format!("`{name}` does not lie beside this program"),
            "start it as `cargo xtask`, which builds both into one folder",
        )),
    }
}

/// What `program` writes to standard output; standard error goes to the terminal.
fn printed(program: &Path, arguments: &[&str]) -> Result<Vec<u8>, Failure> {
    let mut command = Command::new(program);
    command
        .args(arguments)
        .stdin(Stdio::null())
        .stderr(Stdio::inherit());
    let call = || format!("`{} {}`", program.display(), arguments.join(" "));
    match command.output() {
        Ok(output) if output.status.success() => Ok(output.stdout),
        Ok(output) => Err(Failure::internal(
            format!("{} failed: {}", call(), output.status),
            "correct what it printed above, then run it again",
        )),
        Err(error) => Err(Failure::internal(
            format!("{} could not be run: {error}", call()),
            "check that the file may be executed",
        )),
    }
}

/// What every generated file should hold; `stiffarm` runs the command and returns its standard output.
fn expected_files(
    root: &Path,
    generated: &[Generated],
    stiffarm: impl Fn(&[&str]) -> Result<Vec<u8>, Failure>,
) -> Result<Files, Failure> {
    let mut files = Files::new();
    for entry in generated {
        match entry.source {
            Source::Stiffarm(arguments) => {
                let content = stiffarm(arguments)?;
                if content.is_empty() {
                    return Err(Failure::internal(
                        format!("`stiffarm {}` printed nothing", arguments.join(" ")),
                        format!(
                            "make it print the content of `{}` to standard output",
                            entry.target
                        ),
                    ));
                }
                files.insert(entry.target.to_string(), content);
            }
            Source::CopyOf(folder) => {
                for (name, content) in files_in(root, folder)? {
                    files.insert(format!("{}/{name}", entry.target), content);
                }
            }
            Source::CopyOfFile(path) => {
                let content = std::fs::read(root.join(path)).map_err(|e| unreadable(path, &e))?;
                files.insert(entry.target.to_string(), content);
            }
        }
    }
    Ok(files)
}

/// Compares the tree under `root` with `expected`, in the order of the paths.
fn drifts(
    root: &Path,
    generated: &[Generated],
    expected: &Files,
) -> Result<BTreeMap<String, Drift>, Failure> {
    let mut drifts = BTreeMap::new();
    for (path, content) in expected {
        match std::fs::read(root.join(path)) {
            Ok(present) if present == *content => {}
            Ok(present) => {
                let line = first_difference(&present, content);
                drifts.insert(path.clone(), Drift::Differs { line });
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {
                drifts.insert(path.clone(), Drift::Missing);
            }
            Err(error) => return Err(unreadable(path, &error)),
        }
    }
    for entry in generated {
        if let Source::CopyOf(_) = entry.source
            && root.join(entry.target).is_dir()
        {
            for name in files_in(root, entry.target)?.into_keys() {
                let path = format!("{}/{name}", entry.target);
                if !expected.contains_key(&path) {
                    drifts.insert(path, Drift::Stray);
                }
            }
        }
    }
    Ok(drifts)
}

/// Prints what differs and how to repair it.
fn report(drifts: &BTreeMap<String, Drift>, count: usize) -> Result<(), Failure> {
    for (path, drift) in drifts {
        match drift {
            Drift::Missing => println!("{path}: missing; fix: cargo xtask generate"),
            Drift::Differs { line } => {
                println!("{path}:{line}: out of date from this line on; fix: cargo xtask generate");
            }
            Drift::Stray => println!("{path}: nothing generates it; fix: {STRAY_FIX}"),
        }
    }
    if drifts.is_empty() {
        println!("{count} generated files are up to date");
        Ok(())
    } else {
        Err(Failure::finding(
            format!(
                "generated files differ from what the code generates: {}",
                Vec::from_iter(drifts.keys().map(String::as_str)).join(", ")
            ),
            "run `cargo xtask generate`, look at the change with `git diff` and commit it",
        ))
    }
}

/// Writes every file that drifted. A stray file is left for a person to judge, and is a finding.
fn write(root: &Path, expected: &Files, drifts: &BTreeMap<String, Drift>) -> Result<(), Failure> {
    let mut strays = Vec::new();
    for (path, drift) in drifts {
        match expected.get(path) {
            Some(content) if *drift != Drift::Stray => {
                let target = root.join(path);
                let folder = target.parent().unwrap_or(root);
                std::fs::create_dir_all(folder)
                    .and_then(|()| std::fs::write(&target, content))
                    .map_err(|error| {
                        Failure::internal(
                            format!("`{path}` could not be written: {error}"),
                            "make it writable, then run `cargo xtask generate` again",
                        )
                    })?;
                println!("wrote {path}");
            }
            _ => strays.push(path.as_str()),
        }
    }
    println!(
        "{} generated files are up to date, {} of them written now",
        expected.len(),
        drifts.len() - strays.len()
    );
    if strays.is_empty() {
        Ok(())
    } else {
        Err(Failure::finding(
            format!(
                "a generated folder holds what nothing generates: {}",
                strays.join(", ")
            ),
            STRAY_FIX,
        ))
    }
}

/// The files of one folder, by name. Generated folders are flat, so a folder in it is refused.
fn files_in(root: &Path, folder: &str) -> Result<Files, Failure> {
    let error = |error: std::io::Error| unreadable(folder, &error);
    let mut files = Files::new();
    for entry in std::fs::read_dir(root.join(folder)).map_err(error)? {
        let entry = entry.map_err(error)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() {
            return Err(Failure::internal(
                format!("`{folder}/{name}` is a folder, and generated folders hold files only"),
                "move its files up",
            ));
        }
        files.insert(name, std::fs::read(entry.path()).map_err(error)?);
    }
    Ok(files)
}

fn unreadable(path: &str, error: &std::io::Error) -> Failure {
    Failure::internal(
        format!("`{path}` could not be read: {error}"),
        "check that it exists and is readable",
    )
}

/// The number of the first line in which two different contents differ, counted from 1.
pub fn first_difference(left: &[u8], right: &[u8]) -> usize {
    let same = left.iter().zip(right).take_while(|(l, r)| l == r).count();
    1 + left[..same].iter().filter(|byte| **byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    const TABLE: &[Generated] = &[
        Generated {
            target: "docs/errors.md",
            source: Source::Stiffarm(&["docs", "errors"]),
        },
        Generated {
            target: "cells",
            source: Source::CopyOf("data/cells"),
        },
        Generated {
            target: "package/LICENSE",
            source: Source::CopyOfFile("LICENSE"),
        },
    ];

    /// A workspace root with one original cell, removed at the end of the test.
    struct Root(PathBuf);

    impl Root {
        fn new(name: &str) -> Self {
            let id = std::process::id();
            let root = Root(std::env::temp_dir().join(format!("xtask-{name}-{id}")));
            root.put("data/cells/comau.toml", "format = 1\n");
            root.put("LICENSE", "free\n");
            root
        }

        fn put(&self, path: &str, content: &str) {
            let path = self.0.join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, content).unwrap();
        }

        fn expected(&self) -> Files {
            expected_files(&self.0, TABLE, echo).unwrap()
        }

        fn drifts(&self) -> Vec<(String, Drift)> {
            let drifts = drifts(&self.0, TABLE, &self.expected()).unwrap();
            drifts.into_iter().collect()
        }
    }

    impl Drop for Root {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    /// Stands for the command: prints its own arguments.
    fn echo(arguments: &[&str]) -> Result<Vec<u8>, Failure> {
        Ok(format!("# {}\n", arguments.join(" ")).into_bytes())
    }

    #[test]
    fn generating_once_leaves_nothing_to_do() {
        let root = Root::new("once");
        let missing = |path: &str| (path.to_string(), Drift::Missing);
        assert_eq!(
            root.drifts(),
            [
                missing("cells/comau.toml"),
                missing("docs/errors.md"),
                missing("package/LICENSE")
            ]
        );
        let expected = root.expected();
        let found = drifts(&root.0, TABLE, &expected).unwrap();
        assert_eq!(report(&found, 2).unwrap_err().code, 1);
        write(&root.0, &expected, &found).unwrap();
        assert_eq!(
            std::fs::read(root.0.join("docs/errors.md")).unwrap(),
            b"# docs errors\n"
        );
        assert_eq!(
            std::fs::read(root.0.join("cells/comau.toml")).unwrap(),
            b"format = 1\n"
        );
        assert_eq!(
            std::fs::read(root.0.join("package/LICENSE")).unwrap(),
            b"free\n"
        );
        assert_eq!(root.drifts(), []);
        report(&BTreeMap::new(), 2).unwrap();
    }

    #[test]
    fn a_changed_file_is_named_with_its_line_and_repaired() {
        let root = Root::new("changed");
        root.put("docs/errors.md", "# docs errors\n");
        root.put("package/LICENSE", "free\n");
        root.put("cells/comau.toml", "format = 1\nname = \"mine\"\n");
        let path = "cells/comau.toml".to_string();
        assert_eq!(root.drifts(), [(path, Drift::Differs { line: 2 })]);
        let expected = root.expected();
        write(
            &root.0,
            &expected,
            &drifts(&root.0, TABLE, &expected).unwrap(),
        )
        .unwrap();
        assert_eq!(root.drifts(), []);
    }

    #[test]
    fn a_stray_copy_is_told_and_kept() {
        let root = Root::new("stray");
        root.put("docs/errors.md", "# docs errors\n");
        root.put("package/LICENSE", "free\n");
        root.put("cells/comau.toml", "format = 1\n");
        root.put("cells/old.toml", "format = 1\n");
        let stray = "cells/old.toml".to_string();
        assert_eq!(root.drifts(), [(stray, Drift::Stray)]);
        let expected = root.expected();
        let found = drifts(&root.0, TABLE, &expected).unwrap();
        let failure = write(&root.0, &expected, &found).unwrap_err();
        assert!(failure.message.ends_with(": cells/old.toml"));
        assert!(root.0.join("cells/old.toml").is_file());
    }

    #[test]
    fn a_command_that_prints_nothing_generates_nothing() {
        let root = Root::new("silent");
        let failure = expected_files(&root.0, TABLE, |_| Ok(Vec::new())).unwrap_err();
        assert_eq!(failure.message, "`stiffarm docs errors` printed nothing");
    }

    #[test]
    fn missing_originals_are_an_error() {
        let root = Root::new("originals");
        std::fs::remove_dir_all(root.0.join("data")).unwrap();
        let failure = expected_files(&root.0, TABLE, echo).unwrap_err();
        assert!(
            failure
                .message
                .starts_with("`data/cells` could not be read")
        );
    }

    #[test]
    fn the_first_difference_is_counted_in_lines() {
        assert_eq!(first_difference(b"", b"a"), 1);
        assert_eq!(first_difference(b"a\nb\nc", b"a\nb\nd"), 3);
        assert_eq!(first_difference(b"a\n", b"a\nb\n"), 2);
    }
}
