//! What the text of the code shows about its structure, checked against ARCHITECTURE.md: no module of the library
//! imports upward, no circle of files or of the parts of a folder in any crate or in the Python package, no long file,
//! few public modules.

mod graph;
mod python;
mod source;
mod uses;

use std::collections::BTreeSet;

use crate::files;
use crate::run::{Failure, Workspace};
use graph::Graph;
use uses::Crate;

/// A file of code is split before it gets longer than this, its tests not counted.
const LONGEST_FILE: usize = 450;

/// More than this nobody takes in at a glance.
const PUBLIC_MODULES: usize = 10;

/// What stands in the line above the order of the library's modules in ARCHITECTURE.md.
const ORDER_HEADING: &str = "```modules";

/// The same above the layers of the Python package: the modules of one line may use each other.
const LAYERS_HEADING: &str = "```layers";

/// The Python package.
const PACKAGE: &str = "crates/stiffarm-py/python/stiffarm";

/// All checks of the structure; every fault is told before the first stops `cargo xtask lint`.
pub fn check(workspace: &Workspace) -> Result<(), Failure> {
    let architecture = files::text(&workspace.root().join("ARCHITECTURE.md"))?;
    let order = order_of_modules(&architecture, ORDER_HEADING);
    let mut faults = Vec::new();
    let sources = files::below(&workspace.root().join("crates"))?;
    let names = sources.keys().filter_map(|path| path.split_once("/src/"));
    let mut names: BTreeSet<String> = names.map(|(name, _)| format!("crates/{name}")).collect();
    names.extend(["fuzz", "xtask"].map(String::from));
    for name in names {
        let mut codes = Vec::new();
        for (path, place) in files::below(&workspace.root().join(&name).join("src"))? {
            if !path.ends_with(".rs") {
                continue;
            }
            let text = files::text(&place)?;
            let code = source::code(&text);
            let lines = code.lines().count();
            if lines > LONGEST_FILE {
                faults.push(format!("{name}/src/{path}: {lines} lines of code"));
            }
            for number in compared_as_text(code) {
                faults.push(format!("{name}/src/{path}:{number}: the code of a finding is compared as text"));
            }
            codes.push((path, code.to_string()));
        }
        let one = Crate::new(codes).graph();
        faults.extend(circles(&name, &one));
        if name == "crates/stiffarm" {
            faults.extend(upward(&one, &order, Beside::Refused));
        }
    }
    let package = package(workspace)?;
    faults.extend(circles(PACKAGE, &package));
    let layers = order_of_modules(&architecture, LAYERS_HEADING);
    faults.extend(upward(&package, &layers, Beside::Allowed));
    let root = files::text(&workspace.root().join("crates/stiffarm/src/lib.rs"))?;
    let count = public_modules(&root);
    if count > PUBLIC_MODULES {
        faults.push(format!("stiffarm has {count} public modules"));
    }
    if faults.is_empty() {
        return Ok(());
    }
    Err(Failure::finding(
        format!("the structure of the code:\n  {}", faults.join("\n  ")),
        "move what is used upward or in a circle to a lower file or a file of its own; \
         split a long file by what it holds; codes that are looked for stand in findings/codes.rs",
    ))
}

/// The lines, from 1, in which the code of a finding is compared with a text that stands there.
fn compared_as_text(code: &str) -> Vec<usize> {
    let is_compared = |line: &str| [".code == \"", ".code != \""].iter().any(|pattern| line.contains(pattern));
    let lines = (1..).zip(code.lines());
    let lines = lines.filter(|(_, line)| is_compared(line));
    lines.map(|(number, _)| number).collect()
}

/// The modules of the Python package, and what they import of each other.
fn package(workspace: &Workspace) -> Result<Graph, Failure> {
    let mut codes = Vec::new();
    for (path, place) in files::below(&workspace.root().join(PACKAGE))? {
        if path.ends_with(".py") || path.ends_with(".pyi") {
            codes.push((path, files::text(&place)?));
        }
    }
    Ok(python::graph("stiffarm", &codes))
}

/// A sentence for each use on a circle.
fn circles(name: &str, graph: &Graph) -> Vec<String> {
    let uses = graph.circles().into_iter();
    let uses = uses.map(|(from, to)| (&graph.paths[from], &graph.paths[to]));
    let sentences = uses.map(|(from, to)| format!("{name}: in a circle, {from} uses {to}"));
    sentences.collect()
}

/// Whether modules of one level may use each other.
#[derive(Clone, Copy, PartialEq)]
enum Beside {
    Allowed,
    Refused,
}

/// The levels of the block below `heading`, lowest first.
fn order_of_modules<'t>(text: &'t str, heading: &str) -> Vec<Vec<&'t str>> {
    text.lines()
        .skip_while(|line| *line != heading)
        .skip(1)
        .take_while(|line| *line != "```")
        .map(|line| line.split_whitespace().collect())
        .collect()
}

/// The faults of `library` against `order`: a module that imports upward, or `beside` itself, and one without a level.
fn upward(library: &Graph, order: &[Vec<&str>], beside: Beside) -> BTreeSet<String> {
    let level = |name: &str| order.iter().position(|modules| modules.contains(&name));
    let mut faults = BTreeSet::new();
    for (user, holder) in &library.uses {
        // The root holds no items of its own.
        let (Some(from), Some(to)) = (user.first(), holder.first()) else {
            continue;
        };
        match (level(from), level(to)) {
            (Some(low), Some(high)) if from != to && (high > low || (high == low && beside == Beside::Refused)) => {
                let (user, holder) = (&library.paths[user], &library.paths[holder]);
                faults.insert(format!("{user} uses {holder}: `{from}` must not know `{to}`"));
            }
            (Some(_), Some(_)) => {}
            (None, _) => {
                faults.insert(format!("`{from}` has no level in ARCHITECTURE.md"));
            }
            (_, None) => {
                faults.insert(format!("`{to}` has no level in ARCHITECTURE.md"));
            }
        }
    }
    faults
}

/// How many modules the documentation of a root shows.
fn public_modules(root: &str) -> usize {
    let lines: Vec<&str> = root.lines().collect();
    lines.windows(2).filter(|pair| pair[1].starts_with("pub mod ") && pair[0] != "#[doc(hidden)]").count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_code_is_as_it_should_be() {
        let outcome = check(&Workspace::find().unwrap());
        assert!(outcome.is_ok(), "{}", outcome.unwrap_err().message);
    }

    fn library(files: &[(&str, &str)]) -> Graph {
        let codes = files.iter();
        Crate::new(codes.map(|(path, code)| (path.to_string(), code.to_string()))).graph()
    }

    fn faults(files: &[(&str, &str)]) -> Vec<String> {
        let order = order_of_modules("z\n```modules\nlow\nleft right\nhigh\n```\nd", ORDER_HEADING);
        Vec::from_iter(upward(&library(files), &order, Beside::Refused))
    }

    #[test]
    fn upward_and_sideways_imports_are_told_and_downward_ones_are_not() {
        let files = [
            ("lib.rs", "pub mod low; pub use high::deep::Item;"),
            ("low/mod.rs", "use crate::{left::{Part, other}, Item};"),
            ("left/mod.rs", "use crate::low; fn a() { crate::right::b() }"),
            ("right.rs", "use super::low::Thing; // use crate::high;"),
            ("high/mod.rs", "mod deep;"),
            ("high/deep.rs", "use crate::left; use super::super::low; use super::Up;"),
        ];
        assert_eq!(
            faults(&files),
            [
                "left/mod.rs uses right.rs: `left` must not know `right`",
                "low/mod.rs uses high/deep.rs: `low` must not know `high`",
                "low/mod.rs uses left/mod.rs: `low` must not know `left`",
            ]
        );
        assert_eq!(faults(&[("low.rs", ""), ("new.rs", "use crate::low;")]), ["`new` has no level in ARCHITECTURE.md"]);
    }

    #[test]
    fn circles_are_found_through_re_exports_and_a_parent_makes_none() {
        let mut files = [
            ("lib.rs", "mod a; mod d;"),
            ("a/mod.rs", "mod b; mod c; pub use b::B; use crate::d::D; struct A;"),
            ("a/b.rs", "use super::{A, c::C};"),
            ("a/c.rs", "use super::B;"),
            ("d.rs", "use std::fmt;"),
        ];
        let circles_of = |files: &[(&str, &str)]| {
            let library = library(files);
            let circles = library.circles().into_iter();
            let uses = circles.map(|(from, to)| format!("{} {}", library.paths[from], library.paths[to]));
            uses.collect::<Vec<String>>()
        };
        assert_eq!(circles_of(&files), ["a/b.rs a/c.rs", "a/c.rs a/b.rs"]);
        // No file stands in a circle, and the folder does.
        let folder = [
            ("lib.rs", "mod a; mod d;"),
            ("a/mod.rs", "mod b; mod c;"),
            ("a/b.rs", "struct B;"),
            ("a/c.rs", "use crate::d::D;"),
            ("d.rs", "use crate::a::b::B;"),
        ];
        assert_eq!(circles_of(&folder), ["a/c.rs d.rs", "d.rs a/b.rs"]);
        files[3].1 = "";
        assert!(circles_of(&files).is_empty());
        files[4].1 = "use crate::a::B;";
        assert_eq!(circles_of(&files), ["a/mod.rs d.rs", "a/b.rs a/mod.rs", "d.rs a/b.rs"]);
    }

    #[test]
    fn a_code_that_is_compared_has_a_name() {
        let code = "a\nlet x = f.code == \"no-name\";\nlet y = f.code == codes::NAME;\n";
        assert_eq!(compared_as_text(code), [2]);
    }

    #[test]
    fn hidden_modules_are_not_shown() {
        let root = "\npub mod a;\nmod b;\n#[doc(hidden)]\npub mod c {\n}\npub mod d;\n";
        assert_eq!(public_modules(root), 2);
    }
}
