//! Serial revolute robots of any number of joints.
//!
//! Whatever the description (modified or standard Denavit–Hartenberg rows), a
//! robot becomes one chain: each joint turns about the z axis of its own frame,
//! placed by a fixed transform in the frame of the joint before it.

mod axes;
mod catalogue;
mod controller;
mod convention;
mod dh;
mod dh_robot;
mod entry;
mod origin;
mod shapes;

pub use axes::{AxisRows, JointAxis, rows_of_axes};
pub use catalogue::{catalogue, find as find_in_catalogue};
pub use controller::Controller;
pub use dh::{DhConvention, DhRow};
pub use dh_robot::DhRobot;
pub use dh_robot::MOST_JOINTS;
pub use entry::{CatalogueEntry, Doubt, DoubtAbout, JointStiffness};
pub use shapes::LinkCapsule;

use crate::error::{Code, Error, Result};
use nalgebra::{DMatrix, DVector, Isometry3, UnitQuaternion, Vector3};
use origin::Origin;
use shapes::Shapes;

/// Stands in for limits that nobody gave \[rad\].
const UNKNOWN_LIMITS: [f64; 2] = [-std::f64::consts::TAU, std::f64::consts::TAU];

/// One revolute joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name used in tables and messages, for example `joint 2`.
    pub name: String,
    /// Frame of this joint at serial angle zero in the frame of the joint
    /// before it (of the base for the first); the joint turns about its z \[m\].
    pub placement: Isometry3<f64>,
    /// The machine's limits of the controller angle \[rad\].
    pub limits: [f64; 2],
}

/// A serial chain of n revolute joints with elastic joints.
///
/// Controllers report angles q; the mechanism has the serial angles
/// θ = offset + C q. Jacobians, torques and stiffness live in θ; bounds, files
/// and pendant values in q.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    name: String,
    joints: Vec<Joint>,
    /// Whether the joints' limits were given: ±360° may be the true ones.
    has_limits: bool,
    flange: Isometry3<f64>,
    offset: DVector<f64>,
    coupling: DMatrix<f64>,
    /// Columns of the θ-from-e matrix E⁻¹ (n × springs) when the springs are not the joint axes.
    spring_mixing: Option<DMatrix<f64>>,
    /// The joints, or elastic coordinates, whose springs were left out, each with its column of E⁻¹.
    left_out: Vec<(usize, DVector<f64>)>,
    gravity_direction: Vector3<f64>,
    origin: Origin,
    shapes: Shapes,
    convention: DhConvention,
    rows: Vec<DhRow>,
}

impl Robot {
    /// Builds a chain from Denavit–Hartenberg rows (see [`DhConvention`]).
    ///
    /// `base` places the first frame in the robot's base frame. Controller
    /// angles equal serial angles (C = 1) and limits are ±2π until
    /// [`with_coupling`](Self::with_coupling) and
    /// [`with_limits`](Self::with_limits) say otherwise.
    ///
    /// # Errors
    /// No rows, or a number that is not finite.
    pub fn from_dh(
        name: impl Into<String>,
        convention: DhConvention,
        rows: &[DhRow],
        base: Isometry3<f64>,
    ) -> Result<Self> {
        if rows.is_empty() {
            return Err(Error::invalid("A robot needs at least one joint."));
        }
        let (placements, flange) = dh::chain(convention, rows, base)?;
        let joints = placements
            .into_iter()
            .enumerate()
            .map(|(i, placement)| Joint { name: format!("joint {}", i + 1), placement, limits: UNKNOWN_LIMITS })
            .collect();
        let n = rows.len();
        Ok(Robot {
            name: name.into(),
            joints,
            has_limits: false,
            flange,
            offset: DVector::from_iterator(n, rows.iter().map(|r| r.offset)),
            coupling: DMatrix::identity(n, n),
            spring_mixing: None,
            left_out: Vec::new(),
            gravity_direction: -Vector3::z(),
            origin: Origin::default(),
            shapes: Shapes::default(),
            convention,
            rows: rows.to_vec(),
        })
    }

    /// Sets C of θ = offset + C q (n × n, invertible).
    ///
    /// # Errors
    /// Wrong size, not finite, or singular.
    pub fn with_coupling(mut self, coupling: DMatrix<f64>) -> Result<Self> {
        self.check_square("C (theta_from_q)", &coupling)?;
        self.coupling = coupling;
        self.origin.settle(DoubtAbout::Angles);
        Ok(self)
    }

    /// Sets E of the elastic coordinates e = E θ (n × n, invertible), for
    /// parallelogram arms whose springs act on actuator coordinates. The
    /// default is the identity: one spring per joint axis.
    ///
    /// # Errors
    /// Wrong size, not finite, or singular.
    pub fn with_elastic_coordinates(mut self, e_from_theta: DMatrix<f64>) -> Result<Self> {
        let inverse = self.check_square("E (elastic_from_theta)", &e_from_theta)?;
        let identity = DMatrix::identity(self.joint_count(), self.joint_count());
        self.spring_mixing = (e_from_theta != identity).then_some(inverse);
        self.left_out.clear();
        Ok(self)
    }

    /// The same arm with some of its springs alone, counted from 0, ascending; the rest is rigid.
    ///
    /// # Panics
    /// A spring that the robot does not have.
    #[must_use]
    pub(crate) fn with_springs(mut self, selected: &[usize]) -> Self {
        let n = self.joint_count();
        let mixing = self.spring_mixing.take();
        let mixing = mixing.unwrap_or_else(|| DMatrix::identity(n, n));
        let springs: Vec<usize> = self.springs().collect();
        for (s, spring) in springs.into_iter().enumerate() {
            if !selected.contains(&s) {
                self.left_out.push((spring, mixing.column(s).into_owned()));
            }
        }
        self.spring_mixing = Some(mixing.select_columns(selected));
        self
    }

    /// Sets the machine's limits of the controller angles \[rad\], one pair per joint.
    ///
    /// # Errors
    /// Wrong number of pairs, or a lower limit that is not below the upper.
    pub fn with_limits(mut self, limits: &[[f64; 2]]) -> Result<Self> {
        if limits.len() != self.joint_count() {
            return Err(Error::new(
                Code::Dimension,
                format!("{} joint limits for {} joints.", limits.len(), self.joint_count()),
            ));
        }
        for (joint, limit) in self.joints.iter_mut().zip(limits) {
            // NaN is not below anything either.
            if limit[0].partial_cmp(&limit[1]) != Some(std::cmp::Ordering::Less) {
                return Err(Error::invalid(format!("The lower limit of {} is not below the upper one.", joint.name)));
            }
            joint.limits = *limit;
        }
        self.has_limits = true;
        self.origin.settle(DoubtAbout::Limits);
        Ok(self)
    }

    /// Sets the direction of gravity in base axes (default −z), for wall- and
    /// ceiling-mounted robots. The vector is normalised.
    ///
    /// # Errors
    /// A zero or non-finite vector.
    pub fn with_gravity_direction(mut self, direction: Vector3<f64>) -> Result<Self> {
        let unit = direction.try_normalize(1e-12).filter(|u| u.iter().all(|v| v.is_finite()));
        self.gravity_direction =
            unit.ok_or_else(|| Error::invalid("The direction of gravity must not have length zero."))?;
        Ok(self)
    }

    /// Sets the robot's name.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Sets the names of the joints, one each.
    ///
    /// # Errors
    /// Wrong number of names, or a name that appears twice.
    pub fn with_joint_names(mut self, names: &[String]) -> Result<Self> {
        if names.len() != self.joint_count() {
            return Err(Error::new(
                Code::Dimension,
                format!("{} joint names for {} joints.", names.len(), self.joint_count()),
            ));
        }
        for (j, name) in names.iter().enumerate() {
            if names[..j].contains(name) {
                return Err(Error::new(Code::Duplicate, format!("The joint name \"{name}\" appears twice.")));
            }
            self.joints[j].name.clone_from(name);
        }
        Ok(self)
    }

    /// Places the whole robot: `pose` is the pose of what was its base frame
    /// in the new one \[m\].
    #[must_use]
    pub fn with_base(mut self, pose: &Isometry3<f64>) -> Self {
        self.joints[0].placement = pose * self.joints[0].placement;
        self.origin.place(pose);
        self.shapes.place(pose);
        self
    }

    /// Places the flange: `pose` is its pose in what was the flange's frame \[m\].
    #[must_use]
    pub fn with_flange(mut self, pose: &Isometry3<f64>) -> Self {
        self.flange *= pose;
        self
    }

    /// Tilts each joint's axis about the y axis of its frame by β \[rad\], after
    /// TransX(a) of a modified row and before RotZ(θ): the fifth number of Hayati
    /// & Mirmirani (1985, doi:10.1002/rob.4620020406) for axes that are nearly parallel.
    ///
    /// # Errors
    /// Wrong number of tilts, or one that is not finite.
    pub fn with_tilts(mut self, tilts: &[f64]) -> Result<Self> {
        let n = self.joint_count();
        if tilts.len() != n {
            let message = format!("{} tilts for {n} joints.", tilts.len());
            return Err(Error::new(Code::Dimension, message));
        }
        if tilts.iter().any(|tilt| !tilt.is_finite()) {
            let message = "The tilt of an axis is not finite.";
            return Err(Error::new(Code::NotFinite, message));
        }
        for (joint, tilt) in self.joints.iter_mut().zip(tilts) {
            joint.placement *= UnitQuaternion::from_axis_angle(&Vector3::y_axis(), *tilt);
        }
        Ok(self)
    }

    fn check_square(&self, what: &str, matrix: &DMatrix<f64>) -> Result<DMatrix<f64>> {
        let n = self.joint_count();
        if matrix.shape() != (n, n) {
            return Err(Error::new(
                Code::Dimension,
                format!("{what} is {} × {}, but the robot has {n} joints.", matrix.nrows(), matrix.ncols()),
            ));
        }
        if matrix.iter().any(|v| !v.is_finite()) {
            return Err(Error::new(Code::NotFinite, format!("{what} has an entry that is not finite.")));
        }
        let scale = matrix.amax();
        matrix
            .clone()
            .try_inverse()
            .filter(|inverse| inverse.iter().all(|v| v.is_finite()) && inverse.amax() * scale < 1e12)
            .ok_or_else(|| Error::invalid(format!("{what} is singular.")))
    }

    /// Name of the robot.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of joints n.
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// Number of springs, the unknowns of an identification: n but where some are left out.
    pub fn spring_count(&self) -> usize {
        self.joints.len() - self.left_out.len()
    }

    /// Names of the springs, in the order of the columns of Ψ.
    pub fn spring_names(&self) -> Vec<String> {
        self.springs().map(|s| self.joints[s].name.clone()).collect()
    }

    /// The joints, or elastic coordinates, that have a spring.
    fn springs(&self) -> impl Iterator<Item = usize> {
        let is_left_out = |joint: usize| self.left_out.iter().any(|(spring, _)| *spring == joint);
        (0..self.joints.len()).filter(move |joint| !is_left_out(*joint))
    }

    /// True where springs lie on no single joint's axis.
    pub(crate) fn mixes_springs(&self) -> bool {
        let mixed = |mixing: &DMatrix<f64>| {
            let mut columns = mixing.column_iter();
            columns.any(|column| column.iter().filter(|v| **v != 0.0).count() > 1)
        };
        self.spring_mixing.as_ref().is_some_and(mixed)
    }

    /// Name of a joint that was left out and that the joint torques Γ \[N·m\] turn.
    pub(crate) fn left_out_but_turned(&self, torque: &[f64]) -> Option<&str> {
        let torque = DVector::from_column_slice(torque);
        let rounding = 1e-9 * torque.amax();
        let mut left_out = self.left_out.iter();
        let turned = left_out.find(|(_, column)| column.dot(&torque).abs() > rounding);
        turned.map(|(joint, _)| self.joints[*joint].name.as_str())
    }

    /// True when no limits of the controller angles were given and ±360° stand
    /// in for them.
    pub fn limits_are_unknown(&self) -> bool {
        !self.has_limits
    }

    /// The joints, base to flange.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Flange in the frame of the last joint.
    pub fn flange(&self) -> &Isometry3<f64> {
        &self.flange
    }

    /// Length of the arm: its links from base to flange, one after the other \[m\].
    pub fn length(&self) -> f64 {
        let links = self.joints.iter().map(|j| j.placement.translation.vector.norm());
        links.sum::<f64>() + self.flange.translation.vector.norm()
    }

    /// C of θ = offset + C q (n × n).
    pub fn coupling(&self) -> &DMatrix<f64> {
        &self.coupling
    }

    /// Columns of E⁻¹ (n × springs) where the springs are not simply the joint axes.
    pub fn spring_mixing(&self) -> Option<&DMatrix<f64>> {
        self.spring_mixing.as_ref()
    }

    /// Direction of gravity, unit vector in base axes.
    pub fn gravity_direction(&self) -> &Vector3<f64> {
        &self.gravity_direction
    }

    /// First joint whose controller angle leaves the machine's limits by more
    /// than 1e-9 rad (or is not a number), with the angle \[rad\].
    pub fn outside_limits(&self, q: &[f64]) -> Option<(usize, f64)> {
        self.joints
            .iter()
            .zip(q)
            .position(|(joint, a)| !(joint.limits[0] - 1e-9..=joint.limits[1] + 1e-9).contains(a))
            .map(|j| (j, q[j]))
    }

    /// Serial angles θ = offset + C q \[rad\].
    ///
    /// # Panics
    /// If `q` does not have n entries.
    pub fn serial_angles(&self, q: &[f64]) -> DVector<f64> {
        DVector::from_iterator(q.len(), self.each_serial_angle(q))
    }

    /// The same one after the other.
    ///
    /// # Panics
    /// If `q` does not have n entries.
    pub(crate) fn each_serial_angle(&self, q: &[f64]) -> impl Iterator<Item = f64> {
        assert_eq!(q.len(), self.joint_count(), "one controller angle per joint");
        let each = self.offset.iter().enumerate();
        each.map(move |(i, offset)| {
            let mut theta = *offset;
            for (j, qj) in q.iter().enumerate() {
                theta += self.coupling[(i, j)] * qj;
            }
            theta
        })
    }

    /// Controller angles q = C⁻¹ (θ − offset) \[rad\]; `None` where C cannot be
    /// inverted, which [`with_coupling`](Self::with_coupling) rules out.
    ///
    /// # Panics
    /// If `theta` does not have n entries.
    pub fn controller_angles(&self, theta: &DVector<f64>) -> Option<DVector<f64>> {
        assert_eq!(theta.len(), self.joint_count(), "one serial angle per joint");
        self.coupling.clone().lu().solve(&(theta - &self.offset))
    }

    /// Gradient with respect to q from the one with respect to θ: Cᵀ g.
    pub fn gradient_to_controller(&self, theta_gradient: &[f64], q_gradient: &mut [f64]) {
        for (j, out) in q_gradient.iter_mut().enumerate() {
            *out = theta_gradient.iter().enumerate().map(|(i, g)| self.coupling[(i, j)] * g).sum();
        }
    }
}
