//! Links and joints as a tree, and the chain from base to tip in it.

use super::robot::{Joint, JointKind, Robot};
use super::source::Source;
use std::collections::{BTreeMap, BTreeSet};
use stiffarm::error::{Code, Error, Result, did_you_mean};

/// Names that a message lists.
const LISTED: usize = 12;

/// A robot whose joints make a tree of its links.
pub(super) struct Tree<'a> {
    pub(super) source: &'a Source<'a>,
    pub(super) robot: &'a Robot,
    /// The joints by their names.
    joints: BTreeMap<&'a str, &'a Joint>,
    /// The joint above each link that has one.
    above: BTreeMap<&'a str, &'a Joint>,
    /// The joints below each link.
    below: BTreeMap<&'a str, Vec<&'a Joint>>,
}

impl<'a> Tree<'a> {
    /// Checks that the joints make trees of the links.
    ///
    /// # Errors
    /// A name given twice, a link that is not there, one below two joints or below itself.
    pub(super) fn new(source: &'a Source<'a>, robot: &'a Robot) -> Result<Self> {
        let mut below: BTreeMap<&str, Vec<&Joint>> = BTreeMap::new();
        for link in &robot.links {
            if below.insert(&link.name, Vec::new()).is_some() {
                let message = format!("The link \"{}\" is given twice.", link.name);
                return Err(source.error_at("link", &link.name, Code::Duplicate, message));
            }
        }
        let mut above: BTreeMap<&str, &Joint> = BTreeMap::new();
        let mut joints: BTreeMap<&str, &Joint> = BTreeMap::new();
        for joint in &robot.joints {
            let error = |code, message| source.error_at("joint", &joint.name, code, message);
            if joints.insert(&joint.name, joint).is_some() {
                let message = format!("The joint \"{}\" is given twice.", joint.name);
                return Err(error(Code::Duplicate, message));
            }
            let (parent, child) = (joint.parent.as_str(), joint.child.as_str());
            for link in [parent, child] {
                if !below.contains_key(link) {
                    let message = format!(
                        "The joint \"{}\" joins the link \"{link}\", which the file does not have.",
                        joint.name
                    );
                    let hint = did_you_mean(link, below.keys().copied());
                    return Err(error(Code::UnknownName, message).hint_if(hint));
                }
            }
            if let Some(other) = above.insert(child, joint) {
                let message =
                    format!("The link \"{child}\" hangs on two joints, \"{}\" and \"{}\".", other.name, joint.name);
                let error = error(Code::Urdf, message);
                return Err(error.hint("the joints of a URDF make a tree; leave one out"));
            }
            below.entry(parent).or_default().push(joint);
        }
        let tree = Tree { source, robot, joints, above, below };
        let roots = tree.links().filter(|l| !tree.above.contains_key(l));
        let hung: BTreeSet<&str> = roots.flat_map(|root| tree.all_below(root)).map(|(l, _)| l).collect();
        let round = tree.links().find(|link| !hung.contains(link));
        if let Some(link) = round {
            let message = format!("The link \"{link}\" hangs on itself.");
            return Err(source.error_at("link", link, Code::Urdf, message));
        }
        Ok(tree)
    }

    /// A joint by its name.
    pub(super) fn joint(&self, name: &str) -> Option<&'a Joint> {
        self.joints.get(name).copied()
    }

    /// The names of the joints.
    pub(super) fn joint_names(&self) -> impl Iterator<Item = &'a str> {
        self.joints.keys().copied()
    }

    /// A link and those below it, and whether a joint between moves them.
    pub(super) fn all_below(&self, top: &'a str) -> Vec<(&'a str, bool)> {
        let mut links = vec![(top, false)];
        let mut at = 0;
        while let Some((link, moved)) = links.get(at).copied() {
            let below = self.joints_below(link).iter();
            links.extend(below.map(|joint| {
                let moves = joint.kind != JointKind::Fixed;
                (joint.child.as_str(), moved || moves)
            }));
            at += 1;
        }
        links
    }

    /// The joint above a link.
    pub(super) fn joint_above(&self, link: &str) -> Option<&'a Joint> {
        self.above.get(link).copied()
    }

    /// The joints below a link.
    pub(super) fn joints_below(&self, link: &str) -> &[&'a Joint] {
        self.below.get(link).map_or(&[], Vec::as_slice)
    }

    /// The joints from a link up to the root.
    fn upward(&self, link: &str) -> impl Iterator<Item = &'a Joint> {
        let above = |joint: &&'a Joint| self.joint_above(&joint.parent);
        std::iter::successors(self.joint_above(link), above)
    }

    pub(super) fn links(&self) -> impl Iterator<Item = &'a str> {
        self.robot.links.iter().map(|link| link.name.as_str())
    }

    /// A link by its name, as an option gave it.
    pub(super) fn named(&self, name: &str, role: &str) -> Result<&'a str> {
        self.links().find(|link| *link == name).ok_or_else(|| {
            let message = format!("The URDF has no link \"{name}\" for the {role}.");
            let near = did_you_mean(name, self.links());
            let hint = near.unwrap_or_else(|| format!("its links: {}", some_of(self.links())));
            let error = Error::new(Code::UnknownName, message);
            error.file(self.source.file()).hint(hint)
        })
    }

    /// The base: the link of that name, else the root of the tree.
    ///
    /// # Errors
    /// No such link, or several roots.
    pub(super) fn base(&self, name: Option<&str>) -> Result<&'a str> {
        if let Some(name) = name {
            return self.named(name, "base");
        }
        let roots: Vec<&str> = self.links().filter(|l| !self.above.contains_key(l)).collect();
        match roots.as_slice() {
            [root] => Ok(root),
            [] => Err(Error::new(Code::Urdf, "The URDF has no links.").file(self.source.file())),
            _ => {
                let message = "Several links hang on no joint; one of them must be the base.";
                let error = Error::new(Code::Urdf, message).file(self.source.file());
                Err(error.hint(format!("--base one of {}", some_of(roots.into_iter()))))
            }
        }
    }

    /// The joints from `base` down to `tip`; none where `tip` is not below `base`.
    pub(super) fn path(&self, base: &str, tip: &str) -> Option<Vec<&'a Joint>> {
        if base == tip {
            return Some(Vec::new());
        }
        let mut path: Vec<&Joint> = Vec::new();
        for joint in self.upward(tip) {
            path.push(joint);
            if joint.parent == base {
                path.reverse();
                return Some(path);
            }
        }
        None
    }

    /// As [`Tree::path`], with a joint at least.
    ///
    /// # Errors
    /// `tip` is not below `base`.
    pub(super) fn chain(&self, base: &str, tip: &str) -> Result<Vec<&'a Joint>> {
        let path = self.path(base, tip).filter(|path| !path.is_empty());
        path.ok_or_else(|| {
            let message = format!("No joints lead from the link \"{base}\" to \"{tip}\".");
            let error = Error::new(Code::Urdf, message).file(self.source.file());
            let above = self.upward(tip).map(|joint| joint.parent.as_str());
            let above: Vec<&str> = above.collect();
            if above.is_empty() {
                error.hint(format!("\"{tip}\" is a root of the tree; give another --tip"))
            } else {
                error.hint(format!("--base one of {}", some_of(above.into_iter())))
            }
        })
    }
}

/// Names in a row, the first of many.
pub(super) fn some_of<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let names: Vec<&str> = names.collect();
    let more = names.len().saturating_sub(LISTED);
    let shown = names[..names.len() - more].join(", ");
    match more {
        0 => shown,
        _ => format!("{shown} and {more} more"),
    }
}
