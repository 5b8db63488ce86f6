//! The derivative of a margin by the joint angles, as forces on points that move.

use crate::model::kinematics::Frames;
use nalgebra::Vector3;

/// A force on a point that moves with the first `moved_by` joints: the derivative of a margin by
/// that point's position.
#[derive(Debug, Clone, Copy)]
pub(super) struct Push {
    pub point: Vector3<f64>,
    pub force: Vector3<f64>,
    pub moved_by: usize,
}

const NO_PUSH: Push = Push {
    point: Vector3::new(0.0, 0.0, 0.0),
    force: Vector3::new(0.0, 0.0, 0.0),
    moved_by: 0,
};

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
            self.pushes[self.count] = Push {
                point,
                force,
                moved_by,
            };
            self.count += 1;
        }
    }

    /// Adds `factor` times the derivative with respect to θ.
    pub(crate) fn add_to(&self, frames: &Frames, factor: f64, gradient: &mut [f64]) {
        if let Some(own) = self.by_joint {
            for (g, d) in gradient.iter_mut().zip(own) {
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

    /// Derivatives by the rope's anchor and by the loading point, base axes.
    pub(crate) fn by_load(&self) -> (Vector3<f64>, Vector3<f64>) {
        (self.by_anchor, self.by_loading_point)
    }
}
