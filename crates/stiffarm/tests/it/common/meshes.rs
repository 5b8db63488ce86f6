//! Meshes of known shapes.

use nalgebra::{Isometry3, Vector3};
use stiffarm::model::shape::TriangleMesh;

/// A box from corner to corner, its faces outward.
pub fn box_mesh(low: Vector3<f64>, high: Vector3<f64>) -> TriangleMesh {
    let vertices = (0..8)
        .map(|corner: usize| {
            Vector3::from_fn(|axis, _| match corner >> axis & 1 {
                0 => low[axis],
                _ => high[axis],
            })
        })
        .collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// Both meshes as one.
pub fn joined(mut a: TriangleMesh, b: &TriangleMesh) -> TriangleMesh {
    let offset = a.vertices.len();
    a.vertices.extend(&b.vertices);
    let shifted = b.triangles.iter().map(|t| t.map(|v| v + offset));
    a.triangles.extend(shifted);
    a
}

/// An L of two bars 1 m long and 0.1 m thick.
pub fn l_mesh() -> TriangleMesh {
    let o = Vector3::zeros();
    let long = box_mesh(o, Vector3::new(1.0, 0.1, 0.1));
    joined(long, &box_mesh(o, Vector3::new(0.1, 1.0, 0.1)))
}

/// A capsule about z with its middle at the origin, of rings of `around` corners each, at `pose`.
pub fn capsule_mesh(half: f64, radius: f64, around: usize, pose: &Isometry3<f64>) -> TriangleMesh {
    let rings = around / 2;
    let mut vertices = vec![Vector3::new(0.0, 0.0, -half - radius)];
    for ring in 1..2 * rings {
        let up = std::f64::consts::PI * (ring as f64 / (2 * rings) as f64 - 0.5);
        let shift = if ring < rings { -half } else { half };
        // The middle ring stands at both ends of the cylinder.
        for shift in if ring == rings { vec![-half, half] } else { vec![shift] } {
            for i in 0..around {
                let turn = std::f64::consts::TAU * i as f64 / around as f64;
                vertices.push(Vector3::new(
                    radius * up.cos() * turn.cos(),
                    radius * up.cos() * turn.sin(),
                    radius * up.sin() + shift,
                ));
            }
        }
    }
    vertices.push(Vector3::new(0.0, 0.0, half + radius));
    let last = vertices.len() - 1;
    let count = (last - 1) / around;
    let at = |ring: usize, i: usize| 1 + ring * around + i % around;
    let mut triangles = Vec::new();
    for i in 0..around {
        triangles.push([0, at(0, i + 1), at(0, i)]);
        triangles.push([last, at(count - 1, i), at(count - 1, i + 1)]);
        for ring in 0..count - 1 {
            triangles.push([at(ring, i), at(ring, i + 1), at(ring + 1, i)]);
            triangles.push([at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)]);
        }
    }
    TriangleMesh::new(vertices, triangles).unwrap().placed(pose)
}
