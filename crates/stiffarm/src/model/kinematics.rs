//! Joint frames, points and Jacobians of a chain at one posture.
//!
//! Columns of the geometric Jacobian in the base frame: `[z_i × (p − o_i); z_i]`,
//! rows 0–2 linear \[m/rad\], rows 3–5 angular \[rad/rad\], with respect to the
//! serial angles θ. Derivatives use ∂c_i/∂θ_k = z_min(i,k) × c_max(i,k), where
//! c_i is the linear part of column i.

use crate::model::robot::Robot;
use nalgebra::{Isometry3, Matrix6xX, UnitQuaternion, Vector3};

/// Axes and origins of all joints and the flange, in base axes \[m\].
#[derive(Debug, Clone)]
pub struct Frames {
    axes: Vec<Vector3<f64>>,
    origins: Vec<Vector3<f64>>,
    /// What moves with each joint, after its turn.
    links: Vec<Isometry3<f64>>,
    theta: Vec<f64>,
    flange: Isometry3<f64>,
}

impl Frames {
    /// Frames of `robot` at the controller angles `q` \[rad\].
    ///
    /// # Panics
    /// If `q` does not have one entry per joint.
    pub fn new(robot: &Robot, q: &[f64]) -> Self {
        let mut frames = Frames::zero(robot.joint_count());
        frames.update(robot, q);
        frames
    }

    /// Frames at the serial angles θ \[rad\], without the coupling C.
    ///
    /// # Panics
    /// If `theta` does not have one entry per joint.
    pub fn at_serial_angles(robot: &Robot, theta: &[f64]) -> Self {
        let n = robot.joint_count();
        assert_eq!(theta.len(), n, "one serial angle per joint");
        let mut frames = Frames::zero(n);
        frames.update_serial(robot, theta.iter().copied());
        frames
    }

    /// Moves these frames to the serial angles θ \[rad\].
    ///
    /// # Panics
    /// If `theta` does not have one entry per joint.
    pub(crate) fn move_to_serial_angles(&mut self, robot: &Robot, theta: &[f64]) {
        assert_eq!(theta.len(), robot.joint_count(), "one serial angle per joint");
        self.update_serial(robot, theta.iter().copied());
    }

    /// Memory for the frames of `n` joints.
    pub(crate) fn zero(n: usize) -> Self {
        Frames {
            axes: vec![Vector3::zeros(); n],
            origins: vec![Vector3::zeros(); n],
            links: vec![Isometry3::identity(); n],
            theta: vec![0.0; n],
            flange: Isometry3::identity(),
        }
    }

    /// Moves these frames to the controller angles `q` \[rad\].
    ///
    /// # Panics
    /// If `q` does not have one entry per joint.
    pub fn update(&mut self, robot: &Robot, q: &[f64]) {
        self.update_serial(robot, robot.each_serial_angle(q));
    }

    /// Moves these frames to the serial angles θ \[rad\], one per joint.
    pub(crate) fn update_serial(&mut self, robot: &Robot, theta: impl Iterator<Item = f64>) {
        let mut frame = Isometry3::identity();
        for (i, (joint, angle)) in robot.joints().iter().zip(theta).enumerate() {
            frame *= joint.placement;
            self.theta[i] = angle;
            self.axes[i] = frame.rotation * Vector3::z();
            self.origins[i] = frame.translation.vector;
            frame.rotation *= UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
            // Long products drift off the unit sphere by rounding only; one
            // Newton step keeps rotations orthonormal to machine precision.
            frame.rotation.renormalize_fast();
            self.links[i] = frame;
        }
        self.flange = frame * robot.flange();
    }

    /// Number of joints n.
    pub fn joint_count(&self) -> usize {
        self.axes.len()
    }

    /// Pose of the flange in the base frame \[m\].
    pub fn flange(&self) -> &Isometry3<f64> {
        &self.flange
    }

    /// The serial angles θ \[rad\].
    pub fn serial_angles(&self) -> &[f64] {
        &self.theta
    }

    /// Frames that move with the joints: of each its own frame after its turn, in the base frame \[m\].
    pub fn links(&self) -> &[Isometry3<f64>] {
        &self.links
    }

    /// Unit axes z_i of the joints, base axes.
    pub fn axes(&self) -> &[Vector3<f64>] {
        &self.axes
    }

    /// A point on each joint's axis, base frame \[m\].
    pub fn origins(&self) -> &[Vector3<f64>] {
        &self.origins
    }

    /// Wrist centre: the point on the axis of the last joint but one \[m\].
    pub fn wrist_centre(&self) -> Vector3<f64> {
        self.origins[self.origins.len().saturating_sub(2)]
    }

    /// A point given in flange axes, in the base frame \[m\].
    #[inline]
    pub fn point(&self, in_flange: &Vector3<f64>) -> Vector3<f64> {
        self.flange.rotation * in_flange + self.flange.translation.vector
    }

    /// A direction given in flange axes, in base axes.
    pub fn direction(&self, in_flange: &Vector3<f64>) -> Vector3<f64> {
        self.flange.rotation * in_flange
    }

    /// Linear part of Jacobian column `i` at the base-frame point `p`.
    #[inline]
    pub fn column(&self, i: usize, p: &Vector3<f64>) -> Vector3<f64> {
        self.axes[i].cross(&(p - self.origins[i]))
    }

    /// Geometric Jacobian J(θ; p), 6 × n, base axes: rows 0–2 linear
    /// \[m/rad\], rows 3–5 angular \[rad/rad\], at the base-frame point `p`.
    pub fn jacobian(&self, p: &Vector3<f64>) -> Matrix6xX<f64> {
        let mut jacobian = Matrix6xX::zeros(self.joint_count());
        for i in 0..self.joint_count() {
            jacobian.fixed_view_mut::<3, 1>(0, i).copy_from(&self.column(i, p));
            jacobian.fixed_view_mut::<3, 1>(3, i).copy_from(&self.axes[i]);
        }
        jacobian
    }

    /// Adds to `gradient` the derivative with respect to θ of Σ_i a_i · c_i(p),
    /// where p moves with the flange, c_i are the linear columns at p and a_i
    /// fixed vectors: for each k, z_k · Σ_{i≥k} c_i × a_i + c_k · Σ_{i<k} a_i × z_i.
    pub(crate) fn add_column_gradient(
        &self,
        columns: &[Vector3<f64>],
        adjoints: &[Vector3<f64>],
        gradient: &mut [f64],
    ) {
        let mut behind = Vector3::zeros();
        for k in 0..self.joint_count() {
            gradient[k] += columns[k].dot(&behind);
            behind += adjoints[k].cross(&self.axes[k]);
        }
        let mut ahead = Vector3::zeros();
        for k in (0..self.joint_count()).rev() {
            ahead += columns[k].cross(&adjoints[k]);
            gradient[k] += self.axes[k].dot(&ahead);
        }
    }

    /// Adds to `gradient` the derivative with respect to θ of Σ_i a_i · z_i:
    /// for each k, z_k · Σ_{i>k} z_i × a_i.
    pub(crate) fn add_axis_gradient(&self, adjoints: &[Vector3<f64>], gradient: &mut [f64]) {
        let mut ahead = Vector3::zeros();
        for k in (0..self.joint_count()).rev() {
            gradient[k] += self.axes[k].dot(&ahead);
            ahead += self.axes[k].cross(&adjoints[k]);
        }
    }
}
