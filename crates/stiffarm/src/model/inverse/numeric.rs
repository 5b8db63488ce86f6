//! Postures by iteration, for any chain: damped least squares in q.
//!
//! The damping is proportional to the squared residual, which keeps quadratic
//! convergence even where the Jacobian loses rank (N. Yamashita, M. Fukushima,
//! *On the rate of convergence of the Levenberg–Marquardt method*, Computing
//! Suppl. 15, 2001, 239–249, doi:10.1007/978-3-7091-6217-0_18); the step is
//! written with A·Aᵀ, which is 6 × 6 for any number of joints and gives the
//! smallest step where there are more than six.

use crate::model::kinematics::Frames;
use crate::model::robot::Robot;
use crate::numerics::information::svd;
use nalgebra::{DMatrix, DVector, Isometry3, Matrix6, UnitQuaternion, Vector3, Vector6};

/// Residual below which nothing is left to gain (of the arm's size, rad).
const SETTLED_RESIDUAL: f64 = 1e-13;
/// Residual of a posture that holds the pose (of the arm's size, rad).
pub(super) const SOLVED_RESIDUAL: f64 = 1e-11;
/// Largest step of an angle \[rad\].
const LARGEST_STEP: f64 = 0.7;

/// What an iteration works with; one per search.
pub(super) struct Descent<'a> {
    robot: &'a Robot,
    /// Metres that count as much as a radian.
    size: f64,
    frames: Frames,
    /// Columns of the Jacobian with respect to q, linear rows over `size`.
    columns: Vec<Vector6<f64>>,
    step: Vec<f64>,
    trial: Vec<f64>,
    held: Vec<bool>,
}

impl<'a> Descent<'a> {
    pub(super) fn new(robot: &'a Robot, size: f64) -> Self {
        let n = robot.joint_count();
        Descent {
            robot,
            size,
            frames: Frames::at_serial_angles(robot, &vec![0.0; n]),
            columns: vec![Vector6::zeros(); n],
            step: vec![0.0; n],
            trial: vec![0.0; n],
            held: vec![false; n],
        }
    }

    /// Moves `q` towards a posture with the flange at `target`, inside `limits`
    /// where given; returns the residual's length, below [`SOLVED_RESIDUAL`] when found.
    pub(super) fn solve(
        &mut self,
        target: &Isometry3<f64>,
        q: &mut [f64],
        limits: Option<&[[f64; 2]]>,
        steps: usize,
    ) -> f64 {
        self.frames.update(self.robot, q);
        let mut residual = twist(target, self.frames.flange(), self.size);
        let mut length = residual.norm();
        let mut damping = 1e-2;
        for _ in 0..steps {
            if length.is_nan() || length <= SETTLED_RESIDUAL {
                break;
            }
            self.update_columns();
            let mut better = false;
            for _ in 0..12 {
                let weight = (damping * length * length).max(1e-15);
                let slope = self.damped_step(&residual, weight, q, limits);
                // At a minimum that is no solution.
                if slope <= 1e-6 * length {
                    break;
                }
                for (j, trial) in self.trial.iter_mut().enumerate() {
                    *trial = q[j] + self.step[j];
                    if let Some(limits) = limits {
                        *trial = trial.clamp(limits[j][0], limits[j][1]);
                    }
                }
                self.frames.update(self.robot, &self.trial);
                let next = twist(target, self.frames.flange(), self.size);
                if next.norm() < length {
                    better = true;
                    residual = next;
                    length = next.norm();
                    q.copy_from_slice(&self.trial);
                    damping *= 0.2;
                    break;
                }
                damping *= 5.0;
            }
            if !better {
                break;
            }
        }
        length
    }

    /// What is missing at `q` to position \[m\] and orientation \[rad\].
    pub(super) fn missing(&mut self, target: &Isometry3<f64>, q: &[f64]) -> (f64, f64) {
        self.frames.update(self.robot, q);
        let (linear, angular) = parts(&twist(target, self.frames.flange(), self.size));
        (linear.norm() * self.size, angular.norm())
    }

    /// Direction of q in which the flange moves least, its largest entry ±1;
    /// for six joints.
    pub(super) fn idle_direction(&mut self, q: &[f64]) -> Option<Vec<f64>> {
        self.frames.update(self.robot, q);
        self.update_columns();
        let jacobian = DMatrix::from_fn(6, q.len(), |i, j| self.columns[j][i]);
        let direction = svd(jacobian)?.v.column(q.len() - 1).into_owned();
        let largest = direction.amax();
        Some(direction.iter().map(|d| d / largest).collect())
    }

    /// Columns at the frames' posture.
    fn update_columns(&mut self) {
        let coupling = self.robot.coupling();
        let tip = self.frames.flange().translation.vector;
        self.columns.fill(Vector6::zeros());
        for (i, axis) in self.frames.axes().iter().enumerate() {
            let linear = self.frames.column(i, &tip) / self.size;
            let column = stacked(&linear, axis);
            for (j, sum) in self.columns.iter_mut().enumerate() {
                let factor = coupling[(i, j)];
                if factor != 0.0 {
                    *sum += column * factor;
                }
            }
        }
    }

    /// Sets the step Aᵀ(AAᵀ + λ)⁻¹e, without the joints that it would push
    /// through their limits; returns the length of the slope Aᵀe.
    fn damped_step(&mut self, residual: &Vector6<f64>, weight: f64, q: &[f64], limits: Option<&[[f64; 2]]>) -> f64 {
        let n = q.len();
        self.held.fill(false);
        for _ in 0..=n {
            let mut square = Matrix6::from_diagonal_element(weight);
            let mut slope = 0.0;
            for (column, held) in self.columns.iter().zip(&self.held) {
                if !held {
                    square += column * column.transpose();
                    slope += column.dot(residual).powi(2);
                }
            }
            let Some(factor) = square.cholesky() else {
                return 0.0;
            };
            let solved = factor.solve(residual);
            let mut largest = 0.0_f64;
            let mut pushed = false;
            for j in 0..n {
                self.step[j] = if self.held[j] { 0.0 } else { self.columns[j].dot(&solved) };
                largest = largest.max(self.step[j].abs());
                if let Some(limits) = limits {
                    let [low, high] = limits[j];
                    let out = (q[j] <= low && self.step[j] < 0.0) || (q[j] >= high && self.step[j] > 0.0);
                    self.held[j] |= out;
                    pushed |= out;
                }
            }
            if !pushed {
                if largest > LARGEST_STEP {
                    self.step.iter_mut().for_each(|s| *s *= LARGEST_STEP / largest);
                }
                return slope.sqrt();
            }
        }
        0.0
    }

    /// Moves `q` to where the flange's position is nearest to the target's while
    /// it holds the target's orientation; returns what is missing to position
    /// \[m\] and orientation \[rad\].
    ///
    /// Each step minimises |J_p Δ − e_p|² + λ|Δ|² subject to J_ω Δ = e_ω.
    pub(super) fn approach(&mut self, target: &Isometry3<f64>, q: &mut [f64]) -> (f64, f64) {
        const STEPS: usize = 200;
        let n = q.len();
        self.frames.update(self.robot, q);
        let mut residual = twist(target, self.frames.flange(), self.size);
        let merit = |e: &Vector6<f64>| parts(e).0.norm() + 10.0 * parts(e).1.norm();
        let mut damping = 1e-2;
        for _ in 0..STEPS {
            self.update_columns();
            let mut system = DMatrix::zeros(n + 3, n + 3);
            let mut right = DVector::zeros(n + 3);
            let (linear, angular) = parts(&residual);
            for j in 0..n {
                let (column, turn) = parts(&self.columns[j]);
                for k in 0..n {
                    system[(j, k)] = column.dot(&parts(&self.columns[k]).0);
                }
                right[j] = column.dot(&linear);
                for i in 0..3 {
                    system[(n + i, j)] = turn[i];
                    system[(j, n + i)] = turn[i];
                    right[n + i] = angular[i];
                }
            }
            let before = merit(&residual);
            for _ in 0..12 {
                let mut damped = system.clone();
                for j in 0..n {
                    damped[(j, j)] += damping;
                }
                let Some(step) = damped.lu().solve(&right) else {
                    damping *= 4.0;
                    continue;
                };
                let largest = step.rows(0, n).amax();
                let share = (LARGEST_STEP / largest).min(1.0);
                for j in 0..n {
                    self.trial[j] = q[j] + share * step[j];
                }
                self.frames.update(self.robot, &self.trial);
                let next = twist(target, self.frames.flange(), self.size);
                if merit(&next) < before {
                    residual = next;
                    q.copy_from_slice(&self.trial);
                    damping *= 0.3;
                    break;
                }
                damping *= 4.0;
            }
            if before - merit(&residual) <= 1e-11 * before {
                break;
            }
        }
        let (linear, angular) = parts(&residual);
        (linear.norm() * self.size, angular.norm())
    }
}

fn stacked(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

fn parts(twist: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::new(twist[0], twist[1], twist[2]), Vector3::new(twist[3], twist[4], twist[5]))
}

/// From `pose` to `target`: the way over `size`, and the rotation vector in
/// base axes \[rad\].
pub(super) fn twist(target: &Isometry3<f64>, pose: &Isometry3<f64>, size: f64) -> Vector6<f64> {
    let way = (target.translation.vector - pose.translation.vector) / size;
    stacked(&way, &rotation_vector(&(target.rotation * pose.rotation.inverse())))
}

/// The shorter rotation vector \[rad\], exact to rounding for small ones.
fn rotation_vector(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    let sine = rotation.imag();
    let length = sine.norm();
    if length == 0.0 {
        return Vector3::zeros();
    }
    let angle = 2.0 * length.atan2(rotation.w.abs());
    sine * (angle / length).copysign(rotation.w)
}

/// Columns of J with respect to θ, linear rows over `size`.
pub(super) fn scaled_columns(frames: &Frames, size: f64) -> impl Iterator<Item = Vector6<f64>> {
    let tip = frames.flange().translation.vector;
    let axes = frames.axes().iter().enumerate();
    axes.map(move |(i, axis)| stacked(&(frames.column(i, &tip) / size), axis))
}
