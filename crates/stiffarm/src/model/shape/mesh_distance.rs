//! Exact distances of meshes.
//!
//! The nearest triangle by parry's tree of boxes and its distances of convex shapes. parry sees
//! the surface of a mesh; that something lies wholly inside is found by how often the surface
//! winds around one of its points.

use super::{Solid, TriangleMesh};
use crate::error::{Code, Error, Result};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::query;
use parry3d_f64::shape::{Ball, Cuboid, Cylinder, Segment, Shape, TriMesh};
use parry3d_f64::transformation::try_convex_hull;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A mesh made ready for distances; its frame is that of the mesh.
#[derive(Clone)]
pub struct MeshBody {
    mesh: TriangleMesh,
    tree: TriMesh,
    /// A corner of each part that no triangle connects with the others.
    parts: Vec<Vector3<f64>>,
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl std::fmt::Debug for MeshBody {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MeshBody").field("mesh", &self.mesh).finish()
    }
}

fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn parry_pose(pose: &Isometry3<f64>) -> Pose {
    let q = pose.rotation.quaternion();
    Pose::from_parts(vector(&pose.translation.vector), Rotation::from_xyzw(q.i, q.j, q.k, q.w))
}

impl MeshBody {
    /// Prepares a mesh.
    ///
    /// # Errors
    /// What [`TriangleMesh::new`] refuses, or more than 4 thousand million corners.
    pub fn new(mesh: TriangleMesh) -> Result<Self> {
        let mesh = TriangleMesh::new(mesh.vertices, mesh.triangles)?;
        let small = |v: usize| u32::try_from(v);
        let triangles: Result<Vec<[u32; 3]>, _> =
            mesh.triangles.iter().map(|[a, b, c]| Ok([small(*a)?, small(*b)?, small(*c)?])).collect();
        let triangles = triangles
            .map_err(|_: std::num::TryFromIntError| Error::new(Code::Unsupported, "The mesh has too many corners."))?;
        let tree = TriMesh::new(mesh.vertices.iter().map(vector).collect(), triangles);
        let tree =
            tree.map_err(|e| Error::new(Code::Unsupported, format!("The mesh cannot be used for distances: {e}.")))?;
        let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        for v in mesh.corners().flatten() {
            (low, high) = (low.inf(&v), high.sup(&v));
        }
        Ok(MeshBody { parts: parts(&mesh), mesh, tree, low, high })
    }

    /// The mesh.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// Distance \[m\] of the mesh, with its frame at `pose`, from a solid in the same frame as
    /// that pose; 0 where they touch, overlap, or one is inside the other.
    ///
    /// # Errors
    /// The distance cannot be computed; no shape of this crate is known to do that.
    pub fn distance_to(&self, pose: &Isometry3<f64>, solid: &Solid) -> Result<f64> {
        let (shape, solid_pose, inner): (Box<dyn Shape>, Isometry3<f64>, Vector3<f64>) = match solid {
            Solid::HalfSpace { point, normal } => {
                let heights = self.mesh.corners().flatten().map(|v| {
                    let placed = pose.rotation * v + pose.translation.vector;
                    normal.dot(&(placed - point))
                });
                return Ok(heights.fold(f64::INFINITY, f64::min).max(0.0));
            }
            // By their axes, which have corners: parry's distances of round shapes are microns off.
            Solid::Capsule(c) if c.a == c.b => {
                (Box::new(Ball::new(c.radius)), Isometry3::translation(c.a.x, c.a.y, c.a.z), c.a)
            }
            Solid::Capsule(c) => {
                (Box::new(Segment::new(vector(&c.a), vector(&c.b))), Isometry3::identity(), (c.a + c.b) * 0.5)
            }
            Solid::Block { pose, half } => (Box::new(Cuboid::new(vector(half))), *pose, pose.translation.vector),
            Solid::Cylinder { pose, half_length, radius } => {
                // parry's stands on y.
                let upright = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
                (Box::new(Cylinder::new(*half_length, *radius)), pose * upright, pose.translation.vector)
            }
        };
        let radius = match solid {
            Solid::Capsule(c) if c.a != c.b => c.radius,
            _ => 0.0,
        };
        let apart = (apart(pose, &self.tree, &solid_pose, shape.as_ref())? - radius).max(0.0);
        let inside = apart > 0.0 && self.contains(&pose.inverse_transform_point(&inner.into()).coords);
        Ok(if inside { 0.0 } else { apart })
    }

    /// Distance \[m\] of two meshes with their frames at these poses; 0 where they touch,
    /// overlap, or one is inside the other.
    ///
    /// # Errors
    /// As [`distance_to`](Self::distance_to).
    pub fn distance_to_mesh(
        &self,
        pose: &Isometry3<f64>,
        other: &MeshBody,
        other_pose: &Isometry3<f64>,
    ) -> Result<f64> {
        let apart = apart(pose, &self.tree, other_pose, &other.tree)?;
        let here = pose.inverse() * other_pose;
        let inside = |holder: &MeshBody, held: &MeshBody, to_holder: &Isometry3<f64>| {
            let mut parts = held.parts.iter();
            parts.any(|v| holder.contains(&(to_holder * nalgebra::Point3::from(*v)).coords))
        };
        let inside = apart > 0.0 && (inside(self, other, &here) || inside(other, self, &here.inverse()));
        Ok(if inside { 0.0 } else { apart })
    }

    /// Whether a point that is not on the surface is inside it: the solid angles under which it
    /// sees the triangles add up to a full turn (Van Oosterom and Strackee, 1983,
    /// doi:10.1109/TBME.1983.325207).
    fn contains(&self, point: &Vector3<f64>) -> bool {
        let out = |axis: usize| point[axis] < self.low[axis] || point[axis] > self.high[axis];
        if (0..3).any(out) {
            return false;
        }
        let angles = self.mesh.corners().map(|corners| {
            let [a, b, c] = corners.map(|v| v - point);
            let [x, y, z] = [a.norm(), b.norm(), c.norm()];
            let below = x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y;
            2.0 * a.dot(&b.cross(&c)).atan2(below)
        });
        let turns = angles.sum::<f64>() / (2.0 * TAU);
        turns.abs() > 0.5
    }
}

/// A corner of each part of the mesh, parts being joined by corners.
fn parts(mesh: &TriangleMesh) -> Vec<Vector3<f64>> {
    fn root(parent: &mut [usize], mut v: usize) -> usize {
        while parent[v] != v {
            parent[v] = parent[parent[v]];
            v = parent[v];
        }
        v
    }
    let mut parent: Vec<usize> = (0..mesh.vertices.len()).collect();
    for [a, b, c] in &mesh.triangles {
        let first = root(&mut parent, *a);
        for v in [*b, *c] {
            let other = root(&mut parent, v);
            parent[other] = first;
        }
    }
    let mut roots: Vec<usize> = mesh.triangles.iter().map(|t| root(&mut parent, t[0])).collect();
    roots.sort_unstable();
    roots.dedup();
    roots.into_iter().map(|v| mesh.vertices[v]).collect()
}

fn apart(a: &Isometry3<f64>, first: &dyn Shape, b: &Isometry3<f64>, second: &dyn Shape) -> Result<f64> {
    let separation = query::distance(&parry_pose(a), first, &parry_pose(b), second);
    let separation =
        separation.map_err(|_| Error::new(Code::Internal, "The distance of two shapes is not implemented."))?;
    Ok(separation.distance)
}

/// Volume of the convex hull of a mesh \[m³\]; `None` where it has none, for example because the mesh
/// is flat.
pub fn hull_volume(mesh: &TriangleMesh) -> Option<f64> {
    let points: Vec<Vector> = mesh.vertices.iter().map(vector).collect();
    let (vertices, triangles) = try_convex_hull(&points).ok()?;
    let hull = TriangleMesh::new(
        vertices.iter().map(|v| Vector3::new(v.x, v.y, v.z)).collect(),
        triangles.iter().map(|t| t.map(|v| v as usize)).collect(),
    );
    hull.ok().map(|hull| hull.volume()).filter(|v| *v > 0.0)
}
