//! The axes of a chain, what moves them, and within which limits.
//!
//! A spring per axis and a controller angle per axis is what a [`DhRobot`] can say:
//! θ = offset + C q with a square C. A mimic joint turns by multiplier · q + offset of
//! another joint. It fits where
//!
//! - the joint that it follows is not in the chain: then it stands in for that joint,
//!   whose angle is the controller's and whose multiplier is the entry of C;
//! - it turns about the axis of the joint next to it in the chain: then both are one
//!   axis, on which C has two entries. That is how a URDF writes an arm whose elbow is
//!   driven from the shoulder (a joint that follows joint 2 with −1, then joint 3).
//!
//! Else the chain has more axes than the controller has joints, and is refused.

use super::limits::{doubted, endless, limits, narrowed};
use super::robot::{Joint, JointKind};
use super::source::Source;
use super::tree::Tree;
use nalgebra::{DMatrix, Isometry3, UnitQuaternion, UnitVector3};
use stiffarm::error::{Code, Error, Result, did_you_mean};
use stiffarm::findings::Finding;
use stiffarm::model::robot::{JointAxis, MOST_JOINTS};

/// Axes are one where directions \[rad\] and places \[m\] differ by no more than rounding.
const SAME_AXIS: f64 = 1e-10;

/// A chain as axes moved by the controller's joints.
pub(super) struct Chain<'a> {
    /// The axes at zero, base to tip, in the frame of the base link.
    pub(super) axes: Vec<JointAxis>,
    /// The controller's joints.
    pub(super) drives: Vec<&'a Joint>,
    /// Limits of the controller's joints \[rad\].
    pub(super) limits: Vec<[f64; 2]>,
    /// C of θ = offset + C q.
    pub(super) coupling: DMatrix<f64>,
    /// The tip at zero in the frame of the base link \[m\].
    pub(super) tip: Isometry3<f64>,
    /// The links of the chain, base first.
    pub(super) links: Vec<ChainLink<'a>>,
    /// What was not taken from the file.
    pub(super) findings: Vec<Finding>,
}

/// A link of the chain.
pub(super) struct ChainLink<'a> {
    pub(super) name: &'a str,
    /// Its frame at zero in that of the base link \[m\].
    pub(super) pose: Isometry3<f64>,
    /// Axes before it; none for a link between joints that are one axis.
    pub(super) axes_before: Option<usize>,
}

/// What a joint follows: itself, or another one.
struct JointDrive<'a> {
    drive: &'a Joint,
    multiplier: f64,
    offset: f64,
    is_mimic: bool,
}

/// Joints on one axis.
struct Group<'a> {
    axis: JointAxis,
    /// Angle about the axis per angle of each drive.
    terms: Vec<(&'a Joint, f64)>,
    has_mimic: bool,
    is_mimic_only: bool,
    /// A joint of it, for messages.
    joint: &'a Joint,
    /// Its links in the list of all.
    links: Vec<usize>,
}

/// The chain along the joints `path` from the link `base`.
///
/// # Errors
/// A joint that does not turn, a mimic joint that C cannot say, limits the wrong way round.
pub(super) fn chain<'a>(tree: &Tree<'a>, base: &'a str, path: &[&'a Joint]) -> Result<Chain<'a>> {
    let moving = path.iter().filter(|joint| joint.kind != JointKind::Fixed);
    let moving = moving.count();
    if moving > MOST_JOINTS {
        let message = format!("The chain has {moving} joints; at most {MOST_JOINTS} are supported.");
        return Err(Error::new(Code::Unsupported, message).file(tree.source.file()));
    }
    let mut groups: Vec<Group<'a>> = Vec::new();
    let mut links = vec![(base, Isometry3::identity())];
    let mut at = Isometry3::identity();
    let mut followers = Vec::new();
    for joint in path {
        at *= joint.origin;
        if joint.kind != JointKind::Fixed {
            let direction = direction(tree.source, joint)?;
            let follows = follows(tree, joint)?;
            if follows.multiplier != 0.0 {
                let axis = JointAxis { point: at.translation.vector, direction: at.rotation * *direction };
                add(&mut groups, joint, axis, &follows, links.len());
            }
            at *= UnitQuaternion::from_axis_angle(&direction, follows.offset);
            if follows.is_mimic {
                followers.push((*joint, follows));
            }
        }
        // A link behind a fixed joint goes with the one before it.
        links.push((joint.child.as_str(), at));
    }
    let links = placed(&groups, links);
    groups.retain(|group| !group.terms.is_empty());
    let (drives, coupling) = coupling(tree.source, base, &groups)?;
    let limits = drives.iter().map(|drive| {
        let mut limits = limits(tree.source, drive)?;
        for (joint, follows) in followers.iter().filter(|(_, f)| f.drive.name == drive.name) {
            let by = (follows.drive, follows.multiplier, follows.offset);
            limits = narrowed(tree.source, limits, joint, by)?;
        }
        Ok(limits)
    });
    let limits = limits.collect::<Result<Vec<_>>>()?;
    let findings = drives.iter().copied();
    let findings = findings.flat_map(|drive| endless(drive).into_iter().chain(doubted(drive)));
    let findings = findings.collect();
    Ok(Chain {
        findings,
        axes: groups.iter().map(|group| group.axis).collect(),
        drives,
        limits,
        coupling,
        tip: at,
        links,
    })
}

/// The links with the number of axes before them.
fn placed<'a>(groups: &[Group<'a>], links: Vec<(&'a str, Isometry3<f64>)>) -> Vec<ChainLink<'a>> {
    let last = |group: &Group| group.links[group.links.len() - 1];
    let links = links.into_iter().enumerate();
    links
        .map(|(i, (name, pose))| {
            let between = groups.iter().any(|g| g.links[0] <= i && i < last(g));
            let passed = groups.iter().filter(|g| last(g) <= i);
            let axes = passed.filter(|group| !group.terms.is_empty()).count();
            ChainLink { name, pose, axes_before: (!between).then_some(axes) }
        })
        .collect()
}

/// Adds a joint to the axis before it, where it is the same and one of the two
/// follows another joint, or as an axis of its own.
fn add<'a>(groups: &mut Vec<Group<'a>>, joint: &'a Joint, axis: JointAxis, follows: &JointDrive<'a>, link: usize) {
    let last = groups.last_mut();
    let one = last.filter(|group| {
        let apart = (axis.point - group.axis.point).cross(&group.axis.direction);
        let turned = axis.direction.cross(&group.axis.direction);
        (group.has_mimic || follows.is_mimic) && apart.norm() <= SAME_AXIS && turned.norm() <= SAME_AXIS
    });
    let Some(group) = one else {
        groups.push(Group {
            axis,
            terms: vec![(follows.drive, follows.multiplier)],
            has_mimic: follows.is_mimic,
            is_mimic_only: follows.is_mimic,
            joint,
            links: vec![link],
        });
        return;
    };
    let mut sign = axis.direction.dot(&group.axis.direction).signum();
    // The positive sense is that of the joint of the controller.
    if group.is_mimic_only && !follows.is_mimic {
        group.axis.direction *= sign;
        group.terms.iter_mut().for_each(|(_, factor)| *factor *= sign);
        group.joint = joint;
        sign = 1.0;
    }
    group.has_mimic |= follows.is_mimic;
    group.is_mimic_only &= follows.is_mimic;
    group.links.push(link);
    let same = |(drive, _): &&mut (&Joint, f64)| drive.name == follows.drive.name;
    match group.terms.iter_mut().find(same) {
        Some((_, factor)) => *factor += sign * follows.multiplier,
        None => group.terms.push((follows.drive, sign * follows.multiplier)),
    }
    group.terms.retain(|(_, factor)| *factor != 0.0);
}

/// The controller's joints and C.
fn coupling<'a>(source: &Source<'_>, base: &str, groups: &[Group<'a>]) -> Result<(Vec<&'a Joint>, DMatrix<f64>)> {
    if groups.is_empty() {
        let message = format!("No joint turns anything between \"{base}\" and the tip.");
        return Err(Error::new(Code::Urdf, message).file(source.file()));
    }
    let mut drives: Vec<&Joint> = Vec::new();
    let mut spare = None;
    for group in groups {
        let before = drives.len();
        for (drive, _) in &group.terms {
            if !drives.iter().any(|other| other.name == drive.name) {
                drives.push(drive);
            }
        }
        if drives.len() == before {
            spare.get_or_insert(group);
        }
    }
    let n = groups.len();
    let at = |drive: &Joint| drives.iter().position(|other| other.name == drive.name);
    let mut coupling = DMatrix::zeros(n, drives.len());
    for (i, group) in groups.iter().enumerate() {
        for (drive, factor) in &group.terms {
            if let Some(j) = at(drive) {
                coupling[(i, j)] += factor;
            }
        }
    }
    if drives.len() == n && coupling.clone().try_inverse().is_some() {
        return Ok((drives, coupling));
    }
    let group = spare.or_else(|| groups.iter().find(|g| g.has_mimic));
    let Some(group) = group else {
        return Err(Error::new(Code::Urdf, "The joints of the chain cannot be sorted out."));
    };
    let name = &group.joint.name;
    let message = format!(
        "The joint \"{name}\" follows another one (mimic) in a way that is not supported: {n} axes between base \
         and tip are turned by {} joints of the controller.",
        drives.len()
    );
    let error = source.error_at("joint", name, Code::Unsupported, message);
    Err(error.hint(
        "there must be as many: a mimic joint may follow a joint off the chain, or share its axis with the \
         joint next to it; else describe the arm without it",
    ))
}

/// The axis of a joint that turns, in its own frame.
fn direction(source: &Source<'_>, joint: &Joint) -> Result<UnitVector3<f64>> {
    let error = |code, message| source.error_at("joint", &joint.name, code, message);
    let kind = match joint.kind {
        JointKind::Revolute | JointKind::Continuous => None,
        JointKind::Prismatic => Some("shifts (prismatic)"),
        JointKind::Floating => Some("floats"),
        JointKind::Planar => Some("moves in a plane"),
        JointKind::Spherical => Some("turns about three axes (spherical)"),
        JointKind::Fixed => Some("is fixed"),
    };
    if let Some(kind) = kind {
        let message = format!(
            "The joint \"{}\" between base and tip {kind}; only joints that turn about one axis are supported.",
            joint.name
        );
        return Err(error(Code::Unsupported, message).hint(
            "choose --base and --tip so that it is not between them: a linear track below the base, a tool \
                behind the tip",
        ));
    }
    UnitVector3::try_new(joint.axis, 1e-9).ok_or_else(|| {
        let message = format!("The axis of the joint \"{}\" has length zero.", joint.name);
        error(Code::InvalidValue, message).hint("give its direction: <axis xyz=\"0 0 1\"/>")
    })
}

/// What a joint follows, through joints that follow others themselves.
fn follows<'a>(tree: &Tree<'a>, joint: &'a Joint) -> Result<JointDrive<'a>> {
    let mut follows = JointDrive { drive: joint, multiplier: 1.0, offset: 0.0, is_mimic: false };
    let error = |code, message| tree.source.error_at("joint", &joint.name, code, message);
    for _ in 0..=tree.robot.joints.len() {
        let Some(mimic) = &follows.drive.mimic else {
            let kind = follows.drive.kind;
            if follows.is_mimic && !matches!(kind, JointKind::Revolute | JointKind::Continuous) {
                let message = format!(
                    "The joint \"{}\" follows the joint \"{}\", which does not turn about one axis.",
                    joint.name, follows.drive.name
                );
                return Err(error(Code::Unsupported, message));
            }
            return Ok(follows);
        };
        let Some(next) = tree.joint(&mimic.joint) else {
            let message = format!(
                "The joint \"{}\" follows the joint \"{}\", which the file does not have.",
                follows.drive.name, mimic.joint
            );
            let near = did_you_mean(&mimic.joint, tree.joint_names());
            let error = error(Code::UnknownName, message);
            return Err(error.hint_if(near));
        };
        follows.offset += follows.multiplier * mimic.offset;
        follows.multiplier *= mimic.multiplier;
        follows.is_mimic = true;
        follows.drive = next;
    }
    let message = format!("The joint \"{}\" follows itself.", joint.name);
    Err(error(Code::Urdf, message))
}
