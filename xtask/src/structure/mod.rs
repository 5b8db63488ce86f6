//! What the text of the code shows about its structure, checked against ARCHITECTURE.md: no module of the library
//! imports upward, no circle of files, no long file, few public modules.

mod circles;
mod source;
mod uses;

use std::path::{Path, PathBuf};

use crate::run::{Failure, Workspace};
use uses::Crate;

/// A file of code is split before it gets longer than this, its tests not counted.
const LONGEST_FILE: usize = 450;

/// More than this nobody takes in at a glance.
const PUBLIC_MODULES: usize = 10;

/// What stands in the line above the order of modules in ARCHITECTURE.md.
const ORDER_HEADING: &str = "```modules";

/// All checks of the structure; every fault is told before the first stops `cargo xtask lint`.
pub fn check(workspace: &Workspace) -> Result<(), Failure> {
    let faults = [
        upward_imports(workspace)?,
        circles(workspace)?,
        long_files(workspace)?,
        too_many_modules(workspace)?,
    ]
    .concat();
    if faults.is_empty() {
        return Ok(());
    }
    Err(Failure::finding(
        format!("the structure of the code:\n  {}", faults.join("\n  ")),
        "move what is used upward or in a circle to a lower file or a file of its own; \
         split a long file by what it holds",
    ))
}

/// Imports of the library that go up or sideways in the order of modules of ARCHITECTURE.md.
fn upward_imports(workspace: &Workspace) -> Result<Vec<String>, Failure> {
    let text = read(&workspace.root().join("ARCHITECTURE.md"))?;
    let order = order_of_modules(&text).ok_or_else(|| {
        Failure::finding(
            format!("ARCHITECTURE.md has no block that begins with `{ORDER_HEADING}`"),
            "write the modules of the library there, one level a line, lowest first",
        )
    })?;
    let library = Crate::read("stiffarm", &workspace.root().join("crates/stiffarm/src"))?;
    Ok(upward(&library, &order))
}

/// The levels of the block that begins with [`ORDER_HEADING`], lowest first.
fn order_of_modules(text: &str) -> Option<Vec<Vec<String>>> {
    let mut lines = text.lines().skip_while(|line| *line != ORDER_HEADING);
    lines.next()?;
    let levels = lines.take_while(|line| *line != "```");
    Some(
        levels
            .map(|line| line.split_whitespace().map(String::from).collect())
            .collect(),
    )
}

/// The faults of `library` against `order`: a module that imports upward or sideways, and one without a level.
fn upward(library: &Crate, order: &[Vec<String>]) -> Vec<String> {
    let level = |name: &String| order.iter().position(|modules| modules.contains(name));
    let mut faults = Vec::new();
    for used in library.uses() {
        // The root holds no items of its own.
        let (Some(from), Some(to)) = (used.from.first(), used.to.first()) else {
            continue;
        };
        let fault = match (level(from), level(to)) {
            (None, _) => format!("`{from}` has no level in ARCHITECTURE.md"),
            (_, None) => format!("`{to}` has no level in ARCHITECTURE.md"),
            (Some(low), Some(high)) if from != to && high >= low => format!(
                "{} uses {}: `{from}` must not know `{to}`",
                library.path(&used.from).display(),
                library.path(&used.to).display()
            ),
            _ => continue,
        };
        if !faults.contains(&fault) {
            faults.push(fault);
        }
    }
    faults
}

/// Circles of files in every crate, each as the files in the order in which they use each other.
fn circles(workspace: &Workspace) -> Result<Vec<String>, Failure> {
    let mut faults = Vec::new();
    for (name, source) in sources(workspace)? {
        let one = Crate::read(&name, &source)?;
        for circle in circles::circles(&one.uses()) {
            let files: Vec<String> = circle
                .iter()
                .chain(circle.first())
                .map(|module| one.path(module).display().to_string())
                .collect();
            faults.push(format!("{}: circle {}", one.name, files.join(" -> ")));
        }
    }
    Ok(faults)
}

/// Files with more than [`LONGEST_FILE`] lines of code.
fn long_files(workspace: &Workspace) -> Result<Vec<String>, Failure> {
    let mut faults = Vec::new();
    for (_, source) in sources(workspace)? {
        let mut files = Vec::new();
        find_rust_files(&source, &mut files)?;
        for path in files {
            let lines = source::lines_of_code(&read(&path)?);
            if lines > LONGEST_FILE {
                let shown = path.strip_prefix(workspace.root()).unwrap_or(&path);
                faults.push(format!("{}: {lines} lines of code", shown.display()));
            }
        }
    }
    Ok(faults)
}

/// The library's root when it shows more than [`PUBLIC_MODULES`].
fn too_many_modules(workspace: &Workspace) -> Result<Vec<String>, Failure> {
    let root = read(&workspace.root().join("crates/stiffarm/src/lib.rs"))?;
    let shown = public_modules(&root);
    let fault = format!(
        "stiffarm has {} public modules: {}",
        shown.len(),
        shown.join(", ")
    );
    Ok(Vec::from_iter(
        (shown.len() > PUBLIC_MODULES).then_some(fault),
    ))
}

/// The modules that the documentation of a root shows.
fn public_modules(root: &str) -> Vec<String> {
    let mut shown = Vec::new();
    let mut hidden = false;
    for line in root.lines() {
        if let Some(rest) = line.strip_prefix("pub mod ") {
            let name = rest.trim_end_matches([';', '{', ' ']);
            shown.extend((!hidden).then(|| name.to_string()));
        }
        // An attribute or a comment may stand between the mark and its module.
        hidden = line == "#[doc(hidden)]" || hidden && line.starts_with(['#', '/']);
    }
    shown
}

/// Name and `src` folder of every crate.
fn sources(workspace: &Workspace) -> Result<Vec<(String, PathBuf)>, Failure> {
    let crates = workspace.root().join("crates");
    let mut folders = entries(&crates)?;
    folders.push(workspace.root().join("fuzz"));
    folders.push(workspace.root().join("xtask"));
    Ok(folders
        .into_iter()
        .filter(|folder| folder.join("src").is_dir())
        .map(|folder| {
            let name = folder.file_name().unwrap_or_default();
            (name.to_string_lossy().into_owned(), folder.join("src"))
        })
        .collect())
}

/// Adds the Rust files below `folder` to `found`, in the order of their names.
fn find_rust_files(folder: &Path, found: &mut Vec<PathBuf>) -> Result<(), Failure> {
    for path in entries(folder)? {
        if path.is_dir() {
            find_rust_files(&path, found)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    Ok(())
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let paths = std::fs::read_dir(folder)
        .and_then(|entries| entries.map(|entry| entry.map(|e| e.path())).collect());
    let mut paths: Vec<PathBuf> = paths.map_err(|error| unread(folder, &error))?;
    paths.sort();
    Ok(paths)
}

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| unread(path, &error))
}

fn unread(path: &Path, error: &std::io::Error) -> Failure {
    Failure::internal(
        format!("`{}` could not be read: {error}", path.display()),
        "check that the checkout is complete",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn workspace() -> Workspace {
        Workspace::find().unwrap()
    }

    fn nothing(faults: Result<Vec<String>, Failure>) {
        let faults = faults.unwrap();
        assert!(faults.is_empty(), "\n{}", faults.join("\n"));
    }

    #[test]
    fn no_module_imports_upward() {
        nothing(upward_imports(&workspace()));
    }

    #[test]
    fn no_circle_of_files() {
        nothing(circles(&workspace()));
    }

    #[test]
    fn no_long_file() {
        nothing(long_files(&workspace()));
    }

    #[test]
    fn the_root_shows_few_modules() {
        nothing(too_many_modules(&workspace()));
    }

    #[test]
    fn the_order_is_read_from_its_block() {
        let text = "# A\n\n```text\nz\n```\n```modules\na b\nc\n```\nd\n";
        assert_eq!(order_of_modules(text).unwrap(), [vec!["a", "b"], vec!["c"]]);
        assert_eq!(order_of_modules("a\nb\n"), None);
    }

    fn library(files: &[(&str, &str)]) -> Crate {
        let texts = files
            .iter()
            .map(|(path, text)| (PathBuf::from(path), text.to_string()));
        Crate::of_texts("library", texts.collect())
    }

    const ORDER: &str = "```modules\nlow\nleft right\nhigh\n```";

    fn faults(files: &[(&str, &str)]) -> Vec<String> {
        upward(&library(files), &order_of_modules(ORDER).unwrap())
    }

    #[test]
    fn upward_and_sideways_imports_are_told_and_downward_ones_are_not() {
        let files = [
            ("lib.rs", "pub mod low; pub use high::deep::Item;"),
            ("low/mod.rs", "use crate::{left::{Part, other}, Item};"),
            (
                "left/mod.rs",
                "use crate::low; fn a() { crate::right::b() }",
            ),
            ("right.rs", "use super::low::Thing; // use crate::high;"),
            ("high/mod.rs", "mod deep;"),
            (
                "high/deep.rs",
                "use crate::left; use super::super::low; use super::Up;",
            ),
        ];
        assert_eq!(
            faults(&files),
            [
                "left/mod.rs uses right.rs: `left` must not know `right`",
                "low/mod.rs uses high/deep.rs: `low` must not know `high`",
                "low/mod.rs uses left/mod.rs: `low` must not know `left`",
            ]
        );
        assert_eq!(
            faults(&[("low.rs", ""), ("new.rs", "use crate::low;")]),
            ["`new` has no level in ARCHITECTURE.md"]
        );
    }

    #[test]
    fn circles_are_found_through_re_exports_and_a_parent_makes_none() {
        let circle = [
            ("lib.rs", "mod a; mod d;"),
            (
                "a/mod.rs",
                "mod b; mod c; pub use b::B; use crate::d::D; struct A;",
            ),
            ("a/b.rs", "use super::{A, c::C};"),
            ("a/c.rs", "use super::B;"),
            ("d.rs", "use std::fmt;"),
        ];
        let found = circles::circles(&library(&circle).uses());
        assert_eq!(found, [[["a", "b"], ["a", "c"]]]);

        let mut through_the_parent = circle;
        through_the_parent[3].1 = "";
        assert!(circles::circles(&library(&through_the_parent).uses()).is_empty());
        through_the_parent[4].1 = "use crate::a::B;";
        let found = circles::circles(&library(&through_the_parent).uses());
        assert_eq!(found, [vec![vec!["a"], vec!["d"], vec!["a", "b"]]]);
    }

    #[test]
    fn hidden_modules_are_not_shown() {
        let root = "pub mod a;\nmod b;\n#[doc(hidden)]\n/// C.\npub mod c {\n}\npub mod d;\n";
        assert_eq!(public_modules(root), ["a", "d"]);
    }
}
