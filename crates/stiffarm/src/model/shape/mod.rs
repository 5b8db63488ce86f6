//! Shapes of links, tools and obstacles, and how far a line segment is from them.
//!
//! The links of an arm are capsules, each a segment with a radius; tools and what stands around are
//! convex solids with a signed distance: positive outside, minus the depth
//! below the surface inside. The signed distance of a convex solid is a convex
//! function, so the smallest one along a segment is a convex problem of one
//! variable, inside the solid too: [`nearest`] solves it, in closed form where there is one. [`between`] is
//! the distance of two solids.

mod between;
mod capsule;
mod cover;
mod fit;
mod mesh;
mod mesh_distance;
mod nearest;
mod signed_distance;

pub use between::{Between, between};
pub use capsule::Capsule;
pub use cover::{capsules_around, solids_around};
pub use fit::capsules_of_mesh;
pub use mesh::TriangleMesh;
pub use mesh_distance::{MeshBody, hull_volume};
pub(crate) use nearest::nearest_within;
pub use nearest::{Nearest, nearest};

use crate::error::{Error, Result};
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

/// A convex solid in some frame \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Solid {
    /// A cylinder with half spheres at its ends; a sphere where both ends are one point.
    Capsule(Capsule),
    /// A box with its centre and axes at `pose`.
    Block {
        /// Centre and axes.
        pose: Isometry3<f64>,
        /// Half its size along its axes.
        half: Vector3<f64>,
    },
    /// A cylinder with flat ends about the z axis of `pose`, its centre the origin there.
    Cylinder {
        /// Centre and axes.
        pose: Isometry3<f64>,
        /// Half its length.
        half_length: f64,
        /// Its radius.
        radius: f64,
    },
    /// Everything behind a plane: floor, ceiling, wall.
    HalfSpace {
        /// A point on the plane.
        point: Vector3<f64>,
        /// Away from what is filled.
        normal: Unit<Vector3<f64>>,
    },
}

impl Solid {
    /// A box of this size, with its centre and axes at `pose` \[m\].
    ///
    /// # Errors
    /// A side that is not above zero.
    pub fn block(pose: Isometry3<f64>, size: Vector3<f64>) -> Result<Self> {
        if size.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
            return Err(Error::invalid("Each side of a box must be above zero."));
        }
        Ok(Solid::Block { pose, half: size * 0.5 })
    }

    /// A cylinder with flat ends, from the middle of one to the middle of the other \[m\].
    ///
    /// # Errors
    /// Both ends are one point, or the radius is not above zero.
    pub fn cylinder(from: Vector3<f64>, to: Vector3<f64>, radius: f64) -> Result<Self> {
        let along = Unit::try_new(to - from, 1e-9)
            .ok_or_else(|| Error::invalid("Both ends of a cylinder are the same point."))?;
        if !(radius.is_finite() && radius > 0.0) {
            return Err(Error::invalid("The radius of a cylinder must be above zero."));
        }
        let turn = UnitQuaternion::rotation_between(&Vector3::z(), &along)
            .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
        Ok(Solid::Cylinder {
            pose: Isometry3::from_parts(Translation3::from((from + to) * 0.5), turn),
            half_length: (to - from).norm() * 0.5,
            radius,
        })
    }

    /// The same solid seen from the frame in which its own frame lies at `pose`.
    #[must_use]
    pub fn placed(&self, pose: &Isometry3<f64>) -> Self {
        match *self {
            Solid::Capsule(capsule) => Solid::Capsule(capsule.placed(pose)),
            Solid::Block { pose: local, half } => Solid::Block { pose: pose * local, half },
            Solid::Cylinder { pose: local, half_length, radius } => {
                Solid::Cylinder { pose: pose * local, half_length, radius }
            }
            Solid::HalfSpace { point, normal } => Solid::HalfSpace {
                point: pose.rotation * point + pose.translation.vector,
                normal: pose.rotation * normal,
            },
        }
    }

    /// A sphere that contains the solid: centre and radius, infinite for a half-space \[m\].
    pub(crate) fn ball(&self) -> (Vector3<f64>, f64) {
        match self {
            Solid::Capsule(c) => ((c.a + c.b) * 0.5, (c.b - c.a).norm() * 0.5 + c.radius),
            Solid::Block { pose, half } => (pose.translation.vector, half.norm()),
            Solid::Cylinder { pose, half_length, radius } => {
                (pose.translation.vector, (half_length * half_length + radius * radius).sqrt())
            }
            Solid::HalfSpace { point, .. } => (*point, f64::INFINITY),
        }
    }
}
