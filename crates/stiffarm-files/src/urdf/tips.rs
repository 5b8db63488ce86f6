//! Which links can be the tip: where the arm ends, and what looks like a gripper behind it.

use super::robot::{Joint, JointKind};
use super::tree::{Tree, some_of};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::FRAC_PI_2;
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::{Finding, codes};

/// Links that by custom are the flange, the first one first: taken where there are several ends.
const TIPS: [&str; 2] = ["tool0", "flange"];
/// Ends of the names of links that by custom are the flange, the first one first.
const FLANGES: [&str; 4] = ["tool0", "flange", "ee_link", "link_ee"];
/// Words in the names of a gripper's joints, and of the links that they move.
const FINGERS: [&str; 6] = ["finger", "knuckle", "thumb", "jaw", "claw", "pinch"];
/// Words in the names of a gripper's joints; links that carry a gripper have them, too.
const GRIPPERS: [&str; 3] = ["gripper", "grasp", "robotiq"];
/// Words of joints that turn a gripper as a whole.
const WRISTS: [&str; 6] = ["roll", "rot", "yaw", "pitch", "wrist", "swivel"];
/// A joint of an arm is not this much weaker than the one before it.
const WEAK: f64 = 0.1;

/// What makes a joint look like one of a gripper.
struct Gripper<'a> {
    joint: &'a Joint,
    sign: &'static str,
    /// The link to take as the tip instead.
    flange: &'a str,
}

/// The joint of a chain from which on it looks like a gripper, where an arm is before it.
fn gripper<'a>(tree: &Tree<'a>, path: &[&'a Joint]) -> Option<Gripper<'a>> {
    let moving = path.iter().filter(|joint| joint.kind != JointKind::Fixed);
    let moving: Vec<&Joint> = moving.copied().collect();
    // A finger that is the robot.
    if moving.first().is_some_and(|joint| named(tree, joint).is_some()) {
        return None;
    }
    moving.windows(2).enumerate().find_map(|(i, pair)| {
        let [before, joint] = [pair[0], pair[1]];
        let is_last = i + 2 == moving.len();
        let sign = named(tree, joint).or_else(|| {
            let seen = is_last.then(|| seen(tree, path, before, joint));
            seen.flatten()
        })?;
        let flange = flange(tree, &before.child);
        Some(Gripper { joint, sign, flange })
    })
}

fn has(name: &str, words: &[&str]) -> bool {
    let name = name.to_ascii_lowercase();
    words.iter().any(|word| name.contains(word))
}

/// What the names say.
fn named(tree: &Tree<'_>, joint: &Joint) -> Option<&'static str> {
    let is_named = |joint: &Joint| {
        let is_finger = has(&joint.child, &FINGERS) && !has(&joint.name, &WRISTS);
        is_finger || is_grippers(&joint.name)
    };
    if is_named(joint) {
        return Some("by its name");
    }
    let follower = followers(tree, joint).any(is_named);
    follower.then_some("as fingers follow it")
}

/// Whether a joint has a name as those of grippers have.
fn is_grippers(joint: &str) -> bool {
    (has(joint, &FINGERS) || has(joint, &GRIPPERS)) && !has(joint, &WRISTS)
}

/// Doubts axes of an arm that have the name of a gripper's joint, where all that is left are the names.
pub fn doubted_axes(joints: &[&str]) -> Vec<Finding> {
    let is_arm = joints.first().is_some_and(|first| !is_grippers(first));
    let gripper_names = joints.iter().filter(|name| is_arm && is_grippers(name));
    let sentence = |name: &str| {
        format!(
            "By its name {name} is a joint of a gripper, and no axis of the arm: write the cell again, up to the \
             flange (`stiffarm init --urdf … --tip LINK`), or take the joint out of [robot]."
        )
    };
    gripper_names.map(|name| Finding::caution(codes::URDF_GRIPPER, *name, sentence(name))).collect()
}

/// Joints that follow a joint.
fn followers<'t>(tree: &'t Tree<'_>, joint: &Joint) -> impl Iterator<Item = &'t Joint> {
    let follows = move |other: &&Joint| {
        let mimic = other.mimic.as_ref();
        mimic.is_some_and(|mimic| mimic.joint == joint.name)
    };
    tree.robot.joints.iter().filter(follows)
}

/// What the last joint shows beside its name: one sign of a gripper and another one, or its limits.
fn seen(tree: &Tree<'_>, path: &[&Joint], before: &Joint, joint: &Joint) -> Option<&'static str> {
    let in_chain = |other: &Joint| path.iter().any(|chain_joint| chain_joint.name == other.name);
    let beside = [&joint.parent, &joint.child].map(|link| tree.joints_below(link));
    let mut beside = beside.into_iter().flatten();
    let limit = &joint.limit;
    let is_limited = joint.kind == JointKind::Revolute && limit.lower < limit.upper;
    let signs = [
        ("as another joint follows it", followers(tree, joint).any(|other| !in_chain(other))),
        ("as a joint beside it shifts", beside.any(|other| other.kind == JointKind::Prismatic)),
        ("as it is far weaker than the one before it", limit.effort > 0.0 && limit.effort < WEAK * before.limit.effort),
        ("as it opens and closes", is_limited && limit.lower * limit.upper == 0.0),
        ("as it hardly turns", is_limited && limit.upper - limit.lower < FRAC_PI_2),
    ];
    let shown = signs.iter().filter(|(_, is_so)| *is_so);
    // Limits alone make no gripper.
    let is_one = signs[..3].iter().any(|(_, is_so)| *is_so) && shown.clone().count() > 1;
    let first = shown.map(|(sign, _)| *sign).next();
    first.filter(|_| is_one)
}

/// The link that is the flange of an arm whose last joint moves `link`: one by custom, else the last of those
/// fixed to it that have its name with another number, else itself.
fn flange<'a>(tree: &Tree<'a>, link: &'a str) -> &'a str {
    let mut rigid = vec![link];
    let mut at = 0;
    while let Some(next) = rigid.get(at) {
        let below = tree.joints_below(next).iter();
        let fixed = below.filter(|joint| joint.kind == JointKind::Fixed);
        rigid.extend(fixed.map(|joint| joint.child.as_str()));
        at += 1;
    }
    let custom = FLANGES.iter().find_map(|end| rigid.iter().find(|name| name.ends_with(end)));
    let stem = |name: &str| name.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    let is_next = |name: &&&str| stem(name) < name.len() && name[..stem(name)] == link[..stem(link)];
    let numbered = || rigid.iter().rfind(is_next);
    custom.or_else(numbered).copied().unwrap_or(link)
}

/// The tip: the link of that name, else the only end of the tree below `base` that a
/// joint moves and that is no gripper's, else `tool0` or `flange`.
///
/// # Errors
/// No such link, or several ends.
pub(super) fn tip<'a>(tree: &Tree<'a>, name: Option<&str>, base: &'a str) -> Result<&'a str> {
    if let Some(name) = name {
        return tree.named(name, "tip");
    }
    let moved = tree.all_below(base).into_iter();
    let moved = moved.filter(|(_, moved)| *moved);
    let moved: BTreeSet<&str> = moved.map(|(link, _)| link).collect();
    let is_end = |link: &&str| moved.contains(link) && tree.joints_below(link).is_empty();
    let ends: Vec<&str> = tree.links().filter(is_end).collect();
    let only = match ends.as_slice() {
        [end] => Some(*end),
        _ => None,
    };
    let is_arm = |end: &&'a str| {
        let path = tree.path(base, end).unwrap_or_default();
        gripper(tree, &path).is_none()
    };
    let custom = TIPS.iter().find_map(|tip| moved.get(tip).copied());
    if let Some(tip) = only.filter(is_arm).or(custom).or(only) {
        return Ok(tip);
    }
    let file = tree.source.file();
    if ends.is_empty() {
        let message = format!("No joint moves a link below \"{base}\".");
        return Err(Error::new(Code::Urdf, message).file(file));
    }
    let message = format!("Below \"{base}\" the robot ends in {} links; one of them must be the tip.", ends.len());
    let error = Error::new(Code::Urdf, message).file(file);
    Err(error.hint(format!("--tip one of {}", listed(tree, base, &ends))))
}

/// Doubts a chain that goes on into a gripper.
pub(super) fn doubted<'a>(tree: &Tree<'a>, path: &[&'a Joint]) -> Option<Finding> {
    let gripper = gripper(tree, path)?;
    let sentence = format!(
        "The joint looks like one of a gripper, {}: no axis of the arm. The arm before it ends in \"{}\": --tip {}.",
        gripper.sign, gripper.flange, gripper.flange
    );
    let name = gripper.joint.name.as_str();
    Some(Finding::caution(codes::URDF_GRIPPER, name, sentence))
}

/// The option that ends a chain before its gripper, where it has one.
pub(super) fn before_gripper<'a>(tree: &Tree<'a>, path: &[&'a Joint]) -> Option<String> {
    let gripper = gripper(tree, path)?;
    Some(format!(
        "\"{}\" looks like a joint of a gripper: --tip {} ends the chain before it",
        gripper.joint.name, gripper.flange
    ))
}

/// A link to choose as the tip; the likeliest one is the least.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Tip {
    is_gripper: bool,
    is_uncommon: bool,
    joints: Reverse<usize>,
    is_behind: bool,
    said: String,
}

impl Tip {
    /// A link with the joints of its chain, from the last joint on that does not turn; none where there are none.
    fn new<'a>(tree: &Tree<'a>, base: &'a str, link: &'a str, is_behind: bool) -> Option<Self> {
        let whole = tree.path(base, link)?;
        let cut = whole.iter().rposition(|joint| !turns(joint));
        let path = cut.map_or(&whole[..], |at| &whole[at + 1..]);
        let is_own = |joint: &&&Joint| joint.kind != JointKind::Fixed && joint.mimic.is_none();
        let moving = path.iter().filter(is_own);
        let names: Vec<&str> = moving.map(|joint| joint.name.as_str()).collect();
        let mut said = match names.as_slice() {
            [] => return None,
            [one] => format!("{link} (1 joint, {one}"),
            [first, .., last] => format!("{link} ({} joints, {first} to {last}", names.len()),
        };
        if let Some(at) = cut {
            said += &format!("; with --base {}", whole[at].child);
        }
        let gripper = gripper(tree, path);
        if let Some(gripper) = &gripper {
            said += &format!("; {} looks like a gripper's", gripper.joint.name);
        }
        Some(Tip {
            is_gripper: gripper.is_some(),
            is_uncommon: !FLANGES.iter().any(|end| link.ends_with(end)),
            joints: Reverse(names.len()),
            is_behind,
            said: said + ")",
        })
    }
}

fn turns(joint: &Joint) -> bool {
    use JointKind::{Continuous, Fixed, Revolute};
    matches!(joint.kind, Continuous | Fixed | Revolute)
}

/// The tips that the ends of a tree leave, the likeliest first, each with the joints of its chain: where an arm
/// ends, and what is behind it.
fn listed<'a>(tree: &Tree<'a>, base: &'a str, ends: &[&'a str]) -> String {
    let mut tips = BTreeMap::new();
    for end in ends {
        let path = tree.path(base, end).unwrap_or_default();
        let arm = gripper(tree, &path).map(|gripper| gripper.flange);
        let arm = arm.or_else(|| {
            let last = path.iter().rfind(|j| j.kind != JointKind::Fixed && turns(j));
            last.map(|joint| flange(tree, &joint.child))
        });
        tips.entry(*end).or_insert(true);
        tips.extend(arm.map(|arm| (arm, false)));
    }
    let tips = tips.into_iter();
    let mut tips: Vec<Tip> = tips.filter_map(|(link, is_behind)| Tip::new(tree, base, link, is_behind)).collect();
    tips.sort();
    if tips.is_empty() {
        return some_of(ends.iter().copied());
    }
    some_of(tips.iter().map(|tip| tip.said.as_str()))
}
