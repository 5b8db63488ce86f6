//! The two parts that come nearest to each other at a posture, and where.

use super::Scene;
use super::placed_parts::PlacedParts;
use super::work::Work;
use crate::model::observation::PostureTerms;
use nalgebra::Vector3;

/// Two parts and the points where they are nearest.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosestPair {
    /// Their names: of the part that moves, and of the other.
    pub names: [String; 2],
    /// Distance between their surfaces \[m\], negative where they overlap.
    pub distance: f64,
    /// The point of each surface, base frame \[m\].
    pub points: [Vector3<f64>; 2],
}

impl Scene {
    /// Of the pairs that are kept apart the one that comes nearest at this posture; `None` where
    /// there is none.
    pub fn closest(&self, terms: &PostureTerms) -> Option<ClosestPair> {
        let mut work = Work::default();
        let placed = PlacedParts::new(&self.parts, terms.frames(), &mut work.shapes);
        let mut best: Option<ClosestPair> = None;
        for pair in &self.pairs {
            let enough = best.as_ref().map_or(f64::INFINITY, |best| best.distance);
            let (distance, touch) = pair.distance(&placed, enough);
            let Some(touch) = touch.filter(|_| distance < enough) else {
                continue;
            };
            best = Some(ClosestPair {
                names: [pair.mover, pair.solid].map(|part| self.name(part).to_string()),
                distance,
                points: touch.surfaces(distance),
            });
        }
        best
    }
}
