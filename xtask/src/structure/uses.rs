//! Which file of a crate uses which other: the paths in its code, followed to the file that holds the item.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::graph::{Graph, Module};
use super::source::{is_name, words};

/// The files of one crate and what they use.
pub struct Crate {
    files: BTreeMap<Module, File>,
}

/// One file of a crate.
struct File {
    path: String,
    words: Vec<String>,
    /// What the file's `use` items call its own: name in this file to path from the crate's root.
    names: BTreeMap<String, Module>,
}

impl Crate {
    /// The crate with these files: path below `src`, and code.
    pub fn new(codes: impl IntoIterator<Item = (String, String)>) -> Self {
        let mut files = BTreeMap::new();
        for (path, code) in codes {
            let (words, names) = (words(&code), BTreeMap::new());
            files.insert(module_of(Path::new(&path)), File { path, words, names });
        }
        let modules: BTreeSet<Module> = files.keys().cloned().collect();
        for (module, file) in &mut files {
            file.names = imported_names(module, &file.words, &modules);
        }
        Crate { files }
    }

    /// Every use of another file's items, each once: the module that uses, and the one that holds the item. A parent's
    /// use of its own descendants is none: that is how a folder shows what it holds.
    fn uses(&self) -> BTreeSet<(Module, Module)> {
        let mut uses = BTreeSet::new();
        for (module, file) in &self.files {
            for path in paths(module, &file.words) {
                let Some(holder) = self.holder(&path, 0) else {
                    continue;
                };
                if !holder.starts_with(module) {
                    uses.insert((module.clone(), holder));
                }
            }
        }
        uses
    }

    /// The files and who uses whom.
    pub fn graph(&self) -> Graph {
        let paths = self.files.iter();
        let paths = paths.map(|(module, file)| (module.clone(), file.path.clone()));
        Graph { paths: paths.collect(), uses: self.uses() }
    }

    /// The module whose file holds the item at `path` from the root, through re-exports.
    fn holder(&self, path: &[String], depth: usize) -> Option<Module> {
        let length = (0..=path.len()).rev().find(|&length| self.files.contains_key(&path[..length]))?;
        let (module, rest) = path.split_at(length);
        let again = rest.first().and_then(|name| {
            let target = self.files[module].names.get(name)?;
            let whole = [target.as_slice(), &rest[1..]].concat();
            (depth < 8 && whole != path).then_some(whole)
        });
        match again {
            Some(path) => self.holder(&path, depth + 1),
            None => Some(module.to_vec()),
        }
    }
}

/// The module that the file at `path` below `src` holds.
fn module_of(path: &Path) -> Module {
    let path = match path.file_stem().and_then(|stem| stem.to_str()) {
        Some("mod" | "lib" | "main") => path.with_file_name(""),
        _ => path.with_extension(""),
    };
    path.iter().map(|part| part.to_string_lossy().into_owned()).collect()
}

/// The names that `use` items give to items of this crate.
fn imported_names(module: &Module, words: &[String], modules: &BTreeSet<Module>) -> BTreeMap<String, Module> {
    let mut named_paths = Vec::new();
    for at in (0..words.len()).filter(|&i| words[i] == "use") {
        let child = [module.as_slice(), &words[at + 1..at + 2]].concat();
        if modules.contains(&child) {
            read_tree(words, at + 1, module.clone(), &mut named_paths);
        } else if let Some((start, base)) = base(module, words, at + 1) {
            read_tree(words, start, base, &mut named_paths);
        }
    }
    named_paths.into_iter().collect()
}

/// Every path in `words` that begins with `crate`, `super` or `self`.
fn paths(module: &Module, words: &[String]) -> Vec<Module> {
    let mut named_paths = Vec::new();
    for at in 0..words.len() {
        let is_inside = at > 0 && words[at - 1] == "::";
        if let Some((start, base)) = base(module, words, at).filter(|_| !is_inside) {
            read_tree(words, start, base, &mut named_paths);
        }
    }
    named_paths.into_iter().map(|(_, path)| path).collect()
}

/// The module that `crate::`, `self::` or `super::super::` at `at` means, and where the path goes on.
fn base(module: &Module, words: &[String], start: usize) -> Option<(usize, Module)> {
    let mut base = module.clone();
    let mut at = start;
    while words.get(at + 1).is_some_and(|word| word == "::") {
        match words[at].as_str() {
            "crate" => base.clear(),
            "self" => {}
            "super" => {
                base.pop();
            }
            _ => break,
        }
        at += 2;
    }
    (at > start).then_some((at, base))
}

/// Reads the path or `use` tree at `at` below `base`: every path with the name that it gets. Returns where it ends.
fn read_tree(words: &[String], mut at: usize, mut base: Module, named_paths: &mut Vec<(String, Module)>) -> usize {
    let word = |at: usize| words.get(at).map_or("", String::as_str);
    loop {
        match word(at) {
            "{" => {
                at += 1;
                while at < words.len() && word(at) != "}" {
                    // A comma is no path: it is passed over.
                    at = read_tree(words, at, base.clone(), named_paths).max(at + 1);
                }
                return at + 1;
            }
            "self" | "*" => {}
            name if name.starts_with(is_name) => {
                base.push(name.to_string());
            }
            _ => return at,
        }
        at += 1;
        if word(at) == "::" {
            at += 1;
            continue;
        }
        let mut name = base.last().cloned().unwrap_or_default();
        if word(at) == "as" {
            name = word(at + 1).to_string();
            at += 2;
        }
        named_paths.push((name, base));
        return at;
    }
}
