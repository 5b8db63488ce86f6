//! Observation matrix Ψ, Eqs. (9)–(11): Ψ H = Δ.
//!
//! Rows: for posture, for measuring point, x, y, z in base axes. Columns: one
//! per spring. Ψ_ij = J^m_ij · Γ_j with Γ = (J^f)ᵀ W, where J^f belongs to the
//! loading point and J^m to the measuring point.

mod class;
mod extra;
mod matrix;
mod spring;

pub use class::ElasticClass;
pub(crate) use extra::{Elements, places, row_part};
pub use extra::{ExtraTerm, RowPart};
pub use matrix::{Rows, fill_observation_matrix, observation_matrix, observation_shape};
pub(crate) use spring::{link_axes, on_first_axis};
/// What tests turn springs with.
pub(crate) mod internals {
    pub use super::spring::link_axes;
}

use crate::error::{Code, Error, Result};
use crate::model::kinematics::Frames;
use crate::model::load::{Load, LoadCase, Wrench};
use crate::model::robot::Robot;
use crate::model::tool::Tool;
use crate::numerics::information::scale_columns;
use nalgebra::{DMatrix, DVector, Vector3, Vector6};
use std::borrow::Cow;

/// What is loaded and measured: robot, tool and load.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// The robot.
    pub robot: Robot,
    /// Its tool.
    pub tool: Tool,
    /// Its load.
    pub load: Load,
}

impl Setup {
    /// The setup under each of its loads: itself alone where there are no load cases.
    pub fn cases(&self) -> Vec<Setup> {
        match self.load.cases() {
            [] => vec![self.clone()],
            cases => cases.iter().map(|case| self.under(case)).collect(),
        }
    }

    /// The setup under the load that readings of the state `state` were taken under: itself
    /// where there are no load cases.
    ///
    /// # Errors
    /// As [`Load::case_of`].
    pub fn of_state(&self, state: &str) -> Result<Cow<'_, Setup>> {
        let case = self.load.cases().get(self.load.case_of(state)?);
        Ok(match case {
            None => Cow::Borrowed(self),
            Some(case) => Cow::Owned(self.under(case)),
        })
    }

    /// The setup with a weight of `magnitude` \[N\] at its loading point as the load.
    pub(crate) fn under_weight(&self, magnitude: f64) -> Setup {
        Setup { load: Load::Weight { magnitude, direction: *self.robot.gravity_direction() }, ..self.clone() }
    }

    fn under(&self, case: &LoadCase) -> Setup {
        Setup { robot: self.robot.clone(), tool: self.tool.loaded_at(case.loading_point), load: case.load.clone() }
    }
}

/// Everything of one posture that Ψ and its derivatives need.
#[derive(Debug, Clone)]
pub struct PostureTerms {
    pub(crate) frames: Frames,
    pub(crate) loading_point: Vector3<f64>,
    pub(crate) loading_columns: Vec<Vector3<f64>>,
    pub(crate) measuring_points: Vec<Vector3<f64>>,
    /// Linear joint columns at the measuring points, point by point (m · n).
    pub(crate) columns: Vec<Vector3<f64>>,
    pub(crate) wrench: Wrench,
    pub(crate) torque: Vec<f64>,
    /// Joint torques in the reference \[N·m\]; none where it is unloaded.
    before: Vec<f64>,
}

/// A rope shorter than this has no direction \[m\].
const SHORTEST_ROPE: f64 = 1e-6;

impl PostureTerms {
    /// Terms at the controller angles `q` \[rad\]. `wrench` replaces the load's
    /// own (a measured wrench at the loading point, base axes).
    ///
    /// # Errors
    /// The load is [`Load::Measured`] and no wrench is given, or `q` has the
    /// wrong length or an entry that is not finite.
    pub fn new(setup: &Setup, q: &[f64], wrench: Option<&Wrench>) -> Result<Self> {
        let mut terms = PostureTerms::memory(setup);
        terms.move_to(setup, q, wrench)?;
        Ok(terms)
    }

    /// Memory for the terms of `setup` at one posture after another.
    pub(crate) fn memory(setup: &Setup) -> Self {
        let n = setup.robot.joint_count();
        let m = setup.tool.point_count();
        PostureTerms {
            frames: Frames::zero(n),
            loading_point: Vector3::zeros(),
            loading_columns: vec![Vector3::zeros(); n],
            measuring_points: vec![Vector3::zeros(); m],
            columns: vec![Vector3::zeros(); m * n],
            wrench: Wrench::force(Vector3::zeros()),
            torque: vec![0.0; n],
            before: Vec::new(),
        }
    }

    /// Moves these terms to the controller angles `q` \[rad\] without allocating.
    ///
    /// # Errors
    /// As [`PostureTerms::new`].
    pub(crate) fn move_to(&mut self, setup: &Setup, q: &[f64], wrench: Option<&Wrench>) -> Result<()> {
        check_angles(&setup.robot, q)?;
        self.frames.update(&setup.robot, q);
        self.fill(setup, wrench)
    }

    /// Recomputes everything at `q` without allocating.
    ///
    /// # Errors
    /// As [`PostureTerms::new`], except that `q` is trusted.
    pub(crate) fn update(&mut self, setup: &Setup, q: &[f64]) -> Result<()> {
        self.frames.update(&setup.robot, q);
        self.fill(setup, None)
    }

    pub(crate) fn fill(&mut self, setup: &Setup, wrench: Option<&Wrench>) -> Result<()> {
        let n = setup.robot.joint_count();
        self.loading_point = self.frames.point(&setup.tool.loading_point);
        let rope = setup.load.rope_length(&self.loading_point);
        if wrench.is_none() && rope.is_some_and(|length| length < SHORTEST_ROPE) {
            let message = "The rope's anchor lies on the loading point at a posture, so that the rope has no direction \
                           and pulls with nothing.";
            return Err(Error::invalid(message).key("load.anchor_mm").hint(
                "give the rope's fixed end in the base frame: it is not the loading point, which is in flange axes",
            ));
        }
        self.wrench = match wrench {
            Some(wrench) => *wrench,
            None => setup.load.wrench(&self.frames, &self.loading_point).ok_or_else(|| match &setup.load {
                Load::Cases(_) => {
                    Error::new(Code::Unsupported, "The cell has several load cases, and one load is asked for.")
                        .key("load.case")
                        .hint("put one of the loads alone into [load]")
                }
                _ => Error::new(Code::MissingKey, "The load is measured, but this posture comes with no force.").hint(
                    "give fx_n, fy_n, fz_n with each measurement; to plan or simulate, set load.kind to \
                         \"rope\", \"weight\" or \"wrench\" as the load will be",
                ),
            })?,
        };
        for j in 0..n {
            self.loading_columns[j] = self.frames.column(j, &self.loading_point);
            // Γ = (J^f)ᵀ W, Eq. (4).
            self.torque[j] = self.torque_of(&self.wrench, j);
        }
        for (a, point) in setup.tool.measuring_points.iter().enumerate() {
            let p = self.frames.point(&point.position);
            self.measuring_points[a] = p;
            for j in 0..n {
                self.columns[a * n + j] = self.frames.column(j, &p);
            }
        }
        Ok(())
    }

    fn torque_of(&self, wrench: &Wrench, j: usize) -> f64 {
        self.loading_columns[j].dot(&wrench.force) + self.frames.axes()[j].dot(&wrench.moment)
    }

    /// The same under another wrench, at the loading point, base axes.
    #[must_use]
    pub(crate) fn under(&self, wrench: &Wrench) -> Self {
        let mut out = self.clone();
        out.wrench = *wrench;
        for j in 0..out.torque.len() {
            out.torque[j] = out.torque_of(wrench, j);
        }
        out
    }

    /// The same against a reference that carries `preload` (at the loading point, base axes) instead of nothing.
    #[must_use]
    pub fn against(mut self, preload: &Wrench) -> Self {
        let joints = 0..self.torque.len();
        self.before = joints.map(|j| self.torque_of(preload, j)).collect();
        self
    }

    /// How many halves of its gap joint `j` goes through between reference and load, about its axis: from the middle,
    /// where it stands unloaded, or from the side on which a preload holds it. Without torque it may rest anywhere.
    pub(crate) fn halves_of_gap(&self, j: usize) -> f64 {
        let side = |torque: f64| if torque == 0.0 { 0.0 } else { torque.signum() };
        let before = self.before.get(j).copied().unwrap_or(0.0);
        side(before + self.torque[j]) - side(before)
    }

    /// The joint frames.
    pub fn frames(&self) -> &Frames {
        &self.frames
    }

    /// Loading point, base frame \[m\].
    pub fn loading_point(&self) -> &Vector3<f64> {
        &self.loading_point
    }

    /// Measuring points, base frame \[m\].
    pub fn measuring_points(&self) -> &[Vector3<f64>] {
        &self.measuring_points
    }

    /// Wrench at the loading point, base axes.
    pub fn wrench(&self) -> &Wrench {
        &self.wrench
    }

    /// Joint torques Γ = (J^f)ᵀ W, Eq. (4), serial joints \[N·m\].
    pub fn torque(&self) -> &[f64] {
        &self.torque
    }

    /// Loads of the springs: Γ itself, or E⁻ᵀ Γ in elastic coordinates \[N·m\].
    pub fn spring_loads(&self, robot: &Robot) -> DVector<f64> {
        let torque = DVector::from_column_slice(&self.torque);
        match robot.spring_mixing() {
            None => torque,
            Some(mixing) => mixing.tr_mul(&torque),
        }
    }

    /// Linear spring columns at the measuring points, 3m × springs \[m/rad\]: rows
    /// for measuring point, x, y, z; mixed by E⁻¹ where the springs are not
    /// the joints.
    pub fn spring_columns(&self, robot: &Robot) -> DMatrix<f64> {
        let n = self.torque.len();
        let m = self.measuring_points.len();
        let mut joints = DMatrix::zeros(3 * m, n);
        for a in 0..m {
            for j in 0..n {
                joints.fixed_view_mut::<3, 1>(3 * a, j).copy_from(&self.columns[a * n + j]);
            }
        }
        match robot.spring_mixing() {
            None => joints,
            Some(mixing) => joints * mixing,
        }
    }

    /// This posture's block of Ψ, 3m × springs, translations only, Eq. (11).
    pub fn block(&self, robot: &Robot) -> DMatrix<f64> {
        let mut block = self.spring_columns(robot);
        let loads = self.spring_loads(robot);
        // Ψ_ij = J^m_ij Γ_j, Eq. (11).
        scale_columns(&mut block, loads.iter().copied());
        block
    }

    /// Rotational rows of this posture's Ψ, 3 × springs \[rad\]: every point of the
    /// rigid tool turns alike.
    pub fn rotation_block(&self, robot: &Robot) -> DMatrix<f64> {
        let n = self.torque.len();
        let mut joints = DMatrix::zeros(3, n);
        for j in 0..n {
            joints.fixed_view_mut::<3, 1>(0, j).copy_from(&self.frames.axes()[j]);
        }
        let mut block = match robot.spring_mixing() {
            None => joints,
            Some(mixing) => joints * mixing,
        };
        let loads = self.spring_loads(robot);
        scale_columns(&mut block, loads.iter().copied());
        block
    }

    /// Known displacement of the measuring points from the series compliance
    /// between flange and reflectors, 3m \[m\]; zero without one.
    pub fn known_displacement(&self, tool: &Tool) -> DVector<f64> {
        let m = self.measuring_points.len();
        let mut displacement = DVector::zeros(3 * m);
        for (a, point) in self.measuring_points.iter().enumerate() {
            let twist = self.known_twist(tool, point);
            displacement.fixed_rows_mut::<3>(3 * a).copy_from(&twist.fixed_rows::<3>(0));
        }
        displacement
    }

    /// The same at the base-frame point `at` beyond the compliance: \[shift (m);
    /// turn (rad)\], base axes.
    pub fn known_twist(&self, tool: &Tool, at: &Vector3<f64>) -> Vector6<f64> {
        let Some(series) = &tool.series_compliance else {
            return Vector6::zeros();
        };
        let origin = self.frames.point(&series.origin);
        let at_origin = self.wrench.moved(&self.loading_point, &origin);
        let rotation = self.frames.flange().rotation;
        let force = rotation.inverse_transform_vector(&at_origin.force);
        let moment = rotation.inverse_transform_vector(&at_origin.moment);
        let twist = series.matrix * Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z);
        let shift = rotation * Vector3::new(twist[0], twist[1], twist[2]);
        let turn = rotation * Vector3::new(twist[3], twist[4], twist[5]);
        let shift = shift + turn.cross(&(at - origin));
        Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
    }
}

/// Checks length and finiteness of controller angles.
///
/// # Errors
/// Wrong number of angles, or one that is not finite.
pub fn check_angles(robot: &Robot, q: &[f64]) -> Result<()> {
    if q.len() != robot.joint_count() {
        return Err(Error::new(
            Code::Dimension,
            format!("{} angles for the {} joints of {}.", q.len(), robot.joint_count(), robot.name()),
        ));
    }
    match q.iter().position(|v| !v.is_finite()) {
        Some(j) => {
            Err(Error::new(Code::NotFinite, format!("The angle of {} is not a finite number.", robot.joints()[j].name)))
        }
        None => Ok(()),
    }
}
