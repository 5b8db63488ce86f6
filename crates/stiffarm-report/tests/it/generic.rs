//! The figure module is generic: it uses neither stiffarm nor the modules that
//! turn stiffarm's results into figures.

use std::path::{Path, PathBuf};

/// All sources below `folder`.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files
}

/// Lines of a source that reach out of the figure module. `depth` is how many
/// `super` lead from the file to the root of the figure module.
fn reaching_out(source: &str, depth: usize) -> Vec<&str> {
    let code = source.split("#[cfg(test)]").next().unwrap_or_default();
    let outside = "super::".repeat(depth + 1);
    let reaches = |line: &str| {
        let parts: Vec<&str> = line.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).collect();
        parts.iter().any(|path| {
            let first = path.split("::").next().unwrap_or_default();
            first == "stiffarm" || path.contains(&outside) || (first == "crate" && !path.starts_with("crate::figure"))
        })
    };
    code.lines().filter(|line| !line.trim_start().starts_with("//") && reaches(line)).collect()
}

#[test]
fn the_figure_module_uses_nothing_outside_itself() {
    let out = "use stiffarm::Cell;\nuse crate::study::Table;\nuse super::super::super::study::Table;";
    assert_eq!(reaching_out(out, 2).len(), 3);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/figure");
    let files = sources(&folder);
    assert!(files.len() > 10, "{files:?}");
    for file in files {
        let inside = file.strip_prefix(&folder).unwrap();
        let folders = inside.components().count() - 1;
        let depth = folders + usize::from(!file.ends_with("mod.rs"));
        let source = std::fs::read_to_string(&file).unwrap();
        let lines = reaching_out(&source, depth);
        assert!(lines.is_empty(), "{}: {lines:?}", inside.display());
    }
}
