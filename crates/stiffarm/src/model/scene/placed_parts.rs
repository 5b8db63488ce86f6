//! The parts of a scene where they are at one posture.

use super::part::{Carrier, Part};
use crate::model::kinematics::Frames;
use crate::model::shape::Solid;
use nalgebra::Vector3;

/// A solid in a ball.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounded {
    pub solid: Solid,
    pub centre: Vector3<f64>,
    pub radius: f64,
}

impl Bounded {
    fn new(solid: Solid) -> Self {
        let (centre, radius) = solid.ball();
        Bounded { solid, centre, radius }
    }

    #[inline]
    /// A lower bound of the solid's distance from the segment from `a` to `b`.
    pub fn least_distance(&self, a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
        let along = b - a;
        let length = along.norm_squared();
        let t = if length > 0.0 { ((self.centre - a).dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
        (self.centre - a - along * t).norm() - self.radius
    }
}

/// Solids of all parts in the base frame.
#[derive(Debug, Clone, Default)]
pub(super) struct Shapes {
    solids: Vec<Bounded>,
    /// Where the solids of each part begin.
    starts: Vec<usize>,
}

/// The parts where they are at one posture.
pub(super) struct PlacedParts<'a> {
    pub frames: &'a Frames,
    parts: &'a [Part],
    solids: &'a [Bounded],
    starts: &'a [usize],
}

impl<'a> PlacedParts<'a> {
    pub fn new(parts: &'a [Part], frames: &'a Frames, shapes: &'a mut Shapes) -> Self {
        let Shapes { solids, starts } = shapes;
        solids.clear();
        starts.clear();
        for part in parts {
            starts.push(solids.len());
            if part.carrier == Carrier::World {
                solids.extend(part.solids.iter().map(|s| Bounded::new(*s)));
            } else {
                let pose = part.carrier.pose(frames);
                solids.extend(part.solids.iter().map(|s| Bounded::new(s.placed(&pose))));
            }
        }
        starts.push(solids.len());
        PlacedParts { frames, parts, solids, starts }
    }

    pub fn part_count(&self) -> usize {
        self.parts.len()
    }

    pub fn solids(&self, part: usize) -> &[Bounded] {
        &self.solids[self.starts[part]..self.starts[part + 1]]
    }

    pub fn is_tool(&self, part: usize) -> bool {
        self.parts[part].is_tool()
    }

    pub fn moved_by(&self, part: usize) -> usize {
        let carrier = self.parts[part].carrier;
        carrier.moved_by(self.frames.joint_count())
    }
}
