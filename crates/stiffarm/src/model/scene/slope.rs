//! The derivative of a margin by the joint angles, as forces on points that move.

use crate::model::kinematics::Frames;
use crate::model::shape::Nearest;
use nalgebra::Vector3;

/// A force on a point that moves with the first `moved_by` joints: the derivative of a margin by
/// that point's position.
#[derive(Debug, Clone, Copy)]
pub(super) struct Push {
    pub point: Vector3<f64>,
    pub force: Vector3<f64>,
    pub moved_by: usize,
}

const NO_PUSH: Push = Push { point: Vector3::new(0.0, 0.0, 0.0), force: Vector3::new(0.0, 0.0, 0.0), moved_by: 0 };

/// ∂margin/∂θ_k = z_k · (Σ (x − o_k) × f + turn), over the pushes on points x that joint k moves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slope<'a> {
    pushes: [Push; 3],
    count: usize,
    /// Moment on the tool, beside what the pushes give.
    pub(super) turn: Vector3<f64>,
    /// Instead of all that: the derivative itself, one per joint.
    pub(super) by_joint: Option<&'a [f64]>,
    /// Derivative by the rope's anchor.
    pub(super) by_anchor: Vector3<f64>,
    /// Derivative by a loading point that moves in the tool, base axes.
    pub(super) by_loading_point: Vector3<f64>,
}

impl<'a> Slope<'a> {
    pub(super) const NONE: Slope<'static> = Slope {
        pushes: [NO_PUSH; 3],
        count: 0,
        turn: Vector3::new(0.0, 0.0, 0.0),
        by_joint: None,
        by_anchor: Vector3::new(0.0, 0.0, 0.0),
        by_loading_point: Vector3::new(0.0, 0.0, 0.0),
    };

    pub(super) fn push(&mut self, point: Vector3<f64>, force: Vector3<f64>, moved_by: usize) {
        if moved_by > 0 {
            self.pushes[self.count] = Push { point, force, moved_by };
            self.count += 1;
        }
    }

    /// Adds `factor` times the derivative with respect to θ.
    fn add_to(&self, frames: &Frames, factor: f64, gradient: &mut [f64]) {
        if let Some(by_joint) = self.by_joint {
            for (g, d) in gradient.iter_mut().zip(by_joint) {
                *g += factor * d;
            }
            return;
        }
        let joints = frames.axes().iter().zip(frames.origins());
        for (k, (g, (axis, origin))) in gradient.iter_mut().zip(joints).enumerate() {
            let mut moment = self.turn;
            for push in &self.pushes[..self.count] {
                if k < push.moved_by {
                    moment += (push.point - origin).cross(&push.force);
                }
            }
            *g += factor * axis.dot(&moment);
        }
    }
}

/// Where a line comes nearest to a solid: enough to tell how their distance changes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch {
    /// Ends of the line.
    pub(super) ends: [Vector3<f64>; 2],
    /// Number of joints that move each end.
    pub(super) moved_by: [usize; 2],
    /// Number of joints that move the solid.
    pub(super) solid_moved_by: usize,
    pub(super) at: Nearest,
}

impl Touch {
    /// The points of both surfaces, of the line's and of the solid's, that are `distance` apart \[m\].
    pub(super) fn surfaces(&self, distance: f64) -> [Vector3<f64>; 2] {
        let ([a, b], at) = (self.ends, &self.at);
        let solid = a + (b - a) * at.t - at.direction * at.distance;
        [solid + at.direction * distance, solid]
    }

    fn slope(&self) -> Slope<'static> {
        let ([a, b], at) = (self.ends, &self.at);
        let mut slope = Slope::NONE;
        let point = a + (b - a) * at.t;
        if self.moved_by[0] == self.moved_by[1] {
            slope.push(point, at.direction, self.moved_by[0]);
        } else {
            slope.push(a, at.direction * (1.0 - at.t), self.moved_by[0]);
            slope.push(b, at.direction * at.t, self.moved_by[1]);
        }
        slope.push(point, -at.direction, self.solid_moved_by);
        slope
    }
}

/// The derivative of a margin, worked out where it is asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Derivative<'a> {
    /// None, or not asked for.
    Zero,
    Touch(&'a Touch),
    Slope(&'a Slope<'a>),
}

impl Derivative<'_> {
    /// Adds `factor` times the derivative with respect to θ.
    pub(crate) fn add_to(&self, frames: &Frames, factor: f64, gradient: &mut [f64]) {
        match self {
            Derivative::Zero => {}
            Derivative::Touch(touch) => touch.slope().add_to(frames, factor, gradient),
            Derivative::Slope(slope) => slope.add_to(frames, factor, gradient),
        }
    }

    /// Derivatives by the rope's anchor and by the loading point, base axes.
    pub(crate) fn by_load(&self) -> (Vector3<f64>, Vector3<f64>) {
        match self {
            Derivative::Slope(slope) => (slope.by_anchor, slope.by_loading_point),
            _ => (Vector3::zeros(), Vector3::zeros()),
        }
    }
}
