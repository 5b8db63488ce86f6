//! Capsules around a mesh.
//!
//! A capsule is convex, so it contains a triangle when it contains its corners. More than one come
//! from cutting the triangles with planes: each part has a capsule of its own, and together they
//! contain every triangle.

mod around;
mod cut;

use super::{Capsule, TriangleMesh};
use crate::numerics::order::sort_by_number;
use around::{Effort, capsule_around};
use cut::{Polygon, cut, planes};

/// A cut must leave no more than this share of a capsule's volume.
const WORTH_CUTTING_SHARE: f64 = 0.75;
/// So many of the best planes are looked at closely.
const FINALISTS: usize = 4;

/// At most `most` capsules that together contain the whole mesh, small in volume, in its frame \[m\].
///
/// One more is taken where the two that replace a capsule have at most 75 % of its volume. Ends and
/// radii are whole hundredths of a millimetre, the radius rounded up. The search is local: a
/// smaller set may exist. None for a mesh without vertices.
///
/// # Panics
/// If a triangle has a corner that is not there, which [`TriangleMesh::new`] refuses.
pub fn capsules_of_mesh(mesh: &TriangleMesh, most: usize) -> Vec<Capsule> {
    if mesh.vertices.is_empty() || most == 0 {
        return Vec::new();
    }
    let mut seen = vec![false; mesh.vertices.len()];
    mesh.triangles.iter().flatten().for_each(|v| seen[*v] = true);
    let lone = mesh.vertices.iter().zip(&seen).filter(|(_, seen)| !**seen);
    let polygons: Vec<Polygon> = mesh
        .corners()
        .map(|corners| corners.to_vec())
        // Corners of no triangle count, too.
        .chain(lone.map(|(vertex, _)| vec![*vertex]))
        .collect();
    let mut parts = vec![Part::new(polygons)];
    while parts.len() < most {
        for part in &mut parts {
            part.look_for_halves();
        }
        let saved = |part: &Part| part.halves.as_ref().map(|halves| part.volume() - volume(halves));
        let best = (0..parts.len()).filter_map(|at| Some((at, saved(&parts[at])?))).max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((at, _)) = best else { break };
        let halves = parts[at].halves.take();
        parts.splice(at..=at, halves.into_iter().flatten());
    }
    parts.into_iter().map(|part| part.capsule).collect()
}

/// A part of the mesh and the capsule around it.
struct Part {
    polygons: Vec<Polygon>,
    capsule: Capsule,
    /// Two parts to take its place, where they are worth it; looked for once.
    halves: Option<Vec<Part>>,
    looked: bool,
}

fn volume(parts: &[Part]) -> f64 {
    parts.iter().map(Part::volume).sum()
}

impl Part {
    fn new(polygons: Vec<Polygon>) -> Self {
        Part { capsule: capsule_around(&polygons.concat(), Effort::Full), polygons, halves: None, looked: false }
    }

    fn volume(&self) -> f64 {
        self.capsule.volume()
    }

    fn look_for_halves(&mut self) {
        if std::mem::replace(&mut self.looked, true) {
            return;
        }
        let rough = |polygons: &[Polygon]| capsule_around(&polygons.concat(), Effort::Rough).volume();
        let mut cuts: Vec<(f64, [Vec<Polygon>; 2])> = planes(&self.polygons)
            .into_iter()
            .map(|plane| cut(&self.polygons, &plane))
            .filter(|halves| halves.iter().all(|half| !half.is_empty()))
            .map(|halves| (rough(&halves[0]) + rough(&halves[1]), halves))
            .collect();
        sort_by_number(&mut cuts, |a| a.0);
        let finalists = cuts.into_iter().take(FINALISTS);
        let parts = finalists.map(|(_, halves)| halves.into_iter().map(Part::new).collect());
        self.halves = parts
            .min_by(|a: &Vec<Part>, b: &Vec<Part>| volume(a).total_cmp(&volume(b)))
            .filter(|halves| volume(halves) <= WORTH_CUTTING_SHARE * self.volume());
    }
}
