//! Circles in a graph of files.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::uses::Use;

type Module = Vec<String>;
type Graph = BTreeMap<Module, BTreeSet<Module>>;

/// A shortest circle through each file that lies on one, each circle once and from its first file on.
pub fn circles(uses: &BTreeSet<Use>) -> Vec<Vec<Module>> {
    let mut graph = Graph::new();
    for used in uses {
        graph
            .entry(used.from.clone())
            .or_default()
            .insert(used.to.clone());
    }
    let mut circles = BTreeSet::new();
    for start in graph.keys() {
        if let Some(circle) = shortest(&graph, start) {
            circles.insert(from_the_first(circle));
        }
    }
    circles.into_iter().collect()
}

/// The shortest circle through `start`.
fn shortest(graph: &Graph, start: &Module) -> Option<Vec<Module>> {
    let mut reached: BTreeMap<&Module, &Module> = BTreeMap::new();
    let mut queue = VecDeque::from([start]);
    while let Some(module) = queue.pop_front() {
        for next in graph.get(module).into_iter().flatten() {
            if next == start {
                let mut circle = vec![module.clone()];
                let mut at = module;
                while let Some(&before) = reached.get(at).filter(|_| at != start) {
                    circle.push(before.clone());
                    at = before;
                }
                circle.reverse();
                return Some(circle);
            }
            if !reached.contains_key(next) {
                reached.insert(next, module);
                queue.push_back(next);
            }
        }
    }
    None
}

/// The same circle, told from its smallest module on.
fn from_the_first(mut circle: Vec<Module>) -> Vec<Module> {
    let first = (0..circle.len()).min_by_key(|&i| &circle[i]).unwrap_or(0);
    circle.rotate_left(first);
    circle
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_circle_is_told_once() {
        let module = |name: &str| vec![name.to_string()];
        let used = |pair: &str| Use {
            from: module(&pair[..1]),
            to: module(&pair[1..]),
        };
        let uses = ["ab", "bc", "ca", "cd", "de", "ed", "ef"].map(used);
        assert_eq!(
            circles(&BTreeSet::from(uses)),
            [
                vec![module("a"), module("b"), module("c")],
                vec![module("d"), module("e")]
            ]
        );
    }
}
