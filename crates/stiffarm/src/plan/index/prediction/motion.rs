//! What every unknown of the mixed elastic model does to the flange at one posture, in
//! flange axes, and how that changes with the joint angles.
//!
//! In flange axes a spring of the arm needs two things: the motion transform A_s from its
//! own frame to the flange's, and the flange's wrench w, which is A_sᵀ w in the spring's
//! frame. An entry (a, b) of its compliance then moves the flange by
//! A_s (e_a f_b + e_b f_a), f = A_sᵀ w, and a turn of joint j behind the spring changes
//! A_s by −ad(ξ_j) A_s, ξ_j being that joint's own unit motion.

use crate::model::elastic::Effect;
use crate::model::load::{Axes, Load};
use crate::model::observation::{ExtraTerm, PostureTerms, link_axes, on_first_axis};
use crate::model::robot::Robot;
use nalgebra::{DMatrix, DVector, Matrix3, Matrix6, Vector3, Vector6};

/// The arm at one posture as its flange sees it: motions are \[shift; turn\] at the
/// flange's origin, wrenches \[force; moment\] about it, all in flange axes.
#[derive(Debug, Clone)]
pub(crate) struct ArmMotion {
    /// A_s: base first, then joint by joint.
    transforms: Vec<Matrix6<f64>>,
    /// ξ_j of each joint.
    joints: Vec<Vector6<f64>>,
    /// w.
    wrench: Vector6<f64>,
    /// Loading point in flange axes \[m\].
    loading_point: Vector3<f64>,
    /// The rope's anchor in flange axes \[m\].
    anchor: Option<Vector3<f64>>,
}

impl ArmMotion {
    /// The arm with the wrench of `terms`, which `load` gives.
    pub(crate) fn new(terms: &PostureTerms, load: &Load) -> Self {
        let frames = terms.frames();
        let flange = frames.flange();
        let inverse = flange.rotation.inverse().to_rotation_matrix();
        let at = |axes: &Matrix3<f64>, origin: &Vector3<f64>| {
            let place = inverse * (origin - flange.translation.vector);
            transform(&(inverse.matrix() * axes), &place)
        };
        let mut transforms = vec![at(&Matrix3::identity(), &on_first_axis(frames))];
        for (j, origin) in frames.origins().iter().enumerate() {
            transforms.push(at(&link_axes(frames, j), origin));
        }
        let joints = transforms[1..].iter().map(|a| a.column(5).into_owned()).collect();
        let in_flange = |point: &Vector3<f64>| inverse * (point - flange.translation.vector);
        let loading_point = in_flange(terms.loading_point());
        let stated = terms.wrench();
        let (force, moment) = (inverse * stated.force, inverse * stated.moment);
        let moment = moment + loading_point.cross(&force);
        ArmMotion {
            transforms,
            joints,
            wrench: stack(&force, &moment),
            loading_point,
            anchor: match load {
                Load::Rope { anchor, .. } => Some(in_flange(anchor)),
                _ => None,
            },
        }
    }

    /// Motions of the flange by each spring of the joints, then by each effect, 6 × unknowns.
    pub(crate) fn columns(&self, robot: &Robot, effects: &[Effect]) -> DMatrix<f64> {
        let n = robot.spring_count();
        let mut out = DMatrix::zeros(6, n + effects.len());
        let (axes, loads) = self.springs(robot);
        for j in 0..n {
            out.column_mut(j).copy_from(&(axes.column(j) * loads[j]));
        }
        let felt = self.felt();
        for (i, effect) in effects.iter().enumerate() {
            let (place, row, column) = entry(effect);
            let (a, f) = (&self.transforms[place], &felt[place]);
            let mut motion = a.column(row) * (f[column] * effect.scale);
            if row != column {
                motion += a.column(column) * (f[row] * effect.scale);
            }
            out.column_mut(n + i).copy_from(&motion);
        }
        out
    }

    /// Unit motions of the springs, 6 × n, and their loads: E⁻¹ mixes both.
    fn springs(&self, robot: &Robot) -> (DMatrix<f64>, DVector<f64>) {
        let axes = DMatrix::from_fn(6, self.joints.len(), |i, j| self.joints[j][i]);
        let axes = match robot.spring_mixing() {
            None => axes,
            Some(mixing) => axes * mixing,
        };
        let loads = axes.tr_mul(&self.wrench);
        let loads = DVector::from_column_slice(loads.as_slice());
        (axes, loads)
    }

    /// The wrench in each spring's frame.
    fn felt(&self) -> Vec<Vector6<f64>> {
        let of = |a: &Matrix6<f64>| a.tr_mul(&self.wrench);
        self.transforms.iter().map(of).collect()
    }

    /// Adds to `gradient` the derivatives by the serial joint angles of a function whose
    /// derivative by [`columns`](Self::columns) is `adjoint`, 6 × unknowns.
    pub(crate) fn add_gradient(
        &self,
        robot: &Robot,
        load: &Load,
        effects: &[Effect],
        adjoint: &DMatrix<f64>,
        gradient: &mut [f64],
    ) {
        let n = robot.spring_count();
        let mut by_wrench = Vector6::zeros();
        // Σ over what stands before a joint of (derivative by A or ξ) times (A or ξ)ᵀ.
        let mut moved = vec![Matrix6::zeros(); self.transforms.len()];
        let (axes, loads) = self.springs(robot);
        let mut by_axes = DMatrix::zeros(6, n);
        for j in 0..n {
            let column_adjoint = adjoint.column(j);
            let by_load = column_adjoint.dot(&axes.column(j));
            by_axes.set_column(j, &(column_adjoint * loads[j] + self.wrench * by_load));
            by_wrench += axes.column(j) * by_load;
        }
        let by_joints = match robot.spring_mixing() {
            None => by_axes,
            Some(mixing) => by_axes * mixing.transpose(),
        };
        for (j, xi) in self.joints.iter().enumerate() {
            let by: Vector6<f64> = by_joints.fixed_view::<6, 1>(0, j).into_owned();
            moved[j + 1] += by * xi.transpose();
        }
        let felt = self.felt();
        let mut by_transform = vec![Matrix6::<f64>::zeros(); self.transforms.len()];
        let mut by_felt = vec![Vector6::<f64>::zeros(); self.transforms.len()];
        for (i, effect) in effects.iter().enumerate() {
            let (place, row, column) = entry(effect);
            let (a, f) = (&self.transforms[place], &felt[place]);
            let column_adjoint: Vector6<f64> = adjoint.fixed_view::<6, 1>(0, n + i) * effect.scale;
            let (by_a, by_f) = (&mut by_transform[place], &mut by_felt[place]);
            by_f[column] += column_adjoint.dot(&a.column(row));
            let mut target = by_a.column_mut(row);
            target += column_adjoint * f[column];
            if row != column {
                by_f[row] += column_adjoint.dot(&a.column(column));
                let mut target = by_a.column_mut(column);
                target += column_adjoint * f[row];
            }
        }
        for (s, a) in self.transforms.iter().enumerate() {
            let by = by_transform[s] + self.wrench * by_felt[s].transpose();
            by_wrench += a * by_felt[s];
            moved[s] += by * a.transpose();
        }
        let mut before = Matrix6::zeros();
        for (j, xi) in self.joints.iter().enumerate() {
            before += moved[j];
            gradient[j] -= before.dot(&cross_motion(xi));
        }
        self.add_load_gradient(load, &by_wrench, gradient);
    }

    /// The part of the gradient that comes from the wrench, which keeps its direction in
    /// the base, follows the rope, or turns with the flange.
    fn add_load_gradient(&self, load: &Load, by_wrench: &Vector6<f64>, gradient: &mut [f64]) {
        let (by_force, by_moment) = split(by_wrench);
        // The moment about the flange's origin holds that of the force.
        let by_force = by_force + by_moment.cross(&self.loading_point);
        let (force, whole) = split(&self.wrench);
        let moment = whole - self.loading_point.cross(&force);
        match (load, self.anchor) {
            (Load::Rope { .. }, Some(anchor)) => {
                let rope = anchor - self.loading_point;
                let length = rope.norm();
                if length <= 0.0 {
                    return;
                }
                let unit = rope / length;
                // Negative where a cylinder pushes.
                let magnitude = force.dot(&unit);
                let by_anchor = (by_force - unit * unit.dot(&by_force)) * (magnitude / length);
                for (g, xi) in gradient.iter_mut().zip(&self.joints) {
                    let (shift, turn) = split(xi);
                    *g -= by_anchor.dot(&(shift + turn.cross(&anchor)));
                }
            }
            (Load::Constant { axes: Axes::Tool, .. }, _) => {}
            _ => {
                for (g, xi) in gradient.iter_mut().zip(&self.joints) {
                    let (_, turn) = split(xi);
                    *g -= by_force.dot(&turn.cross(&force)) + by_moment.dot(&turn.cross(&moment));
                }
            }
        }
    }
}

/// Motion transform of a frame with these axes (columns) and origin.
fn transform(axes: &Matrix3<f64>, origin: &Vector3<f64>) -> Matrix6<f64> {
    let mut out = Matrix6::zeros();
    out.fixed_view_mut::<3, 3>(0, 0).copy_from(axes);
    out.fixed_view_mut::<3, 3>(3, 3).copy_from(axes);
    let lever = origin.cross_matrix() * axes;
    out.fixed_view_mut::<3, 3>(0, 3).copy_from(&lever);
    out
}

fn stack(first: &Vector3<f64>, second: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(first.x, first.y, first.z, second.x, second.y, second.z)
}

fn split(v: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::new(v[0], v[1], v[2]), Vector3::new(v[3], v[4], v[5]))
}

/// ad(ξ): the change of a motion \[shift; turn\] that turns with ξ.
fn cross_motion(xi: &Vector6<f64>) -> Matrix6<f64> {
    let (shift, turn) = split(xi);
    let mut out = Matrix6::zeros();
    out.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn.cross_matrix());
    out.fixed_view_mut::<3, 3>(3, 3).copy_from(&turn.cross_matrix());
    out.fixed_view_mut::<3, 3>(0, 3).copy_from(&shift.cross_matrix());
    out
}

/// Place (base first), row and column of an effect.
fn entry(effect: &Effect) -> (usize, usize, usize) {
    match effect.term {
        ExtraTerm::Spring { joint, row, column } => (joint.map_or(0, |j| j + 1), row, column),
        // No other term is a random effect.
        _ => (0, 0, 0),
    }
}
