//! General springs at a posture under a load, and the small motions they make.

use super::PostureTerms;
use crate::model::kinematics::Frames;
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

/// A direction across an axis is clear from this length on (of a unit vector; m).
const CLEAR_LENGTH: f64 = 1e-2;

/// A general spring at a posture under a load.
#[derive(Clone)]
pub(super) struct LoadedSpring {
    axes: Matrix3<f64>,
    origin: Vector3<f64>,
    /// Force and moment about the origin, along its axes.
    load: Vector6<f64>,
    /// The axis that follows, along its axes, with the turn about that axis under a unit of
    /// compliance: it counts the turn of the spring about it as its own compliance.
    next: Option<(Vector3<f64>, Motion)>,
    /// True for the spring of a joint, whose last turn is that joint's own axis.
    has_axis: bool,
}

impl LoadedSpring {
    pub(super) fn new(terms: &PostureTerms, joint: Option<usize>) -> Self {
        let frames = terms.frames();
        let (axes, origin) = match joint {
            Some(j) => (link_axes(frames, j), frames.origins()[j]),
            None => (Matrix3::identity(), on_first_axis(frames)),
        };
        let moved = |to: &Vector3<f64>| terms.wrench().moved(terms.loading_point(), to);
        let wrench = moved(&origin);
        let (force, moment) = (axes.tr_mul(&wrench.force), axes.tr_mul(&wrench.moment));
        let next = joint.map_or(0, |j| j + 1);
        let next = frames.axes().get(next).zip(frames.origins().get(next));
        LoadedSpring {
            load: Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z),
            next: next.map(|(axis, at)| {
                let turn = axis * axis.dot(&moved(at).moment);
                (axes.tr_mul(axis), Motion::turn(turn, *at))
            }),
            has_axis: joint.is_some(),
            axes,
            origin,
        }
    }

    /// Motion per unit of an entry of its compliance.
    pub(super) fn entry(&self, row: usize, column: usize) -> Motion {
        let mut give = Vector6::zeros();
        give[row] = self.load[column];
        give[column] = self.load[row];
        let twice = if row == column { 1.0 } else { 2.0 };
        self.motion(&give, |along| match row {
            0..3 => 0.0,
            5 if self.has_axis => 0.0,
            _ => twice * along[row - 3] * along[column - 3],
        })
    }

    /// Motion with this compliance, symmetric.
    pub(super) fn with(&self, compliance: &Matrix6<f64>) -> Motion {
        let turns = compliance.fixed_view::<3, 3>(3, 3);
        let axial = if self.has_axis { turns[(2, 2)] } else { 0.0 };
        self.motion(&(compliance * self.load), |along| along.dot(&(turns * along)) - axial * along.z * along.z)
    }

    /// Motion by `give` along its axes, of which the axis that follows counts `about_next` as
    /// its own: a quadratic form of the direction of that axis.
    fn motion(&self, give: &Vector6<f64>, about_next: impl Fn(&Vector3<f64>) -> f64) -> Motion {
        let mut motion = Motion {
            shift: self.axes * give.fixed_rows::<3>(0),
            turn: self.axes * give.fixed_rows::<3>(3),
            origin: self.origin,
        };
        if let Some((along, turned)) = &self.next {
            let part = about_next(along);
            motion.add(&Motion::turn(turned.turn * -part, turned.origin));
        }
        motion
    }
}

/// A small motion: shift of the body's point at the origin, and turn.
#[derive(Clone)]
pub(super) struct Motion {
    shift: Vector3<f64>,
    turn: Vector3<f64>,
    origin: Vector3<f64>,
}

impl Motion {
    pub(super) fn turn(turn: Vector3<f64>, origin: Vector3<f64>) -> Self {
        Motion { shift: Vector3::zeros(), turn, origin }
    }

    /// Goes on with a further small motion of the same body.
    pub(super) fn add(&mut self, other: &Motion) {
        self.shift += other.at(&self.origin);
        self.turn += other.turn;
    }

    /// \[shift (m) of the body's point at `p`; turn (rad)\].
    pub(super) fn twist(&self, p: &Vector3<f64>) -> Vector6<f64> {
        let shift = self.at(p);
        Vector6::new(shift.x, shift.y, shift.z, self.turn.x, self.turn.y, self.turn.z)
    }

    /// Shifts of the body's points, x, y, z of each \[m\].
    pub(super) fn rows(&self, points: &[Vector3<f64>]) -> impl Iterator<Item = f64> {
        points.iter().flat_map(|p| self.at(p).data.0[0])
    }

    /// Shift of the body's point at `p`.
    fn at(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.shift + self.turn.cross(&(p - self.origin))
    }
}

/// The point of axis 1 nearest the base frame's origin.
pub(crate) fn on_first_axis(frames: &Frames) -> Vector3<f64> {
    let (axis, origin) = (frames.axes()[0], frames.origins()[0]);
    origin - axis * axis.dot(&origin)
}

/// Axes fixed to the link behind joint `j`: z its axis, x across it towards the next
/// joint's axis, or its origin, or along the flange's x. Which of them depends on the
/// robot alone, not on its posture.
pub fn link_axes(frames: &Frames, j: usize) -> Matrix3<f64> {
    let z = frames.axes()[j];
    let across = |v: Vector3<f64>| v - z * z.dot(&v);
    let next = frames.axes().get(j + 1).map(|axis| {
        let origin = frames.origins()[j + 1] - frames.origins()[j];
        [across(*axis), across(origin)]
    });
    // The last resort where a joint with the same axis follows; one of both is clear.
    let flange = frames.flange().rotation;
    let last = [flange * Vector3::x(), flange * Vector3::y()].map(across);
    let mut all = next.into_iter().flatten().chain(last);
    let x = all.find_map(|v| v.try_normalize(CLEAR_LENGTH));
    let x = x.unwrap_or_else(Vector3::x);
    Matrix3::from_columns(&[x, z.cross(&x), z])
}
