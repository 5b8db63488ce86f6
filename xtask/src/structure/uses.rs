//! Which file of a crate uses which other: the paths in its code, followed to the file that holds the item.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::source::words;
use crate::run::Failure;

/// A module of a crate, as the names from the root to it; the root itself is empty.
type Module = Vec<String>;

/// The files of one crate and what they use.
pub struct Crate {
    /// Name of the crate's folder.
    pub name: String,
    files: BTreeMap<Module, File>,
}

/// One file of a crate.
struct File {
    path: PathBuf,
    words: Vec<String>,
    /// What the file's `use` items call its own: name in this file to path from the crate's root.
    names: BTreeMap<String, Vec<String>>,
}

/// One use of an item of another file.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Use {
    /// The module that uses.
    pub from: Module,
    /// The module that holds the item.
    pub to: Module,
}

impl Crate {
    /// Reads every file below `source`, the `src` folder of the crate `name`.
    pub fn read(name: &str, source: &Path) -> Result<Self, Failure> {
        let mut found = Vec::new();
        super::find_rust_files(source, &mut found)?;
        let texts = found.into_iter().map(|path| {
            let text = super::read(&path)?;
            let below = path.strip_prefix(source).unwrap_or(&path).to_path_buf();
            Ok((below, text))
        });
        Ok(Self::of_texts(name, texts.collect::<Result<_, Failure>>()?))
    }

    /// The crate with these files: path below `src`, and text.
    pub fn of_texts(name: &str, texts: Vec<(PathBuf, String)>) -> Self {
        let mut files: BTreeMap<Module, File> = texts
            .into_iter()
            .map(|(path, text)| {
                let file = File {
                    words: words(&text),
                    names: BTreeMap::new(),
                    path: path.clone(),
                };
                (module_of(&path), file)
            })
            .collect();
        let modules: BTreeSet<Module> = files.keys().cloned().collect();
        for (module, file) in &mut files {
            file.names = imported_names(module, &file.words, &modules);
        }
        Crate {
            name: name.to_string(),
            files,
        }
    }

    /// The path below `src` of the file of `module`.
    pub fn path(&self, module: &Module) -> &Path {
        self.files.get(module).map_or(Path::new("?"), |f| &f.path)
    }

    /// Every use of another file's items, each once. A parent's use of its own descendants is none: that is how a
    /// folder shows what it holds.
    pub fn uses(&self) -> BTreeSet<Use> {
        let mut uses = BTreeSet::new();
        for (module, file) in &self.files {
            for path in paths(module, &file.words) {
                let Some(to) = self.holder(&path.segments, 0) else {
                    continue;
                };
                if to != *module && !to.starts_with(module) {
                    let from = module.clone();
                    uses.insert(Use { from, to });
                }
            }
        }
        uses
    }

    /// The module whose file holds the item at `path` from the root, through re-exports.
    fn holder(&self, path: &[String], depth: usize) -> Option<Module> {
        let length = (0..=path.len())
            .rev()
            .find(|&length| self.files.contains_key(&path[..length]))?;
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
    let mut module: Module = path
        .with_extension("")
        .iter()
        .map(|part| part.to_string_lossy().into_owned())
        .collect();
    if matches!(
        module.last().map(String::as_str),
        Some("mod" | "lib" | "main")
    ) {
        module.pop();
    }
    module
}

/// One path of the code, from the crate's root.
struct FoundPath {
    segments: Vec<String>,
    /// What the file calls it, for a path in a `use`.
    name: Option<String>,
}

/// The names that `use` items give to items of this crate.
fn imported_names(
    module: &Module,
    words: &[String],
    modules: &BTreeSet<Module>,
) -> BTreeMap<String, Vec<String>> {
    let mut names = BTreeMap::new();
    for at in (0..words.len()).filter(|&i| words[i] == "use") {
        let first = words.get(at + 1).map_or("", String::as_str);
        let child = [module.as_slice(), &[first.to_string()]].concat();
        let mut found = Vec::new();
        if modules.contains(&child) {
            read_tree(words, at + 1, module.clone(), &mut found);
        } else if let Some((start, base)) = base(module, words, at + 1) {
            read_tree(words, start, base, &mut found);
        }
        for path in found {
            if let Some(name) = path.name {
                names.insert(name, path.segments);
            }
        }
    }
    names
}

/// Every path in `words` that begins with `crate`, `super` or `self`.
fn paths(module: &Module, words: &[String]) -> Vec<FoundPath> {
    let mut found = Vec::new();
    for at in 0..words.len() {
        let inside = at > 0 && words[at - 1] == "::";
        if let Some((start, base)) = base(module, words, at).filter(|_| !inside) {
            read_tree(words, start, base, &mut found);
        }
    }
    found
}

/// The module that `crate::`, `self::` or `super::super::` at `at` means, and where the path goes on.
fn base(module: &Module, words: &[String], mut at: usize) -> Option<(usize, Module)> {
    let mut base = module.clone();
    let start = at;
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

/// Reads the path or `use` tree at `at` below `base` into `found`; returns where it ends.
fn read_tree(
    words: &[String],
    mut at: usize,
    mut base: Vec<String>,
    found: &mut Vec<FoundPath>,
) -> usize {
    loop {
        match words.get(at).map(String::as_str) {
            Some("{") => {
                at += 1;
                while at < words.len() && words[at] != "}" {
                    let before = at;
                    at = read_tree(words, at, base.clone(), found);
                    if words.get(at).is_some_and(|word| word == ",") || at == before {
                        at += 1;
                    }
                }
                return at + 1;
            }
            Some("*") => {
                found.push(FoundPath {
                    segments: base,
                    name: None,
                });
                return at + 1;
            }
            Some(word) if is_name(word) => {
                if word != "self" {
                    base.push(word.to_string());
                }
                at += 1;
            }
            _ => return at,
        }
        if words.get(at).is_some_and(|word| word == "::") {
            at += 1;
            continue;
        }
        let mut name = base.last().cloned();
        if words.get(at).is_some_and(|word| word == "as") {
            name = words.get(at + 1).cloned();
            at += 2;
        }
        found.push(FoundPath {
            segments: base,
            name,
        });
        return at;
    }
}

fn is_name(word: &str) -> bool {
    word.starts_with(|sign: char| sign.is_alphabetic() || sign == '_')
}
