//! Collision geometry of the links, as data; nothing here reads a mesh.

use super::chain::Chain;
use super::robot::{CollisionGeometry, JointKind};
use super::tree::Tree;
use nalgebra::Isometry3;
use std::collections::{BTreeMap, BTreeSet};
use stiffarm::error::{Code, Result};
use stiffarm::model::robot::AxisRows;

/// A shape that goes with a link of the chain.
#[derive(Debug, Clone, PartialEq)]
pub struct CollisionShape {
    /// The link it goes with: 0 is the base, i moves with joint i.
    pub link: usize,
    /// Name of the URDF's link, for messages.
    pub urdf_link: String,
    /// Its frame \[m\]: for link 0 in the base frame; for link i in the frame of joint
    /// i after its turn, [`Frames::links`](stiffarm::model::kinematics::Frames::links).
    pub pose: Isometry3<f64>,
    /// What it is.
    pub geometry: CollisionGeometry,
}

/// Shapes of a chain, and the links that go with none of its links.
pub(super) type Shapes = (Vec<CollisionShape>, Vec<String>);

/// The shapes of the chain's links and of what is fixed to them, link by link; and
/// the links with shapes that move otherwise.
///
/// # Errors
/// A size that is not above zero.
pub(super) fn shapes(tree: &Tree<'_>, chain: &Chain<'_>, rows: &AxisRows) -> Result<Shapes> {
    let placed = placed(tree, chain);
    let mut shapes = Vec::new();
    let mut left_out = Vec::new();
    for link in &tree.robot.links {
        if link.collisions.is_empty() {
            continue;
        }
        let Some((body, at)) = placed.get(link.name.as_str()) else {
            left_out.push(link.name.clone());
            continue;
        };
        let frame = match body {
            0 => Isometry3::identity(),
            i => rows.links[i - 1],
        };
        for collision in &link.collisions {
            if let Some(wrong) = wrong(&collision.geometry) {
                let message = format!("A shape of the link \"{}\" {wrong}.", link.name);
                let source = tree.source;
                return Err(source.error_at("link", &link.name, Code::InvalidValue, message));
            }
            shapes.push(CollisionShape {
                link: *body,
                urdf_link: link.name.clone(),
                pose: frame.inv_mul(&(at * collision.origin)),
                geometry: collision.geometry.clone(),
            });
        }
    }
    shapes.sort_by_key(|shape| shape.link);
    Ok((shapes, left_out))
}

/// The links that go with one of the chain's, and their frames at zero in the base.
fn placed<'a>(tree: &Tree<'a>, chain: &Chain<'a>) -> BTreeMap<&'a str, (usize, Isometry3<f64>)> {
    let in_chain: BTreeSet<&str> = chain.links.iter().map(|chain_link| chain_link.name).collect();
    let mut placed = BTreeMap::new();
    for chain_link in &chain.links {
        let Some(body) = chain_link.axes_before else {
            continue;
        };
        let mut open = vec![(chain_link.name, chain_link.pose)];
        while let Some((link, at)) = open.pop() {
            placed.insert(link, (body, at));
            let below = tree.joints_below(link).iter();
            let down = below.map(|j| (*j, j.child.as_str(), at * j.origin));
            let above = tree.joint_above(link).into_iter();
            let up = above.map(|j| (j, j.parent.as_str(), at * j.origin.inverse()));
            for (joint, next, at) in down.chain(up) {
                let is_new = !in_chain.contains(next) && !placed.contains_key(next);
                if joint.kind == JointKind::Fixed && is_new {
                    open.push((next, at));
                }
            }
        }
    }
    placed
}

/// What is wrong with a shape; mirrored meshes are not.
fn wrong(geometry: &CollisionGeometry) -> Option<&'static str> {
    let sizes = match geometry {
        CollisionGeometry::Mesh { scale, .. } => {
            return scale.contains(&0.0).then_some("has a scale of zero");
        }
        CollisionGeometry::Box { size } => size.to_vec(),
        CollisionGeometry::Cylinder { radius, length } | CollisionGeometry::Capsule { radius, length } => {
            vec![*radius, *length]
        }
        CollisionGeometry::Sphere { radius } => vec![*radius],
    };
    sizes.iter().any(|size| *size <= 0.0).then_some("has a size that is not above zero")
}
