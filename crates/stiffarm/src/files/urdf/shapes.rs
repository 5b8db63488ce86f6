//! Collision geometry of the links, as data; nothing here reads a mesh.

use super::chain::Chain;
use super::tree::{Tree, pose};
use crate::error::{Code, Result};
use crate::model::robot::AxisRows;
use nalgebra::Isometry3;
use std::collections::{BTreeMap, BTreeSet};
use urdf_rs::JointType;

/// A shape that goes with a link of the chain.
#[derive(Debug, Clone, PartialEq)]
pub struct CollisionShape {
    /// The link it goes with: 0 is the base, i moves with joint i.
    pub link: usize,
    /// Name of the URDF's link, for messages.
    pub urdf_link: String,
    /// Its frame \[m\]: for link 0 in the base frame; for link i in the frame of joint
    /// i after its turn, [`Frames::links`](crate::model::kinematics::Frames::links).
    pub pose: Isometry3<f64>,
    /// What it is.
    pub geometry: CollisionGeometry,
}

/// Geometry of a shape in its own frame \[m\].
#[derive(Debug, Clone, PartialEq)]
pub enum CollisionGeometry {
    /// A mesh.
    Mesh {
        /// Its file as the URDF names it; [`MeshFolders::find`](super::MeshFolders::find)
        /// says where that is.
        path: String,
        /// Factors on the mesh's x, y, z, which then are in m.
        scale: [f64; 3],
    },
    /// A box about the frame's origin.
    Box {
        /// Lengths of the whole edges along x, y, z \[m\].
        size: [f64; 3],
    },
    /// A cylinder about z, its middle at the origin.
    Cylinder {
        /// Radius \[m\].
        radius: f64,
        /// Whole length \[m\].
        length: f64,
    },
    /// A cylinder about z with half a ball on each end, its middle at the origin.
    Capsule {
        /// Radius \[m\].
        radius: f64,
        /// Length of the cylinder, without the balls \[m\].
        length: f64,
    },
    /// A ball about the origin.
    Sphere {
        /// Radius \[m\].
        radius: f64,
    },
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
    let mut found = Vec::new();
    let mut left_out = Vec::new();
    for link in &tree.robot.links {
        if link.collision.is_empty() {
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
        for collision in &link.collision {
            let geometry = geometry(&collision.geometry);
            if let Some(wrong) = wrong(&geometry) {
                let message = format!("A shape of the link \"{}\" {wrong}.", link.name);
                let source = tree.source;
                return Err(source.error_at("link", &link.name, Code::InvalidValue, message));
            }
            found.push(CollisionShape {
                link: *body,
                urdf_link: link.name.clone(),
                pose: frame.inv_mul(&(at * pose(&collision.origin))),
                geometry,
            });
        }
    }
    found.sort_by_key(|shape| shape.link);
    Ok((found, left_out))
}

/// The links that go with one of the chain's, and their frames at zero in the base.
fn placed<'a>(tree: &Tree<'a>, chain: &Chain<'a>) -> BTreeMap<&'a str, (usize, Isometry3<f64>)> {
    let in_chain: BTreeSet<&str> = chain.links.iter().map(|own| own.name).collect();
    let mut placed = BTreeMap::new();
    for own in &chain.links {
        let Some(body) = own.axes_before else {
            continue;
        };
        let mut open = vec![(own.name, own.pose)];
        while let Some((link, at)) = open.pop() {
            placed.insert(link, (body, at));
            let below = tree.joints_below(link).iter();
            let down = below.map(|j| (*j, j.child.link.as_str(), at * pose(&j.origin)));
            let above = tree.joint_above(link).into_iter();
            let up = above.map(|j| (j, j.parent.link.as_str(), at * pose(&j.origin).inverse()));
            for (joint, next, at) in down.chain(up) {
                let is_new = !in_chain.contains(next) && !placed.contains_key(next);
                if joint.joint_type == JointType::Fixed && is_new {
                    open.push((next, at));
                }
            }
        }
    }
    placed
}

fn geometry(read: &urdf_rs::Geometry) -> CollisionGeometry {
    use urdf_rs::Geometry;
    match read {
        Geometry::Mesh { filename, scale } => CollisionGeometry::Mesh {
            path: filename.clone(),
            scale: scale.map_or([1.0; 3], |scale| scale.0),
        },
        Geometry::Box { size } => CollisionGeometry::Box { size: size.0 },
        Geometry::Cylinder { radius, length } => CollisionGeometry::Cylinder {
            radius: *radius,
            length: *length,
        },
        Geometry::Capsule { radius, length } => CollisionGeometry::Capsule {
            radius: *radius,
            length: *length,
        },
        Geometry::Sphere { radius } => CollisionGeometry::Sphere { radius: *radius },
    }
}

/// What is wrong with a shape; mirrored meshes are not.
fn wrong(geometry: &CollisionGeometry) -> Option<&'static str> {
    let sizes = match geometry {
        CollisionGeometry::Mesh { scale, .. } => {
            return scale.contains(&0.0).then_some("has a scale of zero");
        }
        CollisionGeometry::Box { size } => size.to_vec(),
        CollisionGeometry::Cylinder { radius, length }
        | CollisionGeometry::Capsule { radius, length } => vec![*radius, *length],
        CollisionGeometry::Sphere { radius } => vec![*radius],
    };
    sizes
        .iter()
        .any(|size| *size <= 0.0)
        .then_some("has a size that is not above zero")
}
