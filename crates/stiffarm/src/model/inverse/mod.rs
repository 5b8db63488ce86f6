//! Inverse kinematics: the postures that hold the flange at a pose.
//!
//! Arms of two families (see `closed_form`) are solved in closed form, which
//! gives every posture; any other chain numerically. The families are found by
//! the chain's geometry, to rounding, so that calibrated axes, a placed base
//! and a coupling C are no obstacle; a chain that is nearly of a family starts
//! its numeric search from the postures of that family's arm.
//!
//! Libraries of closed forms exist, but want an arm described by their own
//! seven lengths, without base, coupling or calibrated axes.
//!
//! Our own inverse kinematics. The families are recognised by the chain's
//! geometry, so a placed base, calibrated axes and a coupling C are no
//! obstacle; rs-opw-kinematics wants seven lengths of its own and has none of
//! these, ik-geo came without a licence. Angles come from tangents of half
//! angles, not from arc cosines, which lose half their digits at a stretched
//! elbow. An arm that is nearly of a family starts its iterations from that
//! family's postures.

mod closed_form;
mod numeric;
mod search;
mod turns;
mod unreachable;

pub use unreachable::{Region, Unreachable};

use crate::error::{Code, Error, Result};
use crate::model::dexterity::inverted;
use crate::model::kinematics::Frames;
use crate::model::observation::check_angles;
use crate::model::robot::Robot;
use crate::numerics::information::svd;
use crate::units::{rad_to_deg, rad_to_sentence_deg};
use closed_form::{ClosedForm, Theta, wrapped};
use nalgebra::{DMatrix, Isometry3, Matrix6, Vector6};
use numeric::{Descent, SOLVED_RESIDUAL, scaled_columns, twist};
use std::vec::IntoIter;
use turns::Turns;
pub(crate) use turns::largest_change;

/// Deviation from a family's geometry that is rounding (rad, of the size).
const EXACT_GEOMETRY: f64 = 1e-9;
/// Deviation up to which a family's arm is worth starting from.
const SIMILAR_GEOMETRY: f64 = 0.1;
/// Distance of its branches from each other, for iterations that start there \[rad\].
const BRANCH_DISTANCE: f64 = 0.1;
/// A pose this near to the reachable ones counts as one (of the size).
const SLACK: f64 = 1e-10;
/// Residual that a posture may leave (of the size, rad).
const ACCEPTED_RESIDUAL: f64 = 1e-9;
/// Postures nearer than this, full turns aside, are one \[rad\].
const SAME_ANGLE: f64 = 1e-7;
/// Condition number of the scaled Jacobian of a singular posture.
const SINGULAR_CONDITION: f64 = 1e6;
/// Iterations along one branch.
const STEPS_OF_A_BRANCH: usize = 50;

/// How postures are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Every posture by formulas.
    ClosedForm,
    /// Those that iterations from many starts find.
    Numeric,
}

impl Method {
    /// Name for tables and messages.
    pub fn as_str(self) -> &'static str {
        match self {
            Method::ClosedForm => "closed form",
            Method::Numeric => "numeric",
        }
    }
}

/// One posture of a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Controller angles \[rad\].
    pub q: Vec<f64>,
    /// Whether they are within the machine's limits.
    pub within_limits: bool,
    /// Condition number of the Jacobian at the flange: linear rows over the
    /// arm's size, ‖J‖·‖J⁺‖ in Frobenius norms over the rank it should have.
    /// 1 is best; infinite where a rank is lost.
    pub condition: f64,
    /// Whether the posture is singular, as far as numbers tell (condition
    /// above 10⁶). Where angles are free there, it stands for all of them.
    pub singular: bool,
}

/// What is known of a pose.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Its postures, at least one, inside the machine's limits or not.
    Reachable(Vec<Branch>),
    /// How far it is out of reach.
    Unreachable(Unreachable),
}

/// Finds the postures that hold the flange at a pose.
#[derive(Debug, Clone)]
pub struct InverseKinematics {
    robot: Robot,
    turns: Turns,
    /// Length of the chain, what a radian is weighed against \[m\].
    size: f64,
    closed_form: Option<ClosedForm>,
    /// Closed form of the arm that this one nearly is.
    similar: Option<ClosedForm>,
}

impl InverseKinematics {
    /// Prepares the inverse kinematics of `robot`; its geometry decides on the
    /// method.
    pub fn new(robot: &Robot) -> Self {
        let zero = Frames::at_serial_angles(robot, &vec![0.0; robot.joint_count()]);
        let origins = zero.origins().iter();
        let ends = zero.origins().iter().skip(1);
        let tip = &zero.flange().translation.vector;
        let length: f64 = origins.zip(ends.chain([tip])).map(|(a, b)| (b - a).norm()).sum();
        // A chain without length only turns: metres then weigh as radians.
        let size = if length > 0.0 { length } else { 1.0 };
        let closed_form = ClosedForm::detect(&zero, size, EXACT_GEOMETRY, 0.0);
        let similar = match closed_form {
            Some(_) => None,
            None => ClosedForm::detect(&zero, size, SIMILAR_GEOMETRY, BRANCH_DISTANCE),
        };
        InverseKinematics { turns: Turns::new(robot), robot: robot.clone(), size, closed_form, similar }
    }

    /// How postures are found.
    pub fn method(&self) -> Method {
        match self.closed_form {
            Some(_) => Method::ClosedForm,
            None => Method::Numeric,
        }
    }

    /// The robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Every posture with the flange at `flange` (base frame, \[m\]), each
    /// with the full turns nearest to the middle of the machine's limits; those
    /// outside the limits are included and marked.
    ///
    /// In closed form these are all, at most eight, ordered by shoulder, elbow
    /// and wrist; angles that a singular pose leaves free are near the middle
    /// of the limits. A numeric search of six joints or fewer gives those that
    /// many starts find; of more joints, a sample of different postures,
    /// within the limits where any was found there.
    ///
    /// # Errors
    /// A pose that is not finite; [`Code::Unreachable`], with the distance.
    pub fn branches(&self, flange: &Isometry3<f64>) -> Result<Vec<Branch>> {
        match self.solve(flange)? {
            Outcome::Reachable(branches) => Ok(branches),
            Outcome::Unreachable(unreachable) => Err(unreachable.error(&self.robot)),
        }
    }

    /// As [`branches`](Self::branches), with an unreachable pose as a value.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn solve(&self, flange: &Isometry3<f64>) -> Result<Outcome> {
        check_pose(flange)?;
        let branches = self.all(flange, self.turns.middle());
        if !branches.is_empty() {
            return Ok(Outcome::Reachable(branches));
        }
        Ok(Outcome::Unreachable(self.unreachable(flange)?))
    }

    /// The posture within the machine's limits whose largest change of a
    /// controller angle from `start` \[rad\] is smallest, full turns included.
    ///
    /// Among all postures where [`branches`](Self::branches) gives all; with
    /// more than six joints the one that iterations from `start` lead to. At a
    /// singular pose free angles stay near `start`.
    ///
    /// # Errors
    /// A pose or `start` that is not finite, or of another length;
    /// [`Code::Unreachable`], with the distance; [`Code::OutsideLimits`], with
    /// the joint that leaves its limits in the posture that does so least.
    pub fn nearest(&self, flange: &Isometry3<f64>, start: &[f64]) -> Result<Vec<f64>> {
        check_pose(flange)?;
        check_angles(&self.robot, start)?;
        let mut best: Option<(f64, Vec<f64>)> = None;
        if self.closed_form.is_none()
            && let Some(q) = self.led_from(flange, start)
        {
            if self.robot.joint_count() > 6 {
                return Ok(q);
            }
            best = Some((largest_change(&q, start), q));
        }
        let branches = self.all(flange, start);
        for branch in &branches {
            if let Some(q) = self.turns.near(&branch.q, start) {
                let change = largest_change(&q, start);
                if best.as_ref().is_none_or(|(least, _)| change < *least) {
                    best = Some((change, q));
                }
            }
        }
        match best {
            Some((_, q)) => Ok(q),
            None if branches.is_empty() => Err(self.unreachable(flange)?.error(&self.robot)),
            None => Err(self.outside_limits(&branches)),
        }
    }

    /// The posture that Newton's iterations from `start` lead to: one branch,
    /// followed along a path point by point. A few microseconds a point;
    /// machine limits are not looked at.
    ///
    /// # Errors
    /// A pose or `start` that is not finite, or of another length;
    /// [`Code::Unreachable`] when the iterations do not converge, because the
    /// pose is out of reach or the branch ends before it.
    pub fn follow(&self, flange: &Isometry3<f64>, start: &[f64]) -> Result<Vec<f64>> {
        check_pose(flange)?;
        check_angles(&self.robot, start)?;
        let mut q = start.to_vec();
        let residual = Descent::new(&self.robot, self.size).solve(flange, &mut q, None, STEPS_OF_A_BRANCH);
        if residual <= SOLVED_RESIDUAL {
            return Ok(q);
        }
        Err(Error::new(
            Code::Unreachable,
            "The posture cannot be followed to the pose: it is out of reach, or a singular posture lies between.",
        )
        .hint("take smaller steps, or look at all postures of the pose"))
    }

    /// `q` \[rad\] with full turns of its joints added so that it is within the
    /// machine's limits and as near to `near` as they allow (largest change);
    /// `None` when no turns are within the limits.
    pub fn turns_near(&self, q: &[f64], near: &[f64]) -> Option<Vec<f64>> {
        let both_fit = self.fits(q) && self.fits(near);
        both_fit.then(|| self.turns.near(q, near)).flatten()
    }

    /// Writes to `turned` what [`turns_near`](Self::turns_near) says of finite angles; the largest change from `near`
    /// \[rad\], `None` also where it is `least` or more.
    pub(crate) fn turned_near(&self, q: &[f64], near: &[f64], least: f64, turned: &mut [f64]) -> Option<f64> {
        self.turns.turned_near(q, near, least, turned)
    }

    /// Every posture within the machine's limits that differs from `q` \[rad\]
    /// by full turns of its joints; of very wide limits those about the middle.
    pub fn turns_within_limits(&self, q: &[f64]) -> Vec<Vec<f64>> {
        if self.fits(q) { self.turns.within_limits(q) } else { Vec::new() }
    }

    fn fits(&self, q: &[f64]) -> bool {
        q.len() == self.robot.joint_count() && q.iter().all(|v| v.is_finite())
    }

    /// All branches, free angles near `near`.
    fn all(&self, flange: &Isometry3<f64>, near: &[f64]) -> Vec<Branch> {
        let Some(mut postures) = self.postures(flange, near) else {
            return self.search(flange, near);
        };
        let mut frames = Frames::zero(self.robot.joint_count());
        let mut branches: Vec<Branch> = Vec::with_capacity(8);
        while let Some(q) = postures.next(&mut frames) {
            branches.push(self.branch(q, self.inverse_jacobian(&frames).0));
        }
        branches
    }

    /// The postures of [`solve`](Self::solve) one by one, `None` without a closed form.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub(crate) fn each_posture<'a>(&'a self, flange: &'a Isometry3<f64>) -> Result<Option<Postures<'a>>> {
        check_pose(flange)?;
        Ok(self.postures(flange, self.turns.middle()))
    }

    fn postures<'a>(&'a self, flange: &'a Isometry3<f64>, near: &[f64]) -> Option<Postures<'a>> {
        let closed_form = self.closed_form.as_ref()?;
        let solutions = closed_form.solve(flange, &self.theta(near), SLACK * self.size);
        Some(Postures {
            inverse: self,
            flange,
            before: Vec::with_capacity(solutions.len()),
            solutions: solutions.into_iter(),
        })
    }

    fn theta(&self, q: &[f64]) -> Theta {
        let serial = self.robot.serial_angles(q);
        std::array::from_fn(|i| serial[i])
    }

    /// `q` has the turns nearest to the middle of the limits.
    fn branch(&self, q: Vec<f64>, condition: f64) -> Branch {
        Branch { within_limits: self.turns.contain(&q), singular: condition > SINGULAR_CONDITION, q, condition }
    }

    /// A Newton step where formulas leave more than rounding, to which `frames` move; whether the posture then holds
    /// the pose.
    fn polish(&self, frames: &mut Frames, flange: &Isometry3<f64>, theta: &mut Theta) -> bool {
        frames.update_serial(&self.robot, theta.iter().copied());
        let mut residual = twist(flange, frames.flange(), self.size);
        for _ in 0..2 {
            if residual.norm() < 1e-14 {
                break;
            }
            let (_, Some(inverse)) = self.inverse_jacobian(frames) else { break };
            let step = inverse * residual;
            let trial: Theta = std::array::from_fn(|i| theta[i] + step[i]);
            frames.update_serial(&self.robot, trial.iter().copied());
            let next = twist(flange, frames.flange(), self.size);
            if next.norm() >= 0.5 * residual.norm() {
                frames.update_serial(&self.robot, theta.iter().copied());
                break;
            }
            (*theta, residual) = (trial, next);
        }
        residual.norm() <= ACCEPTED_RESIDUAL
    }

    /// Condition number and inverse of the scaled Jacobian of six joints.
    fn inverse_jacobian(&self, frames: &Frames) -> (f64, Option<Matrix6<f64>>) {
        let mut jacobian = Matrix6::zeros();
        for (i, column) in scaled_columns(frames, self.size).enumerate() {
            jacobian.set_column(i, &column);
        }
        inverted(jacobian)
    }

    /// Condition number of the scaled Jacobian at controller angles.
    fn condition(&self, q: &[f64]) -> f64 {
        let frames = Frames::new(&self.robot, q);
        let columns: Vec<Vector6<f64>> = scaled_columns(&frames, self.size).collect();
        let mut jacobian = DMatrix::from_fn(6, columns.len(), |i, j| columns[j][i]);
        if columns.len() > 6 {
            jacobian = jacobian.transpose();
        }
        let rank = jacobian.ncols() as f64;
        svd(jacobian).map_or(f64::INFINITY, |svd| {
            let inverse: f64 = svd.values.iter().map(|s| s.powi(-2)).sum();
            svd.values.norm() * inverse.sqrt() / rank
        })
    }

    /// Says which joint leaves its limits, in the posture that does so least.
    fn outside_limits(&self, branches: &[Branch]) -> Error {
        let excesses = branches.iter().map(|b| (self.turns.excess(&b.q), &b.q));
        let least = excesses.min_by(|a, b| a.0.1.total_cmp(&b.0.1));
        let Some(((joint, excess), q)) = least else {
            return Error::new(Code::OutsideLimits, "No posture is within the limits.");
        };
        let (angle, name) = (rad_to_deg(q[joint]), &self.robot.joints()[joint].name);
        let [low, high] = self.robot.joints()[joint].limits.map(rad_to_sentence_deg);
        Error::new(
            Code::OutsideLimits,
            format!(
                "The pose takes {name} to {angle:.1}°, {:.1}° outside the machine's limits, {low}° to {high}°.",
                rad_to_deg(excess)
            ),
        )
        .hint(match branches.len() {
            1 => "it has no other posture; move or turn the pose".to_string(),
            count => format!("of the pose's {count} postures this one leaves the limits least; move or turn the pose"),
        })
    }
}

/// The postures of a pose in closed form, one after the other, each once.
pub(crate) struct Postures<'a> {
    inverse: &'a InverseKinematics,
    flange: &'a Isometry3<f64>,
    solutions: IntoIter<Theta>,
    before: Vec<Theta>,
}

impl Postures<'_> {
    /// The next one, with the full turns nearest to the middle of the machine's limits \[rad\]; `frames` move there.
    pub(crate) fn next(&mut self, frames: &mut Frames) -> Option<Vec<f64>> {
        for mut theta in self.solutions.by_ref() {
            if !self.inverse.polish(frames, self.flange, &mut theta) {
                continue;
            }
            let is_same = |other: &Theta| other.iter().zip(&theta).all(|(a, b)| wrapped(a - b).abs() < SAME_ANGLE);
            if !self.before.iter().any(is_same) {
                self.before.push(theta);
                let turns = &self.inverse.turns;
                return Some(turns.to_middle(turns.controller_angles(&theta)));
            }
        }
        None
    }
}

fn check_pose(pose: &Isometry3<f64>) -> Result<()> {
    let numbers = pose.translation.vector.iter();
    if numbers.chain(pose.rotation.coords.iter()).all(|v| v.is_finite()) {
        return Ok(());
    }
    Err(Error::new(Code::NotFinite, "The pose has a number that is not finite."))
}
