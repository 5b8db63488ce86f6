//! Which module of a Python package uses which other: every import of its code, those inside functions and those for
//! types as well.

use std::collections::BTreeSet;
use std::path::Path;

use super::graph::{Graph, Module};
use super::source::is_name;

/// The modules of the package `name` and what they import of it: path below the package, and code; a stub stands for a
/// module that is no Python.
pub fn graph(name: &str, codes: &[(String, String)]) -> Graph {
    let modules = codes.iter().map(|(path, _)| (module_of(path), path.clone()));
    let mut graph = Graph { paths: modules.collect(), uses: BTreeSet::new() };
    for (path, code) in codes {
        let module = module_of(path);
        let mut folder = module.clone();
        if Path::new(path).file_stem().is_none_or(|stem| stem != "__init__") {
            folder.pop();
        }
        for used in imports(code, name, &folder) {
            // The longest module in front of the name: a name of a module, or one that it holds.
            let lengths = (0..=used.len()).rev();
            let mut holders = lengths.map(|length| &used[..length]);
            let holder = holders.find(|holder| graph.paths.contains_key(*holder));
            if let Some(holder) = holder.filter(|holder| **holder != module) {
                graph.uses.insert((module.clone(), holder.to_vec()));
            }
        }
    }
    graph
}

fn module_of(path: &str) -> Module {
    let path = Path::new(path).with_extension("");
    let parts = path.iter().map(|part| part.to_string_lossy().into_owned());
    parts.filter(|part| part != "__init__").collect()
}

/// What a code imports of the package `name`, as names from its root.
fn imports(code: &str, name: &str, folder: &[String]) -> Vec<Module> {
    let mut modules = Vec::new();
    for statement in statements(code) {
        let (module, names) = if let Some(rest) = statement.strip_prefix("from ") {
            let Some((module, names)) = rest.split_once(" import ") else {
                continue;
            };
            (module, names)
        } else if let Some(names) = statement.strip_prefix("import ") {
            ("", names)
        } else {
            continue;
        };
        let rest = module.trim_start_matches('.');
        let dots = module.len() - rest.len();
        let base = match dots {
            0 => Vec::new(),
            // One dot is the folder of the module itself.
            dots => [&[name.to_string()], &folder[..(folder.len() + 1).saturating_sub(dots)]].concat(),
        };
        for one in names.split(',') {
            let one = one.split_whitespace().next().unwrap_or_default();
            let parts = rest.split('.').chain(one.split('.'));
            let parts = parts.filter(|part| part.starts_with(is_name));
            let whole: Module = base.iter().cloned().chain(parts.map(String::from)).collect();
            if whole.first().is_some_and(|first| first == name) {
                modules.push(whole[1..].to_vec());
            }
        }
    }
    modules
}

/// The lines of a code without text and comments, what stands in brackets on one line.
fn statements(code: &str) -> Vec<String> {
    let (mut lines, mut line) = (Vec::new(), String::new());
    let (mut rest, mut depth) = (code, 0_usize);
    while let Some(sign) = rest.chars().next() {
        let quotes = ["\"\"\"", "'''", "\"", "'"];
        if let Some(quote) = quotes.into_iter().find(|quote| rest.starts_with(quote)) {
            rest = after_text(&rest[quote.len()..], quote);
            continue;
        }
        if sign == '#' {
            rest = rest.find('\n').map_or("", |end| &rest[end..]);
            continue;
        }
        match sign {
            '\n' if depth == 0 => lines.push(std::mem::take(&mut line).trim().to_string()),
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            '\n' => line.push(' '),
            _ => line.push(sign),
        }
        rest = &rest[sign.len_utf8()..];
    }
    lines.push(line.trim().to_string());
    lines
}

/// What stands behind the text that `quote` ends.
fn after_text<'c>(mut rest: &'c str, quote: &str) -> &'c str {
    while let Some(sign) = rest.chars().next() {
        if let Some(behind) = rest.strip_prefix(quote) {
            return behind;
        }
        let escaped = if sign == '\\' { rest[1..].chars().next() } else { None };
        rest = &rest[sign.len_utf8() + escaped.map_or(0, char::len_utf8)..];
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph_of(files: &[(&str, &str)]) -> Graph {
        let codes: Vec<(String, String)> =
            files.iter().map(|(path, code)| (path.to_string(), code.to_string())).collect();
        graph("arm", &codes)
    }

    #[test]
    fn imports_count_wherever_they_stand_and_text_does_not() {
        let files = [
            ("__init__.py", "\"\"\"\nfrom . import text\n\"\"\"\nfrom .a import (\n    One,  # from .b\n    Two,\n)\n"),
            ("a.py", "from __future__ import annotations\nfrom . import _native, c as d\n"),
            ("b.py", "def f():\n    s = 'it\\'s'\n    from .plot import look\n    import arm.c\n"),
            ("c.py", "if TYPE_CHECKING:\n    from .b import B\n"),
            ("text.py", ""),
            ("_native.pyi", ""),
            ("plot/__init__.py", "from .look import draw\n"),
            ("plot/look.py", "from .. import c, One\nimport numpy as np\n"),
        ];
        let graph = graph_of(&files);
        let path = |module: &Module| graph.paths[module].as_str();
        let uses: Vec<_> = graph.uses.iter().map(|(a, b)| format!("{} {}", path(a), path(b))).collect();
        assert_eq!(
            uses,
            [
                "__init__.py a.py",
                "a.py _native.pyi",
                "a.py c.py",
                "b.py c.py",
                "b.py plot/look.py",
                "c.py b.py",
                "plot/__init__.py plot/look.py",
                "plot/look.py __init__.py",
                "plot/look.py c.py",
            ]
        );
        let circles: Vec<_> = graph.circles().iter().map(|(a, b)| format!("{} {}", path(a), path(b))).collect();
        assert_eq!(
            circles,
            [
                "__init__.py a.py",
                "a.py c.py",
                "b.py c.py",
                "b.py plot/look.py",
                "c.py b.py",
                "plot/look.py __init__.py",
                "plot/look.py c.py",
            ]
        );
    }
}
