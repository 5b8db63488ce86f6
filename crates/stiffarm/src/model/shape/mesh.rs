//! Triangle meshes.

use crate::error::{Code, Error, Result};
use nalgebra::{Isometry3, Vector3};

/// Triangles with their corners, in the frame of whatever they show \[m\].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriangleMesh {
    /// The corners.
    pub vertices: Vec<Vector3<f64>>,
    /// Three positions in `vertices` each.
    pub triangles: Vec<[usize; 3]>,
}

/// Largest coordinate of a mesh \[m\].
const FARTHEST: f64 = 1e6;

impl TriangleMesh {
    /// A mesh of these triangles \[m\].
    ///
    /// # Errors
    /// No triangles, a corner that is not there, or a coordinate that is not finite or beyond
    /// a thousand kilometres, which no squares of lengths would survive.
    pub fn new(vertices: Vec<Vector3<f64>>, triangles: Vec<[usize; 3]>) -> Result<Self> {
        if triangles.is_empty() {
            return Err(Error::new(Code::TooFewData, "The mesh has no triangles."));
        }
        if let Some(at) = triangles.iter().flatten().find(|v| **v >= vertices.len()) {
            return Err(Error::invalid(format!(
                "A triangle has corner {at}, but there are {} corners, counted from 0.",
                vertices.len()
            )));
        }
        if vertices.iter().flatten().any(|v| !v.is_finite()) {
            return Err(Error::new(Code::NotFinite, "The mesh has a coordinate that is not finite."));
        }
        let farthest = vertices.iter().map(|v| v.amax()).fold(0.0, f64::max);
        if farthest > FARTHEST {
            return Err(Error::invalid(format!(
                "The mesh has a coordinate of {farthest:.1e} m, which cannot be meant."
            )));
        }
        Ok(TriangleMesh { vertices, triangles })
    }

    /// Corners of each triangle.
    ///
    /// # Panics
    /// If a triangle has a corner that is not there, which [`new`](Self::new) refuses.
    pub fn corners(&self) -> impl Iterator<Item = [Vector3<f64>; 3]> + '_ {
        let at = |v: usize| self.vertices[v];
        self.triangles.iter().map(move |t| t.map(at))
    }

    /// Its size along the axes of its frame \[m\].
    pub fn extent(&self) -> Vector3<f64> {
        let Some(first) = self.vertices.first() else {
            return Vector3::zeros();
        };
        let (mut low, mut high) = (*first, *first);
        for v in &self.vertices {
            low = low.inf(v);
            high = high.sup(v);
        }
        high - low
    }

    /// The same mesh seen from the frame in which its own frame lies at `pose`.
    #[must_use]
    pub fn placed(&self, pose: &Isometry3<f64>) -> Self {
        let place = |p: &Vector3<f64>| pose.rotation * p + pose.translation.vector;
        TriangleMesh { vertices: self.vertices.iter().map(place).collect(), triangles: self.triangles.clone() }
    }

    /// The volume that the triangles enclose \[m³\]; of a surface with gaps, a guess.
    pub fn volume(&self) -> f64 {
        let sum: f64 = self.corners().map(|[a, b, c]| a.dot(&b.cross(&c))).sum();
        sum.abs() / 6.0
    }
}
