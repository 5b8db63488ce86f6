//! Files and who uses whom, and what stands in a circle.

use std::collections::{BTreeMap, BTreeSet};

/// A module, as the names from the root to it; the root itself is empty.
pub type Module = Vec<String>;

/// A use: the module that uses, and the one that holds what is used.
pub type Use = (Module, Module);

/// The files of a crate or a package by their modules, and every use of another file's items, each once.
pub struct Graph {
    pub paths: BTreeMap<Module, String>,
    pub uses: BTreeSet<Use>,
}

impl Graph {
    /// The uses on circles: of files, and of the parts of a folder, each with all that stands below it.
    pub fn circles(&self) -> BTreeSet<&Use> {
        let mut uses = self.on_circles(|(from, to)| Some((from, to)));
        uses.extend(self.on_circles(parts));
        uses
    }

    /// The uses whose `ends` lie on one circle.
    fn on_circles(&self, ends: impl Fn(&Use) -> Option<(&[String], &[String])>) -> BTreeSet<&Use> {
        let mut next: BTreeMap<&[String], BTreeSet<&[String]>> = BTreeMap::new();
        for (from, to) in self.uses.iter().filter_map(&ends) {
            next.entry(from).or_default().insert(to);
        }
        let leads = |from, to| {
            let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
            while let Some(at) = open.pop() {
                if at == to {
                    return true;
                }
                if seen.insert(at) {
                    open.extend(next.get(at).into_iter().flatten());
                }
            }
            false
        };
        let uses = self.uses.iter();
        uses.filter(|one| ends(one).is_some_and(|(from, to)| leads(to, from))).collect()
    }
}

/// The parts of the innermost folder around both ends that they stand in; none where one end is that folder itself.
fn parts((from, to): &Use) -> Option<(&[String], &[String])> {
    let shared = from.iter().zip(to).take_while(|(a, b)| a == b).count();
    Some((from.get(..=shared)?, to.get(..=shared)?))
}
